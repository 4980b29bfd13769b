//! Side preference of the rails: a robot that comes to a fork whose ways are as good turns to the side where it saw openings.
//!
//! Two worlds, symmetric about the corridor that the robot comes along: a T, and a cross. Slits beside the corridor are openings
//! to the lasers and too narrow for the robot: two to one side are the two votes that make a preference [TDBVP, V], none are
//! none. A hundred approaches to each, from the four directions of the grid by turns, each from another place with other noise.

use fieldline_tests::full;
use fieldline_tests::random::Random;
use fieldline_tests::runs::Unseen;
use host_sim::link::direct::Direct;
use host_sim::trial::mission::{Mission, explore};
use host_sim::world::{Start, World};

/// Approaches to each fork, in the short test and in the full one.
const APPROACHES: [u64; 2] = [20, 100];
/// Of so many, this many end on the preferred side.
const PREFERRED: [u64; 2] = [19, 95];
/// Simulated time within which a robot has come to the fork and out of it, milliseconds.
const TIME_MS: u32 = 60_000;

/// Side of the world, and its cells along it. The fork is in the middle.
const SIDE_M: f64 = 21.0;
const CELLS: usize = 210;
/// Half the width of the corridors, and where the ones behind the fork end, from the middle, metres.
const HALF_M: f64 = 1.0;
const END_M: f64 = 7.0;
/// Where the robot's corridor begins, and the slits along it; half their width and how deep they are, metres.
const BEGIN_M: f64 = -10.0;
const SLITS_M: [f64; 2] = [-6.5, -3.5];
const SLIT_HALF_M: f64 = 0.2;
const SLIT_DEPTH_M: f64 = 2.0;
/// A robot this far from the middle has taken a way, metres.
const TAKEN_M: f64 = 2.5;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Fork {
    T,
    Cross,
}

/// Ways out of a fork, seen by the robot that comes; also the side of the slits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Way {
    Left,
    Right,
    On,
    Nowhere,
}

/// Whether a place is free: metres along the robot's corridor from the fork, and to its left. What leads on has a bend, so that not
/// all of it is seen from the fork.
fn is_free(fork: Fork, slits: Way, (along, left): (f64, f64)) -> bool {
    let beside = match slits {
        Way::Left => left,
        Way::Right => -left,
        Way::On | Way::Nowhere => return is_corridor(fork, (along, left)),
    };
    let is_slit = SLITS_M.iter().any(|at| (along - at).abs() < SLIT_HALF_M);
    is_slit && (0.0..HALF_M + SLIT_DEPTH_M).contains(&beside) || is_corridor(fork, (along, left))
}

fn is_corridor(fork: Fork, (along, left): (f64, f64)) -> bool {
    let aside = left.abs();
    let bend = END_M - 2.0 * HALF_M..END_M;
    let comes = aside < HALF_M && (BEGIN_M..HALF_M).contains(&along);
    let crosses = along.abs() < HALF_M && aside < END_M;
    let bends_back = bend.contains(&aside) && (-4.0..HALF_M).contains(&along);
    let goes_on = aside < HALF_M && (0.0..END_M).contains(&along);
    let bends_aside = bend.contains(&along) && aside < 4.0;
    comes || crosses || bends_back || fork == Fork::Cross && (goes_on || bends_aside)
}

/// The quarter turn between the grid and an approach: (along, left) of (x, y), both from the middle.
fn turned(quarters: u64, (x, y): (f64, f64)) -> (f64, f64) {
    (0..quarters % 4).fold((x, y), |(x, y), _| (y, -x))
}

fn world(fork: Fork, slits: Way, quarters: u64, start: Start) -> World {
    let at = |k: usize| (k as f64 + 0.5) * SIDE_M / CELLS as f64 - SIDE_M / 2.0;
    let cell = |i, j| match is_free(fork, slits, turned(quarters, (at(i), at(j)))) {
        true => '.',
        false => '#',
    };
    let row = |j| (0..CELLS).map(|i| cell(i, j)).collect::<String>();
    let rows: Vec<String> = (0..CELLS).rev().map(row).collect();
    let rows: Vec<&str> = rows.iter().map(String::as_str).collect();
    let picture = World::picture("fork", SIDE_M / CELLS as f64, &rows);
    World::flat("fork", picture.occupancy().clone(), vec![start])
}

/// Somewhere at the corridor's closed end, looking along it.
fn start(quarters: u64, random: &mut Random) -> Start {
    let mut within = |most: f64| most * random.between(-1000, 1000) as f64 / 1000.0;
    let (along, left) = (BEGIN_M + 1.0 + within(0.3), within(0.3));
    // Back from the approach to the grid.
    let (x, y) = turned(4 - quarters % 4, (along, left));
    Start {
        x_m: x + SIDE_M / 2.0,
        y_m: y + SIDE_M / 2.0,
        yaw_rad: within(0.3) + quarters as f64 * core::f64::consts::FRAC_PI_2,
    }
}

/// The way that a robot takes.
fn way(fork: Fork, slits: Way, seed: u64) -> Way {
    let quarters = seed % 4;
    let start = start(quarters, &mut Random::new(seed));
    let mission = Mission {
        strategy: "tdbvp".into(),
        seed,
        time_limit_ms: TIME_MS,
        ..Mission::default()
    };
    let world = world(fork, slits, quarters, start);
    let (report, record) =
        explore(&mission, &world, &mut Direct::new(), &mut Unseen).expect("the start is free");
    assert_eq!(report.safety.collisions, 0, "{fork:?}, {slits:?}, {seed}");
    let places = record.steps.iter().map(|step| {
        let from_middle = |at: f64| at - SIDE_M / 2.0;
        let place = (from_middle(step.truth.x_m), from_middle(step.truth.y_m));
        turned(quarters, place)
    });
    let taken = |(along, left): (f64, f64)| match () {
        () if left > TAKEN_M => Some(Way::Left),
        () if left < -TAKEN_M => Some(Way::Right),
        () if along > TAKEN_M => Some(Way::On),
        () => None,
    };
    places.filter_map(taken).next().unwrap_or(Way::Nowhere)
}

/// How many approaches end on the left, on the right, straight on, and nowhere.
fn ways(fork: Fork, slits: Way) -> [u64; 4] {
    let mut counts = [0; 4];
    for seed in 0..APPROACHES[usize::from(full())] {
        counts[way(fork, slits, seed) as usize] += 1;
    }
    println!("{fork:?}, openings {slits:?}: {counts:?}");
    counts
}

fn assert_follows_preference(fork: Fork) {
    let least = PREFERRED[usize::from(full())];
    for side in [Way::Left, Way::Right] {
        let counts = ways(fork, side);
        assert!(counts[side as usize] >= least, "{side:?}: {counts:?}");
    }
    // Without a preference both sides are as likely: apart by less than three standard deviations.
    let counts = ways(fork, Way::Nowhere);
    let [left, right] = [counts[0], counts[1]];
    assert!(
        left.abs_diff(right).pow(2) <= 9 * (left + right),
        "{counts:?}"
    );
    assert_eq!(counts[Way::Nowhere as usize], 0, "{counts:?}");
}

#[test]
fn at_a_symmetric_t_the_robot_turns_to_the_side_with_openings() {
    assert_follows_preference(Fork::T);
}

#[test]
fn at_a_symmetric_cross_the_robot_turns_to_the_side_with_openings() {
    assert_follows_preference(Fork::Cross);
}
