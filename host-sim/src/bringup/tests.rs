use super::{Step, run};
use crate::link::direct::Direct;
use crate::robot::{Miswiring, RobotSpec};
use crate::sim::{SimConfig, Simulator};
use crate::world::World;
use fieldline_protocol::message::Strategy;

/// Makes the steps with a simulated robot that has these mistakes, in an office.
fn steps(robot: &str, mistakes: &str) -> Vec<Step> {
    let world = World::open("office").expect("built in");
    let robot = RobotSpec::open(robot).expect("a preset");
    let miswiring = match mistakes {
        "" => Miswiring::default(),
        text => text.parse().expect("valid"),
    };
    let config = SimConfig {
        lidars: robot.lidars.clone(),
        limits: robot.drive,
        footprint: robot.hull,
        radius_m: robot.radius_m,
        miswiring,
        // In a room: along a corridor no scan tells how far the robot drove.
        start: 1,
        ..SimConfig::default()
    };
    let mut simulator = Simulator::new(&world, config).expect("it fits");
    let start = simulator.start_message(Strategy::Frontier);
    let mut told = Vec::new();
    let passed = run(&mut Direct::new(), &mut simulator, &start, |step| {
        told.push(step.clone());
    });
    assert_eq!(passed, told.iter().all(|step| step.passed), "{told:?}");
    told
}

#[test]
fn every_preset_that_is_wired_rightly_passes_all_steps() {
    for preset in crate::robot::presets::names() {
        let steps = steps(preset, "");
        assert_eq!(steps.len(), 6, "{preset}: {:?}", steps.last());
        assert!(steps.iter().all(|step| step.passed), "{preset}: {steps:?}");
    }
}

#[test]
fn each_mistake_fails_in_the_step_that_shows_it_and_names_the_remedy() {
    for (mistake, number, word) in [
        ("ranges-times=0.001", 2, "millimetres"),
        ("ranges-times=1000", 2, "return nothing"),
        ("clock-stands", 3, "stands"),
        ("clock-times=1000", 3, "microseconds"),
        ("mirrored", 4, "mirrored"),
        ("yaw-sign", 4, "sign"),
        ("wheels-swapped", 4, "swapped"),
        ("reversed", 4, "swapped"),
        ("yaw-times=2", 4, "greater turn"),
        ("laser-turned=90", 5, "90 degrees to the left"),
        ("laser-turned=-90", 5, "90 degrees to the right"),
        ("laser-turned=180", 5, "backwards"),
        ("way-sign", 5, "sign of its distance"),
        ("millimetres", 5, "longer way"),
        ("odometry-times=0.001", 5, "shorter way"),
        ("odometry-times=2", 5, "longer way"),
        ("odometry-times=0.5", 5, "shorter way"),
    ] {
        let steps = steps("round-0.35", mistake);
        let last = steps.last().expect("a step");
        let remedy = last.remedy.clone().unwrap_or_default();
        assert_eq!(last.number, number, "{mistake}: {last:?}");
        assert!(remedy.contains(word), "{mistake}: {last:?}");
    }
}
