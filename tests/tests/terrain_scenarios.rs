//! What the terrain paper shows of its scenarios 2, 3 and 4, by the device's map over time [Maffei-Terrain, IV].
//!
//! `golden/scenarios.txt` has two starts of each, `scenarios-full.txt` (`tests/run --full`) all ten. What is asserted is what holds; the rest is in
//! the tables, to be seen:
//!
//! | scenario | the paper | table |
//! | --- | --- | --- |
//! | 2, holes | the near rim is negative before the robot is within 0.5 m of it | cells of the rim that came so near, and those of them that were known by then |
//! | 3, building | its interior is known without going in | where the robot was when the interior was known, and share known when it first went in |
//! | 4, cliff | an obstacle when first seen from below, negative from above | cells of its face by the class that they had first |
//!
//! A cell of the cliff counts for the side from which the face around it, two cells to all sides, was first a barrier, and for neither if it became
//! one itself from the other side: there the cliff had been seen before.
//!
//! Places are those of the worlds as drawn (`host_sim::world`). Metres, give or take one cell.

use core::fmt::Write as _;

use std::collections::BTreeMap;

use fieldline_planner::geometry::Cell;
use fieldline_tests::history::{History, Watcher};
use fieldline_tests::runs::{explored, faults, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::uneven::Tour;
use fieldline_tests::watched::Watched;
use fieldline_tests::{full, golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::metrics::{GroundTruth, TrueClass};
use host_sim::report::{MapCell, Report};
use host_sim::trial::{Record, Step};
use host_sim::world::World;

/// Share of what can be reached that must be known at the end.
const LEAST_COVERAGE: f64 = 0.97;
/// South-west and north-east corners of the holes.
const HOLES: [[f64; 4]; 2] = [[16.4, 16.8, 22.2, 21.6], [3.8, 4.4, 8.4, 8.0]];
/// How near the robot's centre comes to a rim that should be known by then.
const NEAR_M: f64 = 0.5;
/// Middle of the building's entrance.
const ENTRANCE: [f64; 2] = [13.5, 12.0];
/// Per cent of the interior that must be known before the robot is in the entrance, and of it at the end.
const LEAST_KNOWN: f64 = 97.0;
/// The cliff runs north between these, the ramp's side and what the wall around the world covers left out, and no farther than so from a line; its foot
/// and its rim differ by more than this.
const CLIFF: Cliff = Cliff {
    y_m: [7.0, 23.5],
    x_m: [14.5, 19.0],
    least_rise_m: 1.0,
};
/// Of the cells of the cliff's face, those that must have the right class first.
const LEAST_SHARE: f64 = 0.95;

struct Cliff {
    y_m: [f64; 2],
    x_m: [f64; 2],
    least_rise_m: f64,
}

/// A run, and what the map said all the time.
struct Tale {
    start: usize,
    report: Report,
    record: Record,
    history: History,
}

fn tales(world: &World) -> Vec<Tale> {
    let count = if full() { world.starts().len() } else { 2 };
    let starts: Vec<usize> = (0..count).collect();
    let tales = in_parallel(&starts, |&start| {
        let mut watcher = Watcher::new();
        let mut link = Watched::new(Direct::new(), |link, observation, _| {
            watcher.look(link, observation)
        });
        let mission = Tour::of(world, start, 0).mission();
        let (report, record) = explored(&mission, world, &mut link);
        Tale {
            start,
            report,
            record,
            history: watcher.history,
        }
    });
    for tale in &tales {
        let start = tale.start;
        let none: [&str; 0] = [];
        assert_eq!(
            faults(&tale.report, LEAST_COVERAGE),
            none,
            "{} start {start}",
            world.name()
        );
    }
    tales
}

impl Tale {
    fn ground(&self) -> &GroundTruth {
        self.record.ground.as_ref().expect("an uneven world")
    }

    /// The first step at which something holds.
    fn first(&self, holds: impl Fn(&Step) -> bool) -> Option<&Step> {
        self.record.steps.iter().find(|step| holds(step))
    }

    /// Whether the map had any of these classes within a cell at a time.
    fn had(&self, [x, y]: [i32; 2], time_ms: u32, classes: &[MapCell]) -> bool {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        around
            .map(|cell| self.history.at(cell, time_ms))
            .any(|class| classes.contains(&class))
    }
}

fn middle([x, y]: [i32; 2]) -> [f64; 2] {
    [x, y].map(|k| (f64::from(k) + 0.5) * 0.1)
}

fn distance_m(step: &Step, [x_m, y_m]: [f64; 2]) -> f64 {
    (step.truth.x_m - x_m).hypot(step.truth.y_m - y_m)
}

/// Cells of a rectangle.
fn cells([x0, y0, x1, y1]: [f64; 4]) -> impl Iterator<Item = [i32; 2]> {
    let [x0, y0, x1, y1] = [x0, y0, x1, y1].map(|m| (m * 10.0).round() as i32);
    (y0..y1).flat_map(move |y| (x0..x1).map(move |x| [x, y]))
}

/// Negative cells of a hole beside ground that the robot covers.
fn rim(ground: &GroundTruth, [x0, y0, x1, y1]: [f64; 4]) -> Vec<[i32; 2]> {
    let class = |x: i32, y: i32| ground.class(Cell { x, y });
    let is_rim = |[x, y]: &[i32; 2]| {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
        class(*x, *y) == TrueClass::Negative
            && around
                .map(|(x, y)| class(x, y))
                .any(|class| class == TrueClass::Traversable)
    };
    let around = [x0 - 0.2, y0 - 0.2, x1 + 0.2, y1 + 0.2];
    cells(around).filter(is_rim).collect()
}

/// What was known of a hole's rim when the robot came near.
#[derive(Default)]
struct Rim {
    near: u32,
    named: u32,
    kept_off: u32,
    nearest_m: Option<f64>,
    /// Whether the cell that it came near to first was named by then.
    first: Option<(u32, bool)>,
}

impl Rim {
    fn of(tale: &Tale, hole: [f64; 4]) -> Self {
        let mut rim_seen = Self::default();
        for cell in rim(tale.ground(), hole) {
            let place = middle(cell);
            let steps = tale.record.steps.iter();
            let nearest = steps.map(|step| distance_m(step, place)).reduce(f64::min);
            rim_seen.nearest_m = nearest.map(|m| rim_seen.nearest_m.map_or(m, |n| n.min(m)));
            let Some(step) = tale.first(|step| distance_m(step, place) <= NEAR_M) else {
                continue;
            };
            let time_ms = step.truth.time_ms;
            let named = tale.had(cell, time_ms, &[MapCell::NegativeObstacle]);
            rim_seen.near += 1;
            rim_seen.named += u32::from(named);
            let off = tale.had(cell, time_ms, &[MapCell::Obstacle]);
            rim_seen.kept_off += u32::from(named || off);
            if rim_seen
                .first
                .is_none_or(|(first_ms, _)| time_ms < first_ms)
            {
                rim_seen.first = Some((time_ms, named));
            }
        }
        rim_seen
    }
}

/// What the map said of the rims of holes, and the rims that it had too late, a line each.
fn holes() -> (Table, String) {
    let columns = [
        "holes: start",
        "hole",
        "rim cells within 0.5 m",
        "negative before",
        "kept off before",
        "the first one negative",
        "nearest m",
        "falls",
    ];
    let mut table = Table::new(0, &columns);
    let mut late = String::new();
    for tale in tales(&worlds::builtin("holes")) {
        for (name, hole) in ["north-east", "south-west"].iter().zip(HOLES) {
            let rim = Rim::of(&tale, hole);
            let start = tale.start;
            if rim.named != rim.near {
                let (named, near) = (rim.named, rim.near);
                let _ = writeln!(
                    late,
                    "start {start}: {named} of {near} cells of the {name} hole's rim were negative before the robot was near"
                );
            }
            table.row(vec![
                tale.start.to_string(),
                (*name).into(),
                rim.near.to_string(),
                rim.named.to_string(),
                rim.kept_off.to_string(),
                rim.first
                    .map_or("-", |(_, named)| if named { "yes" } else { "no" })
                    .into(),
                number(rim.nearest_m, 2),
                tale.report.safety.falls.to_string(),
            ]);
        }
    }
    (table, late)
}

/// Whether a place is in the building's room, clear of its walls.
fn is_inside([x_m, y_m]: [f64; 2]) -> bool {
    let (aside, inwards) = ((x_m - ENTRANCE[0]).abs(), y_m - ENTRANCE[1]);
    (0.3..5.4).contains(&inwards) && aside < (0.6 + inwards).min(2.5)
}

/// Per cent of the building's interior that is known at a time.
fn known(tale: &Tale, room: &[[i32; 2]], time_ms: u32) -> f64 {
    let is_known = |cell: &&[i32; 2]| tale.history.at(**cell, time_ms) != MapCell::Unknown;
    100.0 * room.iter().filter(is_known).count() as f64 / room.len() as f64
}

/// When [`LEAST_KNOWN`] of it was known.
fn seen_ms(tale: &Tale, room: &[[i32; 2]]) -> Option<u32> {
    let first = |cell: &[i32; 2]| tale.history.of(*cell).first().map(|(time_ms, _)| *time_ms);
    let mut times: Vec<u32> = room.iter().filter_map(first).collect();
    times.sort_unstable();
    let enough = (LEAST_KNOWN / 100.0 * room.len() as f64).ceil() as usize;
    times.get(enough).copied()
}

fn building() -> Table {
    let columns = [
        "building: start",
        "97 % known after s",
        "m before the entrance then",
        "went in after s",
        "known then %",
        "known at the end %",
    ];
    let room: Vec<[i32; 2]> = cells([10.0, 12.0, 17.0, 18.0])
        .filter(|cell| is_inside(middle(*cell)))
        .collect();
    let seconds = |step: &Step| f64::from(step.truth.time_ms) / 1000.0;
    let mut table = Table::new(0, &columns);
    for tale in tales(&worlds::builtin("building")) {
        let known = |time_ms: u32| known(&tale, &room, time_ms);
        let seen_ms = seen_ms(&tale, &room);
        let seen = tale.first(|step| Some(step.truth.time_ms) == seen_ms);
        let before_m = seen.map(|step| ENTRANCE[1] - step.truth.y_m);
        let entered = tale.first(|step| is_inside([step.truth.x_m, step.truth.y_m]));
        let at_the_end = known(u32::MAX);
        let start = tale.start;
        assert!(at_the_end > LEAST_KNOWN, "{start}: {at_the_end} %");
        assert!(
            before_m.is_some_and(|before_m| before_m > 0.0),
            "{start}: seen from {before_m:?} m before the entrance"
        );
        table.row(vec![
            start.to_string(),
            number(seen.map(seconds), 1),
            number(before_m, 2),
            number(entered.map(seconds), 1),
            number(entered.map(|step| known(step.truth.time_ms)), 1),
            number(Some(at_the_end), 1),
        ]);
    }
    table
}

/// Cells of the cliff's face: so much height between those around them.
fn face(world: &World) -> Vec<[i32; 2]> {
    let [west, east] = CLIFF.x_m;
    let [south, north] = CLIFF.y_m;
    let is_face = |[x, y]: &[i32; 2]| {
        let around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| [x + dx, y + dy]));
        let heights = around.filter_map(|cell| {
            let [x_m, y_m] = middle(cell);
            world.ground_m(x_m, y_m)
        });
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(z), high.max(z))
        });
        high - low > CLIFF.least_rise_m
    };
    cells([west, south, east, north]).filter(is_face).collect()
}

/// When a cell first was a barrier, of which kind, and whether the robot was on the plateau's side then.
fn first_barrier(tale: &Tale, cell: [i32; 2]) -> Option<(u32, MapCell, bool)> {
    let is_barrier =
        |class: MapCell| matches!(class, MapCell::Obstacle | MapCell::NegativeObstacle);
    let mut changes = tale.history.of(cell).iter();
    let (time_ms, class) = *changes.find(|(_, class)| is_barrier(*class))?;
    let step = tale.first(|step| step.truth.time_ms == time_ms)?;
    Some((time_ms, class, step.truth.x_m > middle(cell)[0]))
}

/// Cells of the face that were first an obstacle, and first negative, by whether the robot was on the low ground then or on the plateau.
fn first_classes(tale: &Tale, world: &World) -> [[u32; 2]; 2] {
    let mut counts = [[0; 2]; 2];
    let face: BTreeMap<[i32; 2], _> = face(world)
        .into_iter()
        .filter_map(|cell| Some((cell, first_barrier(tale, cell)?)))
        .collect();
    for (&[x, y], &(_, class, from_above)) in &face {
        let around = (-2..=2).flat_map(|dy| (-2..=2).map(move |dx| [x + dx, y + dy]));
        let first = around
            .filter_map(|cell| face.get(&cell))
            .min_by_key(|(time_ms, ..)| *time_ms);
        if first.is_some_and(|(.., above)| *above == from_above) {
            let negative = class == MapCell::NegativeObstacle;
            counts[usize::from(from_above)][usize::from(negative)] += 1;
        }
    }
    counts
}

fn cliff() -> Table {
    let columns = [
        "cliff: start",
        "from below: obstacle",
        "negative",
        "from above: obstacle",
        "negative",
        "known %",
    ];
    let mut table = Table::new(0, &columns);
    let world = worlds::builtin("cliff");
    let mut seen = [false; 2];
    for tale in tales(&world) {
        let [below, above] = first_classes(&tale, &world);
        let start = tale.start;
        for (side, right, all) in [
            (0, below[0], below[0] + below[1]),
            (1, above[1], above[0] + above[1]),
        ] {
            seen[side] |= all > 0;
            assert!(
                f64::from(right) >= LEAST_SHARE * f64::from(all),
                "{start}: {below:?} from below, {above:?} from above"
            );
        }
        let mut row = vec![start.to_string()];
        row.extend(below.iter().chain(&above).map(ToString::to_string));
        row.push(format!("{:.2}", 100.0 * tale.report.coverage.fraction));
        table.row(row);
    }
    assert_eq!(seen, [true; 2], "both sides are looked from in some run");
    table
}

#[test]
fn what_the_map_said_when_it_mattered() {
    let (rims, late) = holes();
    let text = format!("{rims}\n{}\n{}", building(), cliff());
    let name = if full() {
        "scenarios-full.txt"
    } else {
        "scenarios.txt"
    };
    golden::compare(name, &text);
    // After the table, so that it is there to read.
    assert!(late.is_empty(), "\n{late}");
}
