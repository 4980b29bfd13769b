//! What the stages of a step take, from marks that the image leaves.
//!
//! A mark is a store to a stimulus port of the trace unit (ITM), which only the emulated image
//! makes, where its own counter reads instructions: port 0 for the first of [`Mark::ALL`], and so
//! on. `firmware/device/src/meter.rs` has the same marks in the same order. What runs between two
//! marks belongs to the stage that the second one ends. The cost of encoding a reply belongs to the
//! next step, as in the device's own count.

use crate::block::Counts;

/// Address of the first stimulus port.
pub const PORTS: u32 = 0xe000_0000;

/// Number of stages.
pub const STAGES: usize = 7;

/// A point of a step.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mark {
    /// A request is complete.
    Request,
    /// The end of a stage: 0 for *session*, then in the order of a step.
    Stage(usize),
    /// The reply is about to be encoded.
    Reply,
    /// The reply is encoded: the step has ended.
    Replied,
}

impl Mark {
    /// All marks in the order of their ports.
    pub const ALL: [Self; 10] = [
        Self::Request,
        Self::Stage(0),
        Self::Stage(1),
        Self::Stage(2),
        Self::Stage(3),
        Self::Stage(4),
        Self::Stage(5),
        Self::Stage(6),
        Self::Reply,
        Self::Replied,
    ];

    /// Returns the mark that a store to `address` is, if it is one.
    #[must_use]
    pub fn at(address: u32) -> Option<Self> {
        let offset = address.checked_sub(PORTS)?;
        let is_port = offset.is_multiple_of(4);
        Self::ALL
            .get(offset as usize / 4)
            .copied()
            .filter(|_| is_port)
    }
}

/// Instructions and cycles of a stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StageCost {
    /// Instructions.
    pub instructions: u32,
    /// Cycles.
    pub cycles: u32,
}

/// Cost of a step: session, sense, topology, plan, window, solve, drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StepCost {
    /// The stages in the order of a step.
    pub stages: [StageCost; STAGES],
}

impl StepCost {
    /// Length of a step in the plugin's file.
    pub const BYTES: usize = STAGES * 8;

    /// Returns the cycles of all stages.
    #[must_use]
    pub fn cycles(&self) -> u64 {
        self.stages.iter().map(|it| u64::from(it.cycles)).sum()
    }

    /// Returns the instructions of all stages.
    #[must_use]
    pub fn instructions(&self) -> u64 {
        self.stages
            .iter()
            .map(|it| u64::from(it.instructions))
            .sum()
    }

    /// Returns the bytes for the plugin's file: of each stage instructions and cycles, little
    /// endian.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let mut bytes = [0; Self::BYTES];
        let (words, _) = bytes.as_chunks_mut::<4>();
        let values = self
            .stages
            .iter()
            .flat_map(|it| [it.instructions, it.cycles]);
        for (word, value) in words.iter_mut().zip(values) {
            *word = value.to_le_bytes();
        }
        bytes
    }

    /// Reads what [`StepCost::to_bytes`] wrote.
    #[must_use]
    pub fn from_bytes(bytes: &[u8; Self::BYTES]) -> Self {
        let (words, _) = bytes.as_chunks::<4>();
        let word = |i: usize| words.get(i).map_or(0, |&it| u32::from_le_bytes(it));
        let stage = |i: usize| StageCost {
            instructions: word(2 * i),
            cycles: word(2 * i + 1),
        };
        Self {
            stages: core::array::from_fn(stage),
        }
    }
}

/// Divides the counts of a chip among the stages of its steps.
#[derive(Debug, Default)]
pub struct Account {
    /// The counts at the last mark.
    since: Counts,
    /// The stages of the step since its request.
    step: StepCost,
    /// Cost of encoding the reply before.
    reply: StageCost,
}

impl Account {
    /// Enters a mark at these counts. Returns the cost of a step that ends with it.
    pub fn mark(&mut self, mark: Mark, counts: Counts) -> Option<StepCost> {
        let spent = StageCost {
            instructions: difference(counts.instructions, self.since.instructions),
            cycles: difference(counts.cycles, self.since.cycles),
        };
        self.since = counts;
        match mark {
            Mark::Request => {
                self.step = StepCost::default();
                add(&mut self.step.stages[0], self.reply);
                None
            }
            Mark::Stage(stage) => {
                if let Some(stage) = self.step.stages.get_mut(stage) {
                    add(stage, spent);
                }
                None
            }
            Mark::Reply => None,
            Mark::Replied => {
                self.reply = spent;
                Some(self.step)
            }
        }
    }
}

fn difference(now: u64, before: u64) -> u32 {
    now.saturating_sub(before).try_into().unwrap_or(u32::MAX)
}

fn add(to: &mut StageCost, spent: StageCost) {
    to.instructions = to.instructions.saturating_add(spent.instructions);
    to.cycles = to.cycles.saturating_add(spent.cycles);
}

#[cfg(test)]
mod tests {
    use super::{Account, Mark, PORTS, StageCost, StepCost};
    use crate::block::Counts;

    #[test]
    fn every_port_is_its_mark() {
        for (port, mark) in Mark::ALL.into_iter().enumerate() {
            assert_eq!(Mark::at(PORTS + 4 * port as u32), Some(mark));
        }
        for other in [PORTS - 4, PORTS + 2, PORTS + 40, 0, u32::MAX] {
            assert_eq!(Mark::at(other), None, "{other:#x}");
        }
    }

    /// Marks a step that begins at count `from`, with 10 instructions and 15 cycles a mark.
    fn step(account: &mut Account, from: u64) -> Option<StepCost> {
        let marks = [0, 1, 2, 3, 1, 8, 9];
        let mut ended = None;
        for (n, port) in marks.into_iter().enumerate() {
            let spent = from + 10 * n as u64;
            let counts = Counts {
                instructions: spent,
                cycles: spent * 3 / 2,
            };
            ended = account.mark(Mark::ALL[port], counts);
        }
        ended
    }

    #[test]
    fn a_count_belongs_to_the_stage_that_ends_with_it() {
        let mut account = Account::default();
        let first = step(&mut account, 1000).unwrap();
        let of = |times: u32| StageCost {
            instructions: 10 * times,
            cycles: 15 * times,
        };
        let none = StageCost::default();
        assert_eq!(first.stages, [of(2), of(1), of(1), none, none, none, none]);
        // The reply to the first step is in the second one.
        let second = step(&mut account, 5000).unwrap();
        assert_eq!(second.stages[0], of(3));
        assert_eq!((second.instructions(), second.cycles()), (50, 75));
    }

    #[test]
    fn bytes_are_read_as_they_were_written() {
        let mut cost = StepCost::default();
        for (i, stage) in cost.stages.iter_mut().enumerate() {
            *stage = StageCost {
                instructions: i as u32,
                cycles: u32::MAX - i as u32,
            };
        }
        assert_eq!(StepCost::from_bytes(&cost.to_bytes()), cost);
        assert_eq!(cost.to_bytes()[..8], [0, 0, 0, 0, 255, 255, 255, 255]);
    }
}
