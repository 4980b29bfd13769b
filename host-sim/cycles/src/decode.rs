//! Decodes Thumb-2 and `FPv4-SP` instructions into their classes.
//!
//! Encodings: `ARMv7-M` Architecture Reference Manual (DDI 0403), A5. Only what a price needs is
//! decoded. `tests/cases/chip/cycles.rs` compares class, length and registers with a disassembler,
//! over all instructions of the image.

mod fpu;

use crate::instruction::{Class, Instruction, PC, SP, set};

/// Returns true if `halfword` is the first of two.
#[must_use]
pub const fn is_wide(halfword: u16) -> bool {
    halfword >= 0xe800
}

/// Decodes the instruction at the start of `code`; `None` if `code` ends within it.
#[must_use]
pub fn decode(code: &[u8]) -> Option<Instruction> {
    let (first, rest) = code.split_first_chunk::<2>()?;
    let first = u16::from_le_bytes(*first);
    if !is_wide(first) {
        return Some(narrow(first));
    }
    let (second, _) = rest.split_first_chunk::<2>()?;
    Some(wide(first, u16::from_le_bytes(*second)))
}

/// Decodes an instruction of one halfword.
#[must_use]
pub fn narrow(halfword: u16) -> Instruction {
    let h = u32::from(halfword);
    let plain = |class| Instruction::new(class, 2);
    let access = |class, loads, address| Instruction::access(class, 2, loads, address);
    let is_load = h & 0x800 != 0;
    let load_or_store = |register, base| match is_load {
        true => access(Class::Load, set(register), set(base)),
        false => access(Class::StoreImmediate, 0, set(base)),
    };
    match h >> 12 {
        4 => match h >> 10 & 3 {
            0 => plain(Class::Alu),
            1 => plain(special(h)),
            _ => access(Class::Load, set(h >> 8 & 7), set(PC)),
        },
        5 => {
            let address = set(h >> 3 & 7) | set(h >> 6 & 7);
            // STR, STRH, STRB, then LDRSB and all other loads.
            match h >> 9 & 7 {
                0..=2 => access(Class::StoreRegister, 0, address),
                _ => access(Class::Load, set(h & 7), address),
            }
        }
        6..=8 => load_or_store(h & 7, h >> 3 & 7),
        9 => load_or_store(h >> 8 & 7, SP),
        0..=3 | 10 => plain(Class::Alu),
        11 => miscellaneous(h),
        12 => {
            let listed = h as u16 & 0xff;
            let class = Class::Multiple {
                words: listed.count_ones() as u8,
                load: is_load,
            };
            access(class, if is_load { listed } else { 0 }, set(h >> 8 & 7))
        }
        13 => match h >> 8 & 15 {
            14 | 15 => plain(Class::Unknown),
            _ => plain(Class::Branch),
        },
        14 => plain(Class::Branch),
        _ => plain(Class::Unknown),
    }
}

/// Returns the class of ADD, CMP and MOV with high registers, and of BX and BLX.
fn special(h: u32) -> Class {
    let destination = h & 7 | h >> 4 & 8;
    match h >> 8 & 3 {
        3 => Class::BranchRegister,
        1 => Class::Alu,
        _ if destination == PC => Class::BranchRegister,
        _ => Class::Alu,
    }
}

/// Decodes the narrow instructions `0xbxxx`.
fn miscellaneous(h: u32) -> Instruction {
    let plain = |class| Instruction::new(class, 2);
    // Eight low registers, and LR or PC.
    let words = (h & 0x1ff).count_ones() as u8;
    let stack = |class, loads| Instruction::access(class, 2, loads, set(SP));
    match h >> 8 & 15 {
        1 | 3 | 9 | 11 => plain(Class::Branch),
        4 | 5 => stack(Class::Multiple { words, load: false }, 0),
        6 => plain(Class::System),
        12 => stack(Class::Multiple { words, load: true }, h as u16 & 0xff),
        13 => stack(Class::BranchLoad { words }, 0),
        14 => plain(Class::Unknown),
        15 if h & 15 != 0 => plain(Class::IfThen),
        15 if matches!(h & 0xf0, 0x20 | 0x30) => plain(Class::Wait),
        _ => plain(Class::Alu),
    }
}

/// Decodes an instruction of two halfwords.
#[must_use]
pub fn wide(first: u16, second: u16) -> Instruction {
    let (a, b) = (u32::from(first), u32::from(second));
    let plain = |class| Instruction::new(class, 4);
    match a >> 9 {
        0b111_0100 if a & 0x40 == 0 => multiple(a, b),
        0b111_0100 => dual_exclusive_or_table(a, b),
        0b111_0101 => plain(Class::Alu),
        0b111_0110 | 0b111_0111 => fpu::decode(a, b),
        0b111_1000..=0b111_1011 if b & 0x8000 == 0 => plain(Class::Alu),
        0b111_1000..=0b111_1011 => plain(branch_or_control(a, b)),
        0b111_1100 => single(a, b),
        0b111_1101 => plain(multiply_or_divide(a, b)),
        _ => plain(Class::Unknown),
    }
}

/// Decodes LDM and STM.
fn multiple(a: u32, b: u32) -> Instruction {
    let load = a & 0x10 != 0;
    let words = b.count_ones() as u8;
    let class = match load && b & 0x8000 != 0 {
        true => Class::BranchLoad { words },
        false => Class::Multiple { words, load },
    };
    let loads = match class {
        Class::Multiple { load: true, .. } => b as u16,
        _ => 0,
    };
    Instruction::access(class, 4, loads, set(a))
}

/// Decodes LDRD and STRD, LDREX and STREX, TBB and TBH.
fn dual_exclusive_or_table(a: u32, b: u32) -> Instruction {
    let load = a & 0x10 != 0;
    let access = |class, loads, address| Instruction::access(class, 4, loads, address);
    if a & 0xfff0 == 0xe8d0 && b & 0xffe0 == 0xf000 {
        return access(Class::BranchTable, 0, set(a) | set(b));
    }
    if matches!(a & 0xffe0, 0xe840 | 0xe8c0) {
        return match load {
            true => access(Class::Load, set(b >> 12), set(a)),
            false => access(Class::StoreRegister, 0, set(a)),
        };
    }
    let loads = match load {
        true => set(b >> 12) | set(b >> 8),
        false => 0,
    };
    access(Class::Multiple { words: 2, load }, loads, set(a))
}

/// Returns the class of branches and of instructions that control the core.
fn branch_or_control(a: u32, b: u32) -> Class {
    let is_control = b & 0x5000 == 0 && a & 0x0380 == 0x0380;
    if !is_control {
        return Class::Branch;
    }
    match a & 0xfff0 {
        0xf380 | 0xf390 | 0xf3e0 => Class::System,
        0xf3b0 => Class::Barrier,
        0xf3a0 if matches!(b & 0xff, 2 | 3) => Class::Wait,
        0xf3a0 => Class::Alu,
        _ => Class::Unknown,
    }
}

/// Decodes loads and stores of one register.
fn single(a: u32, b: u32) -> Instruction {
    let (base, register) = (a & 15, b >> 12);
    let by_register = a & 0x80 == 0 && b & 0x800 == 0 && base != PC;
    let address = set(base) | if by_register { set(b) } else { 0 };
    let access = |class, loads| Instruction::access(class, 4, loads, address);
    let is_word = a & 0x60 == 0x40;
    match a & 0x10 != 0 {
        false if by_register => access(Class::StoreRegister, 0),
        false => access(Class::StoreImmediate, 0),
        true if register == PC && is_word => access(Class::BranchLoad { words: 1 }, 0),
        // PLD and PLI, which the core ignores.
        true if register == PC => Instruction::new(Class::Alu, 4),
        true => access(Class::Load, set(register)),
    }
}

/// Returns the class of arithmetic with registers.
fn multiply_or_divide(a: u32, b: u32) -> Class {
    match (a & 0xfff0, b & 0xf0) {
        (0xfb90 | 0xfbb0, 0xf0) => Class::Divide,
        _ => Class::Alu,
    }
}

#[cfg(test)]
mod tests {
    use super::{decode, narrow, wide};
    use crate::instruction::Class;

    #[test]
    fn narrow_instructions_have_the_classes_of_the_manual() {
        for (code, class) in [
            (0x1840, Class::Alu),                     // adds r0, r0, r1
            (0x4340, Class::Alu),                     // muls r0, r0
            (0x4770, Class::BranchRegister),          // bx lr
            (0x4687, Class::BranchRegister),          // mov pc, r0
            (0x4801, Class::Load),                    // ldr r0, [pc, #4]
            (0x5088, Class::StoreRegister),           // str r0, [r1, r2]
            (0x5688, Class::Load),                    // ldrsb r0, [r1, r2]
            (0x6048, Class::StoreImmediate),          // str r0, [r1, #4]
            (0x8848, Class::Load),                    // ldrh r0, [r1, #2]
            (0x9001, Class::StoreImmediate),          // str r0, [sp, #4]
            (0xb108, Class::Branch),                  // cbz r0, ...
            (0xbd10, Class::BranchLoad { words: 2 }), // pop {r4, pc}
            (0xbf08, Class::IfThen),                  // it eq
            (0xbf00, Class::Alu),                     // nop
            (0xbf30, Class::Wait),                    // wfi
            (0xb672, Class::System),                  // cpsid i
            (0xd0fe, Class::Branch),                  // beq
            (0xe7fe, Class::Branch),                  // b
            (0xdf00, Class::Unknown),                 // svc 0
        ] {
            let it = narrow(code);
            assert_eq!((it.class, it.bytes), (class, 2), "{code:#x}");
        }
        let (push, words) = (narrow(0xb570), 4); // push {r4, r5, r6, lr}
        assert_eq!(push.class, Class::Multiple { words, load: false });
        assert!(push.is_on_stack());
    }

    #[test]
    fn wide_instructions_have_the_classes_of_the_manual() {
        for (first, second, class) in [
            (0xfb90, 0xf0f1, Class::Divide),                  // sdiv r0, r0, r1
            (0xfb00, 0xf001, Class::Alu),                     // mul r0, r0, r1
            (0xf000, 0xf800, Class::Branch),                  // bl
            (0xf000, 0x8000, Class::Branch),                  // beq.w
            (0xe8d0, 0xf001, Class::BranchTable),             // tbb [r0, r1]
            (0xe850, 0x0f00, Class::Load),                    // ldrex r0, [r0]
            (0xf850, 0x0021, Class::Load),                    // ldr.w r0, [r0, r1, lsl #2]
            (0xf840, 0x0021, Class::StoreRegister),           // str.w r0, [r0, r1, lsl #2]
            (0xf8c0, 0x0100, Class::StoreImmediate),          // str.w r0, [r0, #256]
            (0xf85d, 0xfb04, Class::BranchLoad { words: 1 }), // ldr pc, [sp], #4
            (0xf3bf, 0x8f5f, Class::Barrier),                 // dmb
            (0xf3ef, 0x8010, Class::System),                  // mrs r0, primask
            (0xf04f, 0x0000, Class::Alu),                     // mov.w r0, #0
            (
                0xe9d0,
                0x0100,
                Class::Multiple {
                    words: 2,
                    load: true,
                },
            ), // ldrd r0, r1, [r0]
        ] {
            let it = wide(first, second);
            assert_eq!((it.class, it.bytes), (class, 4), "{first:#x} {second:#x}");
        }
    }

    #[test]
    fn registers_of_an_access_are_known() {
        let load = wide(0xf850, 0x1022); // ldr.w r1, [r0, r2, lsl #2]
        assert_eq!((load.loads, load.address), (1 << 1, 1 | 1 << 2));
        let pair = wide(0xe9d3, 0x4502); // ldrd r4, r5, [r3, #8]
        assert_eq!((pair.loads, pair.address), (1 << 4 | 1 << 5, 1 << 3));
    }

    #[test]
    fn code_that_ends_within_an_instruction_is_none() {
        assert_eq!(decode(&[]), None);
        assert_eq!(decode(&[0x70]), None);
        assert_eq!(decode(&[0x90, 0xfb, 0xf1]), None);
        assert_eq!(decode(&[0x70, 0x47]), Some(narrow(0x4770)));
    }
}
