//! What level beams met far off on uneven ground: landmarks that hold the pose, and no obstacles.
//!
//! Heights are measured within 3 m of the robot, so the map knows what stands there and nothing
//! farther off. A level laser sees 16 m. A wall at 8 m holds the pose as well as one at 2 m,
//! although nobody can tell yet if it is a wall or a slope. So the ends of level beams are kept in
//! bits of their own, which only the localiser reads.
//!
//! ```text
//! landmark(c) = bit(c) and the map has no ground at c
//! bit(c) ← 1   if a level beam ends at c, outside of the elevation window and within REACH_M,
//!              where the map knows nothing, and neither an obstacle nor a bit is beside c
//! ```
//!
//! Ground that is measured later removes a landmark by itself. The bits lie in a window of
//! 25.6 × 25.6 m that rolls with the robot. Their memory is 32 pages of the pool, lent while a
//! session on uneven ground corrects its odometry.
//!
//! Units: map cells, metres.

use crate::config::Config;
use crate::geometry::{Cell, Pose};
use crate::grid::Rolling;
use crate::ground::elevation::WINDOW_SIDE;
use crate::ground::ray::{Attitude, Mount};
use crate::input::{Input, has_company};
use crate::map::integrate::level_beams;
use crate::map::{Class, Map, Tiles};

/// Cells along the window's side.
const SIDE: i32 = 256;
/// The window's geometry.
type Window = Rolling<SIDE, 1>;
/// Bytes of the bits.
const BYTES: usize = (SIDE * SIDE / 8) as usize;
/// Pages that hold the bits.
pub(super) const PAGES: usize = BYTES / size_of::<super::tiles::Cells>();
/// Greatest distance of a landmark from the robot, metres: it stays in the window for a step.
pub(crate) const REACH_M: f32 = 12.4;

/// Returns the index of a cell's byte, and its bit there.
const fn bit_of(cell: Cell) -> (usize, u8) {
    let slot = Window::slot(cell);
    (slot / 8, 1 << (slot % 8))
}

/// Returns the origin of the landmarks around the elevation window with this origin.
const fn around(elevation: Cell) -> Cell {
    Window::origin(elevation.offset(WINDOW_SIDE / 2, WINDOW_SIDE / 2))
}

impl<const TILES: usize, const SLOTS: usize> Tiles<TILES, SLOTS> {
    /// Returns the landmarks in the square of 2 × 2 cells from `corner` on. None on flat ground.
    #[inline]
    pub(crate) fn landmarks_from(&self, corner: Cell) -> u32 {
        let bits = self.landmark_bytes();
        if bits.is_empty() {
            return 0;
        }
        let mut square = 0;
        for (k, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let cell = corner.offset(dx, dy);
            square |= u32::from(self.is_landmark(cell)) << k;
        }
        square
    }

    /// Returns true if a cell is a landmark.
    #[inline]
    fn is_landmark(&self, cell: Cell) -> bool {
        let (byte, bit) = bit_of(cell);
        let bits = self.landmark_bytes().get(byte);
        bits.is_some_and(|bits| bits & bit != 0) && self.class(cell) == Class::Unknown
    }

    fn set_landmark(&mut self, cell: Cell, stands: bool) {
        let (byte, bit) = bit_of(cell);
        if let Some(bits) = self.landmark_bytes_mut().get_mut(byte) {
            *bits = if stands { *bits | bit } else { *bits & !bit };
        }
    }
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Moves the window after the elevation window moved from `from`.
    fn follow_landmarks(&mut self, from: Cell) {
        let (from, to) = (around(from), around(self.window));
        let Some([columns, rows]) = Window::entering(from, to) else {
            self.tiles.landmark_bytes_mut().fill(0);
            return;
        };
        for y in rows {
            (to.x..to.x + SIDE).for_each(|x| self.tiles.set_landmark(Cell { x, y }, false));
        }
        for x in columns {
            (to.y..to.y + SIDE).for_each(|y| self.tiles.set_landmark(Cell { x, y }, false));
        }
    }

    /// Enters the ends of level beams. The elevation window was at `from` before this step.
    pub(super) fn mark_landmarks(&mut self, config: &Config, input: &Input<'_>, from: Cell) {
        if self.tiles.landmark_bytes().is_empty() {
            return;
        }
        self.follow_landmarks(from);
        let attitude = Attitude::of(&input.pose);
        let depth_m = config.tuning.ground.hit_depth_m;
        let lasers = config.lasers.iter().zip(input.scans);
        for (laser, ranges_mm) in lasers.filter(|(laser, _)| laser.is_level()) {
            let mount = Mount::new(&attitude, laser);
            let beams = level_beams(&Pose::default(), laser, ranges_mm, &config.tuning.map);
            let ends = beams
                .filter(|beam| beam.hit && beam.length_m < REACH_M)
                .filter(|beam| has_company(ranges_mm, beam.number))
                .filter_map(|beam| attitude.ray(&mount, beam.number, beam.length_m))
                .map(|ray| ray.hit_cell(depth_m));
            for cell in ends {
                let is_far = !Rolling::<WINDOW_SIDE, 1>::covers(self.window, cell);
                if is_far && self.is_new_landmark(cell) {
                    self.tiles.set_landmark(cell, true);
                }
            }
        }
    }

    /// Returns true if the map knows nothing of a cell, and nothing stands beside it.
    fn is_new_landmark(&self, cell: Cell) -> bool {
        let beside = cell.offset(-1, -1);
        let is_alone = self.tiles.obstacles_from::<3>(beside) == 0;
        let mut around = (0..9).map(|k| beside.offset(k % 3, k / 3));
        is_alone
            && self.tiles.class(cell) == Class::Unknown
            && !around.any(|cell| self.tiles.is_landmark(cell))
    }
}
