//! Baseline *bvp*: the boundary-value problem over the full grid \[Prestes02\], from which the
//! methods of all the other papers start.
//!
//! Obstacles hold p = 1, unexplored cells p = 0, and the free cells of the whole known grid are
//! relaxed. The robot follows −∇p from where it stands. It chooses no goal and remembers none: the
//! nearest and largest frontiers attract it most. The exploration ends when the robot can reach no
//! unexplored cell.
//!
//! Shared with the planner: map, configuration space (a cell into which the robot does not fit is
//! an obstacle, so unexplored cells among obstacles attract nothing) and drive. An unexplored cell
//! that the field leads to and that comes no nearer is dropped, with the cells within
//! [`progress::DROP_RADIUS_M`] of it: from then on they are relaxed like free cells. The rule is in
//! [`progress`].
//!
//! Departs from \[Prestes02\]: the field is solved for 1 − p, to convergence, by multigrid. A fixed
//! number of sweeps of p leaves it flat far from the frontiers, which ends runs. That failure of
//! the method cannot occur here. The other failure, indecision between far goals, remains.
//!
//! On uneven ground ([`UnevenScene`]) it has the planner's preferences \[Maffei20, eqs. 3 to 5\]
//! over the whole grid, with every height measured so far. The planner has them in a window around
//! the robot.
//!
//! # Cost
//! See [`Work`]: the grid grows with the building, so this baseline runs on the host only.

mod boundary;
mod field;
mod graph;
mod multigrid;
pub mod progress;
mod work;

use fieldline_planner::config::PreferenceMode;
use fieldline_planner::field::preference::Preferences;
use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::math;
use fieldline_planner::status::ResidualFrontier;
use fieldline_protocol::message::FieldRow;

use super::slope::{self, Role};
use super::strategy::{Outcome, Scene, Strategy, UnevenScene};
use boundary::Kind;
use field::{Field, GOAL};
use progress::ProgressChecker;
pub use work::Work;

/// Greatest number of cycles in a step.
const MOST_CYCLES: u16 = 12;
/// The heading has converged if a cycle changes it by less than this, radians.
const SETTLED_RAD: f32 = 0.01;

/// The strategy.
#[derive(Clone, Debug, Default)]
pub struct Bvp {
    field: Field,
    robot: Cell,
    preferences: Preferences,
    progress: ProgressChecker,
    cycles: u16,
    exhausted: bool,
    work: Work,
}

impl Bvp {
    /// Makes the strategy for a new session.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// Returns the cost of the run so far.
    #[must_use]
    pub const fn work(&self) -> Work {
        self.work
    }

    /// Returns the preferences after the last step.
    #[must_use]
    pub const fn preferences(&self) -> &Preferences {
        &self.preferences
    }

    /// Sets the boundary of the field.
    fn charge(&mut self, scene: &Scene<'_>) {
        let progress = &self.progress;
        let is_goal = |cell| !progress.is_dropped(cell);
        self.field.charge(scene.chart, self.robot, is_goal);
    }

    /// Sets the preference of every cell, for the flatness of the field of the step before.
    fn prefer(&mut self, scene: &Scene<'_>, uneven: &UnevenScene<'_>) {
        let (ground, heights) = (uneven.ground, uneven.heights);
        if ground.mode == PreferenceMode::Off {
            return;
        }
        let global = self.preferences.global(ground);
        let preferences = self.preferences;
        self.field.prefer(|cell| {
            let height_m = heights.height_m(cell);
            let difference_m = height_m.map(|height_m| height_m - scene.pose.z_m);
            preferences.of_cell(ground, global, difference_m)
        });
    }

    /// Runs cycles until the heading at a point has converged and the descent reaches a goal, at
    /// most [`MOST_CYCLES`].
    fn relax(&mut self, at: Point) {
        let mut before = None;
        self.cycles = 0;
        self.exhausted = false;
        loop {
            self.field.cycle();
            self.cycles += 1;
            let heading = self.field.heading_at(at);
            let settled = before
                .zip(heading)
                .is_some_and(|(a, b): (f32, f32)| math::wrap(a - b).abs() < SETTLED_RAD);
            if settled && self.field.descend(at.cell()).is_some() {
                return;
            }
            if self.cycles >= MOST_CYCLES {
                self.exhausted = true;
                return;
            }
            before = heading;
        }
    }
}

impl Strategy for Bvp {
    fn reset(&mut self) {
        *self = Self::new();
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outcome {
        let at = scene.pose.point();
        self.robot = at.cell();
        self.charge(scene);
        if !self.field.has_goals() && self.progress.try_again() {
            self.charge(scene);
        }
        if !self.field.has_goals() {
            return Outcome::Nothing;
        }
        if let Some(uneven) = &scene.uneven {
            self.prefer(scene, uneven);
        }
        self.relax(at);
        if let Some(p_diff) = self.field.p_diff(self.robot) {
            self.preferences.note(p_diff as f32);
        }
        let (field, box_cells) = (&self.field, scene.chart.area().len());
        self.work
            .add(field.cells(), box_cells, self.cycles, field.updates());
        if let Some(goal) = self.field.descend(self.robot) {
            self.progress.note(at, goal, scene.time_ms);
        }
        if self.progress.is_stuck() {
            Outcome::Stuck
        } else {
            Outcome::Path
        }
    }

    fn heading_at(&self, _scene: &Scene<'_>, point: Point) -> Option<f32> {
        self.field.heading_at(point)
    }

    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32 {
        let here = self.field.q(scene.pose.point().cell());
        (self.field.q(point.cell()) / here.max(f64::MIN_POSITIVE)) as f32
    }

    fn dropped(&self) -> Vec<ResidualFrontier> {
        self.progress.dropped().to_vec()
    }

    fn cycles(&self) -> u16 {
        self.cycles
    }

    fn is_exhausted(&self) -> bool {
        self.exhausted
    }

    /// Returns a row of the part of the grid around the robot.
    fn field_row(&self, row: u8) -> Option<FieldRow> {
        if self.field.cells() == 0 {
            return None;
        }
        slope::field_row(self.robot, row, |cell| {
            let role = match self.field.kind(cell) {
                Kind::Free(_) => Role::Free,
                Kind::Obstacle => Role::Obstacle,
                Kind::Goal => Role::Goal,
            };
            (role, (self.field.q(cell) / GOAL) as f32)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Bvp, MOST_CYCLES, PreferenceMode};
    use crate::baseline::chart::{Chart, sketch::chart};
    use crate::baseline::heights::HeightGrid;
    use crate::baseline::strategy::{Outcome, Scene, Strategy, UnevenScene};
    use fieldline_planner::config::{GroundTuning, UnevenGround};
    use fieldline_planner::geometry::{Cell, Point, Pose};
    use fieldline_planner::ground::elevation::{Elevation, WINDOW_CELLS};
    use fieldline_protocol::message::FIELD_SIDE;

    fn scene(chart: &Chart, at: Point, time_ms: u32) -> Scene<'_> {
        let pose = Pose {
            x_m: at.x_m,
            y_m: at.y_m,
            ..Pose::default()
        };
        Scene {
            chart,
            pose,
            time_ms,
            uneven: None,
        }
    }

    /// Follows the heading in steps of half a cell until it stands in an unexplored cell.
    fn follow(rows: &[&str]) -> Option<Cell> {
        let (chart, robot) = chart(rows);
        let (mut bvp, mut at) = (Bvp::new(), robot);
        for step in 0..400 {
            let index = chart.area().index(at.cell());
            if index.is_some_and(|index| chart.is_unexplored(index)) {
                return Some(at.cell());
            }
            let scene = scene(&chart, at, step * 10);
            assert_eq!(bvp.plan(&scene), Outcome::Path);
            let (sin, cos) = bvp.heading_at(&scene, at)?.sin_cos();
            at.x_m += 0.05 * cos;
            at.y_m += 0.05 * sin;
        }
        None
    }

    #[test]
    fn the_descent_reaches_the_frontier_round_corners_and_through_doors() {
        let rows = [
            "####################", //
            "#........#.........#",
            "#........#.........#",
            "#..................#",
            "#........#.........#",
            "##########.........#",
            "#........#.........#",
            "#........#.........#",
            "#R.......#........?#",
            "#........#.........#",
            "####################",
        ];
        // The robot's room has no door, so no goal is reachable.
        let (closed, robot) = chart(&rows);
        let scene = scene(&closed, robot, 0);
        assert_eq!(Bvp::new().plan(&scene), Outcome::Nothing);
        let mut opened = rows;
        opened[5] = "####..####.........#";
        assert_eq!(follow(&opened), Some(Cell { x: 18, y: 2 }));
    }

    #[test]
    fn of_two_frontiers_the_nearer_or_the_larger_attracts() {
        let rows = |left: &'static str, right: &'static str, robot: usize| {
            let mut rows = [".".repeat(21), ".".repeat(21), ".".repeat(21)];
            rows[1].replace_range(robot..=robot, "R");
            rows.map(|row| format!("#{left}{row}{right}#")).to_vec()
        };
        let goal = |rows: Vec<String>| {
            let wall = "#".repeat(rows[0].len());
            let rows: Vec<&str> = core::iter::once(wall.as_str())
                .chain(rows.iter().map(String::as_str))
                .chain([wall.as_str()])
                .collect();
            follow(&rows).unwrap().x
        };
        assert!(goal(rows("?", "?", 7)) < 5, "the left is nearer");
        assert!(goal(rows("?", "?", 13)) > 15, "the right is nearer");
        let mut larger_right = rows("?", "?", 10);
        larger_right[0].replace_range(1..2, "#");
        assert!(goal(larger_right) > 15, "equally far, the right is larger");
    }

    /// Two paths lead round a block to one goal, the shorter over lower ground. With preferences
    /// the robot takes the longer path.
    #[test]
    fn preferences_turn_the_robot_to_level_ground() {
        let rows = [
            "#################", //
            "#...............#",
            "#...............#",
            "#...............#",
            "#...#########...#",
            "#...#########...#",
            "#...#########...#",
            "#R..#########..?#",
            "#...#########...#",
            "#...............#",
            "#...............#",
            "#...............#",
            "#################",
        ];
        let (chart, robot) = chart(&rows);
        let (mut bytes, mut marks) = (vec![0; 2 * WINDOW_CELLS], vec![0; WINDOW_CELLS]);
        let mut origin = Cell { x: -20, y: -20 };
        let mut elevation =
            Elevation::new(&mut bytes, &mut marks, &mut origin, &GroundTuning::DEFAULT);
        for (x, y) in (0..17).flat_map(|x| (0..13).map(move |y| (x, y))) {
            let height_m = if y < 4 { -0.6 } else { 0.0 };
            elevation.mark_wheel_contact(Cell { x, y }, height_m);
        }
        let mut heights = HeightGrid::default();
        heights.keep(&elevation.read());
        let turn = |mode| {
            let ground = UnevenGround {
                mode,
                least_preference: -1.0,
                ..UnevenGround::TABLE_I
            };
            let uneven = UnevenScene {
                ground: &ground,
                heights: &heights,
            };
            let scene = Scene {
                uneven: Some(uneven),
                ..scene(&chart, robot, 0)
            };
            let mut bvp = Bvp::new();
            assert!((0..10).all(|_| bvp.plan(&scene) == Outcome::Path));
            bvp.heading_at(&scene, robot).expect("a path")
        };
        assert!(
            turn(PreferenceMode::Off) < 0.0,
            "the shorter path is to the south"
        );
        assert!(
            turn(PreferenceMode::Global) < 0.0,
            "a global preference is the same everywhere"
        );
        assert!(
            turn(PreferenceMode::Both) > 0.0,
            "the level path is to the north"
        );
        assert!(turn(PreferenceMode::Height) > 0.0);
    }

    #[test]
    fn the_window_shown_is_the_grid_around_the_robot() {
        let (chart, robot) = chart(&["#####", "#R.?#", "#####"]);
        let mut bvp = Bvp::new();
        assert_eq!(bvp.field_row(0), None, "no field yet");
        let scene = scene(&chart, robot, 0);
        assert_eq!(bvp.plan(&scene), Outcome::Path);
        assert!(bvp.cycles() <= MOST_CYCLES && !bvp.is_exhausted());
        let row = bvp.field_row(FIELD_SIDE as u8 / 2).unwrap();
        let middle = FIELD_SIDE / 2;
        let kind = |x: usize| row.cells[x / 4] >> (2 * (x % 4)) & 3;
        assert_eq!(
            [middle - 1, middle, middle + 1, middle + 2].map(kind),
            [1, 0, 0, 2]
        );
        // q₁ = q₂/4 and q₂ = (q₁ + 1)/4.
        let exact = [0.0, 1.0 / 15.0, 4.0 / 15.0, 1.0];
        for (k, exact) in exact.into_iter().enumerate() {
            assert!((row.q[middle - 1 + k] - exact).abs() < 1e-6, "{:?}", row.q);
        }
        assert_eq!(bvp.field_row(FIELD_SIDE as u8), None);
    }
}
