//! Seeded maps and naive twins for the skeleton's tests.
#![allow(dead_code, reason = "each test file uses its part")]

use std::collections::VecDeque;

use fieldline_planner::grid::{Plane, PlaneMut, Shape, Site};

/// A xorshift generator: the same maps on every machine.
pub(crate) struct Rng(u64);

impl Rng {
    /// From a seed.
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// 64 bits.
    pub(crate) fn next(&mut self) -> u64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        self.0.wrapping_mul(0x2545_f491_4f6c_dd1d)
    }

    /// Below `n`.
    pub(crate) fn below(&mut self, n: usize) -> usize {
        (self.next() >> 33) as usize % n
    }

    /// With a probability of so many hundredths.
    pub(crate) fn percent(&mut self, p: usize) -> bool {
        self.below(100) < p
    }
}

/// A map held naively.
#[derive(Clone, PartialEq, Eq, Debug)]
pub(crate) struct Map {
    pub(crate) columns: usize,
    pub(crate) rows: usize,
    pub(crate) cells: Vec<bool>,
}

impl Map {
    pub(crate) fn new(columns: usize, rows: usize, value: bool) -> Self {
        let cells = vec![value; columns * rows];
        Self {
            columns,
            rows,
            cells,
        }
    }

    pub(crate) fn get(&self, x: isize, y: isize) -> bool {
        x >= 0
            && y >= 0
            && (x as usize) < self.columns
            && (y as usize) < self.rows
            && self.cells[y as usize * self.columns + x as usize]
    }

    pub(crate) fn set(&mut self, x: usize, y: usize, value: bool) {
        if x < self.columns && y < self.rows {
            self.cells[y * self.columns + x] = value;
        }
    }

    pub(crate) fn rect(&mut self, x: usize, y: usize, width: usize, height: usize, value: bool) {
        for j in y..y + height {
            for i in x..x + width {
                self.set(i, j, value);
            }
        }
    }

    pub(crate) fn disc(&mut self, x: usize, y: usize, radius: usize, value: bool) {
        for j in y.saturating_sub(radius)..=y + radius {
            for i in x.saturating_sub(radius)..=x + radius {
                if i.abs_diff(x).pow(2) + j.abs_diff(y).pow(2) <= radius * radius {
                    self.set(i, j, value);
                }
            }
        }
    }

    pub(crate) fn parse(picture: &str) -> Self {
        let lines: Vec<&str> = picture.lines().filter(|l| !l.is_empty()).collect();
        let mut map = Self::new(lines[0].len(), lines.len(), false);
        for (y, line) in lines.iter().enumerate() {
            for (x, c) in line.bytes().enumerate() {
                map.set(x, y, c == b'#');
            }
        }
        map
    }

    pub(crate) fn print(&self) -> String {
        let mut text = String::new();
        for row in self.cells.chunks(self.columns) {
            text.extend(row.iter().map(|c| if *c { '#' } else { '.' }));
            text.push('\n');
        }
        text
    }

    pub(crate) fn shape(&self) -> Shape {
        Shape::new(self.columns.div_ceil(32), self.rows).unwrap()
    }

    pub(crate) fn words(&self) -> Vec<u32> {
        let mut words = vec![0; self.shape().words()];
        let mut plane = PlaneMut::new(self.shape(), &mut words).unwrap();
        for y in 0..self.rows {
            for x in 0..self.columns {
                if self.get(x as isize, y as isize) {
                    plane.set(site(x, y));
                }
            }
        }
        words
    }

    pub(crate) fn with_words(&self, words: &[u32]) -> Self {
        let plane = Plane::new(self.shape(), words).unwrap();
        let mut map = Self::new(self.columns, self.rows, false);
        for s in plane.sites() {
            map.set(usize::from(s.x), usize::from(s.y), true);
        }
        map
    }

    /// Pieces of the cells of one value, counted as if the map were framed by clear cells.
    pub(crate) fn pieces(&self, value: bool, diagonal: bool) -> usize {
        let (width, height) = (self.columns as isize + 2, self.rows as isize + 2);
        let mut seen = vec![false; (width * height) as usize];
        let mut pieces = 0;
        for start in 0..width * height {
            let at = |i: isize| self.get(i % width - 1, i / width - 1) == value;
            if seen[start as usize] || !at(start) {
                continue;
            }
            pieces += 1;
            seen[start as usize] = true;
            let mut stack = vec![start];
            while let Some(i) = stack.pop() {
                for (dx, dy) in AROUND {
                    let (x, y) = (i % width + dx, i / width + dy);
                    let near = y * width + x;
                    let inside = x >= 0 && y >= 0 && x < width && y < height;
                    if (diagonal || dx * dy == 0) && inside && !seen[near as usize] && at(near) {
                        seen[near as usize] = true;
                        stack.push(near);
                    }
                }
            }
        }
        pieces
    }

    /// Guo–Hall thinning, cell by cell, from the paper's conditions.
    pub(crate) fn thinned(&self) -> Self {
        self.thinned_around(&Self::new(self.columns, self.rows, false))
    }

    /// The same, where the cells of `anchors` are never deleted.
    pub(crate) fn thinned_around(&self, anchors: &Self) -> Self {
        let mut map = self.clone();
        loop {
            let before = map.cells.clone();
            for second in [false, true] {
                let now = map.clone();
                for y in 0..map.rows {
                    for x in 0..map.columns {
                        let held = anchors.get(x as isize, y as isize);
                        if !held && now.deletes(x as isize, y as isize, second) {
                            map.set(x, y, false);
                        }
                    }
                }
            }
            if map.cells == before {
                return map;
            }
        }
    }

    fn deletes(&self, x: isize, y: isize, second: bool) -> bool {
        if !self.get(x, y) {
            return false;
        }
        let p = |dx: isize, dy: isize| usize::from(self.get(x + dx, y + dy));
        let (p2, p3, p4, p5) = (p(0, -1), p(1, -1), p(1, 0), p(1, 1));
        let (p6, p7, p8, p9) = (p(0, 1), p(-1, 1), p(-1, 0), p(-1, -1));
        let c = ((1 - p2) & (p3 | p4))
            + ((1 - p4) & (p5 | p6))
            + ((1 - p6) & (p7 | p8))
            + ((1 - p8) & (p9 | p2));
        let n1 = (p9 | p2) + (p3 | p4) + (p5 | p6) + (p7 | p8);
        let n2 = (p2 | p3) + (p4 | p5) + (p6 | p7) + (p8 | p9);
        let n = n1.min(n2);
        let m = if second {
            (p2 | p3 | (1 - p5)) & p4
        } else {
            (p6 | p7 | (1 - p9)) & p8
        };
        c == 1 && (2..=3).contains(&n) && m == 0
    }

    /// Steps from the nearest seed over set cells, 8-connected.
    pub(crate) fn distances(&self, seeds: &[Site]) -> Vec<Option<u32>> {
        let mut steps = vec![None; self.cells.len()];
        let mut queue = VecDeque::new();
        for seed in seeds {
            let i = usize::from(seed.y) * self.columns + usize::from(seed.x);
            if self.cells[i] && steps[i].is_none() {
                steps[i] = Some(0);
                queue.push_back(i);
            }
        }
        while let Some(i) = queue.pop_front() {
            let (x, y) = ((i % self.columns) as isize, (i / self.columns) as isize);
            for (dx, dy) in AROUND {
                let near = (y + dy) * self.columns as isize + x + dx;
                if self.get(x + dx, y + dy) && steps[near as usize].is_none() {
                    steps[near as usize] = steps[i].map(|s: u32| s + 1);
                    queue.push_back(near as usize);
                }
            }
        }
        steps
    }
}

/// Steps to the eight neighbours.
pub(crate) const AROUND: [(isize, isize); 8] = [
    (1, 0),
    (0, -1),
    (-1, 0),
    (0, 1),
    (1, -1),
    (-1, -1),
    (-1, 1),
    (1, 1),
];

pub(crate) fn site(x: usize, y: usize) -> Site {
    Site {
        x: x as u16,
        y: y as u16,
    }
}

/// Cells of a map to be held fast, and some outside it: single ones, or the rims of a rectangle and of a disc.
pub(crate) fn any_anchors(rng: &mut Rng, map: &Map) -> Map {
    let mut anchors = Map::new(map.columns, map.rows, false);
    if rng.percent(50) {
        let density = [1, 5, 30, 90][rng.below(4)];
        for cell in &mut anchors.cells {
            *cell = rng.percent(density);
        }
        return anchors;
    }
    let (x, y) = (rng.below(map.columns), rng.below(map.rows));
    let (width, height) = (2 + rng.below(40), 2 + rng.below(30));
    anchors.rect(x, y, width, height, true);
    anchors.rect(x + 1, y + 1, width - 2, height - 2, false);
    let (x, y, radius) = (
        rng.below(map.columns),
        rng.below(map.rows),
        2 + rng.below(20),
    );
    anchors.disc(x, y, radius, true);
    anchors.disc(x, y, radius - 1, false);
    anchors
}

/// Maps of all kinds, by seed: noise, rooms with doors, corridors, discs, an open hall with rubble.
pub(crate) fn any_map(rng: &mut Rng) -> Map {
    let (columns, rows) = (1 + rng.below(140), 1 + rng.below(70));
    match rng.below(5) {
        0 => noise(rng, columns, rows),
        1 => rooms(rng, columns, rows),
        2 => corridors(rng, columns, rows),
        3 => discs(rng, columns, rows),
        _ => hall(rng, columns, rows),
    }
}

pub(crate) fn noise(rng: &mut Rng, columns: usize, rows: usize) -> Map {
    let density = 20 + rng.below(78);
    let mut map = Map::new(columns, rows, false);
    for cell in &mut map.cells {
        *cell = rng.percent(density);
    }
    map
}

pub(crate) fn rooms(rng: &mut Rng, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, true);
    let pitch = 9 + rng.below(14);
    for x in (pitch..columns).step_by(pitch) {
        map.rect(x, 0, 1, rows, false);
        for y in (0..rows).step_by(pitch) {
            map.rect(x, y + 2 + rng.below(pitch), 1, 1 + rng.below(3), true);
        }
    }
    for y in (pitch..rows).step_by(pitch) {
        map.rect(0, y, columns, 1, false);
        for x in (0..columns).step_by(pitch) {
            map.rect(x + 2 + rng.below(pitch), y, 1 + rng.below(3), 1, true);
        }
    }
    for _ in 0..columns * rows / 150 {
        let (x, y) = (rng.below(columns), rng.below(rows));
        map.rect(x, y, 1 + rng.below(3), 1 + rng.below(3), false);
    }
    map
}

pub(crate) fn corridors(rng: &mut Rng, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, false);
    for _ in 0..6 {
        let width = 1 + rng.below(7);
        map.rect(0, rng.below(rows), columns, width, true);
        map.rect(rng.below(columns), 0, width, rows, true);
    }
    map
}

pub(crate) fn discs(rng: &mut Rng, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, false);
    for k in 0..24 {
        let (x, y) = (rng.below(columns), rng.below(rows));
        map.disc(x, y, rng.below(14), k % 3 != 2);
    }
    map
}

pub(crate) fn hall(rng: &mut Rng, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, true);
    for _ in 0..rng.below(1 + columns * rows / 200) {
        map.set(rng.below(columns), rng.below(rows), false);
    }
    map
}
