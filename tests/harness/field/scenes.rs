//! Seeded windows over seeded floors, with and without preferences, and changes of their boundary.

use fieldline_planner::field::{Preference, SIDE, Window};

use super::floor::{Floor, Kind};
use super::{Rows, cells, sin_cos};
use crate::random::Random;

/// Preferences inside a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pull {
    /// No preference anywhere.
    None,
    /// Preferences from heights of rolling ground, and a global one up to 0.1 \[Maffei20, eqs. 3,
    /// 5\].
    Heights,
}

/// One window to solve.
#[derive(Debug)]
pub struct Scene {
    /// The robot's cell: the reached cell nearest to the middle.
    pub robot: (usize, usize),
    /// The window, charged and not yet solved.
    pub window: Window,
}

/// Draws the window of a seed.
///
/// A quarter of the windows have a frontier, which is many goals, instead of one goal. A window is
/// drawn again if its goals reach less than a tenth of it.
///
/// # Panics
/// Never: a window that is returned has reached cells.
#[must_use]
pub fn scene(kind: Kind, pull: Pull, seed: u64) -> Scene {
    let mut random = Random::mixed(seed ^ (kind as u64) << 32 ^ (pull as u64) << 40);
    let side = SIDE as i32;
    loop {
        let mut free = Floor::draw(kind, side, &mut random).cut(0, 0);
        let mut goal = [0; SIDE];
        if random.chance(0.25) {
            draw_frontier(&mut free, &mut goal, &mut random);
        } else {
            let (x, y) = (random.within(1, side - 1), random.within(1, side - 1));
            goal[y as usize] = free[y as usize] & 1 << x;
        }
        let mut window = Window::new();
        window.set_boundary(&free, &goal);
        if cells().filter(|&(x, y)| window.is_reached(x, y)).count() < SIDE * SIDE / 10 {
            continue;
        }
        let robot = nearest_to_middle(&window);
        if pull == Pull::Heights {
            let ground = Ground::draw(&mut random);
            let global = 0.1 * random.unit();
            ground.prefer(&mut window, (0, 0), robot, global);
        }
        return Scene { robot, window };
    }
}

/// Makes the free cells beyond a ragged border goals, as if they were not yet explored.
fn draw_frontier(free: &mut Rows, goal: &mut Rows, random: &mut Random) {
    let (ky, kx) = sin_cos(random.angle());
    let (start, wave, phase) = (
        5.0 + 20.0 * random.unit(),
        0.1 + 0.5 * random.unit(),
        random.angle(),
    );
    for (x, y) in cells() {
        let (dx, dy) = (x as f64 - 30.0, y as f64 - 30.0);
        let edge = start + 2.0 * sin_cos((dx * ky - dy * kx) * wave + phase).0 + random.unit();
        if dx * kx + dy * ky > edge {
            goal[y] |= free[y] & 1 << x;
            free[y] &= !(1 << x);
        }
    }
}

fn nearest_to_middle(window: &Window) -> (usize, usize) {
    let middle = SIDE / 2;
    let reached = cells().filter(|&(x, y)| window.is_reached(x, y));
    let distance = |&(x, y): &(usize, usize)| x.abs_diff(middle).pow(2) + y.abs_diff(middle).pow(2);
    reached.min_by_key(distance).expect("a reached cell")
}

/// A change of the boundary under a solved field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Change {
    /// The goal moves to another cell.
    GoalJumps,
    /// A second goal appears.
    GoalAppears,
    /// One of two goals vanishes.
    GoalVanishes,
    /// A wall right across, with a narrow gap or none, gets another gap of seven cells.
    DoorOpens,
    /// The reverse of [`Change::DoorOpens`].
    DoorCloses,
}

/// Every change, in the order of the tables.
pub const CHANGES: [Change; 5] = [
    Change::GoalJumps,
    Change::GoalAppears,
    Change::GoalVanishes,
    Change::DoorOpens,
    Change::DoorCloses,
];

/// Returns the boundaries (free cells, goals) before and after a change.
#[must_use]
pub fn before_and_after(scene: &Scene, change: Change, random: &mut Random) -> [(Rows, Rows); 2] {
    let (mut free, mut goal, mut other): (Rows, Rows, Rows) = ([0; SIDE], [0; SIDE], [0; SIDE]);
    for (x, y) in cells() {
        goal[y] |= u64::from(scene.window.is_goal(x, y)) << x;
        free[y] |= u64::from(scene.window.is_reached(x, y)) << x | goal[y];
    }
    let reached: Vec<_> = cells()
        .filter(|&(x, y)| scene.window.is_reached(x, y))
        .collect();
    let (x, y) = reached[random.within(0, reached.len() as i32) as usize];
    if (x, y) != scene.robot {
        other[y] = 1 << x;
    }
    let both = core::array::from_fn(|y| goal[y] | other[y]);

    let side = SIDE as i32;
    let (mut closed, mut open) = (free, free);
    let wall = random.within(5, side - 5) as usize;
    let gap = if random.chance(0.3) {
        0
    } else {
        0b111 << random.within(0, side - 3)
    };
    closed[wall] &= gap;
    open[wall] &= gap | 0b111_1111 << random.within(0, side - 7);
    match change {
        Change::GoalJumps => [(free, goal), (free, other)],
        Change::GoalAppears => [(free, other), (free, both)],
        Change::GoalVanishes => [(free, both), (free, other)],
        Change::DoorOpens => [(closed, goal), (open, goal)],
        Change::DoorCloses => [(open, goal), (closed, goal)],
    }
}

/// Rolling ground: a sum of four sine waves, heights in metres.
#[derive(Debug)]
pub struct Ground([[f64; 4]; 4]);

impl Ground {
    /// Draws waves of 2 to 8 m length, with heights up to 0.4 m in sum.
    pub(crate) fn draw(random: &mut Random) -> Self {
        Self(core::array::from_fn(|_| {
            let wave = core::f64::consts::TAU / (20.0 + 60.0 * random.unit());
            let (sin, cos) = sin_cos(random.angle());
            [wave * cos, wave * sin, random.angle(), 0.1 * random.unit()]
        }))
    }

    fn height(&self, x: i32, y: i32) -> f64 {
        let wave = |&[kx, ky, phase, height]: &[f64; 4]| {
            height * sin_cos(kx * f64::from(x) + ky * f64::from(y) + phase).0
        };
        self.0.iter().map(wave).sum()
    }

    /// Sets preferences by \[Maffei20, eqs. 3, 5\] in a window whose cell (0, 0) lies at `corner`,
    /// for a robot in its cell `robot`.
    pub fn prefer(
        &self,
        window: &mut Window,
        corner: (i32, i32),
        robot: (usize, usize),
        global: f64,
    ) {
        let height = |x: usize, y: usize| self.height(corner.0 + x as i32, corner.1 + y as i32);
        let here = height(robot.0, robot.1);
        window.set_preferences(|x, y| {
            let repulsion = (-2.0 * (here - height(x, y)).abs()).max(-0.5);
            Preference::nearest((global + repulsion).clamp(-0.5, 0.5) as f32)
        });
    }
}
