//! The flash against a naive twin over long random walks.
//!
//! The twin keeps a calendar of the cycles in which the array reads, and its caches are lists in
//! the order of their last use. Both are slow and plain.

use std::collections::BTreeSet;

use fieldline_cycles::flash::{AHEAD, CODE_LINES, DATA_LINES, Flash, WAIT_STATES};

/// A cache as a list, the latest line first.
struct List {
    lines: Vec<u32>,
    most: usize,
}

impl List {
    /// Uses a line; returns true if it was there. Otherwise it is there now.
    fn use_line(&mut self, line: u32) -> bool {
        let found = self.lines.iter().position(|&it| it == line);
        if let Some(at) = found {
            self.lines.remove(at);
        }
        self.lines.insert(0, line);
        self.lines.truncate(self.most);
        found.is_some()
    }
}

struct Twin {
    code: List,
    data: List,
    /// Cycles in which the array reads.
    calendar: BTreeSet<u64>,
    current: Option<u32>,
    /// The line prefetched last, and the cycle in which it comes.
    prefetched: Option<(u32, u64)>,
}

impl Twin {
    fn new() -> Self {
        let list = |most| List {
            lines: Vec::new(),
            most,
        };
        Self {
            code: list(CODE_LINES),
            data: list(DATA_LINES),
            calendar: BTreeSet::new(),
            current: None,
            prefetched: None,
        }
    }

    /// Reads behind all reads that are in the calendar; returns the last cycle of the read.
    fn read(&mut self, now: u64) -> u64 {
        let mut first = now;
        while self.calendar.range(first..).next().is_some() {
            first += 1;
        }
        self.calendar.extend(first..=first + WAIT_STATES);
        first + WAIT_STATES
    }

    fn fetch(&mut self, line: u32, straight: bool, now: u64) -> u64 {
        if self.current == Some(line) {
            return 0;
        }
        self.current = Some(line);
        let mut time = now;
        if !self.code.use_line(line) {
            let comes = match self.prefetched {
                Some((prefetched, comes)) if prefetched == line => comes,
                _ => self.read(now),
            };
            while time < comes {
                time += 1;
            }
        }
        let ahead = if straight { AHEAD.min(time - now) } else { 0 };
        time -= ahead;
        let next = line + 1;
        let is_known = self.code.lines.contains(&next);
        if !is_known && self.prefetched.is_none_or(|(line, _)| line != next) {
            let comes = self.read(time);
            self.prefetched = Some((next, comes));
        }
        time - now
    }

    fn load(&mut self, line: u32, now: u64) -> u64 {
        if self.data.use_line(line) {
            return 0;
        }
        self.read(now) - now
    }
}

/// A sequence of random numbers (xorshift).
struct Random(u64);

impl Random {
    fn below(&mut self, limit: u64) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0 % limit
    }
}

/// Walks through `span` lines of code: mostly straight on, sometimes with a jump.
fn walk(seed: u64, span: u32, steps: usize) -> u64 {
    let mut random = Random(seed);
    let (mut flash, mut twin) = (Flash::default(), Twin::new());
    let (mut line, mut now, mut waited) = (0, 0, 0);
    for step in 0..steps {
        let straight = random.below(10) > 2;
        line = match straight {
            true => line + 1,
            false => random.below(u64::from(span)) as u32,
        };
        let wait = flash.fetch(line, straight, now);
        let expected = twin.fetch(line, straight, now);
        assert_eq!(
            wait, expected,
            "seed {seed}, step {step}: line {line} at {now}"
        );
        now += wait + random.below(12);
        waited += wait;
        if random.below(4) == 0 {
            let data = 5000 + random.below(12) as u32;
            let wait = flash.load(data, now);
            let expected = twin.load(data, now);
            assert_eq!(
                wait, expected,
                "seed {seed}, step {step}: data {data} at {now}"
            );
            now += wait;
        }
        // What is long over does not matter.
        if step % 100 == 0 {
            twin.calendar = twin.calendar.split_off(&now.saturating_sub(1));
        }
    }
    waited
}

#[test]
fn the_flash_waits_as_its_naive_twin_does() {
    for seed in 1..=20 {
        // Less than the cache, about as much, and far more.
        let waits = [20, 70, 1000].map(|span| walk(seed, span, 5000));
        assert!(waits[0] < waits[1] && waits[1] < waits[2], "{waits:?}");
    }
}
