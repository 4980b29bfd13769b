//! What each instruction took: the chip's count of cycles, divided among addresses.
//!
//! ```text
//! executions × the block's own price                     to each of its instructions
//! wait for the first and the later lines, for a division to the block's first instruction
//! refill after a taken branch                             to the branch
//! wait for data, misaligned access                        to the instruction that accesses
//! ```
//!
//! Invariant: the charges of an interval are not negative in sum, and they add up to the difference
//! of the chip's cycles. Unit: cycles.

use core::mem;

use crate::block::Block;

/// Cycles of one instruction, by its address. Those of a part of an interval may be negative.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Charge {
    /// Address of the instruction.
    pub address: u32,
    /// Cycles.
    pub cycles: i64,
}

/// What a block took in an interval.
#[derive(Clone, Copy, Debug, Default)]
struct Tally {
    executions: u64,
    /// Waits before its instructions.
    at_start: u64,
    /// Refills after its last instruction.
    at_end: u64,
}

impl Tally {
    fn is_empty(&self) -> bool {
        self.executions == 0 && self.at_start == 0 && self.at_end == 0
    }
}

/// The charges since the last interval ended.
#[derive(Debug, Default)]
pub(crate) struct Ledger {
    /// By number of the block.
    tallies: Vec<Tally>,
    /// Blocks whose tally is not empty.
    touched: Vec<usize>,
    /// What belongs to one instruction of a block.
    single: Vec<Charge>,
}

impl Ledger {
    fn tally(&mut self, block: usize) -> Option<&mut Tally> {
        if self.tallies.len() <= block {
            self.tallies.resize(block + 1, Tally::default());
        }
        let tally = self.tallies.get_mut(block)?;
        if tally.is_empty() {
            self.touched.push(block);
        }
        Some(tally)
    }

    /// A block was executed, after a wait.
    pub(crate) fn execute(&mut self, block: usize, wait: u64) {
        if let Some(tally) = self.tally(block) {
            tally.executions += 1;
            tally.at_start += wait;
        }
    }

    /// The pipeline was refilled behind a block.
    pub(crate) fn refill(&mut self, block: usize, cycles: u32) {
        if cycles > 0
            && let Some(tally) = self.tally(block)
        {
            tally.at_end += u64::from(cycles);
        }
    }

    /// An instruction took more than its price.
    pub(crate) fn charge(&mut self, address: u32, cycles: u64) {
        if cycles > 0 {
            let cycles = cycles as i64;
            self.single.push(Charge { address, cycles });
        }
    }

    /// The instructions of a block from `address` on were not executed.
    pub(crate) fn take_back(&mut self, block: &Block, address: u32) {
        let rest = block.prices().filter(|&(at, _)| is_behind(at, address));
        let charges = rest.map(|(address, cycles)| Charge {
            address,
            cycles: -i64::from(cycles),
        });
        self.single.extend(charges);
    }

    /// Ends the interval. `left` is a block and the address from which on it was not executed yet:
    /// that part belongs to the next interval.
    pub(crate) fn take(&mut self, blocks: &[Block], left: Option<(&Block, u32)>) -> Vec<Charge> {
        if let Some((block, address)) = left {
            self.take_back(block, address);
        }
        let mut charges = mem::take(&mut self.single);
        for number in self.touched.drain(..) {
            let tally = self.tallies.get_mut(number).map(mem::take);
            if let (Some(block), Some(tally)) = (blocks.get(number), tally) {
                enter(&mut charges, block, tally);
            }
        }
        if let Some((block, address)) = left {
            let rest = block.prices().filter(|&(at, _)| is_behind(at, address));
            rest.for_each(|(address, cycles)| self.charge(address, cycles.into()));
        }
        charges
    }
}

/// Returns true if `at` is `address` or follows it in the same block.
const fn is_behind(at: u32, address: u32) -> bool {
    at.wrapping_sub(address) < 1 << 16
}

/// Enters what a block took.
fn enter(charges: &mut Vec<Charge>, block: &Block, tally: Tally) {
    let mut last = block.start;
    for (address, cycles) in block.prices() {
        last = address;
        let cycles = i64::from(cycles) * tally.executions as i64;
        charges.push(Charge { address, cycles });
    }
    let beside = [(block.start, tally.at_start), (last, tally.at_end)];
    let beside = beside.into_iter().filter(|&(_, cycles)| cycles > 0);
    charges.extend(beside.map(|(address, cycles)| Charge {
        address,
        cycles: cycles as i64,
    }));
}
