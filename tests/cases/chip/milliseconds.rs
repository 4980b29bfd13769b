//! Milliseconds of a step on the chip by the model of its cycles: `golden/milliseconds.txt`.
//!
//! The runs are those of `flat` and of one world of `uneven`, with the plugin that counts cycles.
//! Each is compared there with the same run by call, so the plugin changes no command.

use fieldline_tests::emulator::{chip, image, profiled_chip, watched_chip};
use fieldline_tests::milliseconds;
use fieldline_tests::runs::explored;
use fieldline_tests::watched::Watched;
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::cycles::StepCost;
use host_sim::link::direct::Direct;
use host_sim::link::profile::RawProfile;
use host_sim::trial::mission::Mission;

use crate::{flat, uneven};

/// Instructions between a mark that the plugin sees and the read of the chip's own counter.
const BETWEEN: u32 = 40;

/// Stages in the order of a step.
const STAGES: [&str; 7] = [
    "session", "sense", "topology", "plan", "window", "solve", "drive",
];

/// A few steps.
fn short() -> Mission {
    Mission {
        link: "qemu".into(),
        time_limit_ms: 4_000,
        ..Mission::default()
    }
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn a_step_takes_milliseconds_by_the_model() {
    let mut reports = flat::RUNS.clone();
    reports.push(uneven::COUNTED.clone());
    milliseconds::check("milliseconds.txt", &reports);
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn the_plugin_counts_the_instructions_that_the_chip_counts() {
    let mut steps = 0;
    let mut link = Watched::new(watched_chip(&image()), |link, _, command| {
        let stages = command.cost.stages;
        let counted = [
            stages.session,
            stages.sense,
            stages.topology,
            stages.plan,
            stages.window,
            stages.solve,
            stages.drive,
        ];
        let modelled = link.end().cycles().expect("the step was counted");
        assert_eq!(link.end().cycles(), None, "a step is read once");
        for (stage, counted) in modelled.stages.into_iter().zip(counted) {
            let is_same = stage.instructions.abs_diff(counted) <= BETWEEN;
            assert!(is_same, "{stage:?}, counted {counted}: {modelled:?}");
            // An instruction takes a cycle or more, but for those that fold into others.
            let least = stage.instructions - stage.instructions / 10;
            let is_plausible = (least..=4 * stage.instructions + 400).contains(&stage.cycles);
            assert!(is_plausible, "{stage:?}: {modelled:?}");
        }
        link.tile(0, 0)?;
        assert_eq!(link.end().cycles(), None, "a request for a tile is no step");
        steps += 1;
        Ok(())
    });
    let (report, _) = explored(&short(), &worlds::builtin("cluttered"), &mut link);
    drop(link);
    assert!(steps > 10, "{steps}");
    // The steps were read here, so the run had none.
    assert_eq!(report.planner.cycles, None);
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn a_profile_has_the_cycles_of_the_run() {
    let (image, raw, world) = (image(), RawProfile::new(), worlds::builtin("cluttered"));
    let mut link = profiled_chip(&image, Some(raw.path()));
    let (report, record) = explored(&short(), &world, &mut link);
    drop(link);
    // The profile changes no command.
    let by_call = explored(&short(), &world, &mut Direct::new()).0;
    assert_eq!(report.digest, by_call.digest);
    let folded = raw.folded(&image).expect("the image has its functions");
    let stages = STAGES.iter().enumerate().map(|(i, stage)| {
        let of_step = |cycles: &StepCost| u64::from(cycles.stages[i].cycles);
        let steps = record.steps.iter().filter_map(|step| step.cycles.as_ref());
        (*stage, steps.map(of_step).sum::<u64>())
    });
    let mut sum = 0;
    for (stage, cycles) in stages {
        let of_stage = folded
            .stacks()
            .filter(|(stack, _)| stack.starts_with(stage));
        assert_eq!(of_stage.map(|(_, it)| it).sum::<u64>(), cycles, "{stage}");
        sum += cycles;
    }
    assert_eq!(folded.cycles(), sum);
    // Each stack has a function with its name, and the dear one is where it belongs.
    for (stack, _) in folded.stacks() {
        assert!(
            !stack.contains("(unknown)") && !stack.contains("_ZN"),
            "{stack}"
        );
    }
    let solver = "fieldline_planner::field::pyramid::Pyramid::solve";
    let solves = folded.stacks().filter(|(stack, _)| stack.contains(solver));
    let (inside, outside): (Vec<_>, Vec<_>) = solves.partition(|(it, _)| it.starts_with("solve;"));
    assert!(!inside.is_empty() && outside.is_empty(), "{outside:?}");
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn without_the_plugin_no_cycles_are_counted() {
    let mut link = chip(&image());
    let (report, _) = explored(&short(), &worlds::builtin("cluttered"), &mut link);
    assert!(report.planner.instructions.is_some());
    assert_eq!(report.planner.ms, None);
    assert_eq!(report.planner.stage_cycles, None);
}
