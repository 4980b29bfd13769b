//! Height levels: a coarse map of the ground's height, and the level of a goal, which delays its
//! wave.
//!
//! ```text
//! level(x, y) = λ_h |h_reference − h(x, y)| / |ε_hmin|, rounded, at most MOST_LEVEL
//! delay       = LEVEL_STEPS · level
//! ```
//!
//! Departs from \[Maffei20, III-C\]. There one field over the whole grid both bends the way and
//! chooses the goal: a goal behind n cells of ε attracts e^(nε) times less. Here the field's window
//! is 6 m wide, and the wave along the skeleton chooses the goal; so the preference acts there as
//! well. Along a slope n grows with the height, so the level has no limit where eq. 3 has `ε_hmin`.
//!
//! The *reference* is the height of the level ground that the robot stood on last, not the robot's
//! own height: halfway down a slope both ends are equally far off, and the level above would be
//! left half explored.
//!
//! The map keeps the heights of the elevation window as that moves on, one for 8 × 8 cells of every
//! tile; a compact tile ([`crate::map::compaction`]) keeps one height. On flat ground there is no
//! such map, and the obstacle points use its memory.
//!
//! Units: decimetres above the start, saturated at ±12.7 m.

use crate::config::UnevenGround;
use crate::geometry::Cell;
use crate::ground::elevation::{Heights, WINDOW_SIDE};
use crate::map::compaction::Entry;
use crate::map::tiles::TILE_SIDE;
use crate::map::{SideTable, Tiles};
use crate::math;

/// Side of a block, cells.
const BLOCK: i32 = 8;
/// Side of a tile, blocks.
const ACROSS: i32 = TILE_SIDE / BLOCK;
/// Blocks of a tile.
const BLOCKS: usize = (ACROSS * ACROSS) as usize;
/// Units of height in a metre.
const PER_METRE: f32 = 10.0;
/// The height of a block where none was measured.
const NONE: i8 = i8::MIN;
/// Every second cell along a block's side is a sample of its height.
const SAMPLED: usize = 2;
/// Greatest level of a goal.
pub(crate) const MOST_LEVEL: u32 = 8;
/// Delay of a goal for each level, coarse steps. With the parameters of \[Maffei20, Table I\], 0.25
/// m of height count as 10 m of way.
pub(crate) const LEVEL_STEPS: u32 = 50;

/// The map of heights, for a pool of `TILES` tiles.
#[derive(Debug)]
pub(crate) struct HeightLevels<const TILES: usize> {
    /// The blocks of each tile, by the tile's place in the pool.
    blocks: [[i8; BLOCKS]; TILES],
}

impl<const TILES: usize> HeightLevels<TILES> {
    /// Makes an empty map.
    pub(crate) const fn new() -> Self {
        Self {
            blocks: [[NONE; BLOCKS]; TILES],
        }
    }

    /// Takes over the heights in the elevation window.
    pub(crate) fn note<const SLOTS: usize>(
        &mut self,
        heights: &Heights<'_>,
        tiles: &Tiles<TILES, SLOTS>,
    ) {
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
                    // A block that leaves the window keeps the height of the whole block. For one
                    // that enters it, half a block is better than nothing.
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

    /// Returns the height of the ground around a cell, metres; where none was measured, the mean of
    /// the blocks beside that have one. A goal lies at the edge of the measured ground, and its own
    /// block often has no height: taken for level, it would draw the robot up a slope.
    pub(crate) fn height_around_m<const SLOTS: usize>(
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

    /// Returns the height of the ground in a cell's block, metres; `None` where none was measured.
    /// In a compact tile it is the tile's height.
    pub(crate) fn height_m<const SLOTS: usize>(
        &self,
        tiles: &Tiles<TILES, SLOTS>,
        cell: Cell,
    ) -> Option<f32> {
        let stored = match tiles.entry(cell.x.div_euclid(TILE_SIDE), cell.y.div_euclid(TILE_SIDE)) {
            Entry::Untouched => return None,
            Entry::Page(page) => *self.blocks.get(page)?.get(place(cell))?,
            Entry::Coded(unit) => tiles.kept(unit),
        };
        (stored != NONE).then(|| f32::from(stored) / PER_METRE)
    }
}

/// A compact tile keeps the mean of its heights.
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
}

impl<const TILES: usize> Default for HeightLevels<TILES> {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the place of a cell's block in its tile.
fn place(cell: Cell) -> usize {
    let along = |at: i32| at.rem_euclid(TILE_SIDE) / BLOCK;
    (along(cell.y) * ACROSS + along(cell.x)) as usize
}

/// Returns the mean height of the measured samples in the block with this corner.
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

/// The level of goals, where height levels are on.
#[derive(Clone, Copy, Debug)]
pub(crate) struct LevelCost<'a, const TILES: usize> {
    /// The map of heights.
    pub(crate) heights: &'a HeightLevels<TILES>,
    /// The parameters of the preference.
    pub(crate) ground: &'a UnevenGround,
    /// The height of the level ground that the robot stood on last, metres.
    pub(crate) reference_m: f32,
}

impl<const TILES: usize> LevelCost<'_, TILES> {
    /// Returns the levels from another reference height.
    pub(crate) const fn from(&self, reference_m: f32) -> Self {
        Self {
            reference_m,
            ..*self
        }
    }

    /// Returns the level of a goal, at most [`MOST_LEVEL`]; 0 where its height is not known.
    pub(crate) fn of<const SLOTS: usize>(&self, tiles: &Tiles<TILES, SLOTS>, goal: Cell) -> u32 {
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
    use crate::ground::elevation::tests::OwnedWindow;
    use crate::map::{Class, Tiles};

    const SLOPE: f32 = 0.3;

    fn at(x: i32, y: i32) -> Cell {
        Cell { x, y }
    }

    /// The heights of a slope that rises to the east, measured by a robot that drove up it from x =
    /// 0 to 100 cells.
    fn climbed() -> (HeightLevels<24>, Box<Tiles<24, 64>>) {
        let mut tiles = Box::new(Tiles::new());
        tiles.reset();
        for x in -30..140 {
            for y in -20..20 {
                tiles.set(at(x, y), Class::Free).expect("room");
            }
        }
        let mut owned = OwnedWindow::new(at(0, 0));
        let mut map = HeightLevels::new();
        for robot in (0..=100).step_by(5) {
            let mut window = owned.write();
            window.follow(at(robot, 0));
            for x in robot - 32..robot + 32 {
                for y in -20..20 {
                    window.measure(at(x, y), SLOPE * at(x, y).centre().x_m);
                }
            }
            map.note(&window.read(), &tiles);
        }
        (map, tiles)
    }

    #[test]
    fn heights_stay_known_where_the_window_has_left() {
        let (map, tiles) = climbed();
        for x in -15..118 {
            let height_m = map.height_m(&tiles, at(x, 3)).expect("measured");
            let truth_m = SLOPE * at(x, 3).centre().x_m;
            // The rise over half a block, and half a decimetre.
            let most_m = SLOPE * 0.5 + 0.051;
            assert!(
                (height_m - truth_m).abs() < most_m,
                "{x}: {height_m} {truth_m}"
            );
        }
        assert_eq!(map.height_m(&tiles, at(0, 29)), None, "never measured");
        assert_eq!(map.height_m(&tiles, at(0, 500)), None, "no tile");
    }

    /// The block of the frontier is not measured, the one before it is.
    #[test]
    fn a_goal_at_the_edge_of_the_measured_ground_has_the_height_beside_it() {
        let (map, tiles) = climbed();
        let edge = (100..200)
            .find(|&x| map.height_m(&tiles, at(x, 3)).is_none())
            .expect("the window ended");
        let before_m = map.height_m(&tiles, at(edge - BLOCK, 3)).expect("measured");
        let height_m = map.height_around_m(&tiles, at(edge, 3)).expect("beside");
        assert!((height_m - before_m).abs() < 1e-3, "{height_m} {before_m}");
        let levels = LevelCost {
            heights: &map,
            ground: &UnevenGround::TABLE_I,
            reference_m: 0.0,
        };
        assert_eq!(levels.of(&tiles, at(edge, 3)), MOST_LEVEL);
        assert_eq!(map.height_around_m(&tiles, at(edge + 9, 3)), None);
    }

    #[test]
    fn levels_count_from_the_reference_and_have_no_sign() {
        let (map, tiles) = climbed();
        let ground = &UnevenGround::TABLE_I;
        let level = |reference_m: f32, x: i32| {
            let levels = LevelCost {
                heights: &map,
                ground,
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
    fn without_repulsion_there_are_no_levels() {
        let (map, tiles) = climbed();
        let ground = &UnevenGround {
            least_preference: 0.0,
            ..UnevenGround::TABLE_I
        };
        let levels = LevelCost {
            heights: &map,
            ground,
            reference_m: 5.0,
        };
        assert_eq!(levels.of(&tiles, at(2, 0)), 0);
    }

    #[test]
    fn heights_beyond_the_range_are_the_farthest() {
        let mut tiles = Box::<Tiles<4, 64>>::default();
        tiles.reset();
        tiles.set(at(1, 1), Class::Free).expect("room");
        let mut owned = OwnedWindow::new(at(0, 0));
        let mut window = owned.write();
        for k in 0..64 {
            window.measure(at(k % 8, k / 8), -40.0);
        }
        let mut map = HeightLevels::<4>::new();
        map.note(&window.read(), &tiles);
        assert_eq!(map.height_m(&tiles, at(1, 1)), Some(-12.7));
    }
}
