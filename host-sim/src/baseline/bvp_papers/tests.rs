//! Steps of the strategy on charts drawn by hand: headings, flatness, goals that are dropped.

use super::{BvpPapers, Precision, Relaxation, STUCK_MS};
use crate::baseline::chart::{Chart, sketch::chart};
use crate::baseline::strategy::{Outcome, Scene, Strategy};
use crate::baseline::{Bvp, bvp::progress::LOOK_MS};
use fieldline_planner::geometry::{Point, Pose};
use fieldline_planner::status::ResidualReason;
use fieldline_protocol::message::FIELD_SIDE;

const ROOMS: [&str; 11] = [
    "####################", //
    "#........#.........#",
    "#........#.........#",
    "#..................#",
    "#........#.........#",
    "####..####.........#",
    "#........#.........#",
    "#........#.........#",
    "#R.......#........?#",
    "#........#.........#",
    "####################",
];

fn scene(chart: &Chart, at: Point, time_ms: u32) -> Scene<'_> {
    Scene {
        chart,
        pose: Pose {
            x_m: at.x_m,
            y_m: at.y_m,
            ..Pose::default()
        },
        time_ms,
        uneven: None,
    }
}

fn with(sweeps: u16, precision: Precision) -> BvpPapers {
    BvpPapers::new(Relaxation { sweeps, precision })
}

/// A corridor two cells wide: 1 − p falls by a factor of about 2.6 a cell.
fn corridor(cells: usize) -> (Chart, Point) {
    let wall = "#".repeat(cells + 3);
    let floor = format!("#{}?#", ".".repeat(cells));
    let start = format!("#R{}?#", ".".repeat(cells - 1));
    chart(&[&wall, &floor, &start, &wall])
}

#[test]
fn with_enough_sweeps_its_headings_are_those_of_the_converged_field() {
    let (chart, robot) = chart(&ROOMS);
    let (mut papers, mut solved) = (with(2_000, Precision::F64), Bvp::new());
    let scene = scene(&chart, robot, 0);
    assert_eq!(papers.plan(&scene), Outcome::Path);
    (0..20).for_each(|_| assert_eq!(solved.plan(&scene), Outcome::Path));
    let mut compared = 0;
    for index in (0..chart.area().len()).filter(|&index| chart.is_known_passable(index)) {
        let at = chart.area().cell(index).centre();
        let (ours, theirs) = (papers.heading_at(&scene, at), solved.heading_at(&scene, at));
        let (ours, theirs) = (ours.expect("a slope"), theirs.expect("a slope"));
        let apart = fieldline_planner::math::wrap(ours - theirs).abs();
        assert!(apart < 0.01, "{at:?}: {ours} and {theirs}");
        compared += 1;
    }
    assert!(compared > 140, "{compared}");
}

#[test]
fn one_sweep_a_step_gets_there_too_because_the_field_is_stored() {
    let (chart, robot) = chart(&ROOMS);
    let (mut once, mut often) = (with(1, Precision::F64), with(2_000, Precision::F64));
    let at = |time_ms| scene(&chart, robot, time_ms);
    often.plan(&at(0));
    let wanted = often.heading_at(&at(0), robot).expect("a slope");
    let apart = |papers: &BvpPapers| {
        let heading = papers.heading_at(&at(0), robot);
        heading.map(|it| fieldline_planner::math::wrap(it - wanted).abs())
    };
    once.plan(&at(0));
    assert!(apart(&once).is_none_or(|apart| apart > 0.1));
    (1..2_000).for_each(|step| {
        once.plan(&at(step));
    });
    assert!(apart(&once).is_some_and(|apart| apart < 0.001));
    once.reset();
    once.plan(&at(0));
    assert!(apart(&once).is_none_or(|apart| apart > 0.1), "forgotten");
}

#[test]
fn flat_is_told_and_depends_on_the_type() {
    let outcome = |cells, sweeps, precision| {
        let (chart, robot) = corridor(cells);
        with(sweeps, precision).plan(&scene(&chart, robot, 0))
    };
    assert_eq!(outcome(10, 1_000, Precision::F32), Outcome::Path);
    assert_eq!(outcome(20, 1_000, Precision::F64), Outcome::Path);
    assert_eq!(outcome(20, 1_000, Precision::F32), Outcome::Flat);
    assert_eq!(outcome(50, 1_000, Precision::F64), Outcome::Flat);
}

#[test]
fn without_a_goal_in_reach_it_is_not_flat_but_done() {
    let mut closed = ROOMS;
    closed[3] = "#........#.........#";
    let (chart, robot) = chart(&closed);
    let mut papers = BvpPapers::new(Relaxation::DEFAULT);
    assert_eq!(papers.plan(&scene(&chart, robot, 0)), Outcome::Nothing);
}

#[test]
fn only_a_goal_that_was_reached_is_dropped_and_a_robot_that_stands_is_stuck() {
    let (far, robot) = chart(&ROOMS);
    let mut papers = BvpPapers::new(Relaxation::DEFAULT);
    let steps = (0..STUCK_MS).step_by(1_000);
    for time_ms in steps {
        assert_eq!(papers.plan(&scene(&far, robot, time_ms)), Outcome::Path);
    }
    assert!(papers.dropped().is_empty());
    assert_eq!(papers.plan(&scene(&far, robot, STUCK_MS)), Outcome::Stuck);

    let (near, robot) = chart(&["#####", "#R.?#", "#####"]);
    let mut papers = BvpPapers::new(Relaxation::DEFAULT);
    assert_eq!(papers.plan(&scene(&near, robot, 0)), Outcome::Path);
    assert_eq!(
        papers.plan(&scene(&near, robot, LOOK_MS + 1)),
        Outcome::Path
    );
    assert_eq!(papers.dropped()[0].reason, ResidualReason::Unobservable);
    assert_eq!(
        papers.plan(&scene(&near, robot, LOOK_MS + 2)),
        Outcome::Nothing
    );
}

#[test]
fn the_window_shown_holds_one_minus_p() {
    let (chart, robot) = chart(&["#####", "#R.?#", "#####"]);
    let mut papers = BvpPapers::new(Relaxation::DEFAULT);
    assert_eq!(papers.field_row(0), None, "no field yet");
    papers.plan(&scene(&chart, robot, 0));
    let middle = FIELD_SIDE / 2;
    let row = papers.field_row(middle as u8).expect("a row");
    // q₁ = q₂/4 and q₂ = (q₁ + 1)/4.
    let exact = [0.0, 1.0 / 15.0, 4.0 / 15.0, 1.0];
    for (k, exact) in exact.into_iter().enumerate() {
        assert!((row.q[middle - 1 + k] - exact).abs() < 1e-6, "{:?}", row.q);
    }
}
