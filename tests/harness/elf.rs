//! Flash and memory that an image takes, read from its ELF file.
//!
//! Flash is programmed: the bytes of every loadable segment, at the address where they are stored.
//! Memory is reserved before the program runs, at the address where it is used. A section that
//! begins with bytes of flash (`.data`) counts in both. Units: bytes.

use core::fmt;
use core::ops::Range;
use std::path::Path;

use object::{Object as _, ObjectSection as _, ObjectSegment as _, ObjectSymbol as _};

use object::read::elf::{ElfFile32, ProgramHeader as _};

/// Flash of an STM32F405.
const FLASH: Range<u64> = 0x0800_0000..0x0810_0000;
/// Addresses of memory, on the chip or in the emulator.
const MEMORY: [Range<u64>; 2] = [0x1000_0000..0x1001_0000, 0x2000_0000..0x2004_0000];

/// A section that takes memory or flash.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Section {
    /// Its name.
    pub name: String,
    /// Address where it is used.
    pub address: u64,
    /// Bytes.
    pub size: u64,
}

/// Flash, sections and symbols of an image.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Image {
    /// Bytes programmed into flash.
    pub flash: u64,
    /// Sections that take up flash or memory, by address.
    pub sections: Vec<Section>,
    /// Every symbol and its address.
    pub symbols: Vec<(String, u64)>,
}

/// Reason why an image could not be read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Unreadable(String);

impl fmt::Display for Unreadable {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}; build the image anew with `cargo image`", self.0)
    }
}

impl core::error::Error for Unreadable {}

impl Image {
    /// Reads an ELF file.
    ///
    /// # Errors
    /// [`Unreadable`] with the file's name.
    pub fn read(path: &Path) -> Result<Self, Unreadable> {
        let named = |error: String| Unreadable(format!("{}: {error}", path.display()));
        let bytes = std::fs::read(path).map_err(|error| named(error.to_string()))?;
        Self::parse(&bytes).map_err(|error| named(error.to_string()))
    }

    fn parse(bytes: &[u8]) -> object::Result<Self> {
        let elf = ElfFile32::<object::Endianness>::parse(bytes)?;
        let stored_in_flash = elf.segments().filter(|segment| {
            let stored = segment.elf_program_header().p_paddr(elf.endian());
            FLASH.contains(&u64::from(stored))
        });
        let flash = stored_in_flash.map(|segment| segment.file_range().1).sum();
        let mut sections: Vec<Section> = elf
            .sections()
            .filter(|section| section.size() > 0)
            .filter(|section| FLASH.contains(&section.address()) || in_memory(section.address()))
            .map(|section| Section {
                name: section.name().unwrap_or("?").into(),
                address: section.address(),
                size: section.size(),
            })
            .collect();
        sections.sort_by_key(|section| section.address);
        let symbols = elf
            .symbols()
            .filter_map(|symbol| Some((symbol.name().ok()?.to_owned(), symbol.address())));
        Ok(Self {
            flash,
            sections,
            symbols: symbols.collect(),
        })
    }

    /// Returns the address of a symbol.
    #[must_use]
    pub fn address(&self, name: &str) -> Option<u64> {
        let found = self.symbols.iter().find(|(symbol, _)| symbol == name);
        found.map(|(_, address)| *address)
    }

    /// Returns the bytes reserved in `memory`.
    #[must_use]
    pub fn reserved(&self, memory: &Range<u64>) -> u64 {
        let inside = self
            .sections
            .iter()
            .filter(|section| memory.contains(&section.address));
        inside.map(|section| section.size).sum()
    }
}

fn in_memory(address: u64) -> bool {
    MEMORY.iter().any(|memory| memory.contains(&address))
}
