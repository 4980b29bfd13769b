//! What the plugin does when QEMU calls it. Safe code.
//!
//! Blocks and instructions are numbers here: QEMU keeps them as the data of a callback. The data of
//! an access has the instruction in its lowest bits and the block above them.

use core::cell::RefCell;
use std::fs::File;
use std::io::Write as _;
use std::sync::{Mutex, PoisonError};

use fieldline_cycles::chip::Access;
use fieldline_cycles::decode::decode;
use fieldline_cycles::instruction::Instruction;
use fieldline_cycles::steps::StepCost;
use fieldline_cycles::watcher::Watcher;

use crate::api::Translation;

/// Bits for the number of an instruction. QEMU translates at most 512 at once.
const INDEX_BITS: u32 = 10;

/// The file for the steps, until the core's thread takes it.
static STEPS: Mutex<Option<File>> = Mutex::new(None);

thread_local! {
    static PLUGIN: RefCell<Option<Plugin>> = const { RefCell::new(None) };
}

/// What the thread of the core owns.
struct Plugin {
    watcher: Watcher,
    steps: Option<File>,
}

impl Plugin {
    fn take() -> Self {
        Self {
            watcher: Watcher::default(),
            steps: STEPS.lock().unwrap_or_else(PoisonError::into_inner).take(),
        }
    }

    fn write(&mut self, cost: &StepCost) {
        let Some(file) = &mut self.steps else { return };
        if let Err(error) = file.write_all(&cost.to_bytes()) {
            eprintln!("qemu-cycles: writing a step failed: {error}; no more steps are written");
            self.steps = None;
        }
    }
}

/// Reads the plugin's arguments: `steps=FILE`.
pub(crate) fn set_up(arguments: &[String]) -> Result<(), String> {
    let mut steps = None;
    for argument in arguments {
        match argument.split_once('=') {
            Some(("steps", path)) => {
                let file = File::options().create(true).append(true).open(path);
                steps = Some(file.map_err(|error| format!("cannot create {path}: {error}"))?);
            }
            _ => return Err(format!("unknown argument '{argument}'; use steps=FILE")),
        }
    }
    *STEPS.lock().unwrap_or_else(PoisonError::into_inner) = steps;
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
