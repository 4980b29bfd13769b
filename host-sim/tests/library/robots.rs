//! Robots of other sizes explore the office: the hull is a parameter, not a constant.

use fieldline_protocol::message::Order;
use fixed::types::I4F12;
use host_sim::link::direct::Direct;
use host_sim::robot::Footprint;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::{Flow, Progress, Watch};
use host_sim::world::World;

/// A watch that looks at nothing.
struct Unwatched;

impl Watch for Unwatched {
    fn step(&mut self, _: &Progress) -> Flow {
        Flow::Continue
    }
}

/// Explores the office with a robot of this length and width, and asserts that it knows all that
/// its radius can explore and touched nothing.
fn assert_explores([length_m, width_m]: [f64; 2], radius_m: f64) {
    let mission = Mission {
        hull: Footprint::rectangle(length_m, width_m, 0.4),
        radius_m,
        // Everything that can be seen, also what is not worth a trip.
        order: Some(Order::Gain { worth: I4F12::ZERO }),
        ..Mission::default()
    };
    let world = World::builtin("office").expect("built in");
    let (report, _) =
        explore(&mission, &world, &mut Direct::new(), &mut Unwatched).expect("it runs");
    assert!(report.explored(), "{:?}", report.outcome);
    let known = report.coverage.fraction;
    assert!(known > 0.999, "{length_m} x {width_m} m: {known}");
    assert_eq!(report.safety.collisions, 0, "{length_m} x {width_m} m");
}

#[test]
fn a_small_round_robot_explores_the_office() {
    assert_explores([0.35, 0.35], 0.23);
}

/// The doors are 0.8 to 0.9 m wide.
#[test]
fn a_long_robot_explores_the_office() {
    assert_explores([0.9, 0.6], 0.35);
}

#[test]
fn a_hull_in_a_wall_is_refused_at_its_start() {
    let mission = Mission {
        hull: Footprint::rectangle(4.0, 4.0, 0.4),
        ..Mission::default()
    };
    let world = World::builtin("narrow-doors").expect("built in");
    let error = explore(&mission, &world, &mut Direct::new(), &mut Unwatched).expect_err("no room");
    let text = error.to_string();
    assert!(
        text.contains("hull overlaps a wall") && text.contains("the most room is at"),
        "{text}"
    );
}
