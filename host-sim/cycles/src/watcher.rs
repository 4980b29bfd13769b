//! What an emulator's plugin drives: a chip, and the account of its steps.

use crate::chip::{Access, Chip};
use crate::instruction::Instruction;
use crate::steps::{Account, Mark, StepCost};

/// A chip that is watched.
#[derive(Debug, Default)]
pub struct Watcher {
    chip: Chip,
    account: Account,
}

impl Watcher {
    /// Returns the number of the block of these instructions, from address `start` on.
    pub fn block(&mut self, start: u32, instructions: &[Instruction]) -> usize {
        self.chip.block(start, instructions)
    }

    /// Executes a block.
    pub fn execute(&mut self, block: usize) {
        self.chip.execute(block);
    }

    /// Accesses memory, in the block that is being executed. Returns the cost of a step that ends
    /// with it.
    pub fn access(&mut self, access: &Access) -> Option<StepCost> {
        self.chip.access(access);
        let mark = Mark::at(access.address).filter(|_| access.store)?;
        self.account.mark(mark, self.chip.counts())
    }
}
