//! Tables of team runs: one line for each run, for each kind of run, or for each size of a team.

use host_sim::report::TeamReport;
use host_sim::trial::team::TeamRecord;

use super::{TeamRun, longest_stand_s};
use crate::table::{Table, number};

/// A column of a table with one line for each run: its head, and the cell of a run.
pub type Column = (&'static str, fn(&TeamRun<'_>, &TeamReport) -> String);

/// What every such table begins with: the run, and how it ended.
const RUN: [Column; 5] = [
    ("world", |_, it| it.whole.world.clone()),
    ("team", |run, _| run.settings()),
    ("ended", |_, it| {
        format!("{}({})", it.whole.outcome.status, it.whole.outcome.reason)
    }),
    ("seed", |_, it| it.whole.seed.to_string()),
    ("known %", |_, it| {
        format!("{:.2}", it.whole.coverage.fraction * 100.0)
    }),
];
/// When 99 % of the ground were known.
const T99: Column = ("T99 s", |_, it| number(it.whole.coverage.t99_s, 1));
/// When the run ended.
pub const END: Column = ("end s", |_, it| format!("{:.1}", it.whole.sim_time_s));
/// Touches of the world, falls and tips.
pub const HITS: Column = ("hits", |_, it| {
    let safety = &it.whole.safety;
    (safety.collisions + safety.falls + safety.tips).to_string()
});
/// Touches of two robots.
pub const CONTACTS: Column = ("contacts", |_, it| {
    it.whole.safety.robot_contacts.unwrap_or(0).to_string()
});
/// Whether all robots have the same map at the end.
pub const EQUAL_MAPS: Column = ("equal maps", |_, it| {
    let equal = it.team.maps_equal;
    equal.map_or("-".into(), |it| it.to_string())
});

/// Makes a table with one line for each run: which it is, how it ended, and more columns.
#[must_use]
pub fn by_run(more: &[Column], runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let columns = [&RUN[..], more].concat();
    let heads: Vec<&str> = columns.iter().map(|(head, _)| *head).collect();
    let mut table = Table::new(3, &heads);
    for (run, report) in runs.iter().zip(reports) {
        table.row(columns.iter().map(|(_, cell)| cell(run, report)).collect());
    }
    table
}

/// Makes a table of what robots of a team do for each other.
#[must_use]
pub fn table(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let columns: [Column; 12] = [
        ("T90 s", |_, it| number(it.whole.coverage.t90_s, 1)),
        T99,
        END,
        ("path m", |_, it| format!("{:.1}", it.whole.path_length_m)),
        ("after another", |_, it| {
            format!("{:.2}", it.team.driven_after_another)
        }),
        ("twice", |_, it| format!("{:.2}", it.team.measured_twice)),
        HITS,
        CONTACTS,
        ("gap m", |_, it| number(it.team.min_robot_gap_m, 3)),
        ("kB", |_, it| {
            format!("{:.1}", it.radio.traffic.sent_bytes as f64 / 1e3)
        }),
        ("lost", |_, it| it.radio.traffic.lost.to_string()),
        EQUAL_MAPS,
    ];
    by_run(&columns, runs, reports)
}

const DROPOUT_COLUMNS: [&str; 15] = [
    "world",
    "team",
    "explored",
    "equal maps",
    "least known %",
    "T99 s",
    "end s",
    "at most",
    "stood s",
    "at most",
    "after another",
    "hits",
    "contacts",
    "kB",
    "lost",
];

/// Makes a table with one line for each kind of run, over its seeds; runs of a kind stand together.
///
/// *Stood* is the longest time for which a robot stood while it explored, in the mean and at most.
#[must_use]
pub fn dropouts(runs: &[TeamRun<'_>], ended: &[(TeamReport, TeamRecord)]) -> Table {
    let mut table = Table::new(2, &DROPOUT_COLUMNS);
    let all: Vec<_> = runs.iter().zip(ended).collect();
    let kind = |run: &TeamRun<'_>| (run.world.name().to_owned(), run.settings());
    for same in all.chunk_by(|(a, _), (b, _)| kind(a) == kind(b)) {
        let of = |of: fn(&TeamReport) -> f64| -> Vec<f64> {
            same.iter().map(|(_, (report, _))| of(report)).collect()
        };
        let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
        let most = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
        let count = |is: fn(&TeamReport) -> bool| same.iter().filter(|(_, it)| is(&it.0)).count();
        let known = of(|it| it.whole.coverage.fraction);
        let t99_s: Option<Vec<f64>> = same
            .iter()
            .map(|(_, (it, _))| it.whole.coverage.t99_s)
            .collect();
        let end_s = of(|it| it.whole.sim_time_s);
        let stood_s: Vec<f64> = same.iter().map(|(_, it)| longest_stand_s(&it.1)).collect();
        let sum = |values: &[f64]| format!("{:.0}", values.iter().sum::<f64>());
        let (world, settings) = kind(same[0].0);
        table.row(vec![
            world,
            settings,
            format!("{} of {}", count(|it| it.whole.explored()), same.len()),
            count(|it| it.team.maps_equal == Some(true)).to_string(),
            format!("{:.2}", known.iter().copied().fold(1.0, f64::min) * 100.0),
            number(t99_s.map(|times| mean(&times)), 1),
            format!("{:.1}", mean(&end_s)),
            format!("{:.1}", most(&end_s)),
            format!("{:.1}", mean(&stood_s)),
            format!("{:.1}", most(&stood_s)),
            format!("{:.2}", mean(&of(|it| it.team.driven_after_another))),
            sum(&of(|it| it.whole.safety.collisions.into())),
            sum(&of(|it| it.whole.safety.robot_contacts.unwrap_or(0).into())),
            format!(
                "{:.0}",
                mean(&of(|it| it.radio.traffic.sent_bytes as f64 / 1e3))
            ),
            sum(&of(|it| it.radio.traffic.lost as f64)),
        ]);
    }
    table
}

/// Makes a table of robots whose odometry drifts.
///
/// *Met* is when the map of each robot came to lie in the team's coordinates. *Apart* is the error
/// of the motion between two maps after that, in the median and at most, over all pairs and steps.
#[must_use]
pub fn alignment(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let columns: [Column; 10] = [
        T99,
        END,
        ("met s", |_, it| {
            let met: Vec<String> = it.robots.iter().map(|it| number(it.met_s, 0)).collect();
            met.join("/")
        }),
        ("apart m", |_, it| {
            number(it.team.agreement.map(|it| it.median_m), 2)
        }),
        ("at most", |_, it| {
            number(it.team.agreement.map(|it| it.max_m), 2)
        }),
        ("apart deg", |_, it| {
            number(it.team.agreement.map(|it| it.median_deg), 2)
        }),
        ("at most", |_, it| {
            number(it.team.agreement.map(|it| it.max_deg), 2)
        }),
        HITS,
        CONTACTS,
        EQUAL_MAPS,
    ];
    by_run(&columns, runs, reports)
}

const SPEED_UP_COLUMNS: [&str; 14] = [
    "world",
    "starts",
    "radio",
    "robots",
    "T90 s",
    "speed-up",
    "T99 s",
    "speed-up",
    "path m",
    "after another",
    "twice",
    "hits",
    "contacts",
    "unfinished",
];

/// Makes a table with one line for each world, start, radio and number of robots, over the seeds.
///
/// Runs of one line stand together, and the runs of one robot of a group come first. A *speed-up*
/// is the mean time of one robot over that of the team; it needs the share in every run.
#[must_use]
pub fn speed_up(runs: &[TeamRun<'_>], reports: &[TeamReport]) -> Table {
    let mut table = Table::new(3, &SPEED_UP_COLUMNS);
    let all: Vec<(&TeamRun<'_>, &TeamReport)> = runs.iter().zip(reports).collect();
    let group = |it: &TeamRun<'_>| (it.world.name().to_owned(), it.apart, it.radio.to_owned());
    for same in all.chunk_by(|(a, _), (b, _)| group(a) == group(b)) {
        let mut alone_s = [None; 2];
        for line in same.chunk_by(|(a, _), (b, _)| a.robots == b.robots) {
            let (run, count) = (line[0].0, line.len() as f64);
            let time = |of: fn(&TeamReport) -> Option<f64>| {
                let times: Option<Vec<f64>> = line.iter().map(|(_, it)| of(it)).collect();
                times.map(|times| times.iter().sum::<f64>() / count)
            };
            let times_s = [
                time(|it| it.whole.coverage.t90_s),
                time(|it| it.whole.coverage.t99_s),
            ];
            if run.robots == 1 {
                alone_s = times_s;
            }
            let faster = |k: usize| alone_s[k].zip(times_s[k]).map(|(alone, team)| alone / team);
            let mean =
                |of: fn(&TeamReport) -> f64| line.iter().map(|(_, it)| of(it)).sum::<f64>() / count;
            let sum = |of: fn(&TeamReport) -> u32| line.iter().map(|(_, it)| of(it)).sum::<u32>();
            table.row(vec![
                run.world.name().into(),
                if run.apart { "apart" } else { "beside" }.into(),
                run.radio.into(),
                run.robots.to_string(),
                number(times_s[0], 1),
                number(faster(0), 2),
                number(times_s[1], 1),
                number(faster(1), 2),
                format!("{:.1}", mean(|it| it.whole.path_length_m)),
                format!("{:.2}", mean(|it| it.team.driven_after_another)),
                format!("{:.2}", mean(|it| it.team.measured_twice)),
                sum(|it| it.whole.safety.collisions).to_string(),
                sum(|it| it.whole.safety.robot_contacts.unwrap_or(0)).to_string(),
                sum(|it| u32::from(!it.whole.explored())).to_string(),
            ]);
        }
    }
    table
}
