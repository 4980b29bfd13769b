//! The decoder of the model of cycles against a disassembler, over every instruction of the image:
//! class, length, words of a transfer, registers of addresses and of the FPU.

use core::str::FromStr as _;
use std::collections::BTreeMap;
use std::process::Command;

use fieldline_cycles::decode::decode;
use fieldline_cycles::instruction::{Class, Instruction};
use fieldline_tests::emulator::image;

/// Of the binary utilities for ARM: `apt-get install binutils-arm-none-eabi`.
const DISASSEMBLER: &str = "arm-none-eabi-objdump";

/// An instruction as the disassembler writes it.
struct Line<'a> {
    text: &'a str,
    code: Vec<u8>,
    /// Without condition suffixes of the width, as in `ldr` for `ldr.w`.
    mnemonic: &'a str,
    operands: &'a str,
}

impl<'a> Line<'a> {
    /// Reads ` 800018c:⇥4812 ⇥ldr⇥r0, [pc, #72]⇥@ comment`; `None` for data and headings.
    fn read(text: &'a str) -> Option<Self> {
        let mut parts = text.split('\t');
        parts.next()?.trim().strip_suffix(':')?;
        let mut code = Vec::new();
        for halfword in parts.next()?.split_whitespace() {
            code.extend(u16::from_str_radix(halfword, 16).ok()?.to_le_bytes());
        }
        let mnemonic = parts.next()?;
        let is_data = mnemonic.starts_with('.') || mnemonic.starts_with('<');
        (!is_data).then(|| Line {
            text,
            code,
            mnemonic: mnemonic.split('.').next().unwrap_or_default(),
            operands: parts.next().unwrap_or_default(),
        })
    }

    fn first(&self) -> &str {
        self.operands.split(',').next().unwrap_or_default().trim()
    }

    /// The operands in the brackets, or all of them.
    fn within(&self, open: char, close: char) -> &str {
        let inside = self.operands.split_once(open).map(|(_, rest)| rest);
        let inside = inside.and_then(|rest| rest.split_once(close));
        inside.map_or(self.operands, |(inside, _)| inside)
    }

    /// Whether the mnemonic is one of these, with any condition.
    fn is(&self, names: &[&str]) -> bool {
        names.iter().any(|name| self.mnemonic.starts_with(name))
    }

    /// The class by the mnemonic.
    fn class(&self) -> Class {
        let (words, has_pc) = listed(self.within('{', '}'));
        let single = self.first().starts_with('s');
        let offset = self.within('[', ']').split(',').nth(1);
        let by_register = offset.is_some_and(|it| core_register(it.trim()).is_some());
        let rest = self.mnemonic.get(2..).unwrap_or_default();
        match self {
            _ if self.is(&["ldrd"]) => Class::Multiple {
                words: 2,
                load: true,
            },
            _ if self.is(&["strd"]) => Class::Multiple {
                words: 2,
                load: false,
            },
            _ if self.is(&["ldr"]) && self.first() == "pc" => Class::BranchLoad { words: 1 },
            _ if self.is(&["ldr"]) => Class::Load,
            _ if self.is(&["strex"]) || self.is(&["str"]) && by_register => Class::StoreRegister,
            _ if self.is(&["str"]) => Class::StoreImmediate,
            _ if self.is(&["ldm", "pop"]) && has_pc => Class::BranchLoad { words },
            _ if self.is(&["ldm", "pop", "vldm", "vpop"]) => Class::Multiple { words, load: true },
            _ if self.is(&["stm", "push", "vstm", "vpush"]) => {
                Class::Multiple { words, load: false }
            }
            _ if self.is(&["vldr"]) && single => Class::FpLoad,
            _ if self.is(&["vstr"]) && single => Class::FpStore,
            _ if self.is(&["vldr", "vstr"]) => Class::Multiple {
                words: 2,
                load: self.is(&["vldr"]),
            },
            _ if self.is(&["sdiv", "udiv"]) => Class::Divide,
            _ if self.is(&["vdiv", "vsqrt"]) => Class::FpDivide,
            _ if self.is(&["vmla", "vmls", "vfm", "vfnm", "vnmla", "vnmls"]) => {
                Class::FpMultiplyAdd
            }
            _ if self.is(&["vadd", "vsub", "vmul", "vnmul", "vcvt"]) => Class::FpArithmetic,
            _ if self.is(&["vmov"]) && self.operands.matches(',').count() > 1 => Class::FpMoveTwo,
            _ if self.is(&["v"]) => Class::FpMove,
            _ if self.is(&["tbb", "tbh"]) => Class::BranchTable,
            _ if self.is(&["it"]) && rest.chars().all(|c| c == 't' || c == 'e') => Class::IfThen,
            _ if self.is(&["cbz", "cbnz"]) => Class::Branch,
            _ if self.is(&["bx", "blx"]) => Class::BranchRegister,
            _ if self.is_branch() => Class::Branch,
            _ if self.is(&["mov"]) && self.first() == "pc" => Class::BranchRegister,
            _ if self.is(&["msr", "mrs", "cps"]) => Class::System,
            _ if self.is(&["dmb", "dsb", "isb", "clrex"]) => Class::Barrier,
            _ if self.is(&["wfi", "wfe"]) => Class::Wait,
            _ if self.is(&["udf", "bkpt", "svc"]) => Class::Unknown,
            _ => Class::Alu,
        }
    }

    fn is_branch(&self) -> bool {
        const CONDITIONS: [&str; 15] = [
            "", "eq", "ne", "cs", "cc", "mi", "pl", "vs", "vc", "hi", "ls", "ge", "lt", "gt", "le",
        ];
        let after = |name| self.mnemonic.strip_prefix(name);
        let branches = ["b", "bl"].into_iter().filter_map(after);
        branches
            .into_iter()
            .any(|condition| CONDITIONS.contains(&condition))
    }

    /// What the decoder says otherwise, in words.
    fn differs(&self, found: &Instruction) -> Option<String> {
        let class = self.class();
        if found.class != class || usize::from(found.bytes) != self.code.len() {
            return Some(format!("is {class:?}, decoded as {found:?}"));
        }
        let is_single = matches!(
            class,
            Class::Load | Class::StoreImmediate | Class::StoreRegister
        );
        if is_single && self.operands.contains('[') {
            let address = core_set(self.within('[', ']'));
            let loads = if class == Class::Load {
                core_set(self.first())
            } else {
                0
            };
            if (found.address, found.loads) != (address, loads) {
                return Some(format!(
                    "has address {address:#x}, loads {loads:#x}: {found:?}"
                ));
            }
        }
        let computes = matches!(
            class,
            Class::FpArithmetic | Class::FpMultiplyAdd | Class::FpDivide
        );
        if computes {
            let mut registers = self.operands.split(',').filter_map(fp_register);
            let writes = registers.next().unwrap_or(0);
            let others: Vec<u32> = registers.collect();
            let reads = match others.is_empty() {
                true => writes,
                false => others.iter().fold(0, |set, one| set | one),
            };
            if (found.fp_writes, found.fp_reads) != (writes, reads) {
                return Some(format!("writes {writes:#x}, reads {reads:#x}: {found:?}"));
            }
        }
        None
    }
}

/// The number of a core register.
fn core_register(name: &str) -> Option<u32> {
    let named = ["sl", "fp", "ip", "sp", "lr", "pc"];
    let special = named
        .iter()
        .position(|it| *it == name)
        .map(|at| at as u32 + 10);
    special.or_else(|| name.strip_prefix('r')?.parse().ok())
}

/// The set of the core registers in `text`.
fn core_set(text: &str) -> u16 {
    let names = text.split([',', ' ', '!']);
    names
        .filter_map(core_register)
        .fold(0, |set, register| set | 1 << register)
}

/// A single register of the FPU as a set.
fn fp_register(text: &str) -> Option<u32> {
    let number = text.trim().strip_prefix('s')?;
    u32::from_str(number).ok().map(|number| 1 << number)
}

/// The words of the registers in a list, and whether PC is one.
fn listed(list: &str) -> (u8, bool) {
    let mut words = 0;
    for part in list.split(',').map(str::trim) {
        let each = if part.starts_with('d') { 2 } else { 1 };
        let number = |name: &str| {
            let digits = name.trim_start_matches(['s', 'd', 'r']);
            core_register(name).or_else(|| digits.parse().ok())
        };
        let ends = part.split_once('-').unwrap_or((part, part));
        if let (Some(first), Some(last)) = (number(ends.0), number(ends.1)) {
            words += (last + 1 - first) as u8 * each;
        }
    }
    (words, list.split([',', ' ']).any(|it| it == "pc"))
}

#[test]
#[ignore = "needs the image and arm-none-eabi-objdump; tests/run runs it"]
fn the_decoder_agrees_with_a_disassembler() {
    let output = Command::new(DISASSEMBLER).arg("-d").arg(image()).output();
    let output = output.unwrap_or_else(|error| {
        panic!("{DISASSEMBLER}: {error}; type: apt-get install binutils-arm-none-eabi")
    });
    let text = String::from_utf8_lossy(&output.stdout);
    let mut classes = BTreeMap::new();
    let mut wrong = Vec::new();
    for line in text.lines().filter_map(Line::read) {
        let Some(found) = decode(&line.code) else {
            wrong.push(format!("{}: ends within an instruction", line.text));
            continue;
        };
        wrong.extend(
            line.differs(&found)
                .map(|what| format!("{}: {what}", line.text)),
        );
        *classes.entry(format!("{:?}", found.class)).or_insert(0) += 1;
    }
    let count: usize = classes.values().sum();
    println!("{count} instructions of {} classes", classes.len());
    assert!(
        wrong.is_empty(),
        "{} differ:\n{}",
        wrong.len(),
        wrong[..wrong.len().min(30)].join("\n")
    );
    // All classes that occur in a program of this size are there.
    assert!(count > 50_000 && classes.len() > 20, "{count}: {classes:?}");
}
