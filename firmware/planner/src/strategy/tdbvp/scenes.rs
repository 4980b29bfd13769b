//! Windows charged with rails, as pictures: where the field leads the robot.
//!
//! A character is a coarse cell of 20 cm, row 0 (the least y) on top: `#` obstacle, `.` free, `>`
//! the robot with its heading along x.

use crate::config::TdbvpTuning;
use crate::field::local_grid::{LocalGrid, position};
use crate::field::{SCRATCH_FLOATS, SIDE, SolverConfig, Window, descent, solve};
use crate::geometry::{Cell, Pose};
use crate::map::{Class, Tiles};
use crate::path::blocked_passages::NONE;
use crate::path::nearest::Centres;
use crate::roadmap::configuration_space::Footprint;
use crate::roadmap::skeleton::{Skeleton, Space};
use crate::strategy::tdbvp::Tdbvp;
use crate::strategy::tdbvp::charges::{charge_rails, prefer};
use crate::strategy::tdbvp::pending_visits::PendingVisits;
use crate::strategy::tdbvp::rails::Rails;
use crate::strategy::tdbvp::sides::Side;

/// The tuned constants.
const TUNING: TdbvpTuning = TdbvpTuning::DEFAULT;

/// A corridor that ends at another one across.
const FORK: &str = "
    ################
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    #..............#
    #...........>..#
    #..............#
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ###########...##
    ################
";

struct Scene {
    tiles: Tiles<16, 64>,
    skeleton: Skeleton<64>,
    rails: Rails<64>,
    pending: PendingVisits,
    robot: Cell,
}

impl Scene {
    /// The robot has driven along its row.
    fn new(picture: &str) -> Self {
        let mut scene = Self {
            tiles: Tiles::new(),
            skeleton: Skeleton::new(),
            rails: Rails::new(TUNING.first_tick_ms, 200),
            pending: PendingVisits::new(),
            robot: Cell::default(),
        };
        scene.tiles.reset();
        for (y, row) in picture.split_whitespace().enumerate() {
            for (x, c) in row.chars().enumerate() {
                let least = Cell {
                    x: 2 * x as i32,
                    y: 2 * y as i32,
                };
                let class = if c == '#' {
                    Class::Obstacle
                } else {
                    Class::Free
                };
                for part in least.quarters() {
                    scene.tiles.set(part, class).unwrap();
                }
                if c == '>' {
                    scene.robot = least;
                }
            }
        }
        scene.skeleton.reset(Space::KnownFree);
        let footprint = Footprint::new(0.1);
        while !scene
            .skeleton
            .advance(&scene.tiles, &footprint, &mut [0; 64 * 8], u32::MAX)
        {}
        for x in 3..=scene.robot.x {
            let y = scene.robot.y;
            scene.pending.note(Cell { x, y });
            scene.pending.visit(Cell { x, y }, &mut scene.rails);
            scene.rails.step();
        }
        scene
    }

    /// The direction in which the field leads the robot: cosine and sine.
    fn heading(&self, side: Option<Side>) -> (f32, f32) {
        let mut grid = LocalGrid::new();
        let footprint = Footprint::new(0.1);
        grid.update(&self.tiles, &footprint, self.robot, 1);
        let centres = Centres::of(&self.skeleton, &self.tiles, &footprint, &NONE).unwrap();
        let (mut window, least) = (Window::new(), self.robot);
        // The middle of the robot's coarse cell.
        let robot = least.offset(1, 1).corner();
        let dates = (&self.rails, &self.pending);
        charge_rails(
            &mut window,
            &grid,
            dates,
            &centres,
            (robot, TUNING.free_m),
            &[0; SIDE],
        );
        if let Some(side) = side {
            let ahead = self
                .pending
                .ahead(self.robot, TUNING.disc_m)
                .expect("it came from somewhere");
            let preferred = (side, ahead);
            prefer(&mut window, &grid, robot, preferred, &TUNING);
        }
        let config = SolverConfig {
            max_cycles: 100,
            ..SolverConfig::default()
        };
        solve(&mut window, &mut [0.0; SCRATCH_FLOATS], &config);
        let (x, y) = position((grid.origin, grid.scale), robot);
        let heading = descent::heading_at(&window, x, y).expect("the field is not flat");
        (heading.cos(), heading.sin())
    }

    /// The robot visits the upper or the lower arm of the corridor across.
    fn visit_arm(&mut self, up: bool) {
        for k in 0..19 {
            let y = if up { 26 + k } else { 2 + k };
            self.rails.visit(Cell { x: 24, y });
        }
    }
}

#[test]
fn the_preferred_side_decides_at_a_fork_of_equal_arms() {
    let scene = Scene::new(FORK);
    let (_, left) = scene.heading(Some(Side::Left));
    let (_, right) = scene.heading(Some(Side::Right));
    assert!(left > 0.2, "left is up: {left}");
    assert!(right < -0.2, "right is down: {right}");
}

#[test]
fn the_arm_not_visited_is_taken_whatever_side_is_preferred() {
    for up in [true, false] {
        let mut scene = Scene::new(FORK);
        scene.visit_arm(up);
        for side in [None, Some(Side::Left), Some(Side::Right)] {
            let (_, left) = scene.heading(side);
            assert!(
                (left < 0.0) == up && left.abs() > 0.2,
                "{up} {side:?}: {left}"
            );
        }
    }
}

#[test]
fn where_all_was_visited_the_older_arm_is_taken() {
    for up in [true, false] {
        let mut scene = Scene::new(FORK);
        scene.visit_arm(!up);
        (0..400).for_each(|_| scene.rails.step());
        scene.visit_arm(up);
        (0..40).for_each(|_| scene.rails.step());
        let (_, left) = scene.heading(None);
        assert!((left < 0.0) == up && left.abs() > 0.2, "{up}: {left}");
    }
}

/// The state of a session with steps of `period_ms`, in the scene's box.
fn session(period_ms: u32, impatience_s: Option<u16>) -> Tdbvp<64> {
    Tdbvp::new(period_ms, 600, impatience_s, &TUNING)
}

#[test]
fn without_impatience_only_a_robot_that_lingers_leaves_the_rails() {
    let scene = Scene::new(FORK);
    let footprint = Footprint::new(0.1);
    let centres = Centres::of(&scene.skeleton, &scene.tiles, &footprint, &NONE).unwrap();
    let robot = scene.robot.offset(1, 1).corner();
    let pose = Pose {
        x_m: robot.x_m,
        y_m: robot.y_m,
        ..Pose::default()
    };
    for impatience_s in [Some(10), None] {
        let mut tdbvp = session(200, impatience_s);
        let mut stay = |time_ms: u32| {
            tdbvp.note(&pose, time_ms, None, &TUNING);
            tdbvp.visit(&centres, robot, &TUNING);
            tdbvp.is_late(time_ms)
        };
        assert!(!stay(0) && !stay(9_800));
        assert_eq!(stay(10_000), impatience_s.is_some());
        assert_eq!(stay(TUNING.linger_ms), impatience_s.is_some());
        assert!(stay(TUNING.linger_ms + 200), "it lingers");
        assert!(stay(TUNING.linger_ms + 400), "until it visits a new place");
    }
}

#[test]
fn a_rail_is_overdue_after_the_time_of_a_tour_at_every_period() {
    let (cell, tour_ms) = (Cell::default(), 40_000);
    for period_ms in [100, 200, 400] {
        let mut tdbvp = session(period_ms, None);
        assert!(
            tdbvp.is_overdue(tdbvp.rails.stamp(cell), tour_ms),
            "never visited"
        );
        tdbvp.rails.visit(cell);
        let mut step = 0;
        while !tdbvp.is_overdue(tdbvp.rails.stamp(cell), tour_ms) {
            tdbvp.rails.step();
            step += 1;
        }
        // A stamp is that of a whole tick.
        let tick_ms = TUNING.first_tick_ms;
        let late_ms = step * period_ms - tour_ms;
        assert!(late_ms <= 2 * tick_ms, "{period_ms} ms: {late_ms} ms late");
    }
}
