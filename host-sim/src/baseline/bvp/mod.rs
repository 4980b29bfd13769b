//! Baseline *bvp*: the frontier-guided boundary-value problem over the full grid [Prestes et al.], the method that all four
//! papers start from.
//!
//! Obstacles hold p = 1, every cell not measured yet p = 0, and the free cells are relaxed over the whole known grid; the robot
//! follows −∇p from where it stands. It chooses no goal and remembers none: it is drawn to the nearest and largest
//! frontiers, and the exploration is finished when no unexplored cell can be come to.
//!
//! What is the same as for the planner's strategy: map, clearance (cells in which the robot does not fit are obstacles, so
//! unexplored cells among them attract nothing), drive, and the rule that ends every run: an unexplored cell that the field
//! leads to and that comes no nearer is given up after a while ([`patience`]), with those within [`patience::DROP_RADIUS_M`] of it;
//! they hold no value from then on but are relaxed like free cells. What is stronger than in [Prestes et al.]: the field is
//! solved for 1 − p, to convergence, by multigrid, where a fixed number of sweeps of p leaves it flat away from the
//! frontiers. So the paper's known failure, flattening, cannot end a run here. The other one, indecision between far goals, is
//! in the method and stays.
//!
//! On uneven ground ([`Uneven`]) it has the planner's preferences [Maffei-UnevenGround, eqs. 3 to 5], over the whole grid: every height that was
//! ever measured counts, where the chip knows those of a window around the robot.
//!
//! # What it would cost on the chip
//! See [`Work`]: the grid grows with the building, which is why this baseline lives on the host.

mod field;
mod graph;
mod multigrid;
pub mod patience;

use fieldline_planner::config::PreferenceMode;
use fieldline_planner::field::height_preference::Preferences;
use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::math;
use fieldline_planner::status::Frontier;
use fieldline_protocol::message::{FIELD_SIDE, FieldRow};

use super::session::{Outlook, Plan, Scene, Uneven};
use field::{Field, GOAL, Kind};
use patience::Patience;

/// Cycles in a step at the most.
const MOST_CYCLES: u16 = 12;
/// A heading that a cycle changes by less than this has converged, radians.
const SETTLED_RAD: f32 = 0.01;

/// What a run has cost so far.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Steps.
    pub steps: u64,
    /// Free cells of the field, summed over the steps.
    pub cells: u64,
    /// Most free cells in a step.
    pub most_cells: u64,
    /// Cells of the known box in the largest step.
    pub box_cells: u64,
    /// Cell updates of the solver.
    pub updates: u64,
    /// Cycles.
    pub cycles: u64,
}

/// The strategy.
#[derive(Clone, Debug, Default)]
pub struct Bvp {
    field: Field,
    robot: Cell,
    preferences: Preferences,
    patience: Patience,
    cycles: u16,
    exhausted: bool,
    work: Work,
}

impl Bvp {
    /// At the start.
    #[must_use]
    pub fn new() -> Self {
        Self::default()
    }

    /// What the run has cost.
    #[must_use]
    pub const fn work(&self) -> Work {
        self.work
    }

    /// Set the field's boundary.
    fn charge(&mut self, scene: &Scene<'_>) {
        let patience = &self.patience;
        let is_goal = |cell| !patience.is_dropped(cell);
        self.field.charge(scene.chart, self.robot, is_goal);
    }

    /// Give every cell its preference, as flat as the field was in the step before.
    fn prefer(&mut self, scene: &Scene<'_>, ground: &Uneven<'_>) {
        let (terrain, heights) = (ground.terrain, ground.heights);
        if terrain.mode == PreferenceMode::Off {
            return;
        }
        let global = self.preferences.global(terrain);
        let preferences = self.preferences;
        self.field.prefer(|cell| {
            let height_m = heights.height_m(cell);
            let difference_m = height_m.map(|height_m| height_m - scene.pose.z_m);
            preferences.of_cell(terrain, global, difference_m)
        });
    }

    /// Cycles until the heading has settled, or no slope is left to find.
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

    fn account(&mut self, box_cells: usize) {
        let cells = self.field.cells() as u64;
        self.work.steps += 1;
        self.work.cells += cells;
        self.work.most_cells = self.work.most_cells.max(cells);
        self.work.box_cells = self.work.box_cells.max(box_cells as u64);
        self.work.updates = self.field.updates();
        self.work.cycles += u64::from(self.cycles);
    }
}

impl Plan for Bvp {
    fn reset(&mut self) {
        *self = Self::new();
    }

    fn plan(&mut self, scene: &Scene<'_>) -> Outlook {
        let at = scene.pose.point();
        self.robot = at.cell();
        self.charge(scene);
        if !self.field.has_goals() && self.patience.try_again() {
            self.charge(scene);
        }
        if !self.field.has_goals() {
            return Outlook::Nothing;
        }
        if let Some(ground) = &scene.ground {
            self.prefer(scene, ground);
        }
        self.relax(at);
        if let Some(p_diff) = self.field.p_diff(self.robot) {
            self.preferences.note(p_diff as f32);
        }
        self.account(scene.chart.frame().len());
        if let Some(goal) = self.field.descend(self.robot) {
            self.patience.note(at, goal, scene.time_ms);
        }
        if self.patience.is_stuck() {
            Outlook::Stuck
        } else {
            Outlook::Way
        }
    }

    fn heading_at(&self, _scene: &Scene<'_>, point: Point) -> Option<f32> {
        self.field.heading_at(point)
    }

    fn potential_at(&self, scene: &Scene<'_>, point: Point) -> f32 {
        let here = self.field.q(scene.pose.point().cell());
        (self.field.q(point.cell()) / here.max(f64::MIN_POSITIVE)) as f32
    }

    fn dropped(&self) -> Vec<Frontier> {
        self.patience.dropped().to_vec()
    }

    fn cycles(&self) -> u16 {
        self.cycles
    }

    fn is_exhausted(&self) -> bool {
        self.exhausted
    }

    /// The part of the grid around the robot.
    fn field_row(&self, row: u8) -> Option<FieldRow> {
        let half = FIELD_SIDE as i32 / 2;
        if usize::from(row) >= FIELD_SIDE || self.field.cells() == 0 {
            return None;
        }
        let y = self.robot.y - half + i32::from(row);
        let cells = (0..FIELD_SIDE as i32).map(|x| Cell {
            x: self.robot.x - half + x,
            y,
        });
        let mut packed = [0u8; FIELD_SIDE.div_ceil(4)];
        for (x, cell) in cells.clone().enumerate() {
            let code = match self.field.kind(cell) {
                Kind::Free(_) => 0,
                Kind::Obstacle => 1,
                Kind::Goal => 2,
            };
            packed[x / 4] |= code << (2 * (x % 4));
        }
        Some(FieldRow {
            row,
            origin_x: (self.robot.x - half) as i16,
            origin_y: (self.robot.y - half) as i16,
            scale: 1,
            q: cells
                .map(|cell| (self.field.q(cell) / GOAL) as f32)
                .collect(),
            cells: packed.into_iter().collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::{Bvp, MOST_CYCLES, PreferenceMode};
    use crate::baseline::chart::sketch::chart;
    use crate::baseline::heights::HeightGrid;
    use crate::baseline::session::{Outlook, Plan, Scene, Uneven};
    use fieldline_planner::config::UnevenGround;
    use fieldline_planner::geometry::{Cell, Point, Pose};
    use fieldline_planner::ground::elevation::{Elevation, WINDOW_CELLS};
    use fieldline_protocol::message::FIELD_SIDE;

    fn pose(at: Point) -> Pose {
        Pose {
            x_m: at.x_m,
            y_m: at.y_m,
            ..Pose::default()
        }
    }

    /// Follows the heading in steps of half a cell until it stands in an unexplored cell.
    fn follow(rows: &[&str]) -> Option<Cell> {
        let (chart, robot) = chart(rows);
        let (mut bvp, mut at) = (Bvp::new(), robot);
        for step in 0..400 {
            if chart
                .frame()
                .index(at.cell())
                .is_some_and(|i| chart.is_unexplored(i))
            {
                return Some(at.cell());
            }
            let scene = Scene {
                chart: &chart,
                pose: pose(at),
                time_ms: step * 10,
                ground: None,
            };
            assert_eq!(bvp.plan(&scene), Outlook::Way);
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
        // There is no door to the robot's room: nothing to come to.
        let (closed, robot) = chart(&rows);
        let scene = Scene {
            chart: &closed,
            pose: pose(robot),
            time_ms: 0,
            ground: None,
        };
        assert_eq!(Bvp::new().plan(&scene), Outlook::Nothing);
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

    /// Two ways round a block to one goal, the shorter over ground that lies lower: with preferences the robot goes the longer way.
    #[test]
    fn preferences_bend_the_way_to_level_ground() {
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
        let mut elevation = Elevation::new(&mut bytes, &mut marks, &mut origin);
        for (x, y) in (0..17).flat_map(|x| (0..13).map(move |y| (x, y))) {
            let height_m = if y < 4 { -0.6 } else { 0.0 };
            elevation.mark_wheel_contact(Cell { x, y }, height_m);
        }
        let mut heights = HeightGrid::default();
        heights.keep(&elevation.read());
        let turn = |mode| {
            let terrain = UnevenGround {
                mode,
                least_preference: -1.0,
                ..UnevenGround::TABLE_I
            };
            let ground = Uneven {
                terrain: &terrain,
                heights: &heights,
            };
            let scene = Scene {
                chart: &chart,
                pose: pose(robot),
                time_ms: 0,
                ground: Some(ground),
            };
            let mut bvp = Bvp::new();
            for _ in 0..10 {
                assert_eq!(bvp.plan(&scene), Outlook::Way);
            }
            bvp.heading_at(&scene, robot).expect("a way")
        };
        assert!(
            turn(PreferenceMode::Off) < 0.0,
            "the shorter way is to the south"
        );
        assert!(
            turn(PreferenceMode::Global) < 0.0,
            "which attracts all ground alike"
        );
        assert!(
            turn(PreferenceMode::Both) > 0.0,
            "the level one to the north"
        );
        assert!(turn(PreferenceMode::Height) > 0.0);
    }

    #[test]
    fn the_window_shown_is_the_grid_around_the_robot() {
        let (chart, robot) = chart(&["#####", "#R.?#", "#####"]);
        let mut bvp = Bvp::new();
        assert_eq!(bvp.field_row(0), None, "nothing was solved yet");
        let scene = Scene {
            chart: &chart,
            pose: pose(robot),
            time_ms: 0,
            ground: None,
        };
        assert_eq!(bvp.plan(&scene), Outlook::Way);
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
