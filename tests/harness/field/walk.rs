//! Seeded walks over a floor larger than the window, as warm starts of the solver.

use fieldline_planner::field::{SIDE, Window};

use super::floor::{Floor, Kind};
use super::scenes::{Ground, Pull};
use crate::random::Random;

/// A walk over a floor larger than the window: a path of cells, each beside the one before.
#[derive(Debug)]
pub struct Walk {
    floor: Floor,
    path: Vec<(i32, i32)>,
    ground: Ground,
}

/// Steps of a walk.
pub const WALK_STEPS: usize = 40;

/// Distance of the local goal, cells ahead on the path.
const AHEAD: usize = 20;

impl Walk {
    /// Draws a shortest path from a random cell to the cell farthest from it, on a floor two and a
    /// half windows wide.
    #[must_use]
    pub fn new(kind: Kind, seed: u64) -> Self {
        let mut random = Random::mixed(seed ^ (kind as u64) << 32 ^ 1 << 50);
        let side = 5 * SIDE as i32 / 2;
        loop {
            let floor = Floor::draw(kind, side, &mut random);
            let path = floor.longest_path((random.within(0, side), random.within(0, side)));
            if path.len() > WALK_STEPS + AHEAD {
                return Self {
                    floor,
                    path,
                    ground: Ground::draw(&mut random),
                };
            }
        }
    }

    /// Moves `window` from step − 1 to `step`. The robot is in the middle; the goal is the path's
    /// cell 20 steps ahead.
    ///
    /// # Panics
    /// If `step` is greater than [`WALK_STEPS`].
    pub fn step(&self, window: &mut Window, step: usize, pull: Pull) {
        let (x, y) = self.path[step];
        let (before_x, before_y) = self.path[step.saturating_sub(1)];
        let half = SIDE as i32 / 2;
        let ahead = self.path[step + AHEAD];
        let mut goal = [0; SIDE];
        goal[(ahead.1 - y + half) as usize] = 1 << (ahead.0 - x + half);
        window.shift(x - before_x, y - before_y);
        window.set_boundary(&self.floor.cut(x - half, y - half), &goal);
        if pull == Pull::Heights {
            let middle = SIDE / 2;
            self.ground
                .prefer(window, (x - half, y - half), (middle, middle), 0.05);
        }
    }
}
