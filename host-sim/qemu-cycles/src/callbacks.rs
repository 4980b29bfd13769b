//! What the plugin does when QEMU calls it. Safe code.
//!
//! Blocks and instructions are numbers here: QEMU keeps them as the data of a callback. The data of
//! an access has the instruction in its lowest bits and the block above them.

use core::cell::RefCell;
use core::mem;
use std::fs::{File, OpenOptions};
use std::io::{self, Seek as _, SeekFrom, Write as _};
use std::sync::{Mutex, PoisonError};

use fieldline_cycles::chip::Access;
use fieldline_cycles::decode::decode;
use fieldline_cycles::instruction::Instruction;
use fieldline_cycles::steps::StepCost;
use fieldline_cycles::watcher::Watcher;

use crate::api::Translation;

/// Bits for the number of an instruction. QEMU translates at most 512 at once.
const INDEX_BITS: u32 = 10;

/// The files, until the core's thread takes them.
static FILES: Mutex<Files> = Mutex::new(Files {
    steps: None,
    profile: None,
});

thread_local! {
    static PLUGIN: RefCell<Option<Plugin>> = const { RefCell::new(None) };
}

/// Where the plugin writes.
#[derive(Default)]
struct Files {
    /// What each step took.
    steps: Option<File>,
    /// The profile of all steps.
    profile: Option<File>,
}

/// What the thread of the core owns.
struct Plugin {
    watcher: Watcher,
    files: Files,
}

impl Plugin {
    fn take() -> Self {
        let mut files = FILES.lock().unwrap_or_else(PoisonError::into_inner);
        let files = mem::take(&mut *files);
        let mut watcher = Watcher::default();
        if files.profile.is_some() {
            watcher.keep_profile();
        }
        Self { watcher, files }
    }

    /// Writes the profile first: who has read the step finds it in the profile.
    fn write(&mut self, cost: &StepCost) {
        let changes = self.watcher.changes();
        write(&mut self.files.profile, "the profile", |file| {
            for (at, bytes) in &changes {
                file.seek(SeekFrom::Start(*at))?;
                file.write_all(bytes)?;
            }
            Ok(())
        });
        write(&mut self.files.steps, "a step", |file| {
            file.write_all(&cost.to_bytes())
        });
    }
}

/// Writes into a file, if there is one. After a failure there is none.
fn write(file: &mut Option<File>, what: &str, action: impl FnOnce(&mut File) -> io::Result<()>) {
    let Some(to) = file else { return };
    if let Err(error) = action(to) {
        eprintln!("qemu-cycles: writing {what} failed: {error}; no more is written");
        *file = None;
    }
}

/// Reads the plugin's arguments: `steps=FILE` and `profile=FILE`.
pub(crate) fn set_up(arguments: &[String]) -> Result<(), String> {
    let mut files = Files::default();
    for argument in arguments {
        let open = |options: &mut OpenOptions, path: &str| {
            let file = options.create(true).open(path);
            let file = file.map_err(|error| format!("cannot create {path}: {error}"))?;
            Ok::<_, String>(Some(file))
        };
        match argument.split_once('=') {
            Some(("steps", path)) => files.steps = open(File::options().append(true), path)?,
            Some(("profile", path)) => {
                files.profile = open(File::options().write(true).truncate(true), path)?;
            }
            _ => {
                return Err(format!(
                    "unknown argument '{argument}'; use steps=FILE or profile=FILE"
                ));
            }
        }
    }
    *FILES.lock().unwrap_or_else(PoisonError::into_inner) = files;
    Ok(())
}

/// Runs `action` on the plugin of this thread.
fn with(action: impl FnOnce(&mut Plugin)) {
    PLUGIN.with(|plugin| {
        // Nothing calls back from within a callback.
        if let Ok(mut plugin) = plugin.try_borrow_mut() {
            action(plugin.get_or_insert_with(Plugin::take));
        }
    });
}

/// QEMU has translated a block.
pub(crate) fn translated(translation: &Translation<'_>) {
    with(|plugin| {
        let codes = (0..translation.len()).map(|index| translation.code(index));
        let instructions: Vec<Instruction> = codes.filter_map(|code| decode(&code)).collect();
        let block = plugin.watcher.block(translation.address(), &instructions);
        translation.on_execution(block);
        for (index, instruction) in instructions.iter().enumerate() {
            if instruction.class.accesses_memory() && !instruction.is_on_stack() {
                translation.on_access(index, block << INDEX_BITS | index);
            }
        }
    });
}

/// A block runs.
pub(crate) fn executed(block: usize) {
    with(|plugin| plugin.watcher.execute(block));
}

/// An instruction has accessed memory.
pub(crate) fn accessed(data: usize, address: u32, size: u32, store: bool) {
    let access = Access {
        block: data >> INDEX_BITS,
        index: data & ((1 << INDEX_BITS) - 1),
        address,
        size,
        store,
    };
    with(|plugin| {
        if let Some(cost) = plugin.watcher.access(&access) {
            plugin.write(&cost);
        }
    });
}
