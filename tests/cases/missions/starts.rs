//! Starts in tight places: on a dock, in a corner, in a bay. What lies beside and behind the hull
//! was never seen, so the robot must not sweep it.
//!
//! ```text
//! ##############################      d  dock: a wall behind
//! #d             #             #      c  corner: walls behind and to the right
//! #              #             #      b  bay: boards behind and on both sides, open ahead
//! #              .             #
//! #==            .             #
//! #b             #             #
//! #==            #             #
//! #c             #             #
//! ##############################
//! ```
//!
//! Units: metres, radians.

use fieldline_tests::golden;
use host_sim::link::direct::Direct;
use host_sim::trial::mission::{Mission, OdometryProfile, explore};
use host_sim::world::{Class, GridCell, Occupancy, Start, World};

/// Side of a drawn cell, metres.
const CELL_M: f64 = 0.01;
/// Half of the hull's length and width, metres.
const HALF_M: [f64; 2] = [0.254, 0.2485];
/// Places, and distances of the hull from what is behind or beside it there, metres. In narrower
/// bays and corners some runs touch: docs/LIMITATIONS.md.
const PLACES: [(&str, &[f64]); 3] = [
    ("dock", &[0.02, 0.03, 0.05, 0.08, 0.12]),
    ("bay", &[0.05, 0.08, 0.12]),
    ("corner", &[0.12]),
];

/// Fills a rectangle with wall.
fn fill(plan: &mut Occupancy, [x0, y0, x1, y1]: [f64; 4]) {
    let index = |at_m: f64| (at_m / CELL_M).round() as i64;
    for y in index(y0)..index(y1) {
        for x in index(x0)..index(x1) {
            plan.set(GridCell { i: x, j: y }, Class::Wall);
        }
    }
}

/// Draws two rooms with a door of 1.2 m, and a place with this gap around the hull.
fn tight(place: &str, gap_m: f64) -> World {
    let mut plan = Occupancy::filled(800, 600, CELL_M, [0.0, 0.0], Class::Free);
    for wall in [
        [0.0, 0.0, 8.0, 0.1],
        [0.0, 5.9, 8.0, 6.0],
        [0.0, 0.0, 0.1, 6.0],
        [7.9, 0.0, 8.0, 6.0],
        [4.5, 0.0, 4.6, 2.4],
        [4.5, 3.6, 4.6, 6.0],
    ] {
        fill(&mut plan, wall);
    }
    let x_m = 0.1 + gap_m + HALF_M[0];
    let y_m = match place {
        "dock" => 4.6,
        "corner" => 0.1 + gap_m + HALF_M[1],
        _ => 2.6,
    };
    if place == "bay" {
        let (side_m, end_m) = (gap_m + HALF_M[1], x_m + 0.2);
        fill(&mut plan, [0.1, y_m - side_m - 0.04, end_m, y_m - side_m]);
        fill(&mut plan, [0.1, y_m + side_m, end_m, y_m + side_m + 0.04]);
    }
    let yaw_rad = 0.0;
    World::flat(place, plan, vec![Start { x_m, y_m, yaw_rad }])
}

/// Explores from a place with this gap. Returns how the run ends, the number of touches, and the
/// share that is known.
fn run(place: &str, gap_m: f64, seed: u64) -> (String, u32, f64) {
    let mission = Mission {
        seed,
        odometry: OdometryProfile::Noisy,
        localise: true,
        ..Mission::default()
    };
    let run = explore(&mission, &tight(place, gap_m), &mut Direct::new(), &mut ());
    let report = run.expect("the start is free").0;
    let (reason, touches) = (report.outcome.reason, report.safety.collisions);
    (reason, touches, report.coverage.fraction)
}

#[test]
fn robots_leave_tight_places_without_a_touch() {
    for (place, gaps_m) in PLACES {
        for (&gap_m, seed) in gaps_m.iter().cycle().zip(0..6) {
            let (reason, touches, known) = run(place, gap_m, seed);
            let end = (reason.as_str(), touches);
            assert_eq!(end, ("explored", 0), "{place}, {gap_m} m, seed {seed}");
            assert!(known > 0.97, "{place}, {gap_m} m, seed {seed}: {known}");
        }
    }
}

mod full {
    use super::{golden, run};
    use fieldline_tests::table::Table;

    #[test]
    #[ignore = "takes minutes: 45 runs; tests/run --full runs it"]
    fn starts_in_tight_places() {
        let mut table = Table::new(1, &["place", "gap m", "explored", "touched", "touches"]);
        for place in ["dock", "bay", "corner"] {
            for gap_m in [0.02, 0.03, 0.05, 0.08, 0.12] {
                let runs: Vec<_> = (0..3).map(|seed| run(place, gap_m, seed)).collect();
                let explored = runs.iter().filter(|run| run.0 == "explored").count();
                let touched = runs.iter().filter(|run| run.1 > 0).count();
                let touches: u32 = runs.iter().map(|run| run.1).sum();
                table.row(vec![
                    place.into(),
                    format!("{gap_m:.2}"),
                    explored.to_string(),
                    touched.to_string(),
                    touches.to_string(),
                ]);
            }
        }
        golden::compare("starts-full.txt", &format!("Three seeds each.\n\n{table}"));
    }
}
