//! The profile of a run against the account of its steps, over random runs: each stage has the same
//! cycles in both.

use fieldline_cycles::chip::Access;
use fieldline_cycles::decode::{decode, narrow};
use fieldline_cycles::instruction::Instruction;
use fieldline_cycles::profile::{Row, rows};
use fieldline_cycles::steps::{Mark, PORTS, STAGES};
use fieldline_cycles::watcher::Watcher;

/// Numbers that look random: xorshift.
struct Dice(u32);

impl Dice {
    fn below(&mut self, bound: u32) -> u32 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 17;
        self.0 ^= self.0 << 5;
        self.0 % bound
    }
}

/// Instructions of all kinds of waits: a load, a division of the FPU and its consumer, an addition,
/// a branch.
fn instruction(dice: &mut Dice) -> Instruction {
    match dice.below(4) {
        0 => narrow(0x6810),
        1 => decode(&[0x80, 0xee, 0x20, 0x0a]).unwrap(),
        2 => decode(&[0x30, 0xee, 0x21, 0x1a]).unwrap(),
        _ => narrow(0x1840),
    }
}

/// A watched chip and its code.
struct Run {
    watcher: Watcher,
    dice: Dice,
    /// Start and instructions.
    code: Vec<(u32, Vec<Instruction>)>,
    file: Vec<u8>,
    sums: Row,
    steps: u32,
}

impl Run {
    fn new(seed: u32) -> Self {
        let mut watcher = Watcher::default();
        watcher.keep_profile();
        let mut dice = Dice(seed);
        let code = (0..40)
            .map(|n| {
                let start = if n == 39 {
                    0x2000_0000
                } else {
                    0x0800_0400 + 0x62 * n
                };
                let count = 2 + dice.below(10);
                let mut block: Vec<_> = (0..count).map(|_| instruction(&mut dice)).collect();
                block.push(narrow([0xe7fe, 0x4770][dice.below(2) as usize]));
                (start, block)
            })
            .collect();
        let file = Vec::new();
        Self {
            watcher,
            dice,
            code,
            file,
            sums: Row::default(),
            steps: 0,
        }
    }

    /// Executes a block, with accesses to memory.
    fn wander(&mut self) {
        let block = self.dice.below(40) as usize;
        let (start, instructions) = &self.code[block];
        let number = self.watcher.block(*start, instructions);
        self.watcher.execute(number);
        for _ in 0..self.dice.below(3) {
            let index = self.dice.below(3) as usize;
            let address = [0x2000_0002, 0x0808_0000, 0x0809_0000][self.dice.below(3) as usize];
            let access = Access {
                block: number,
                index,
                address,
                size: 2,
                store: false,
            };
            self.watcher.access(&access);
        }
    }

    /// Makes a mark in the middle of a block, as the emulator does: the block is given up there.
    fn mark(&mut self, port: u32) {
        let block = self.dice.below(40) as usize;
        let (start, instructions) = self.code[block].clone();
        let whole = self.watcher.block(start, &instructions);
        self.watcher.execute(whole);
        let index = self.dice.below(instructions.len() as u32) as usize;
        let before: u32 = instructions[..index]
            .iter()
            .map(|it| u32::from(it.bytes))
            .sum();
        let alone = self
            .watcher
            .block(start + before, &instructions[index..=index]);
        let access = Access {
            block: alone,
            index: 0,
            address: PORTS + 4 * port,
            size: 0,
            store: true,
        };
        if let Some(cost) = self.watcher.access(&access) {
            for (sum, stage) in self.sums.iter_mut().zip(cost.stages) {
                *sum += u64::from(stage.cycles);
            }
            self.steps += 1;
            for (at, bytes) in self.watcher.changes() {
                let end = at as usize + bytes.len();
                self.file.resize(self.file.len().max(end), 0);
                self.file[at as usize..end].copy_from_slice(&bytes);
            }
        }
        let rest = &instructions[index + 1..];
        if !rest.is_empty() {
            let behind = start + before + u32::from(instructions[index].bytes);
            let rest = self.watcher.block(behind, rest);
            self.watcher.execute(rest);
        }
    }
}

#[test]
fn a_profile_has_the_cycles_of_the_steps() {
    for seed in 1..40 {
        let mut run = Run::new(seed);
        for _ in 0..20 {
            let marks: Vec<u32> = match run.dice.below(3) {
                // A request without a step.
                0 => vec![0, 1],
                _ => vec![0, 1, 2, 3, 4, 5, 6, 7, 1, 8, 9],
            };
            for port in marks {
                for _ in 0..run.dice.below(200) {
                    run.wander();
                }
                run.mark(port);
            }
        }
        let mut sums = Row::default();
        for (address, row) in rows(&run.file) {
            for (sum, cycles) in sums.iter_mut().zip(row) {
                *sum += cycles;
                // A cell of a profile is a count and no wrapped difference.
                assert!(cycles < 1 << 40, "seed {seed}: {address:#x}: {row:?}");
            }
        }
        assert!(run.steps > 5, "seed {seed}");
        assert_eq!(sums, run.sums, "seed {seed}");
        assert_eq!(sums.len(), STAGES);
    }
    assert_eq!(Mark::ALL.len(), 10);
}
