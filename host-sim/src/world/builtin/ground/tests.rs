//! Uneven worlds are as their descriptions say, for a robot within its limits and for one that
//! drives over every edge.

use super::*;
use crate::metrics::{Footing, HEADINGS};
use crate::robot::{Limits, RADIUS_M};
use crate::sim::{Loss, SimConfig, Simulator};
use crate::world::{Class, GridCell, Place, Start, World, place, places};
use core::f64::consts::{FRAC_PI_2, PI};
use fieldline_planner::geometry::Cell;
use fieldline_protocol::message::Twist;
use fixed::types::I4F12;

/// Reachable points of a world.
struct Intent {
    name: &'static str,
    /// Per cent of the map's cells that a robot covers; the rest are walls, faces, holes, and
    /// ground out of reach.
    share: u32,
    /// Points that are reached in every heading, metres.
    open: &'static [[f64; 2]],
    /// Points that are not reached, metres.
    barred: &'static [[f64; 2]],
}

const INTENTS: [Intent; 9] = [
    // Both levels; not a tree.
    Intent {
        name: "slope",
        share: 96,
        open: &[[5.0, 10.0], [25.0, 12.0], [2.0, 23.0], [28.0, 1.0]],
        barred: &[[6.1, 9.4]],
    },
    // The ground around the holes, and the shelf; not the holes.
    Intent {
        name: "holes",
        share: 89,
        open: &[
            [15.4, 19.0],
            [23.2, 19.0],
            [6.0, 3.4],
            [9.4, 6.0],
            [24.5, 1.5],
        ],
        barred: &[[19.0, 19.0], [16.8, 17.2], [6.0, 6.0], [8.2, 4.6]],
    },
    // The room with its corners, except for those beside the entrance.
    Intent {
        name: "building",
        share: 93,
        open: &[[13.5, 11.0], [13.5, 15.0], [12.0, 16.5], [15.0, 16.5]],
        barred: &[[11.2, 12.6], [15.8, 12.6]],
    },
    // The foot of the cliff, and its rim by the ramp; not the hill, not the hole.
    Intent {
        name: "cliff",
        share: 91,
        open: &[[14.8, 14.0], [18.4, 14.0], [24.0, 8.0]],
        barred: &[[6.0, 14.8], [6.0, 13.0], [22.3, 16.3]],
    },
    // The road at half height and the top; not the faces between two turns.
    Intent {
        name: "spiral",
        share: 79,
        open: &[[13.0, 13.0], [4.6, 13.6], [7.9, 13.6]],
        barred: &[[6.3, 13.6], [13.0, 3.6]],
    },
    // The islands of 5, 20 and 40 cm, the last two by their ramps; not the island of 10 cm, and no
    // kerb above 5 cm.
    Intent {
        name: "kerbs",
        share: 86,
        open: &[
            [4.2, 7.0],
            [14.6, 7.0],
            [19.8, 7.0],
            [14.6, 3.9],
            [6.8, 7.0],
        ],
        barred: &[
            [9.4, 7.0],
            [7.6, 7.0],
            [12.8, 7.0],
            [16.4, 7.0],
            [18.0, 7.0],
            [19.8, 9.2],
        ],
    },
    // Crest and trough.
    Intent {
        name: "waves",
        share: 97,
        open: &[[16.0, 18.0], [8.9, 20.6], [11.0, 12.5]],
        barred: &[[14.2, 15.6]],
    },
    // Both sides and the pass; not the ridge.
    Intent {
        name: "pass",
        share: 67,
        open: &[[3.0, 18.0], [24.5, 18.5], [13.0, 6.0]],
        barred: &[[13.0, 12.0], [10.5, 14.0], [13.0, 2.0]],
    },
    // Both sides and the causeway; not the drops.
    Intent {
        name: "causeway",
        share: 69,
        open: &[[3.0, 12.0], [24.0, 2.0], [13.0, 7.2]],
        barred: &[[13.0, 3.0], [13.0, 11.0], [9.3, 8.8]],
    },
];

/// A place that a world must have.
fn known(world: &str, name: &str) -> &'static Place {
    place(world, name).unwrap_or_else(|| panic!("{world} has no {name}"))
}

fn cell([x, y]: [f64; 2]) -> Cell {
    let [x, y] = [x, y].map(|m| (m / 0.1).floor() as i32);
    Cell { x, y }
}

fn footing(world: &World) -> Footing {
    Footing::new(world, world.starts()[0], RADIUS_M, &Limits::WORKING)
}

fn reaches_all_headings(footing: &Footing, place: [f64; 2]) -> bool {
    (0..HEADINGS).all(|k| footing.reaches_heading(cell(place), k))
}

#[test]
fn a_robot_within_its_limits_reaches_the_open_points_only() {
    for intent in INTENTS {
        let name = intent.name;
        let world = World::builtin(name).expect("listed");
        let footing = footing(&world);
        for start in world.starts() {
            let place = [start.x_m, start.y_m];
            assert!(reaches_all_headings(&footing, place), "{name}: {start:?}");
        }
        for place in intent.open {
            assert!(reaches_all_headings(&footing, *place), "{name}: {place:?}");
        }
        for place in intent.barred {
            assert!(!footing.reaches(cell(*place)), "{name}: {place:?}");
        }
        let area = footing.area();
        let covered = (0..area.len()).filter(|k| footing.covers(area.cell(*k)));
        let share = covered.count() as f64 / area.len() as f64;
        assert_eq!((share * 100.0).round() as u32, intent.share, "{name}");
    }
}

#[test]
fn the_four_scenarios_have_ten_starts() {
    for name in ["slope", "holes", "building", "cliff"] {
        let world = World::builtin(name).expect("listed");
        assert_eq!(world.starts().len(), 10, "{name}");
        assert!(world.size_m().iter().all(|side| *side >= 24.0), "{name}");
    }
}

#[test]
fn the_slope_is_climbed_head_on_and_not_crossed_sideways() {
    let footing = footing(&World::builtin("slope").expect("listed"));
    // Half way up: east and west; north and south.
    let middle = cell([14.75, 12.0]);
    assert!(footing.reaches_heading(middle, 0) && footing.reaches_heading(middle, 8));
    assert!(!footing.reaches_heading(middle, 4) && !footing.reaches_heading(middle, 12));
}

#[test]
fn the_pass_and_the_causeway_are_the_only_ways_across() {
    for (name, far) in [("pass", [22.0, 8.0]), ("causeway", [22.0, 8.0])] {
        // A wall across the place and 1.5 m to both sides of it.
        let crossing = known(name, name);
        let (x, [_, y0, _, y1]) = (crossing.point_m[0], crossing.extent_m);
        let (y0, y1) = (y0 - 1.5, y1 + 1.5);
        let world = World::builtin(name).expect("listed");
        let mut plan = world.occupancy().clone();
        let (low, high) = (plan.cell_at(x, y0), plan.cell_at(x, y1));
        for j in low.j..=high.j {
            plan.set(GridCell { i: low.i, j }, Class::Wall);
        }
        let ground = world.elevation().expect("uneven").clone();
        let shut = World::uneven(name, plan, ground, world.starts().to_vec());
        assert!(footing(&world).reaches(cell(far)), "{name}");
        assert!(!footing(&shut).reaches(cell(far)), "{name}");
    }
}

/// The steepest covered ground is as steep as the description says, in degrees over 0.4 m.
#[test]
fn slopes_are_as_steep_as_the_descriptions_say() {
    for (name, degrees) in [("slope", 18), ("waves", 13)] {
        let world = World::builtin(name).expect("listed");
        let footing = footing(&world);
        let area = footing.area();
        let grade = (0..area.len())
            .filter(|k| footing.covers(area.cell(*k)))
            .map(|k| slope_deg(&world, area.cell(k)))
            .fold(0.0, f64::max);
        assert_eq!(grade.round() as u32, degrees, "{name}");
    }
    let waves = World::builtin("waves").expect("listed");
    let [low, high] = waves
        .elevation()
        .and_then(Elevation::span_m)
        .expect("ground");
    assert!((0.98..=1.0).contains(&(high - low)), "{}", high - low);
}

/// The slope over 0.4 m around a cell, degrees; 0 if a part of that has no ground.
fn slope_deg(world: &World, cell: Cell) -> f64 {
    let [x, y] = [cell.x, cell.y].map(|k| (f64::from(k) + 0.5) * 0.1);
    let grade = |dx: f64, dy: f64| {
        let ahead = world.ground_m(x + dx, y + dy)?;
        Some((ahead - world.ground_m(x - dx, y - dy)?) / 0.4)
    };
    match (grade(0.2, 0.0), grade(0.0, 0.2)) {
        (Some(a), Some(b)) => a.hypot(b).atan().to_degrees(),
        _ => 0.0,
    }
}

/// Drives at 0.3 m/s for `seconds` from a start; returns the last position, the collisions and the
/// loss.
fn drive(name: &str, start: [f64; 3], seconds: u32) -> ([f64; 2], u32, Option<Loss>) {
    let world = World::builtin(name).expect("listed");
    let [x_m, y_m, yaw_rad] = start;
    let start = Start { x_m, y_m, yaw_rad };
    let ground = world.elevation().expect("uneven").clone();
    let world = World::uneven(name, world.occupancy().clone(), ground, vec![start]);
    let mut robot = Simulator::new(&world, SimConfig::default()).expect("stands");
    for _ in 0..5 * seconds {
        robot.drive(Some(Twist {
            linear: I4F12::from_num(0.3),
            ..Twist::default()
        }));
    }
    let pose = robot.pose();
    (
        [pose.x_m, pose.y_m],
        robot.safety().collisions,
        robot.loss(),
    )
}

#[test]
fn kerbs_block_from_below_and_are_falls_from_above() {
    // Eastwards at the middle of each island, from 1.2 m before its kerb.
    for (island, climbed) in places("kerbs").iter().zip([true, true, false, false]) {
        let (west, y) = (island.extent_m[0], island.point_m[1]);
        let ([x, _], collisions, loss) = drive("kerbs", [west - 1.2, y, 0.0], 8);
        assert_eq!(loss, None, "{west}");
        if climbed {
            assert!(x > west + 0.7 && collisions == 0, "{west}: {x}");
        } else {
            assert!(x < west && collisions == 1, "{west}: {x}");
        }
    }
    // Westwards off each island.
    for (island, fell) in places("kerbs").iter().zip([false, false, true, true]) {
        let (west, y) = (island.extent_m[0], island.point_m[1]);
        let ([x, _], _, loss) = drive("kerbs", [west + 1.0, y, PI], 7);
        assert_eq!(loss, fell.then_some(Loss::Fell), "{west}");
        assert!(fell || x < west - 0.5, "{west}: {x}");
    }
}

#[test]
fn a_rim_is_a_fall_and_a_cliff_blocks() {
    let hole = known("holes", "north-east hole");
    let [x, y] = known("causeway", "causeway").point_m;
    let cliff_m = known("cliff", "cliff").point_m[0];
    for (name, start) in [
        ("holes", [hole.extent_m[0] - 2.4, hole.point_m[1], 0.0]),
        ("cliff", [cliff_m + 2.9, 13.5, PI]),
        ("causeway", [x, y, FRAC_PI_2]),
        ("causeway", [x, y, -FRAC_PI_2]),
    ] {
        let (place, _, loss) = drive(name, start, 14);
        assert_eq!(loss, Some(Loss::Fell), "{name}: {place:?}");
    }
    let ([x, _], collisions, loss) = drive("cliff", [cliff_m - 2.5, 13.5, 0.0], 14);
    assert_eq!((collisions, loss), (1, None));
    assert!((15.0..16.7).contains(&x), "{x}");
}

#[test]
fn a_ramp_is_level_at_both_ends_and_keeps_its_grade() {
    let at = |k: i32| ramp(0.01 * f64::from(k), 6.0, 1.0);
    assert_eq!((at(-5), at(0)), (0.0, 0.0));
    assert!((at(600) - 1.0).abs() < 1e-12 && (at(700) - 1.0).abs() < 1e-12);
    assert!((at(300) - 0.5).abs() < 1e-12);
    for k in 0..600 {
        let grade = (at(k + 1) - at(k)) / 0.01;
        assert!((0.0..=0.2 + 1e-9).contains(&grade), "{k}: {grade}");
    }
    assert!((at(1) - at(0)) < 1e-3 * 0.2 && (at(600) - at(599)) < 1e-3 * 0.2);
}

#[test]
fn bumps_keep_their_height_and_their_slope() {
    let mut most = 0.0_f64;
    for k in 0..4000 {
        let (x, y) = (0.37 * f64::from(k % 70), 0.41 * f64::from(k / 70));
        let here = bumps(x, y, 0.1);
        assert!(here.abs() <= 0.1);
        most = most.max((bumps(x + 0.1, y, 0.1) - here).abs() / 0.1);
    }
    assert!(most < 3.0_f64.to_radians().tan() * 1.5, "{most}");
}
