//! A block: instructions that run one behind the other, as the emulator translates them, priced
//! once.
//!
//! Invariant: the cycles of `lines` are those of the block's instructions, in order. A block is
//! entered at its start and left at its end, unless the emulator gives it up behind an access to a
//! device: [`Block::rest`] is what it did not execute then.

use crate::flash::line_of;
use crate::instruction::{Class, Instruction};
use crate::price::Run;

/// How a block ends, which decides the refill if something else than the next address follows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// With an instruction that does not branch.
    Straight,
    /// With a target in the instruction.
    Direct,
    /// With a target from a register, from memory, or from a table.
    Indirect,
}

/// Instructions and their cycles.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Instructions.
    pub instructions: u64,
    /// Cycles of the core, with all waits.
    pub cycles: u64,
}

/// A priced block.
#[derive(Clone, Debug)]
pub struct Block {
    /// Address of the first instruction.
    pub start: u32,
    /// Address behind the last one.
    pub end: u32,
    /// How it ends.
    pub ending: End,
    /// Instructions, and cycles without refills and waits for the flash.
    pub counts: Counts,
    /// Its first instruction is wide and lies across two words.
    pub(crate) splits: bool,
    /// Lines of the flash from which it is fetched, and the cycles in each; `None` outside.
    pub(crate) lines: Vec<(Option<u32>, u32)>,
    /// Cycles from its start to the first instruction that waits for the FPU.
    pub(crate) first_fp: Option<u32>,
    /// Cycles for which the FPU divides on after its end.
    pub(crate) divides_on: u32,
    /// The end of each instruction, bytes from the start, and its cycles.
    steps: Vec<(u16, u16)>,
}

impl Block {
    /// Prices the instructions from address `start` on.
    #[must_use]
    pub fn new(start: u32, instructions: &[Instruction]) -> Self {
        let run = Run::of(instructions);
        let mut lines = Vec::new();
        let mut steps = Vec::with_capacity(instructions.len());
        let mut offset = 0;
        for (instruction, &cycles) in instructions.iter().zip(&run.cycles) {
            let bytes = u32::from(instruction.bytes);
            let first = line_of(start.wrapping_add(offset));
            let last = line_of(start.wrapping_add(offset + bytes - 1));
            enter(&mut lines, first);
            enter(&mut lines, last);
            if let Some((_, in_line)) = lines.last_mut() {
                *in_line += cycles;
            }
            offset += bytes;
            steps.push((offset as u16, cycles as u16));
        }
        let is_wide = instructions.first().is_some_and(|it| it.bytes == 4);
        Self {
            start,
            end: start.wrapping_add(offset),
            ending: ending(instructions),
            counts: Counts {
                instructions: instructions.len() as u64,
                cycles: run.cycles.iter().map(|&it| u64::from(it)).sum(),
            },
            splits: is_wide && start & 3 == 2,
            lines,
            first_fp: run.first_fp,
            divides_on: run.divides_on,
            steps,
        }
    }

    /// Returns the address behind instruction `index`; the block's end if there are not so many.
    #[must_use]
    pub fn behind(&self, index: usize) -> u32 {
        let step = self.steps.get(index);
        step.map_or(self.end, |&(end, _)| self.start.wrapping_add(end.into()))
    }

    /// Returns the address of instruction `index`; that of the first if there are not so many.
    pub(crate) fn address(&self, index: usize) -> u32 {
        self.prices().nth(index).map_or(self.start, |(at, _)| at)
    }

    /// Returns the address of each instruction, and its cycles.
    pub(crate) fn prices(&self) -> impl Iterator<Item = (u32, u16)> {
        let starts = core::iter::once(0).chain(self.steps.iter().map(|&(end, _)| end));
        let starts = starts.map(|offset| self.start.wrapping_add(offset.into()));
        starts.zip(self.steps.iter().map(|&(_, cycles)| cycles))
    }

    /// Returns what the block's instructions from `address` on take; `None` if no instruction of
    /// the block, but the first, begins there, and if the block does not end there.
    #[must_use]
    pub fn rest(&self, address: u32) -> Option<Counts> {
        let offset = address.wrapping_sub(self.start);
        let before = self
            .steps
            .iter()
            .position(|&(end, _)| u32::from(end) == offset)?;
        let left = self.steps.get(before + 1..).unwrap_or_default();
        Some(Counts {
            instructions: left.len() as u64,
            cycles: left.iter().map(|&(_, cycles)| u64::from(cycles)).sum(),
        })
    }
}

/// Enters a line, unless the block is fetched from it already.
fn enter(lines: &mut Vec<(Option<u32>, u32)>, line: Option<u32>) {
    if lines.last().is_none_or(|(last, _)| *last != line) {
        lines.push((line, 0));
    }
}

fn ending(instructions: &[Instruction]) -> End {
    match instructions.last().map(|last| last.class) {
        Some(Class::Branch) => End::Direct,
        Some(Class::BranchRegister | Class::BranchLoad { .. } | Class::BranchTable) => {
            End::Indirect
        }
        _ => End::Straight,
    }
}

#[cfg(test)]
mod tests {
    use super::{Block, Counts, End};
    use crate::decode::{narrow, wide};

    #[test]
    fn cycles_belong_to_the_line_in_which_an_instruction_ends() {
        // adds, then add.w across the border of two lines, then bx lr.
        let run = [narrow(0x1840), wide(0xeb00, 0x0001), narrow(0x4770)];
        let block = Block::new(0x0800_000c, &run);
        assert_eq!(block.lines, [(Some(0), 1), (Some(1), 2)]);
        assert_eq!((block.end, block.ending), (0x0800_0014, End::Indirect));
        assert!(Block::new(0x0800_000e, &run[1..]).splits);
    }

    #[test]
    fn the_rest_of_a_block_is_what_lies_behind_an_instruction() {
        let run = [narrow(0x1840), narrow(0x6810), narrow(0x1840)]; // adds, ldr, adds
        let block = Block::new(0x0800_0000, &run);
        assert_eq!(block.behind(1), 0x0800_0004);
        let rest = block.rest(0x0800_0004);
        assert_eq!(
            rest,
            Some(Counts {
                instructions: 1,
                cycles: 1
            })
        );
        assert_eq!(block.rest(block.end), Some(Counts::default()));
        assert_eq!(block.rest(0x0800_0003), None);
        assert_eq!(block.rest(0x0700_0000), None);
    }
}
