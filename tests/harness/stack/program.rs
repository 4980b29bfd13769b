//! The functions of an ELF file: their frames, and whom they call.
//!
//! A frame is the sum of everything by which a function's instructions grow the stack, so it is
//! never too small. Where the file says what the compiler reserved (section `.stack_sizes`), the
//! sum must say the same. Data between the code is left out, by the mapping symbols `$t` and `$d`.
//! Units: bytes.

use core::ops::Range;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use object::read::elf::ElfFile32;
use object::{Object as _, ObjectSection as _, ObjectSymbol as _, SymbolKind};
use rustc_demangle::demangle;

use super::thumb::{Effect, decode};

/// A function of the image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Function {
    /// Its name, without the hash of a mangled one.
    pub name: String,
    /// Bytes that it takes on the stack.
    pub frame: u32,
    /// Bytes that the compiler says it takes.
    pub reserved: Option<u32>,
    /// Addresses of functions that it calls.
    pub calls: BTreeSet<u32>,
    /// Addresses of functions that go on in its place: its frame is gone.
    pub jumps: BTreeSet<u32>,
    /// Number of its calls and jumps to an address in a register.
    pub indirect: u32,
    /// True if a constant of the image is its address, so that it may be called by address.
    pub address_is_stored: bool,
    /// True if it moves the stack pointer to another place. What it jumps to starts there.
    pub sets_stack: bool,
}

/// Functions by address.
pub type Program = BTreeMap<u32, Function>;

/// Reads the functions of an ELF file.
///
/// # Errors
/// A sentence that says what is wrong with the file.
pub fn read(path: &Path) -> Result<Program, String> {
    let named = |error: String| format!("{}: {error}", path.display());
    let bytes = std::fs::read(path).map_err(|error| named(error.to_string()))?;
    let elf = ElfFile32::<object::Endianness>::parse(&*bytes)
        .map_err(|error| named(error.to_string()))?;
    let section = |name: &str| {
        let section = elf.section_by_name(name)?;
        Some((section.address() as u32, section.data().ok()?))
    };
    let (start, code) = section(".text").ok_or_else(|| named("it has no code".into()))?;
    let range = start..start + code.len() as u32;
    let data = marks(&elf);
    let mut program = symbols(&elf, range.clone());
    let starts: Vec<u32> = program.keys().copied().collect();
    let ends = starts.iter().skip(1).copied().chain([range.end]);
    let mut stored = BTreeSet::new();
    let own_ends = own_ends(&elf);
    for (function, next) in program.iter_mut().zip(ends) {
        let (&address, function) = function;
        let end = own_ends.get(&address).map_or(next, |own| next.min(*own));
        stored.extend(walk(function, address..end, &range, &starts, |at| {
            let k = (at - start) as usize;
            let word = code.get(k..k + 4).unwrap_or(&[0; 4]);
            let is_data = data.range(..=at).next_back().is_some_and(|(_, data)| *data);
            let word = u32::from_le_bytes([word[0], word[1], word[2], word[3]]);
            if is_data {
                Word::Data(word)
            } else {
                Word::Code(word)
            }
        }));
    }
    for (_, constants) in [".rodata", ".data"].into_iter().filter_map(section) {
        let words = constants.as_chunks::<4>().0.iter();
        stored.extend(words.map(|word| u32::from_le_bytes(*word)));
    }
    // The lowest bit of a pointer to a function says that it is Thumb code.
    for word in stored.iter().filter(|word| *word & 1 == 1) {
        if let Some(function) = program.get_mut(&(word & !1)) {
            function.address_is_stored = true;
        }
    }
    for (address, reserved) in section(".stack_sizes").map_or_else(Vec::new, |it| sizes(it.1)) {
        if let Some(function) = program.get_mut(&address) {
            function.reserved = Some(reserved);
        }
    }
    Ok(program)
}

/// The four bytes at an address between the code's ends.
enum Word {
    /// A constant between the code.
    Data(u32),
    /// An instruction, or one and the beginning of the next.
    Code(u32),
}

/// Reads what the instructions of a function do. Returns the constants that they hold: a function
/// of which the address is one may be called by it. `starts` has where functions begin, in order.
fn walk(
    function: &mut Function,
    range: Range<u32>,
    code: &Range<u32>,
    starts: &[u32],
    at: impl Fn(u32) -> Word,
) -> Vec<u32> {
    // An address inside of a function stands for the function.
    let owner = |to: u32| match starts.partition_point(|start| *start <= to).checked_sub(1) {
        Some(before) if code.contains(&to) => starts[before],
        _ => to,
    };
    let mut constants = Vec::new();
    let mut low = [0; 16];
    let mut address = range.start;
    while address < range.end {
        let (length, effect) = match at(address) {
            Word::Code(word) => decode(address, word as u16, (word >> 16) as u16),
            Word::Data(word) => {
                constants.push(word);
                (2, Effect::None)
            }
        };
        match effect {
            Effect::None => {}
            Effect::Grows(bytes) => function.frame += bytes,
            Effect::SetsStack => function.sets_stack = true,
            Effect::Calls(to) => {
                function.calls.insert(owner(to));
            }
            Effect::Jumps(to) if range.contains(&to) => {}
            Effect::Jumps(to) => {
                function.jumps.insert(owner(to));
            }
            Effect::CallsRegister | Effect::JumpsRegister => function.indirect += 1,
            Effect::SetsLow(register, value) => low[usize::from(register & 15)] = value,
            Effect::SetsHigh(register, value) => {
                let low = low[usize::from(register & 15)];
                constants.push(u32::from(value) << 16 | u32::from(low));
            }
        }
        address += length;
    }
    constants
}

/// Returns the addresses where data begins (`true`) and where code begins (`false`).
fn marks(elf: &ElfFile32<'_>) -> BTreeMap<u32, bool> {
    let marks = elf.symbols().filter_map(|symbol| {
        let name = symbol.name().ok()?;
        let is_data = name.starts_with("$d");
        (is_data || name.starts_with("$t")).then_some((symbol.address() as u32, is_data))
    });
    marks.collect()
}

/// Returns where each function of known size ends: what the linker fills up to the next one is no
/// code.
fn own_ends(elf: &ElfFile32<'_>) -> BTreeMap<u32, u32> {
    let sized = elf.symbols().filter(|symbol| symbol.size() > 0);
    sized
        .map(|symbol| (symbol.address() as u32 & !1, symbol.size() as u32))
        .map(|(address, size)| (address, address + size))
        .collect()
}

/// Returns the functions within `code`, without what they do.
fn symbols(elf: &ElfFile32<'_>, code: Range<u32>) -> Program {
    // An alias has no size: the name with one comes first, then the order of the alphabet.
    let mut names: BTreeMap<u32, (bool, String)> = BTreeMap::new();
    for symbol in elf.symbols() {
        // The lowest bit says that the code is Thumb code.
        let address = symbol.address() as u32 & !1;
        let is_function = symbol.kind() == SymbolKind::Text && code.contains(&address);
        if let Some(name) = symbol.name().ok().filter(|_| is_function) {
            let name = (symbol.size() == 0, format!("{:#}", demangle(name)));
            let known = names.entry(address).or_insert_with(|| name.clone());
            *known = name.min(known.clone());
        }
    }
    let function = |(_, name)| Function {
        name,
        ..Function::default()
    };
    let functions = names.into_iter();
    functions
        .map(|(address, name)| (address, function(name)))
        .collect()
}

/// Reads section `.stack_sizes`: an address and a number of seven bits a byte, for each function.
fn sizes(mut bytes: &[u8]) -> Vec<(u32, u32)> {
    let mut sizes = Vec::new();
    while let Some((address, rest)) = bytes.split_first_chunk::<4>() {
        let length = rest.iter().take_while(|byte| **byte >= 0x80).count() + 1;
        let (number, rest) = rest.split_at(length.min(rest.len()));
        let digits = number.iter().rev();
        let size = digits.fold(0, |size, byte| size << 7 | u32::from(byte & 0x7f));
        sizes.push((u32::from_le_bytes(*address) & !1, size));
        bytes = rest;
    }
    sizes
}

#[cfg(test)]
mod tests {
    use super::sizes;

    #[test]
    fn sizes_are_numbers_of_seven_bits_a_byte() {
        let bytes = [0x01, 0x02, 0, 0x08, 0x10, 0x05, 0x02, 0, 0x08, 0xf0, 0x3d];
        assert_eq!(sizes(&bytes), [(0x0800_0200, 16), (0x0800_0204, 7920)]);
    }
}
