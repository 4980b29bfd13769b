//! Rails with and without impatience: whole explorations by `tdbvp` that leave the rails for a path
//! after 15 s without a new place, and as \[Maffei14\] has it, never.
//!
//! `golden/impatience-full.txt` has all 15 starts of the four worlds of \[Jorge15\].

use fieldline_tests::digests::Digest;
use fieldline_tests::loops::TDBVP;
use fieldline_tests::runs::{explored, in_parallel, mean};
use fieldline_tests::table::{Table, number};
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{IMPATIENCE_S, Mission};
use host_sim::world::World;

/// Worlds of the table.
const WORLDS: [&str; 4] = ["ouroboros-a", "ouroboros-b", "ouroboros-c", "ouroboros-d"];

/// Explores from every start.
fn sweep(world: &World, impatience_s: Option<u16>) -> Vec<Report> {
    let starts: Vec<usize> = (0..world.starts().len()).collect();
    in_parallel(&starts, |&start| {
        let mission = Mission {
            strategy: TDBVP.into(),
            impatience_s,
            start,
            ..Mission::default()
        };
        explored(&mission, world, &mut Direct::new()).0
    })
}

/// Compares all starts of the worlds, with and without impatience, with golden table `name`.
pub(crate) fn check_every_start(name: &str) {
    let mut table = Table::new(
        2,
        &[
            "world",
            "impatience s",
            "runs",
            "explored",
            "loops",
            "mean s",
            "least s",
            "most s",
            "path m",
            "least known %",
            "hits",
        ],
    );
    let mut digests = Vec::new();
    for world in worlds::builtins(&WORLDS) {
        for impatience_s in [IMPATIENCE_S, None] {
            let reports = sweep(&world, impatience_s);
            let text = impatience_s.map_or("never".into(), |seconds| seconds.to_string());
            table.row(row(&reports, &text));
            let settings = match impatience_s {
                IMPATIENCE_S => "-".into(),
                _ => format!("impatience={text}"),
            };
            digests.extend(Digest::of_all(&reports, &settings));
            let mut impatient = reports.iter().filter(|_| impatience_s.is_some());
            assert!(impatient.all(Report::explored), "{}", world.name());
        }
    }
    golden::compare_runs(name, &format!("{table}"), &digests);
}

fn row(reports: &[Report], impatience: &str) -> Vec<String> {
    let sum = |of: fn(&Report) -> u32| reports.iter().map(of).sum::<u32>();
    let all: Vec<&Report> = reports.iter().collect();
    let times = || reports.iter().map(|report| report.sim_time_s);
    let known = reports
        .iter()
        .map(|report| 100.0 * report.coverage.fraction);
    let explored = reports.iter().filter(|report| report.explored());
    vec![
        reports[0].world.clone(),
        impatience.into(),
        reports.len().to_string(),
        explored.count().to_string(),
        format!(
            "{}/{}",
            sum(|it| it.loops.circled),
            sum(|it| it.loops.islands)
        ),
        number(mean(&all, |it| Some(it.sim_time_s)), 1),
        number(times().reduce(f64::min), 1),
        number(times().reduce(f64::max), 1),
        number(mean(&all, |it| Some(it.path_length_m)), 1),
        number(known.reduce(f64::min), 2),
        sum(|it| it.safety.collisions).to_string(),
    ]
}
