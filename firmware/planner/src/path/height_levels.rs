//! HeightLevels: how high the known ground lies, coarsely and everywhere, and how much later a goal counts for lying on another one.
//!
//! ```text
//! level(x, y) = λ_h |h_storey − h(x, y)| / |ε_hmin|, rounded, at most MOST_LEVEL
//! a goal's wave starts LEVEL_STEPS · level later
//! ```
//!
//! Departs from [Maffei20, III-C]: there one field over the whole grid both bends the way and chooses the goal, for a goal behind n
//! cells of ε attracts e^(nε) times less. The window's field is 6 m wide, and which goal the robot goes to is the wave's choice along the
//! skeleton; so the preference has its say there too: along a slope n grows with the height, so no limit is set to it where eq. 3 has `ε_hmin`. It counts from the *storey*, the ground that the robot last stood on level, and not
//! from the robot's own height: halfway down a slope both of its ends are equally far off, and a storey would be left half explored.
//!
//! Heights of the elevation window are kept as it moves on, one for 8 × 8 cells of every tile of the map. On flat ground there are none,
//! and their memory is the near field's. A tile that is folded ([`crate::map::compaction`]) keeps one height. Units: decimetres above the start, saturated at ±12.7 m.

use crate::config::UnevenGround;
use crate::geometry::Cell;
use crate::ground::elevation::{Heights, WINDOW_SIDE};
use crate::map::compaction::Entry;
use crate::map::tiles::TILE_SIDE;
use crate::map::{SideTable, Tiles};
use crate::math;

/// Cells along a block's side.
const BLOCK: i32 = 8;
/// Blocks along a tile's side.
const ACROSS: i32 = TILE_SIDE / BLOCK;
/// Blocks of a tile.
const BLOCKS: usize = (ACROSS * ACROSS) as usize;
/// Heights a metre.
const PER_METRE: f32 = 10.0;
/// Of a block where none was measured.
const NONE: i8 = i8::MIN;
/// Of so many cells along a block's side one is looked at.
const SAMPLED: usize = 2;
/// Greatest level of a goal.
pub const MOST_LEVEL: u32 = 8;
/// How much later a goal counts for every level, coarse steps: with Table I's parameters 10 m of way for 0.25 m of height.
pub const LEVEL_STEPS: u32 = 50;

/// The heights. `TILES` tiles in the map's pool.
#[derive(Debug)]
pub struct HeightLevels<const TILES: usize> {
    /// By the tile's place in the pool.
    blocks: [[i8; BLOCKS]; TILES],
}

impl<const TILES: usize> HeightLevels<TILES> {
    /// Nothing measured.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            blocks: [[NONE; BLOCKS]; TILES],
        }
    }

    /// Keep what the window holds.
    pub fn note<const SLOTS: usize>(&mut self, heights: &Heights<'_>, tiles: &Tiles<TILES, SLOTS>) {
        let least = heights.origin();
        let blocks =
            |from: i32| from.div_euclid(BLOCK)..=(from + WINDOW_SIDE - 1).div_euclid(BLOCK);
        let is_whole =
            |corner: i32, from: i32| corner >= from && corner + BLOCK <= from + WINDOW_SIDE;
        for by in blocks(least.y) {
            for bx in blocks(least.x) {
                let corner = Cell {
                    x: bx * BLOCK,
                    y: by * BLOCK,
                };
                let whole = is_whole(corner.x, least.x) && is_whole(corner.y, least.y);
                if let Some(stored) = self.block_mut(tiles, corner)
                    // Of one that leaves the window half would count; of one that enters it half is better than nothing.
                    && (whole || *stored == NONE)
                    && let Some(height_m) = mean_m(heights, corner)
                {
                    let most = f32::from(i8::MAX);
                    *stored =
                        (math::floor(height_m * PER_METRE + 0.5) as f32).clamp(-most, most) as i8;
                }
            }
        }
    }

    fn block_mut<const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        cell: Cell,
    ) -> Option<&mut i8> {
        match tiles.entry(cell.x.div_euclid(TILE_SIDE), cell.y.div_euclid(TILE_SIDE)) {
            Entry::Page(page) => self.blocks.get_mut(page)?.get_mut(place(cell)),
            _ => None,
        }
    }

    fn half_mut(&mut self, half: usize) -> Option<&mut i8> {
        self.blocks.get_mut(half / 2)?.get_mut(half % 2)
    }

    /// The height of the ground around a cell, metres; where none was measured, the mean of the blocks beside that have one. A goal lies where
    /// the measured ends, and its own block was often hardly met: taken for level, it would draw the robot up a slope.
    #[must_use]
    pub fn height_around_m<const SLOTS: usize>(
        &self,
        tiles: &Tiles<TILES, SLOTS>,
        cell: Cell,
    ) -> Option<f32> {
        let beside = || {
            let (mut sum_m, mut count) = (0.0, 0_u8);
            for (dx, dy) in (-1..=1).flat_map(|dx| (-1..=1).map(move |dy| (dx, dy))) {
                let near = Cell {
                    x: cell.x + dx * BLOCK,
                    y: cell.y + dy * BLOCK,
                };
                if let Some(height_m) = self.height_m(tiles, near) {
                    (sum_m, count) = (sum_m + height_m, count + 1);
                }
            }
            (count > 0).then(|| sum_m / f32::from(count))
        };
        self.height_m(tiles, cell).or_else(beside)
    }

    /// The height of the ground around a cell, metres; `None` where none was measured. Of a folded tile it is the tile's.
    #[must_use]
    pub fn height_m<const SLOTS: usize>(
        &self,
        tiles: &Tiles<TILES, SLOTS>,
        cell: Cell,
    ) -> Option<f32> {
        let stored = match tiles.entry(cell.x.div_euclid(TILE_SIDE), cell.y.div_euclid(TILE_SIDE)) {
            Entry::Untouched => return None,
            Entry::Page(page) => *self.blocks.get(page)?.get(place(cell))?,
            Entry::Half(half) => *self.blocks.get(half / 2)?.get(half % 2)?,
            Entry::AllFree(kept) => kept,
        };
        (stored != NONE).then(|| f32::from(stored) / PER_METRE)
    }
}

/// A compact tile keeps the mean of its heights, in one of the first two places by its half of a page.
impl<const TILES: usize> SideTable for HeightLevels<TILES> {
    fn release_page(&mut self, page: usize) -> i8 {
        let Some(blocks) = self.blocks.get_mut(page) else {
            return NONE;
        };
        let known = blocks.iter().filter(|&&block| block != NONE);
        let (sum, count) = known.fold((0, 0), |(sum, count), &block| {
            (sum + i32::from(block), count + 1)
        });
        blocks.fill(NONE);
        if count > 0 { (sum / count) as i8 } else { NONE }
    }

    fn restore_page(&mut self, page: usize, kept: i8) {
        if let Some(blocks) = self.blocks.get_mut(page) {
            blocks.fill(kept);
        }
    }

    fn store_half(&mut self, half: usize, kept: i8) {
        if let Some(stored) = self.half_mut(half) {
            *stored = kept;
        }
    }

    fn release_half(&mut self, half: usize) -> i8 {
        self.half_mut(half)
            .map_or(NONE, |stored| core::mem::replace(stored, NONE))
    }
}

impl<const TILES: usize> Default for HeightLevels<TILES> {
    fn default() -> Self {
        Self::new()
    }
}

/// A block's place in its tile.
fn place(cell: Cell) -> usize {
    let along = |at: i32| at.rem_euclid(TILE_SIDE) / BLOCK;
    (along(cell.y) * ACROSS + along(cell.x)) as usize
}

/// Mean height of what is measured in the block with this corner.
fn mean_m(heights: &Heights<'_>, corner: Cell) -> Option<f32> {
    let (mut sum_m, mut count) = (0.0, 0_u8);
    for dy in (0..BLOCK).step_by(SAMPLED) {
        for dx in (0..BLOCK).step_by(SAMPLED) {
            let cell = Cell {
                x: corner.x + dx,
                y: corner.y + dy,
            };
            if let Some(height_m) = heights.height_m(cell) {
                sum_m += height_m;
                count += 1;
            }
        }
    }
    (count > 0).then(|| sum_m / f32::from(count))
}

/// How much later goals count, where heights are preferred.
#[derive(Clone, Copy, Debug)]
pub struct LevelCost<'a, const TILES: usize> {
    /// What is known of heights.
    pub heights: &'a HeightLevels<TILES>,
    /// The parameters of the preference.
    pub ground: &'a UnevenGround,
    /// The robot's storey, metres.
    pub reference_m: f32,
}

impl<const TILES: usize> LevelCost<'_, TILES> {
    /// As they are from another storey.
    #[must_use]
    pub const fn from(&self, reference_m: f32) -> Self {
        Self {
            reference_m,
            ..*self
        }
    }

    /// The level of a goal, at most [`MOST_LEVEL`]; 0 where its height is not known.
    #[must_use]
    pub fn of<const SLOTS: usize>(&self, tiles: &Tiles<TILES, SLOTS>, goal: Cell) -> u32 {
        let Some(height_m) = self.heights.height_around_m(tiles, goal) else {
            return 0;
        };
        let least = self.ground.least_preference;
        if least >= 0.0 {
            return 0;
        }
        let off = self.ground.height_scale * (height_m - self.reference_m).abs() / -least;
        math::floor((off + 0.5).min(MOST_LEVEL as f32)).max(0) as u32
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use super::{BLOCK, HeightLevels, LevelCost, MOST_LEVEL};
    use crate::config::UnevenGround;
    use crate::geometry::Cell;
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};
    use crate::map::{Class, Tiles};

    const SLOPE: f32 = 0.3;

    fn at(x: i32, y: i32) -> Cell {
        Cell { x, y }
    }

    /// A slope that rises to the east, seen from a robot that drove up it from x = 0 to 100 cells.
    fn climbed() -> (HeightLevels<24>, Box<Tiles<24, 64>>) {
        let mut tiles = Box::new(Tiles::new());
        tiles.reset(8, 8);
        for x in -30..140 {
            for y in -20..20 {
                tiles.set(at(x, y), Class::Free).expect("room");
            }
        }
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut storeys = HeightLevels::new();
        for robot in (0..=100).step_by(5) {
            let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
            window.follow(at(robot, 0));
            for x in robot - 32..robot + 32 {
                for y in -20..20 {
                    window.measure(at(x, y), SLOPE * at(x, y).centre().x_m);
                }
            }
            storeys.note(&window.read(), &tiles);
        }
        (storeys, tiles)
    }

    #[test]
    fn heights_stay_known_where_the_window_has_left() {
        let (storeys, tiles) = climbed();
        for x in -15..118 {
            let height_m = storeys.height_m(&tiles, at(x, 3)).expect("measured");
            let truth_m = SLOPE * at(x, 3).centre().x_m;
            // Half a block of slope, and half a decimetre.
            let most_m = SLOPE * 0.5 + 0.051;
            assert!(
                (height_m - truth_m).abs() < most_m,
                "{x}: {height_m} {truth_m}"
            );
        }
        assert_eq!(storeys.height_m(&tiles, at(0, 29)), None, "never measured");
        assert_eq!(storeys.height_m(&tiles, at(0, 500)), None, "no tile");
    }

    /// The frontier's own block is not measured, the one before it is.
    #[test]
    fn a_goal_where_the_measured_ends_is_as_high_as_what_is_beside_it() {
        let (storeys, tiles) = climbed();
        let edge = (100..200)
            .find(|&x| storeys.height_m(&tiles, at(x, 3)).is_none())
            .expect("the window ended");
        let before_m = storeys
            .height_m(&tiles, at(edge - BLOCK, 3))
            .expect("measured");
        let height_m = storeys
            .height_around_m(&tiles, at(edge, 3))
            .expect("beside");
        assert!((height_m - before_m).abs() < 1e-3, "{height_m} {before_m}");
        let levels = LevelCost {
            heights: &storeys,
            ground: &UnevenGround::TABLE_I,
            reference_m: 0.0,
        };
        assert_eq!(levels.of(&tiles, at(edge, 3)), MOST_LEVEL);
        assert_eq!(storeys.height_around_m(&tiles, at(edge + 9, 3)), None);
    }

    #[test]
    fn levels_count_from_the_storey_and_know_no_side() {
        let (storeys, tiles) = climbed();
        let terrain = &UnevenGround::TABLE_I;
        let level = |reference_m: f32, x: i32| {
            let levels = LevelCost {
                heights: &storeys,
                ground: terrain,
                reference_m,
            };
            levels.of(&tiles, at(x, 0))
        };
        assert_eq!(level(0.0, 2), 0);
        assert!((1..=2).contains(&level(0.0, 12)), "0.36 m");
        assert_eq!(level(0.0, 80), MOST_LEVEL, "2.4 m");
        assert_eq!(level(-9.0, 80), MOST_LEVEL);
        assert_eq!(level(2.4, 80), 0);
        assert_eq!(level(2.4, 2), MOST_LEVEL);
        assert_eq!(level(0.0, 500), 0, "of unknown height");
    }

    #[test]
    fn without_a_limit_of_repulsion_there_are_no_levels() {
        let (storeys, tiles) = climbed();
        let terrain = &UnevenGround {
            least_preference: 0.0,
            ..UnevenGround::TABLE_I
        };
        let levels = LevelCost {
            heights: &storeys,
            ground: terrain,
            reference_m: 5.0,
        };
        assert_eq!(levels.of(&tiles, at(2, 0)), 0);
    }

    #[test]
    fn heights_beyond_the_range_are_the_farthest() {
        let mut tiles = Box::<Tiles<4, 64>>::default();
        tiles.reset(8, 8);
        tiles.set(at(1, 1), Class::Free).expect("room");
        let (mut heights, mut marks) = ([0; 2 * WINDOW_CELLS], [0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(at(0, 0));
        for k in 0..64 {
            window.measure(at(k % 8, k / 8), -40.0);
        }
        let mut storeys = HeightLevels::<4>::new();
        storeys.note(&window.read(), &tiles);
        assert_eq!(storeys.height_m(&tiles, at(1, 1)), Some(-12.7));
    }
}
