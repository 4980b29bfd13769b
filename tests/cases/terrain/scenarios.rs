//! The map over time in scenarios 2, 3 and 4 of \[Maffei20, IV\].
//!
//! `golden/scenarios.txt` has two starts of each, `scenarios-full.txt` all ten. A property that
//! holds in every run is asserted; the tables show the rest.
//!
//! - Scenario 2, holes. The paper: the near rim is negative before the robot is within 0.5 m of it.
//!   The table: cells of the rim within 0.5 m, and those that were negative by then.
//! - Scenario 3, building. The paper: the interior is known without going in. The table: the
//!   robot's place when the interior was known, and the share known when it went in.
//! - Scenario 4, cliff. The paper: from below it is first an obstacle, from above first negative.
//!   The table: cells of its face by their first class.
//!
//! A cell of the cliff counts for the side from which the face around it, two cells on all sides,
//! was first a barrier. It counts for neither if it became a barrier from the other side later,
//! because the cliff had been seen before. Units: metres, with an error of one cell.

use core::fmt::Write as _;
use std::collections::BTreeMap;

use fieldline_planner::geometry::Cell;
use fieldline_tests::golden;
use fieldline_tests::places::{self, Building, around, cells, middle};
use fieldline_tests::table::{Table, number};
use fieldline_tests::worlds;
use host_sim::metrics::{GroundTruth, TrueClass};
use host_sim::report::MapCell;
use host_sim::trial::Step;
use host_sim::world::World;

use crate::shared::{FIRST, SECOND, WatchedRun, assert_explored};

/// Distance from a rim within which the robot must know it.
const NEAR_M: f64 = 0.5;
/// Per cent of the interior known before the robot is in the entrance, and at the end.
const LEAST_KNOWN: f64 = 97.0;
/// Part of the cliff world that holds the cliff's face: west, south, east, north. The side of the
/// ramp is south of it, and the wall around the world north.
const CLIFF: [f64; 4] = [14.5, 7.0, 19.0, 23.5];
/// Least difference between the cliff's foot and its rim.
const LEAST_RISE_M: f64 = 1.0;
/// Least share of the face's cells with the right class first.
const LEAST_SHARE: f64 = 0.95;

fn distance_m(step: &Step, [x_m, y_m]: [f64; 2]) -> f64 {
    (step.truth.x_m - x_m).hypot(step.truth.y_m - y_m)
}

/// The rim of a hole at the times when the robot came near.
#[derive(Default)]
struct Rim {
    /// Cells that the robot came near to.
    near: u32,
    /// Cells that were negative by then.
    named: u32,
    /// Cells that were a barrier of any kind by then.
    kept_off: u32,
    nearest_m: Option<f64>,
    /// Time of the first cell that the robot came near to, and true if it was negative by then.
    first: Option<(u32, bool)>,
}

impl Rim {
    fn of(run: &WatchedRun, hole: &[[i32; 2]]) -> Self {
        let mut rim = Self::default();
        for &cell in hole.iter().filter(|cell| is_rim(run.ground(), **cell)) {
            let place = middle(cell);
            let steps = run.record.steps.iter();
            let nearest = steps.map(|step| distance_m(step, place)).reduce(f64::min);
            rim.nearest_m = nearest.map(|m| rim.nearest_m.map_or(m, |n| n.min(m)));
            let Some(step) = run.first(|step| distance_m(step, place) <= NEAR_M) else {
                continue;
            };
            let time_ms = step.truth.time_ms;
            let named = run.had(cell, time_ms, &[MapCell::NegativeObstacle]);
            rim.near += 1;
            rim.named += u32::from(named);
            let off = run.had(cell, time_ms, &[MapCell::Obstacle]);
            rim.kept_off += u32::from(named || off);
            if rim.first.is_none_or(|(first_ms, _)| time_ms < first_ms) {
                rim.first = Some((time_ms, named));
            }
        }
        rim
    }
}

/// Returns true for a cell of a hole beside ground that the robot can cover.
fn is_rim(ground: &GroundTruth, cell: [i32; 2]) -> bool {
    around(cell, 1).any(|[x, y]| ground.class(Cell { x, y }) == TrueClass::Traversable)
}

/// Makes the table of the holes' rims, and lists those that were not negative in time.
fn holes(runs: &[&WatchedRun]) -> (Table, String) {
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
    let world = worlds::builtin("holes");
    for run in runs {
        let start = run.start();
        let pits = places::pits(&world, run.ground());
        assert_eq!(pits.len(), 2, "the world has two holes");
        for (name, hole) in ["north-east", "south-west"].iter().zip(pits) {
            let rim = Rim::of(run, &hole);
            let (named, near) = (rim.named, rim.near);
            if named != near {
                let _ = writeln!(
                    late,
                    "start {start}: {named} of {near} cells of the {name} hole's rim were negative \
                     before the robot was near"
                );
            }
            table.row(vec![
                start.to_string(),
                (*name).into(),
                near.to_string(),
                named.to_string(),
                rim.kept_off.to_string(),
                rim.first
                    .map_or("-", |(_, named)| if named { "yes" } else { "no" })
                    .into(),
                number(rim.nearest_m, 2),
                run.summary.report.safety.falls.to_string(),
            ]);
        }
    }
    (table, late)
}

/// Returns true for a place in the building's room, clear of its walls. The room widens at 45° from
/// the entrance.
fn is_inside(building: &Building, [x_m, y_m]: [f64; 2]) -> bool {
    let [x, y] = building.entrance;
    let (aside, inwards) = ((x_m - x).abs(), y_m - y);
    (0.3..5.4).contains(&inwards) && aside < (0.6 + inwards).min(2.5)
}

/// Returns per cent of the room known at a time.
fn known(run: &WatchedRun, room: &[[i32; 2]], time_ms: u32) -> f64 {
    let is_known = |cell: &&[i32; 2]| run.history.at(**cell, time_ms) != MapCell::Unknown;
    100.0 * room.iter().filter(is_known).count() as f64 / room.len() as f64
}

/// Returns the time at which [`LEAST_KNOWN`] of the room was known.
fn seen_ms(run: &WatchedRun, room: &[[i32; 2]]) -> Option<u32> {
    let first = |cell: &[i32; 2]| run.history.of(*cell).first().map(|(time_ms, _)| *time_ms);
    let mut times: Vec<u32> = room.iter().filter_map(first).collect();
    times.sort_unstable();
    let enough = (LEAST_KNOWN / 100.0 * room.len() as f64).ceil() as usize;
    times.get(enough).copied()
}

fn building(runs: &[&WatchedRun]) -> Table {
    let columns = [
        "building: start",
        "97 % known after s",
        "m before the entrance then",
        "went in after s",
        "known then %",
        "known at the end %",
    ];
    let building = places::building(&worlds::builtin("building"));
    let room: Vec<[i32; 2]> = cells(building.walls)
        .filter(|cell| is_inside(&building, middle(*cell)))
        .collect();
    let seconds = |step: &Step| f64::from(step.truth.time_ms) / 1000.0;
    let mut table = Table::new(0, &columns);
    for run in runs {
        let known = |time_ms: u32| known(run, &room, time_ms);
        let seen_ms = seen_ms(run, &room);
        let seen = run.first(|step| Some(step.truth.time_ms) == seen_ms);
        let before_m = seen.map(|step| building.entrance[1] - step.truth.y_m);
        let is_in = |step: &Step| is_inside(&building, [step.truth.x_m, step.truth.y_m]);
        let entered = run.first(is_in);
        let at_the_end = known(u32::MAX);
        let start = run.start();
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

/// Returns the cells of the cliff's face: the ground within two cells differs by [`LEAST_RISE_M`].
fn face(world: &World) -> Vec<[i32; 2]> {
    let is_face = |cell: &[i32; 2]| {
        let heights = around(*cell, 2).filter_map(|cell| {
            let [x_m, y_m] = middle(cell);
            world.ground_m(x_m, y_m)
        });
        let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), z| {
            (low.min(z), high.max(z))
        });
        high - low > LEAST_RISE_M
    };
    cells(CLIFF).filter(is_face).collect()
}

/// Returns the time at which a cell was first a barrier, its class then, and true if the robot was
/// on the plateau's side.
fn first_barrier(run: &WatchedRun, cell: [i32; 2]) -> Option<(u32, MapCell, bool)> {
    let is_barrier =
        |class: MapCell| matches!(class, MapCell::Obstacle | MapCell::NegativeObstacle);
    let mut changes = run.history.of(cell).iter();
    let (time_ms, class) = *changes.find(|(_, class)| is_barrier(*class))?;
    let step = run.first(|step| step.truth.time_ms == time_ms)?;
    Some((time_ms, class, step.truth.x_m > middle(cell)[0]))
}

/// Counts cells of the face that were first an obstacle and first negative: seen from the low
/// ground, then seen from the plateau.
fn first_classes(run: &WatchedRun, world: &World) -> [[u32; 2]; 2] {
    let mut counts = [[0; 2]; 2];
    let face: BTreeMap<[i32; 2], _> = face(world)
        .into_iter()
        .filter_map(|cell| Some((cell, first_barrier(run, cell)?)))
        .collect();
    for (&cell, &(_, class, from_above)) in &face {
        let first = around(cell, 2)
            .filter_map(|cell| face.get(&cell))
            .min_by_key(|(time_ms, ..)| *time_ms);
        if first.is_some_and(|(.., above)| *above == from_above) {
            let negative = class == MapCell::NegativeObstacle;
            counts[usize::from(from_above)][usize::from(negative)] += 1;
        }
    }
    counts
}

fn cliff(runs: &[&WatchedRun]) -> Table {
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
    for run in runs {
        let [below, above] = first_classes(run, &world);
        let start = run.start();
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
        let known = 100.0 * run.summary.report.coverage.fraction;
        row.push(format!("{known:.2}"));
        table.row(row);
    }
    assert_eq!(
        seen, [true; 2],
        "some run must see the cliff from each side"
    );
    table
}

/// Compares the runs of holes, building and cliff with golden file `name`.
pub(crate) fn check(name: &str, runs: &[Vec<&WatchedRun>; 3]) {
    assert_explored(runs.iter().flatten().map(|run| &run.summary));
    let (rims, late) = holes(&runs[0]);
    let text = format!("{rims}\n{}\n{}", building(&runs[1]), cliff(&runs[2]));
    golden::compare(name, &text);
    // Asserted after the comparison, so that the table is there to read.
    assert!(late.is_empty(), "\n{late}");
}

#[test]
fn the_map_over_time_in_the_papers_scenarios() {
    let first: Vec<&WatchedRun> = FIRST.iter().filter_map(|(_, run)| run.as_ref()).collect();
    let runs = [0, 1, 2].map(|k| vec![first[k], &SECOND[k]]);
    check("scenarios.txt", &runs);
}
