//! Seeded bit maps, and oracles over them: thinning by \[GuoHall89\] and search, cell by cell.

use std::collections::VecDeque;

use fieldline_planner::grid::{Plane, PlaneMut, Site, TileKey, Tiling};

use crate::random::Random;

/// A map with one `bool` for each cell; row 0 is in the north.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Map {
    /// Cells of a row.
    pub columns: usize,
    /// Number of rows.
    pub rows: usize,
    /// Cells, row by row.
    pub cells: Vec<bool>,
}

impl Map {
    /// Makes a map of one value.
    #[must_use]
    pub fn new(columns: usize, rows: usize, value: bool) -> Self {
        let cells = vec![value; columns * rows];
        Self {
            columns,
            rows,
            cells,
        }
    }

    /// Returns a cell; cells outside are clear.
    #[must_use]
    pub fn get(&self, x: isize, y: isize) -> bool {
        x >= 0
            && y >= 0
            && (x as usize) < self.columns
            && (y as usize) < self.rows
            && self.cells[y as usize * self.columns + x as usize]
    }

    /// Sets a cell; one outside is ignored.
    pub fn set(&mut self, x: usize, y: usize, value: bool) {
        if x < self.columns && y < self.rows {
            self.cells[y * self.columns + x] = value;
        }
    }

    /// Fills a rectangle.
    pub fn rect(&mut self, x: usize, y: usize, width: usize, height: usize, value: bool) {
        for j in y..y + height {
            for i in x..x + width {
                self.set(i, j, value);
            }
        }
    }

    /// Fills a disc.
    pub fn disc(&mut self, x: usize, y: usize, radius: usize, value: bool) {
        for j in y.saturating_sub(radius)..=y + radius {
            for i in x.saturating_sub(radius)..=x + radius {
                if i.abs_diff(x).pow(2) + j.abs_diff(y).pow(2) <= radius * radius {
                    self.set(i, j, value);
                }
            }
        }
    }

    /// Reads a picture: `#` is set.
    #[must_use]
    pub fn parse(picture: &str) -> Self {
        let lines: Vec<&str> = picture.lines().filter(|l| !l.is_empty()).collect();
        let mut map = Self::new(lines[0].len(), lines.len(), false);
        for (y, line) in lines.iter().enumerate() {
            for (x, c) in line.bytes().enumerate() {
                map.set(x, y, c == b'#');
            }
        }
        map
    }

    /// Draws the map as a picture.
    #[must_use]
    pub fn print(&self) -> String {
        let mut text = String::new();
        for row in self.cells.chunks(self.columns) {
            text.extend(row.iter().map(|c| if *c { '#' } else { '.' }));
            text.push('\n');
        }
        text
    }

    /// Returns the tiles that have a set cell, sorted: the planner's plane needs no others.
    ///
    /// # Panics
    /// If the map is too large for a plane.
    #[must_use]
    pub fn keys(&self) -> Vec<TileKey> {
        let mut keys: Vec<TileKey> = (0..self.cells.len())
            .filter(|&i| self.cells[i])
            .map(|i| TileKey::at(site(i % self.columns, i / self.columns)))
            .collect();
        keys.sort_unstable();
        keys.dedup();
        keys
    }

    /// Packs the map into words of a plane of these tiles.
    ///
    /// # Panics
    /// If a set cell lies in no tile.
    #[must_use]
    pub fn words(&self, keys: &[TileKey]) -> Vec<u32> {
        let tiling = Tiling::new(keys);
        let mut words = vec![0; tiling.words()];
        let mut plane = PlaneMut::new(tiling, &mut words).unwrap();
        for y in 0..self.rows {
            for x in 0..self.columns {
                if self.get(x as isize, y as isize) {
                    plane.set(site(x, y));
                }
            }
        }
        words
    }

    /// Returns a map of this size with the cells of a plane.
    ///
    /// # Panics
    /// If there are too few words.
    #[must_use]
    pub fn with_words(&self, keys: &[TileKey], words: &[u32]) -> Self {
        let plane = Plane::new(Tiling::new(keys), words).unwrap();
        let mut map = Self::new(self.columns, self.rows, false);
        for at in plane.sites() {
            let (x, y) = column_and_row(at);
            map.set(x, y, true);
        }
        map
    }

    /// Counts the pieces of the cells of one value, as if the map were framed by clear cells.
    #[must_use]
    pub fn pieces(&self, value: bool, diagonal: bool) -> usize {
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

    /// Thins the map, cell by cell, from the conditions of \[GuoHall89\].
    #[must_use]
    pub fn thinned(&self) -> Self {
        self.thinned_around(&Self::new(self.columns, self.rows, false))
    }

    /// Thins the map and never deletes a cell of `anchors`.
    #[must_use]
    pub fn thinned_around(&self, anchors: &Self) -> Self {
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

    /// Returns the steps from the nearest seed over set cells, 8-connected.
    #[must_use]
    pub fn distances(&self, seeds: &[Site]) -> Vec<Option<u32>> {
        let mut steps = vec![None; self.cells.len()];
        let mut queue = VecDeque::new();
        for seed in seeds {
            let (x, y) = column_and_row(*seed);
            let i = y * self.columns + x;
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
const AROUND: [(isize, isize); 8] = [
    (1, 0),
    (0, -1),
    (-1, 0),
    (0, 1),
    (1, -1),
    (-1, -1),
    (-1, 1),
    (1, 1),
];

/// The site of the map's first cell: the least one of the first tile.
fn corner() -> Site {
    TileKey::of(0, 0).unwrap().least()
}

/// Returns the site of a cell of a map in its plane.
#[must_use]
pub fn site(x: usize, y: usize) -> Site {
    let corner = corner();
    Site {
        x: corner.x + x as u16,
        y: corner.y + y as u16,
    }
}

/// Returns the column and the row of a site in its map.
#[must_use]
pub fn column_and_row(site: Site) -> (usize, usize) {
    let corner = corner();
    ((site.x - corner.x).into(), (site.y - corner.y).into())
}

/// Draws anchors: single cells in the map and outside it, or the rims of a rectangle and of a disc.
pub fn any_anchors(random: &mut Random, map: &Map) -> Map {
    let mut anchors = Map::new(map.columns, map.rows, false);
    if random.percent(50) {
        let density = [1, 5, 30, 90][random.index(4)];
        for cell in &mut anchors.cells {
            *cell = random.percent(density);
        }
        return anchors;
    }
    let (x, y) = (random.index(map.columns), random.index(map.rows));
    let (width, height) = (2 + random.index(40), 2 + random.index(30));
    anchors.rect(x, y, width, height, true);
    anchors.rect(x + 1, y + 1, width - 2, height - 2, false);
    let (x, y, radius) = (
        random.index(map.columns),
        random.index(map.rows),
        2 + random.index(20),
    );
    anchors.disc(x, y, radius, true);
    anchors.disc(x, y, radius - 1, false);
    anchors
}

/// Draws a map of any kind: noise, rooms with doors, corridors, discs, or a hall with rubble.
pub fn any_map(random: &mut Random) -> Map {
    let (columns, rows) = (1 + random.index(140), 1 + random.index(70));
    match random.index(5) {
        0 => noise(random, columns, rows),
        1 => rooms(random, columns, rows),
        2 => corridors(random, columns, rows),
        3 => discs(random, columns, rows),
        _ => hall(random, columns, rows),
    }
}

/// Draws a map whose cells are set at random.
pub fn noise(random: &mut Random, columns: usize, rows: usize) -> Map {
    let density = 20 + random.below(78);
    let mut map = Map::new(columns, rows, false);
    for cell in &mut map.cells {
        *cell = random.percent(density);
    }
    map
}

/// Draws rooms with doors and rubble.
pub fn rooms(random: &mut Random, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, true);
    let pitch = 9 + random.index(14);
    for x in (pitch..columns).step_by(pitch) {
        map.rect(x, 0, 1, rows, false);
        for y in (0..rows).step_by(pitch) {
            map.rect(x, y + 2 + random.index(pitch), 1, 1 + random.index(3), true);
        }
    }
    for y in (pitch..rows).step_by(pitch) {
        map.rect(0, y, columns, 1, false);
        for x in (0..columns).step_by(pitch) {
            map.rect(x + 2 + random.index(pitch), y, 1 + random.index(3), 1, true);
        }
    }
    for _ in 0..columns * rows / 150 {
        let (x, y) = (random.index(columns), random.index(rows));
        map.rect(x, y, 1 + random.index(3), 1 + random.index(3), false);
    }
    map
}

/// Draws corridors that cross.
pub fn corridors(random: &mut Random, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, false);
    for _ in 0..6 {
        let width = 1 + random.index(7);
        map.rect(0, random.index(rows), columns, width, true);
        map.rect(random.index(columns), 0, width, rows, true);
    }
    map
}

/// Draws discs, two of three set and one of three clear.
pub fn discs(random: &mut Random, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, false);
    for k in 0..24 {
        let (x, y) = (random.index(columns), random.index(rows));
        map.disc(x, y, random.index(14), k % 3 != 2);
    }
    map
}

/// Draws an open hall with rubble.
pub fn hall(random: &mut Random, columns: usize, rows: usize) -> Map {
    let mut map = Map::new(columns, rows, true);
    for _ in 0..random.index(1 + columns * rows / 200) {
        map.set(random.index(columns), random.index(rows), false);
    }
    map
}
