//! The profile of a run: cycles by instruction of the flash and by stage of a step.
//!
//! Its rows are the halfwords of the flash, from the first on. Row 0 is the vector table, which has
//! no instruction: it has the cycles of code outside of the flash. A row has the cycles of each
//! stage, little endian. A file has the rows one behind the other, so a profile is kept up to date
//! by writing the pages that have changed, and read without parsing.
//!
//! Invariant: the sums over the rows are the stages of the steps that have ended
//! ([`Account`](crate::steps::Account)). Unit: cycles.

use std::collections::BTreeSet;

use crate::flash::{FLASH_START, line_of};
use crate::ledger::Charge;
use crate::steps::{Mark, STAGES};

/// Bytes of a row.
pub const ROW_BYTES: usize = STAGES * 8;
/// Rows that are written together.
const PAGE_ROWS: usize = 64;

/// Cycles of an instruction in each stage.
pub type Row = [u64; STAGES];

/// The profile of the steps that have ended, and what the step took up to now.
#[derive(Debug, Default)]
pub struct Profile {
    rows: Vec<Row>,
    /// Pages of rows that have changed.
    changed: BTreeSet<usize>,
    /// Charges of the step since its request, with their stages.
    step: Vec<(usize, Charge)>,
    /// Charges of the reply before.
    reply: Vec<Charge>,
}

impl Profile {
    /// Enters what was charged since the last mark, by the rule of
    /// [`Account::mark`](crate::steps::Account::mark).
    pub fn mark(&mut self, mark: Mark, charges: Vec<Charge>) {
        match mark {
            Mark::Request => {
                self.step.clear();
                self.step.extend(self.reply.iter().map(|&it| (0, it)));
            }
            Mark::Stage(stage) => self.step.extend(charges.into_iter().map(|it| (stage, it))),
            Mark::Reply => {}
            Mark::Replied => {
                self.reply = charges;
                for (stage, charge) in core::mem::take(&mut self.step) {
                    self.add(stage, charge);
                }
            }
        }
    }

    fn add(&mut self, stage: usize, charge: Charge) {
        let row = row_of(charge.address);
        if self.rows.len() <= row {
            self.rows.resize(row + 1, Row::default());
        }
        let cycles = self.rows.get_mut(row).and_then(|row| row.get_mut(stage));
        if let Some(cycles) = cycles {
            // A part that is taken back may come before what it is taken from.
            *cycles = cycles.wrapping_add_signed(charge.cycles);
            self.changed.insert(row / PAGE_ROWS);
        }
    }

    /// Returns what has changed since the last call: bytes, and their place in the file.
    pub fn changes(&mut self) -> Vec<(u64, Vec<u8>)> {
        let pages = core::mem::take(&mut self.changed);
        let bytes = |page| {
            let first: usize = page * PAGE_ROWS;
            let rows = self.rows.iter().skip(first).take(PAGE_ROWS);
            let bytes = rows.flatten().flat_map(|it| it.to_le_bytes()).collect();
            ((first * ROW_BYTES) as u64, bytes)
        };
        pages.into_iter().map(bytes).collect()
    }
}

/// Returns the row of an instruction.
fn row_of(address: u32) -> usize {
    match line_of(address) {
        Some(_) => (address - FLASH_START) as usize / 2,
        None => 0,
    }
}

/// Returns the rows of a file that have cycles, with their addresses. The address of code outside
/// of the flash is that of the flash.
pub fn rows(file: &[u8]) -> impl Iterator<Item = (u32, Row)> {
    let (rows, _) = file.as_chunks::<ROW_BYTES>();
    let rows = rows.iter().enumerate().map(|(index, bytes)| {
        let (words, _) = bytes.as_chunks::<8>();
        let word = |i: usize| words.get(i).map_or(0, |&it| u64::from_le_bytes(it));
        let address = FLASH_START + 2 * index as u32;
        (address, core::array::from_fn(word))
    });
    rows.filter(|(_, row): &(u32, Row)| row.iter().any(|&it| it > 0))
}

#[cfg(test)]
mod tests {
    use super::{Profile, ROW_BYTES, Row, rows};
    use crate::ledger::Charge;
    use crate::steps::Mark;

    fn charge(address: u32, cycles: i64) -> Vec<Charge> {
        vec![Charge { address, cycles }]
    }

    /// Applies changes to a file.
    fn write(file: &mut Vec<u8>, profile: &mut Profile) {
        for (at, bytes) in profile.changes() {
            let end = at as usize + bytes.len();
            file.resize(file.len().max(end), 0);
            file[at as usize..end].copy_from_slice(&bytes);
        }
    }

    #[test]
    fn a_file_has_the_steps_that_ended() {
        let (mut profile, mut file) = (Profile::default(), Vec::new());
        profile.mark(Mark::Request, charge(0x0800_0100, 99));
        profile.mark(Mark::Stage(1), charge(0x0800_0100, 10));
        profile.mark(Mark::Reply, charge(0x0800_0200, 99));
        assert!(profile.changes().is_empty(), "the step has not ended");
        profile.mark(Mark::Replied, charge(0x0800_0300, 7));
        write(&mut file, &mut profile);
        let row = |stage: usize, cycles| {
            let mut row = Row::default();
            row[stage] = cycles;
            row
        };
        let found: Vec<_> = rows(&file).collect();
        assert_eq!(found, [(0x0800_0100, row(1, 10))]);
        // A request that is answered without a step, then a step: the reply before is in it.
        profile.mark(Mark::Request, Vec::new());
        profile.mark(Mark::Stage(0), charge(0x0800_0100, 50));
        profile.mark(Mark::Request, Vec::new());
        profile.mark(Mark::Stage(1), charge(0x0800_0100, 5));
        profile.mark(Mark::Stage(6), charge(0x2000_0000, 3));
        profile.mark(Mark::Replied, Vec::new());
        write(&mut file, &mut profile);
        let found: Vec<_> = rows(&file).collect();
        let expected = [
            (0x0800_0000, row(6, 3)),
            (0x0800_0100, row(1, 15)),
            (0x0800_0300, row(0, 7)),
        ];
        assert_eq!(found, expected);
        assert_eq!(file.len() % ROW_BYTES, 0);
    }
}
