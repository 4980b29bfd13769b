//! Places that invite wrong closures: other places that look the same.
//!
//! ```text
//! corridors      rooms            pillars          people
//! ┌──┬──┐        ┌─┬─┬─┬─┐        ┌─────────┐      ┌─────────┐
//! │  │  │        ├ ┴ ┴ ┴ ┤        │ · · · · │      │ o o     │  a group stands at one place,
//! │. │. │        │       │        │ · · · · │      │ o o ─►  │  and later in the same way at
//! └     ┘        └───────┘        └─────────┘      └─────────┘  another
//! ```
//!
//! Each scene is drawn from a seed: sizes, odometry's errors and noise. A closure is wrong if it is
//! off by half a metre in a direction that it claims, or by five degrees. It misleads a run if the
//! robot's pose is off by half a metre for longer than 20 s; robust weights undo the others.

use std::vec::Vec;

use super::tests::{Noise, Run, Wall, drive, odometry, run_among, walls};
use crate::alignment::BEAM;
use crate::graph::Closure;
use crate::matrix::Matrix;
use crate::pose::Pose;

/// Information of a direction that is claimed, 1/m²: three beams.
const CLAIM: f32 = 3.0 * BEAM;
/// A closure that is off by more is wrong.
const WRONG: (f32, f32) = (0.5, 0.087);
/// Poses within which a wrong closure is undone: 20 s at half a metre a second.
const UNDONE: usize = 100;

/// What a group of people does.
#[derive(Clone, Copy)]
enum Group {
    /// It stands at the first place on the way there, and at the second on the way back.
    Stands([[f32; 2]; 2]),
    /// It walks with the robot.
    Walks,
}

/// A world, the way through it, and a group of people, around its middle.
struct Scene {
    walls: Vec<Wall>,
    points: Vec<[f32; 2]>,
    people: Vec<[f32; 2]>,
    group: Group,
}

impl Scene {
    fn new(walls: Vec<Wall>, points: Vec<[f32; 2]>) -> Self {
        Self {
            walls,
            points,
            people: Vec::new(),
            group: Group::Walks,
        }
    }

    /// Returns where the people are.
    fn people(&self, returns: bool, pose: &Pose) -> Vec<[f32; 2]> {
        let place = |&[x, y]: &[f32; 2]| match self.group {
            Group::Stands(places) => {
                let [at_x, at_y] = places[usize::from(returns)];
                [at_x + x, at_y + y]
            }
            Group::Walks => pose.point([x, y]),
        };
        self.people.iter().map(place).collect()
    }
}

/// Returns a number between two.
fn between(noise: &mut Noise, low: f32, high: f32) -> f32 {
    low + (high - low) * 0.5 * (noise.next() + 1.0)
}

/// Two equal corridors side by side, joined by a hall at their end.
fn corridors(noise: &mut Noise) -> Scene {
    let long = between(noise, 14.0, 26.0);
    let wide = between(noise, 1.6, 2.6);
    let thick = between(noise, 0.3, 2.0);
    let (far, end) = (2.0 * wide + thick, long + 2.0);
    let mut all = Vec::from(walls(0.0, 0.0, far, end));
    all.extend(walls(wide, 0.0, wide + thick, long));
    for _ in 0..4 {
        let y = between(noise, 1.0, long - 1.0);
        for x in [0.0, wide + thick] {
            all.extend(walls(x, y, x + 0.3, y + 0.4));
        }
    }
    let (one, two) = (0.6 * wide, far - 0.4 * wide);
    Scene::new(
        all,
        [[one, 1.0], [one, end - 1.0], [two, end - 1.0], [two, 1.0]].into(),
    )
}

/// A corridor along a row of equal rooms, each with the same cupboard. The robot looks into all.
fn rooms(noise: &mut Noise) -> Scene {
    let (wide, deep) = (between(noise, 3.0, 5.0), between(noise, 3.0, 5.0));
    let (door, count) = (between(noise, 0.9, 1.4), 6);
    let (x, y) = (
        between(noise, 0.2, 0.5) * wide,
        between(noise, 0.5, 0.8) * deep,
    );
    let mut all = Vec::from(walls(0.0, -2.0, count as f32 * wide, deep));
    let mut points = Vec::from([[1.0, -1.0]]);
    for room in 0..count {
        let left = room as f32 * wide;
        let middle = left + 0.5 * wide;
        all.push([left, 0.0, left, deep]);
        all.push([left, 0.0, middle - 0.5 * door, 0.0]);
        all.push([middle + 0.5 * door, 0.0, left + wide, 0.0]);
        all.extend(walls(left + x - 0.3, y, left + x + 0.3, y + 0.5));
        points.extend([[middle, -1.0], [middle, 0.4 * deep], [middle, -1.0]]);
    }
    Scene::new(all, points)
}

/// A wide hall of equal pillars. The robot drives up one aisle and down the next.
fn pillars(noise: &mut Noise) -> Scene {
    let (apart, count) = (between(noise, 2.5, 4.0), 7);
    let side = apart * (count + 1) as f32;
    let mut all = Vec::from(walls(0.0, 0.0, side, 4.0 * apart));
    for column in 1..=count {
        for row in 1..4 {
            let (x, y) = (column as f32 * apart, row as f32 * apart);
            all.extend(walls(x - 0.2, y - 0.2, x + 0.2, y + 0.2));
        }
    }
    let (near, far) = (0.5 * apart, side - 0.5 * apart);
    let aisles = [0.5, 1.5, 2.5, 3.5].map(|aisle| aisle * apart);
    let points = aisles
        .iter()
        .enumerate()
        .flat_map(|(number, &y)| match number % 2 {
            0 => [[near, y], [far, y]],
            _ => [[far, y], [near, y]],
        });
    Scene::new(all, points.collect())
}

/// A long hall with a group of people. The robot drives round them.
fn people(noise: &mut Noise) -> Scene {
    let scene = walkers(noise);
    let [[_, low], [right, _], [_, high], _] = scene.points[..] else {
        return scene;
    };
    let y = 0.5 * (low + high);
    let first = between(noise, 3.0, 0.5 * right);
    Scene {
        group: Group::Stands([[first, y], [first + between(noise, 2.0, 4.0), y]]),
        ..scene
    }
}

/// A long hall with people close round the robot, who walk with it.
fn walkers(noise: &mut Noise) -> Scene {
    let (long, wide) = (between(noise, 14.0, 24.0), between(noise, 7.0, 10.0));
    let around = (0..5).map(|number| {
        let angle = -1.2 + 0.6 * number as f32 + 0.1 * noise.next();
        let far = between(noise, 1.0, 2.0);
        [far * angle.cos(), far * angle.sin()]
    });
    let people = around.collect();
    let (right, high) = (long - 1.5, wide - 1.5);
    let points = [[1.5, 1.5], [right, 1.5], [right, high], [1.5, high]];
    Scene {
        people,
        ..Scene::new(walls(0.0, 0.0, long, wide).into(), points.into())
    }
}

fn is_wrong(closure: &Closure, run: &Run, truth: &[Pose]) -> bool {
    let at = |key: u16| truth[run.key_scans[usize::from(key)]];
    let real = at(closure.from).between(&at(closure.to));
    let off = closure.measured.minus(&real);
    let is_off = |step: usize| {
        let (y, x) = (step as f32 * core::f32::consts::PI / 16.0).sin_cos();
        along(&closure.information, [x, y]) >= CLAIM && (x * off[0] + y * off[1]).abs() > WRONG.0
    };
    off[2].abs() > WRONG.1 || (0..16).any(is_off)
}

/// Returns the information of a position along a direction, the heading eliminated, 1/m².
fn along(a: &Matrix, [x, y]: [f32; 2]) -> f32 {
    let [[xx, xy, xt], [_, yy, yt], [_, _, tt]] = *a;
    let lever = xt * x + yt * y;
    xx * x * x + 2.0 * xy * x * y + yy * y * y - lever * lever / tt
}

/// What became of the scenes of a kind.
#[derive(Default)]
struct Played {
    closures: usize,
    wrong: usize,
    /// Seeds of the runs that a wrong closure misled for longer than [`UNDONE`].
    misled: Vec<u32>,
}

/// Returns true if the robot's pose was off by half a metre for longer than [`UNDONE`].
fn is_misled(run: &Run, truth: &[Pose]) -> bool {
    let poses = run.live.iter().zip(truth);
    let off: Vec<bool> = poses
        .map(|(live, real)| live.between(real).length_m() > WRONG.0)
        .collect();
    off.split(|is_off| !is_off).any(|part| part.len() > UNDONE)
}

fn play(draw: fn(&mut Noise) -> Scene, seeds: core::ops::Range<u32>) -> Played {
    let mut played = Played::default();
    for seed in seeds {
        // A generator of this kind begins alike for seeds that lie close.
        let mut noise = Noise(seed.wrapping_mul(0x9e37_79b9));
        let scene = draw(&mut noise);
        // There and back again: on the way back there are loops to close.
        let back = scene.points.iter().rev().skip(1);
        let points: Vec<[f32; 2]> = scene.points.iter().chain(back).copied().collect();
        let poses = drive(&points);
        let scale = 0.05 * noise.next();
        let odom = odometry(&poses, scale, &mut noise);
        let half = poses.len() / 2;
        let around = |number: usize, pose: &Pose| scene.people(number > half, pose);
        let run = run_among(&scene.walls, around, &poses, &odom, seed);
        let closures = &run.slam.graph.closures;
        let wrong = closures.iter().filter(|it| is_wrong(it, &run, &poses));
        let wrong = wrong.count();
        played.closures += closures.len();
        played.wrong += wrong;
        if wrong > 0 && is_misled(&run, &poses) {
            played.misled.push(seed);
        }
    }
    played
}

/// A kind of scene: its name, and what draws it.
type Kind = (&'static str, fn(&mut Noise) -> Scene);

const SCENES: [Kind; 4] = [
    ("corridors", corridors),
    ("rooms", rooms),
    ("pillars", pillars),
    ("people", people),
];

/// Plays so many seeds of each scene. Returns the number of runs that were misled.
fn misled(scenes: &[Kind], seeds: u32) -> usize {
    let (mut closures, mut misled) = (0, 0);
    for &(name, draw) in scenes {
        let played = play(draw, 0..seeds);
        std::println!(
            "{name}: {seeds} runs, {} closures, {} wrong, misled {:?}",
            played.closures,
            played.wrong,
            played.misled
        );
        closures += played.closures;
        misled += played.misled.len();
    }
    assert!(closures > 0, "no loop was closed at all");
    misled
}

#[test]
fn places_that_look_the_same_mislead_nobody() {
    assert_eq!(misled(&SCENES, 2), 0);
}

/// Of two equal corridors less than the drift apart, no scan tells which one it is.
#[test]
#[ignore = "a thousand scenes take minutes"]
fn a_thousand_scenes_mislead_two_runs_at_most() {
    assert!(misled(&SCENES, 250) <= 2);
}

/// Ends of beams that move with the robot pull the front end along.
#[test]
#[ignore = "fails: see docs/LIMITATIONS.md"]
fn known_red_people_who_walk_along_mislead_nobody() {
    assert_eq!(misled(&[("walkers", walkers)], 50), 0);
}
