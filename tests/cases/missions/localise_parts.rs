//! What each part of the localisation buys: `golden/localise-parts.txt`.
//!
//! Explorations with noisy odometry in two worlds of rooms and two of bare corridors, with one part
//! left out or with fewer beams.

use fieldline_tests::odometry::{Drive, Setting, sweep};
use fieldline_tests::runs::{self, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::report::Report;
use host_sim::trial::mission::OdometryProfile::Noisy;

const ROOMS: [&str; 2] = ["office", "hall"];
const CORRIDORS: [&str; 2] = ["ouroboros-a", "ouroboros-b"];
/// No constant was chosen on these seeds.
const SEEDS: core::ops::Range<u64> = 100..110;

/// Name, odometry, and constants with other values.
type Variant = (&'static str, Setting, &'static [(&'static str, f32)]);

const CORRECTED: Setting = Setting::corrected(Noisy);
const VARIANTS: [Variant; 10] = [
    ("181 beams", CORRECTED, &[]),
    ("91 beams", CORRECTED, &[("localise.beam_stride", 2.0)]),
    ("61 beams", CORRECTED, &[("localise.beam_stride", 3.0)]),
    ("31 beams", CORRECTED, &[("localise.beam_stride", 6.0)]),
    ("no normals", CORRECTED, &[("localise.flat_m", 0.0)]),
    (
        "no robust weights",
        CORRECTED,
        &[("localise.robust_cells", 10.0)],
    ),
    (
        "no degeneracy rule",
        CORRECTED,
        &[("localise.least_information", 0.0)],
    ),
    (
        "wheels do not slip",
        CORRECTED,
        &[("localise.slip_gap", 1e9)],
    ),
    (
        "no predictions for slips",
        CORRECTED,
        &[("localise.slip_price", 1e9)],
    ),
    ("odometry alone", Setting::uncorrected(Noisy), &[]),
];

/// Returns the cells of a group of worlds: mean and greatest error of the pose, wall error, ghosts.
fn cells(reports: &[Report], worlds: &[&str]) -> Vec<String> {
    let group = reports
        .iter()
        .filter(|it| worlds.contains(&it.world.as_str()));
    let group: Vec<&Report> = group.collect();
    let error = |report: &Report| report.localization.mean_error_m;
    let worst = group.iter().filter_map(|it| error(it)).reduce(f64::max);
    let wall = |report: &Report| report.map.and_then(|map| Some(map.wall_error_m?.p95));
    let ghosts = |report: &Report| report.map.map(|map| 100.0 * map.ghost_share);
    vec![
        number(runs::mean(&group, error), 3),
        number(worst, 3),
        number(runs::mean(&group, wall), 3),
        number(runs::mean(&group, ghosts), 2),
    ]
}

mod full {
    use super::*;

    #[test]
    #[ignore = "takes minutes: 360 runs; tests/run --full runs it"]
    fn parts_of_the_localisation_left_out() {
        let worlds = worlds::builtins(&[ROOMS, CORRIDORS].concat());
        let mut table = Table::new(
            1,
            &[
                "with",
                "rooms m",
                "worst",
                "wall p95 m",
                "ghosts %",
                "corridors m",
                "worst",
                "wall p95 m",
                "ghosts %",
                "least seen %",
                "touched",
            ],
        );
        for (name, setting, changes) in VARIANTS {
            let tuning = runs::tuned(changes);
            let usual = sweep(&worlds, &SEEDS, &[setting]).into_iter();
            let drives: Vec<_> = usual.map(|drive| Drive { tuning, ..drive }).collect();
            let reports = in_parallel(&drives, Drive::go);
            let seen = reports.iter().map(|it| 100.0 * it.coverage.fraction);
            let touched: u32 = reports.iter().map(|it| it.safety.collisions).sum();
            let mut row = vec![name.into()];
            row.extend(cells(&reports, &ROOMS));
            row.extend(cells(&reports, &CORRIDORS));
            row.push(number(seen.reduce(f64::min), 2));
            row.push(touched.to_string());
            table.row(row);
        }
        golden::compare("localise-parts.txt", &table.to_string());
    }
}
