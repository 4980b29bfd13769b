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
//!              where the map knows nothing, and neither an obstacle nor a landmark is beside c
//! ```
//!
//! A beam that runs down leaves none, because it meets ground. Ground that is measured later
//! removes a landmark by itself. The bits lie in a window of 25.6 × 25.6 m that rolls with the
//! robot. Their memory is 32 pages of the pool, lent while a session on uneven ground corrects its
//! odometry.
//!
//! Units: map cells, metres.

use crate::config::Config;
use crate::geometry::{Cell, Pose};
use crate::grid::Rolling;
use crate::ground::elevation::WINDOW_SIDE;
use crate::ground::ray::{Attitude, Mount};
use crate::input::{Input, has_company};
use crate::map::integrate::level_beams;
use crate::map::neighbourhood::{INNER, Neighbourhood};
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
    /// Returns true if there may be landmarks: the ground is uneven.
    pub(super) fn has_landmarks(&self) -> bool {
        !self.landmark_bytes().is_empty()
    }

    /// Returns the landmarks in the square of 2 × 2 cells from `corner` on. None on flat ground.
    pub(super) fn landmarks_from(&self, corner: Cell) -> u32 {
        let mut square = 0;
        for (k, (dx, dy)) in [(0, 0), (1, 0), (0, 1), (1, 1)].into_iter().enumerate() {
            let cell = corner.offset(dx, dy);
            square |= u32::from(self.is_landmark(cell)) << k;
        }
        square
    }

    /// Returns true if a cell is a landmark.
    #[inline]
    pub(super) fn is_landmark(&self, cell: Cell) -> bool {
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
                .filter(|ray| ray.slope > config.tuning.localise.landmark_slope)
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
        let square = Neighbourhood::of(&self.tiles).obstacles_from::<5>(cell.offset(-2, -2));
        let is_alone = square & INNER == 0;
        let mut around = (0..9).map(|k| beside.offset(k % 3, k / 3));
        is_alone
            && self.tiles.class(cell) == Class::Unknown
            && !around.any(|cell| self.tiles.is_landmark(cell))
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;

    use crate::config::{Config, UnevenGround};
    use crate::geometry::{Cell, Pose, Twist};
    use crate::grid::Class;
    use crate::input::{Input, NO_RETURN_MM};
    use crate::map::Map;
    use crate::robot::LaserMount;

    type Scene = Box<Map<152, 400>>;

    fn config(localise: bool) -> Config {
        let laser = LaserMount::level(0.0, 0.40);
        Config {
            ground: Some(UnevenGround::TABLE_I),
            localise,
            ..Config::pioneer_3at([laser].into_iter().collect())
        }
    }

    fn scene(localise: bool) -> Scene {
        let mut map = Scene::default();
        map.begin(&config(localise));
        map
    }

    /// Shows the map a straight wall at x = 8 m from a robot at x, with this pitch.
    fn see(map: &mut Scene, x_m: f32, pitch_rad: f32) {
        let ranges_mm: [u16; 181] = core::array::from_fn(|k| {
            let bearing = (k as f32 - 90.0).to_radians();
            let range_mm = 1000.0 * (8.0 - x_m) / bearing.cos();
            if bearing.abs() < 0.6 {
                range_mm as u16
            } else {
                NO_RETURN_MM
            }
        });
        let pose = Pose {
            x_m,
            pitch_rad,
            ..Pose::default()
        };
        let input = Input {
            time_ms: 0,
            pose,
            velocity: Twist::default(),
            scans: [&ranges_mm, &[]],
        };
        map.observe(&config(true), &input);
    }

    /// Returns the number of landmarks in the column of the wall.
    fn count(map: &Scene) -> usize {
        let wall = (-60..60).map(|y| Cell { x: 80, y });
        wall.filter(|&cell| map.tiles().is_landmark(cell)).count()
    }

    #[test]
    fn a_far_wall_is_a_landmark_and_no_obstacle() {
        let mut map = scene(true);
        see(&mut map, 0.0, 0.0);
        assert!(count(&map) > 15, "{}", count(&map));
        let square = map.tiles().landmarks_from(Cell { x: 80, y: 0 });
        assert_eq!(square & 0b1010, 0, "nothing behind the wall: {square:b}");
        for x in 40..100 {
            let class = map.class(Cell { x, y: 0 });
            assert_eq!(class, Class::Unknown, "{x}");
        }
    }

    #[test]
    fn without_localisation_and_from_beams_that_run_down_there_are_none() {
        let mut map = scene(false);
        see(&mut map, 0.0, 0.0);
        assert_eq!(count(&map), 0);
        let mut map = scene(true);
        see(&mut map, 0.0, 0.06);
        assert_eq!(count(&map), 0);
    }

    #[test]
    fn known_ground_is_no_landmark() {
        let mut map = scene(true);
        see(&mut map, 0.0, 0.0);
        let before = count(&map);
        let wall = (-60..60).map(|y| Cell { x: 80, y });
        let cell = wall.into_iter().find(|&cell| map.tiles().is_landmark(cell));
        let cell = cell.expect("a landmark");
        map.tiles.set(cell, Class::Free).expect("room");
        assert_eq!(count(&map), before - 1);
    }

    /// A cell that left the window is forgotten, and its twin that enters is empty.
    #[test]
    fn landmarks_leave_with_the_window() {
        let mut map = scene(true);
        see(&mut map, 0.0, 0.0);
        let before = count(&map);
        let there = (0..80).map(|k| -0.1 * k as f32);
        for x_m in there.clone() {
            see(&mut map, x_m, 0.06);
        }
        assert_eq!(count(&map), 0, "nearly 16 m west of the wall");
        for x_m in there.rev() {
            see(&mut map, x_m, 0.06);
        }
        assert_eq!(count(&map), 0, "back again");
        see(&mut map, 0.0, 0.0);
        assert_eq!(count(&map), before);
    }
}
