//! The chip: blocks run on it, and it counts instructions and cycles.
//!
//! ```text
//! cycles = the block's own + refill after a taken branch + wait for a division of the FPU
//!        + waits for its lines of the flash + waits for data in the flash + misaligned accesses
//! ```
//!
//! With `-icount` the emulator gives a block up at an access to a device, does the access alone,
//! and goes on with a new block behind it. The new block counts, so what the old one did not
//! execute is taken back.

use std::collections::HashMap;

use crate::block::{Block, Counts, End};
use crate::flash::{Flash, line_of};
use crate::instruction::Instruction;
use crate::ledger::{Charge, Ledger};
use crate::price::{EXCEPTION, REFILL_DIRECT, REFILL_INDIRECT, REFILL_SPLIT, misaligned};

/// Addresses from here on are devices.
const DEVICES: u32 = 0x4000_0000;

/// An access to memory.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Access {
    /// Block of the instruction.
    pub block: usize,
    /// Number of the instruction in the block.
    pub index: usize,
    /// Address of the data.
    pub address: u32,
    /// Binary logarithm of the bytes.
    pub size: u32,
    /// True if it stores.
    pub store: bool,
}

/// A chip and what it has executed.
#[derive(Debug, Default)]
pub struct Chip {
    flash: Flash,
    blocks: Vec<Block>,
    /// Blocks by start and number of instructions: the emulator translates an address several
    /// times, with different lengths.
    known: HashMap<(u32, usize), usize>,
    counts: Counts,
    /// When the FPU has divided.
    divided: u64,
    last: Option<usize>,
    /// The address behind the last access to a device, if no block has begun since.
    behind_device: Option<u32>,
    /// What each instruction took, if somebody wants to know.
    ledger: Option<Ledger>,
}

impl Chip {
    /// Returns the number of the block of these instructions, from address `start` on.
    pub fn block(&mut self, start: u32, instructions: &[Instruction]) -> usize {
        let Self { blocks, known, .. } = self;
        *known.entry((start, instructions.len())).or_insert_with(|| {
            blocks.push(Block::new(start, instructions));
            blocks.len() - 1
        })
    }

    /// Keeps a ledger of what each instruction takes.
    pub fn keep_ledger(&mut self) {
        self.ledger.get_or_insert_default();
    }

    /// Executes a block. An unknown number does nothing.
    pub fn execute(&mut self, number: usize) {
        let left = self.behind_device.take();
        let straight = self.follow(number, left);
        let Some(block) = self.blocks.get(number) else {
            return;
        };
        let begun = self.counts.cycles;
        let mut now = begun;
        let mut straight = straight;
        if let Some(first) = block.first_fp {
            now += self.divided.saturating_sub(now + u64::from(first));
        }
        for &(line, cycles) in &block.lines {
            if let Some(line) = line {
                now += self.flash.fetch(line, straight, now);
            }
            now += u64::from(cycles);
            straight = true;
        }
        if block.divides_on > 0 {
            self.divided = now + u64::from(block.divides_on);
        }
        if let Some(ledger) = &mut self.ledger {
            ledger.execute(number, now - begun - block.counts.cycles);
        }
        self.counts.cycles = now;
        self.counts.instructions += block.counts.instructions;
        self.last = Some(number);
    }

    /// Goes on from the last block to another one, by a refill after a taken branch. `left` is
    /// where the last block was given up. Returns true if the core runs straight.
    fn follow(&mut self, number: usize, left: Option<u32>) -> bool {
        let last = self
            .last
            .and_then(|last| Some((last, self.blocks.get(last)?)));
        let Some(((from, last), block)) = last.zip(self.blocks.get(number)) else {
            return false;
        };
        let rest = left.filter(|&address| address == block.start);
        if let Some((address, rest)) = rest.and_then(|it| Some((it, last.rest(it)?))) {
            self.counts.cycles -= rest.cycles;
            self.counts.instructions -= rest.instructions;
            if let Some(ledger) = &mut self.ledger {
                ledger.take_back(last, address);
            }
            return true;
        }
        if last.end == block.start {
            return true;
        }
        let cycles = refill(last, block);
        self.counts.cycles += u64::from(cycles);
        if let Some(ledger) = &mut self.ledger {
            ledger.refill(from, cycles);
        }
        false
    }

    /// Accesses memory, in the block that is being executed.
    pub fn access(&mut self, access: &Access) {
        let mut wait = u64::from(misaligned(access.address, access.size));
        self.counts.cycles += wait;
        if access.address >= DEVICES {
            let block = self.blocks.get(access.block);
            self.behind_device = block.map(|block| block.behind(access.index));
        } else if !access.store
            && let Some(line) = line_of(access.address)
        {
            let loaded = self.flash.load(line, self.counts.cycles);
            self.counts.cycles += loaded;
            wait += loaded;
        }
        if wait > 0
            && let Some(ledger) = &mut self.ledger
            && let Some(block) = self.blocks.get(access.block)
        {
            ledger.charge(block.address(access.index), wait);
        }
    }

    /// Returns what each instruction took since the last call, with the rest of a block as in
    /// [`Chip::counts`]. Nothing without a ledger.
    pub fn charges(&mut self) -> Vec<Charge> {
        let last = self.last.and_then(|last| self.blocks.get(last));
        // Only an address at which the block was given up has a rest.
        let left = last.zip(self.behind_device);
        let left = left.filter(|(block, address)| block.rest(*address).is_some());
        let ledger = self.ledger.as_mut();
        ledger.map_or_else(Vec::new, |ledger| ledger.take(&self.blocks, left))
    }

    /// Returns what was executed up to now. Right behind an access to a device the rest of the
    /// block is not in it.
    #[must_use]
    pub fn counts(&self) -> Counts {
        let last = self.last.and_then(|last| self.blocks.get(last));
        let rest = last.zip(self.behind_device);
        let rest = rest
            .and_then(|(last, address)| last.rest(address))
            .unwrap_or_default();
        Counts {
            instructions: self.counts.instructions - rest.instructions,
            cycles: self.counts.cycles - rest.cycles,
        }
    }
}

/// Returns the cycles from the end of `last` to `block`, which does not lie behind it.
fn refill(last: &Block, block: &Block) -> u32 {
    let own = match last.ending {
        End::Straight => EXCEPTION,
        End::Direct => REFILL_DIRECT,
        End::Indirect => REFILL_INDIRECT,
    };
    own + if block.splits { REFILL_SPLIT } else { 0 }
}

#[cfg(test)]
mod tests {
    use super::{Access, Chip};
    use crate::block::Counts;
    use crate::decode::narrow;

    const NOP: u16 = 0xbf00;
    const LDR: u16 = 0x6810;
    const B: u16 = 0xe7fe;

    /// Adds a block and returns its number.
    fn add(chip: &mut Chip, start: u32, code: &[u16]) -> usize {
        let instructions: Vec<_> = code.iter().map(|&it| narrow(it)).collect();
        chip.block(start, &instructions)
    }

    fn device(block: usize, index: usize) -> Access {
        Access {
            block,
            index,
            address: 0x4000_0024,
            size: 2,
            store: false,
        }
    }

    #[test]
    fn a_block_that_is_given_up_counts_once() {
        // In memory, so that no flash waits. Once whole, once given up behind the load.
        let mut whole = Chip::default();
        let block = add(&mut whole, 0x2000_0000, &[NOP, LDR, NOP, NOP]);
        whole.execute(block);
        let mut given_up = Chip::default();
        let block = add(&mut given_up, 0x2000_0000, &[NOP, LDR, NOP, NOP]);
        given_up.execute(block);
        let alone = add(&mut given_up, 0x2000_0002, &[LDR]);
        given_up.access(&device(alone, 0));
        assert_eq!(
            given_up.counts(),
            Counts {
                instructions: 2,
                cycles: 3
            }
        );
        let rest = add(&mut given_up, 0x2000_0004, &[NOP, NOP]);
        given_up.execute(rest);
        assert_eq!(given_up.counts(), whole.counts());
        assert_eq!(
            whole.counts(),
            Counts {
                instructions: 4,
                cycles: 5
            }
        );
    }

    #[test]
    fn an_access_of_the_last_instruction_takes_nothing_back() {
        let mut chip = Chip::default();
        let block = add(&mut chip, 0x2000_0000, &[NOP, LDR]);
        chip.execute(block);
        chip.access(&device(block, 1));
        let next = add(&mut chip, 0x2000_0004, &[NOP]);
        chip.execute(next);
        assert_eq!(
            chip.counts(),
            Counts {
                instructions: 3,
                cycles: 4
            }
        );
    }

    #[test]
    fn a_taken_branch_refills_and_one_that_falls_through_does_not() {
        let mut chip = Chip::default();
        let near = add(&mut chip, 0x2000_0000, &[B]);
        let next = add(&mut chip, 0x2000_0002, &[NOP]);
        chip.execute(near);
        chip.execute(next);
        assert_eq!(chip.counts().cycles, 2);
        chip.execute(near);
        // An exception, after an instruction that does not branch.
        assert_eq!(chip.counts().cycles, 2 + 12 + 1);
        chip.execute(near);
        assert_eq!(chip.counts().cycles, 15 + 1 + 1);
    }

    #[test]
    fn an_unknown_block_does_nothing() {
        let mut chip = Chip::default();
        chip.execute(7);
        chip.access(&device(7, 3));
        assert_eq!(chip.counts(), Counts::default());
    }
}
