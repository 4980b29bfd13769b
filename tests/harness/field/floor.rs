//! Seeded floors: rooms, a door, corridors, scattered posts, a cave, slanted walls.

use fieldline_planner::field::SIDE;

use super::{Rows, cells, sin_cos};
use crate::random::Random;

/// A kind of floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// Rooms of a recursive division, walls of one or two cells, doors of 5 to 9.
    Rooms,
    /// One wall of one cell right across, with a door of 6 to 8.
    Door,
    /// Corridors of 5 to 11 cells carved from rock.
    Corridors,
    /// Posts of one to three cells on 2 to 12 % of the floor.
    Scatter,
    /// A cave grown by a cellular automaton.
    Cave,
    /// Walls of one cell at any angle, each with a gap.
    Slanted,
}

/// All kinds, in the order of the tables.
pub const KINDS: [Kind; 6] = [
    Kind::Rooms,
    Kind::Door,
    Kind::Corridors,
    Kind::Scatter,
    Kind::Cave,
    Kind::Slanted,
];

/// A square floor of any size.
#[derive(Clone, Debug)]
pub(crate) struct Floor {
    side: i32,
    free: Vec<bool>,
}

impl Floor {
    /// Draws a floor.
    pub(crate) fn draw(kind: Kind, side: i32, random: &mut Random) -> Self {
        let mut floor = Self {
            side,
            free: vec![kind != Kind::Corridors; (side * side) as usize],
        };
        match kind {
            Kind::Rooms => floor.divide([0, 0, side, side], random),
            Kind::Door => floor.wall_with_door(random),
            Kind::Corridors => floor.carve_corridors(random),
            Kind::Scatter => floor.scatter_posts(random),
            Kind::Cave => floor.grow_cave(random),
            Kind::Slanted => floor.slanted_walls(random),
        }
        floor
    }

    fn is_free(&self, x: i32, y: i32) -> bool {
        let inside = 0..self.side;
        inside.contains(&x) && inside.contains(&y) && self.free[(y * self.side + x) as usize]
    }

    fn set(&mut self, x: i32, y: i32, free: bool) {
        if (0..self.side).contains(&x) && (0..self.side).contains(&y) {
            self.free[(y * self.side + x) as usize] = free;
        }
    }

    fn fill(&mut self, [x, y, width, height]: [i32; 4], free: bool) {
        for row in y..y + height {
            for column in x..x + width {
                self.set(column, row, free);
            }
        }
    }

    fn divide(&mut self, [x, y, width, height]: [i32; 4], random: &mut Random) {
        let longest = width.max(height);
        if longest < 28 || (longest < 45 && random.chance(0.25)) {
            return;
        }
        let (door, thick) = (random.within(5, 10), random.within(1, 3));
        if width >= height {
            let wall = random.within(12, width - 12 - thick);
            self.fill([x + wall, y, thick, height], false);
            self.fill(
                [x + wall, y + random.within(1, height - door), thick, door],
                true,
            );
            self.divide([x, y, wall, height], random);
            self.divide([x + wall + thick, y, width - wall - thick, height], random);
        } else {
            let wall = random.within(12, height - 12 - thick);
            self.fill([x, y + wall, width, thick], false);
            self.fill(
                [x + random.within(1, width - door), y + wall, door, thick],
                true,
            );
            self.divide([x, y, width, wall], random);
            self.divide([x, y + wall + thick, width, height - wall - thick], random);
        }
    }

    fn wall_with_door(&mut self, random: &mut Random) {
        let wall = random.within(self.side / 4, 3 * self.side / 4);
        let door = random.within(6, 9);
        self.fill([0, wall, self.side, 1], false);
        self.fill([random.within(1, self.side - door), wall, door, 1], true);
    }

    fn carve_corridors(&mut self, random: &mut Random) {
        let half = random.within(2, 6);
        let wide = 2 * half + 1;
        let (mut x, mut y) = (self.side / 2, self.side / 2);
        for leg in 0..random.within(6, 12) * (self.side / SIDE as i32) {
            let to = random.within(half + 1, self.side - half - 1);
            let (to_x, to_y) = if leg % 2 == 0 { (to, y) } else { (x, to) };
            let (left, low) = (x.min(to_x) - half, y.min(to_y) - half);
            self.fill(
                [left, low, (x - to_x).abs() + wide, (y - to_y).abs() + wide],
                true,
            );
            (x, y) = (to_x, to_y);
        }
    }

    fn scatter_posts(&mut self, random: &mut Random) {
        let density = 0.02 + 0.10 * random.unit();
        let mut left = (density * f64::from(self.side * self.side)) as i32;
        while left > 0 {
            let post = random.within(1, 4);
            self.fill(
                [
                    random.within(0, self.side),
                    random.within(0, self.side),
                    post,
                    post,
                ],
                false,
            );
            left -= post * post;
        }
    }

    fn grow_cave(&mut self, random: &mut Random) {
        for cell in &mut self.free {
            *cell = random.chance(0.58);
        }
        for _ in 0..4 {
            let before = self.clone();
            for y in 0..self.side {
                for x in 0..self.side {
                    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
                    let walls = around.filter(|&(x, y)| !before.is_free(x, y)).count();
                    self.set(x, y, walls < 5);
                }
            }
        }
    }

    fn slanted_walls(&mut self, random: &mut Random) {
        for _ in 0..random.within(4, 9) * (self.side / SIDE as i32) {
            let (x, y) = (random.within(0, self.side), random.within(0, self.side));
            let (sin, cos) = sin_cos(random.angle());
            let length = random.within(20, 60);
            let gap = random.within(0, length);
            for step in (0..2 * length).filter(|step| (step / 2 - gap).abs() > 4) {
                let along = |origin: i32, slope: f64| {
                    (f64::from(origin) + slope * f64::from(step) / 2.0) as i32
                };
                self.set(along(x, cos), along(y, sin), false);
            }
        }
    }

    /// Returns the window of cells from (x, y) on, as row masks.
    pub(crate) fn cut(&self, x: i32, y: i32) -> Rows {
        let mut rows = [0; SIDE];
        for (column, row) in cells() {
            rows[row] |= u64::from(self.is_free(x + column as i32, y + row as i32)) << column;
        }
        rows
    }

    /// Returns a shortest path from `start` to the free cell farthest from it; only `start` if that
    /// is not free.
    pub(crate) fn longest_path(&self, start: (i32, i32)) -> Vec<(i32, i32)> {
        let mut path = vec![start];
        if !self.is_free(start.0, start.1) {
            return path;
        }
        let mut from = std::collections::BTreeMap::from([(start, start)]);
        let mut queue = std::collections::VecDeque::from([start]);
        while let Some((x, y)) = queue.pop_front() {
            path[0] = (x, y);
            for next in [(x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)] {
                if self.is_free(next.0, next.1) && !from.contains_key(&next) {
                    from.insert(next, (x, y));
                    queue.push_back(next);
                }
            }
        }
        while path[path.len() - 1] != start {
            path.push(from[&path[path.len() - 1]]);
        }
        path.reverse();
        path
    }
}
