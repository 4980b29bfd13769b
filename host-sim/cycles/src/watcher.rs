//! What an emulator's plugin drives: a chip, the account of its steps, and their profile.

use crate::chip::{Access, Chip};
use crate::instruction::Instruction;
use crate::profile::Profile;
use crate::steps::{Account, Mark, StepCost};

/// A chip that is watched.
#[derive(Debug, Default)]
pub struct Watcher {
    chip: Chip,
    account: Account,
    profile: Option<Profile>,
}

impl Watcher {
    /// Keeps a profile.
    pub fn keep_profile(&mut self) {
        self.chip.keep_ledger();
        self.profile.get_or_insert_default();
    }

    /// Returns what has changed in the profile since the last call: bytes, and their place in its
    /// file. Nothing without a profile.
    pub fn changes(&mut self) -> Vec<(u64, Vec<u8>)> {
        let profile = self.profile.as_mut();
        profile.map_or_else(Vec::new, Profile::changes)
    }

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
        if let Some(profile) = &mut self.profile {
            profile.mark(mark, self.chip.charges());
        }
        self.account.mark(mark, self.chip.counts())
    }
}
