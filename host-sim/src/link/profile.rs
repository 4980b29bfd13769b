//! The profile of a run on the emulated chip: cycles by stage and function, by the model.
//!
//! ```text
//! QEMU ─ plugin ─► cycles by instruction ─ DWARF of the image ─► folded stacks
//! ```
//!
//! A folded stack is a line `stage;function;inlined function cycles`, from the outside in. It has
//! no callers: the plugin knows what runs, and not who called it. inferno, speedscope and others
//! read such a file.
//!
//! Invariant: the cycles of all stacks are those of the run's steps.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use addr2line::Context;
use addr2line::gimli::{Dwarf, EndianSlice, RunTimeEndian};
use fieldline_cycles::flash::FLASH_START;
use fieldline_cycles::profile::rows;
use object::{Object as _, ObjectSection as _, SymbolMap, SymbolMapName};

use super::LinkError;
use super::qemu::temporary;

/// Stages in the order of a step.
const STAGES: [&str; 7] = [
    "session", "sense", "topology", "plan", "window", "solve", "drive",
];

/// A file in which the plugin keeps cycles by instruction. It ends with this value.
#[derive(Debug)]
pub struct RawProfile(PathBuf);

impl RawProfile {
    /// Returns a file that is not there yet.
    #[must_use]
    pub fn new() -> Self {
        Self(temporary("profile"))
    }

    /// Returns its path, for [`Options`](super::spec::Options).
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.0
    }

    /// Returns the cycles up to the last step, by the functions of the image that ran.
    ///
    /// # Errors
    /// [`LinkError::Io`] if no plugin made the file, or the image cannot be read.
    pub fn folded(&self, image: &Path) -> Result<Folded, LinkError> {
        let read = |path: &Path| {
            let failed = |error| LinkError::Io(format!("cannot read {}: {error}", path.display()));
            fs::read(path).map_err(failed)
        };
        let (raw, elf) = (read(&self.0)?, read(image)?);
        let folded = Names::of(&elf).map(|names| Folded::of(&raw, &names));
        folded.map_err(|what| {
            let image = image.display();
            LinkError::Io(format!("cannot read the functions of {image}: {what}"))
        })
    }
}

impl Default for RawProfile {
    fn default() -> Self {
        Self::new()
    }
}

impl Drop for RawProfile {
    fn drop(&mut self) {
        // It is not there if nothing was counted.
        let _ = fs::remove_file(&self.0);
    }
}

/// Cycles of stacks.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Folded(BTreeMap<String, u64>);

impl Folded {
    fn of(raw: &[u8], names: &Names<'_>) -> Self {
        let mut stacks = BTreeMap::new();
        for (address, row) in rows(raw) {
            let functions = names.at(address);
            for (stage, cycles) in STAGES
                .into_iter()
                .zip(row)
                .filter(|&(_, cycles)| cycles > 0)
            {
                *stacks.entry(format!("{stage};{functions}")).or_default() += cycles;
            }
        }
        Self(stacks)
    }

    /// Returns the stacks with their cycles.
    pub fn stacks(&self) -> impl Iterator<Item = (&str, u64)> {
        self.0.iter().map(|(stack, &cycles)| (&**stack, cycles))
    }

    /// Returns the cycles of all stacks.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.0.values().sum()
    }

    /// Writes a line for each stack.
    ///
    /// # Errors
    /// Those of the writer.
    pub fn write(&self, mut into: impl Write) -> io::Result<()> {
        for (stack, cycles) in self.stacks() {
            writeln!(into, "{stack} {cycles}")?;
        }
        into.flush()
    }
}

type Slice<'a> = EndianSlice<'a, RunTimeEndian>;

/// The functions of an image.
struct Names<'a> {
    lines: Context<Slice<'a>>,
    symbols: SymbolMap<SymbolMapName<'a>>,
}

impl<'a> Names<'a> {
    fn of(elf: &'a [u8]) -> Result<Self, String> {
        let file = object::File::parse(elf).map_err(|error| error.to_string())?;
        let section = |name: &str| file.section_by_name(name)?.data().ok();
        let dwarf = Dwarf::load(|id| {
            let data = section(id.name()).unwrap_or_default();
            Ok::<_, addr2line::gimli::Error>(EndianSlice::new(data, RunTimeEndian::Little))
        });
        let lines = dwarf.and_then(Context::from_dwarf);
        Ok(Self {
            lines: lines.map_err(|error| error.to_string())?,
            symbols: file.symbol_map(),
        })
    }

    /// Returns the function at an address and those that are inlined there, from the outside in.
    /// Code without DWARF, as that of the compiler's library, has the name of its symbol.
    fn at(&self, address: u32) -> String {
        if address == FLASH_START {
            return "(outside of the flash)".into();
        }
        let mut names = self.frames(address).unwrap_or_default();
        if names.is_empty() {
            // The lowest bit of a symbol says that the code is Thumb.
            let symbol = self.symbols.before(u64::from(address | 1));
            let name = symbol.map_or("(unknown)", SymbolMapName::name);
            names.push(addr2line::demangle_auto(Cow::Borrowed(name), None).into_owned());
        }
        let names: Vec<String> = names
            .iter()
            .rev()
            .map(|name| name.replace(';', ","))
            .collect();
        names.join(";")
    }

    /// The names of DWARF, from the inside out.
    fn frames(&self, address: u32) -> Option<Vec<String>> {
        let mut names = Vec::new();
        let mut frames = self
            .lines
            .find_frames(address.into())
            .skip_all_loads()
            .ok()?;
        while let Ok(Some(frame)) = frames.next() {
            names.push(frame.function?.demangle().ok()?.into_owned());
        }
        Some(names)
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::{Folded, RawProfile};

    #[test]
    fn stacks_are_lines() {
        let stacks = [("plan;f;g", 7), ("plan;f", 2)];
        let stacks = stacks.map(|(stack, cycles)| (stack.to_owned(), cycles));
        let folded = Folded(stacks.into());
        let mut text = Vec::new();
        folded.write(&mut text).unwrap();
        assert_eq!(String::from_utf8(text).unwrap(), "plan;f 2\nplan;f;g 7\n");
        assert_eq!(folded.cycles(), 9);
    }

    #[test]
    fn what_cannot_be_read_is_named() {
        let raw = RawProfile::new();
        let error = raw.folded(Path::new("image")).unwrap_err().to_string();
        assert!(
            error.contains("cannot read") && error.contains(".profile"),
            "{error}"
        );
        std::fs::write(raw.path(), []).unwrap();
        let no_image = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml");
        let error = raw.folded(&no_image).unwrap_err().to_string();
        assert!(error.contains("cannot read the functions of"), "{error}");
        let path = raw.path().to_owned();
        drop(raw);
        assert!(!path.exists());
    }
}
