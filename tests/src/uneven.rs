//! Whole explorations of uneven ground, and what a table says of each.
//!
//! Units in tables: seconds of simulated time, metres, per cent of the ground that can be reached. `climb` is the sum of the true height's changes,
//! up and down. A crossing is a change between the lowest and the highest tenth of the world's heights along the true path.

use fieldline_protocol::message::{Preference, UnevenGround};
use host_sim::link::direct::Direct;
use host_sim::metrics::{MapScore as Truth, crossings};
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::{Mission, TERRAIN};
use host_sim::trial::uneven::{TABLE_I, radians};
use host_sim::world::World;

use crate::runs::explored;
use crate::table::{Table, number};

/// Share of the world's heights at either end that counts as a storey.
const STOREY: f64 = 0.1;

/// One exploration.
#[derive(Clone, Copy, Debug)]
pub struct Tour<'a> {
    /// Where.
    pub world: &'a World,
    /// Which of the world's starts.
    pub start: usize,
    /// Decides the noise.
    pub seed: u64,
    /// Which preferences.
    pub preference: Preference,
    /// Standard deviations of ranges, metres, and of roll and pitch, degrees; the usual ones if `None`.
    pub noise: Option<[f64; 2]>,
    /// Steepest slope that may be driven across, degrees; the usual one if `None`.
    pub roll_deg: Option<f64>,
}

/// What became of it.
#[derive(Clone, Debug)]
pub struct Told {
    /// The report.
    pub report: Report,
    /// Which preferences it had.
    pub preference: Preference,
    /// Changes of storey.
    pub crossings: u32,
    /// The map against the true ground.
    pub truth: Truth,
}

impl<'a> Tour<'a> {
    /// With the usual preferences and noise.
    #[must_use]
    pub fn of(world: &'a World, start: usize, seed: u64) -> Self {
        Self {
            world,
            start,
            seed,
            preference: Preference::Both,
            noise: None,
            roll_deg: None,
        }
    }

    /// What it asks for.
    #[must_use]
    pub fn mission(&self) -> Mission {
        Mission {
            strategy: TERRAIN.into(),
            terrain: Some(UnevenGround {
                preference: self.preference,
                roll: self.roll_deg.map_or(TABLE_I.roll, radians),
                ..TABLE_I
            }),
            seed: self.seed,
            start: self.start,
            laser_m: self.noise.map(|[laser_m, _]| laser_m),
            imu_rad: self.noise.map(|[_, degrees]| degrees.to_radians()),
            ..Mission::default()
        }
    }

    /// Explore by the direct link.
    ///
    /// # Panics
    /// If it cannot begin.
    #[must_use]
    pub fn go(&self) -> Told {
        let (report, record) = explored(&self.mission(), self.world, &mut Direct::new());
        self.told(report, &record)
    }

    /// What is kept of a run.
    #[must_use]
    pub fn told(&self, report: Report, record: &Record) -> Told {
        Told {
            report,
            preference: self.preference,
            crossings: crossings_of(self.world, record),
            truth: truth_of(record),
        }
    }
}

/// Changes between the lowest and the highest tenth of a world's heights along the true path.
fn crossings_of(world: &World, record: &Record) -> u32 {
    let span_m = world.elevation().and_then(|ground| ground.span_m());
    let [low_m, high_m] = span_m.unwrap_or_default();
    let storey_m = STOREY * (high_m - low_m);
    let steps = record.steps.iter();
    let under = steps.filter_map(|step| world.ground_m(step.truth.x_m, step.truth.y_m));
    crossings(under, [low_m + storey_m, high_m - storey_m])
}

/// The record's map against the true ground.
fn truth_of(record: &Record) -> Truth {
    let ground = record.ground.as_ref();
    ground.map_or_else(Truth::default, |ground| {
        ground.compare(|cell| record.map.get(cell.x, cell.y))
    })
}

/// One line a run.
#[must_use]
pub fn table(runs: &[Told]) -> Table {
    let columns = [
        "world",
        "preference",
        "ended",
        "start",
        "seed",
        "time s",
        "path m",
        "climb m",
        "known %",
        "hits",
        "falls",
        "tips",
        "clear m",
        "pitch deg",
        "roll deg",
        "crossings",
        "digest",
    ];
    let mut table = Table::new(3, &columns);
    for run in runs {
        let (report, safety) = (&run.report, &run.report.safety);
        let ride = report.terrain.unwrap_or_default();
        table.row(vec![
            report.world.clone(),
            word(run.preference).into(),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            report.start.to_string(),
            report.seed.to_string(),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            format!("{:.2}", report.climb_m),
            format!("{:.2}", 100.0 * report.coverage.fraction),
            safety.collisions.to_string(),
            safety.falls.to_string(),
            safety.tips.to_string(),
            number(safety.min_clearance_m, 3),
            format!("{:.1}", ride.max_climb_deg),
            format!("{:.1}", ride.max_side_deg),
            crossings_or_dash(run),
            report.digest.chars().take(8).collect(),
        ]);
    }
    table
}

/// One line for each world and preference: means, sums and extremes of its runs.
#[must_use]
pub fn means(runs: &[Told]) -> Table {
    let columns = [
        "world",
        "preference",
        "runs",
        "explored",
        "time s",
        "path m",
        "climb m",
        "known %",
        "least %",
        "hits",
        "falls",
        "tips",
        "clear m",
        "crossings",
        "most",
    ];
    let mut table = Table::new(2, &columns);
    for group in runs.chunk_by(|a, b| key(a) == key(b)) {
        let (first, count) = (&group[0], group.len() as f64);
        let mean = |of: fn(&Told) -> f64| group.iter().map(of).sum::<f64>() / count;
        let sum = |of: fn(&Told) -> u32| group.iter().map(of).sum::<u32>().to_string();
        let known = |run: &Told| 100.0 * run.report.coverage.fraction;
        let clear = group
            .iter()
            .filter_map(|run| run.report.safety.min_clearance_m);
        let storeys = first.report.world == "slope";
        table.row(vec![
            first.report.world.clone(),
            word(first.preference).into(),
            group.len().to_string(),
            sum(|run| u32::from(run.report.explored())),
            format!("{:.1}", mean(|run| run.report.sim_time_s)),
            format!("{:.1}", mean(|run| run.report.path_length_m)),
            format!("{:.2}", mean(|run| run.report.climb_m)),
            format!("{:.2}", mean(|run| 100.0 * run.report.coverage.fraction)),
            number(group.iter().map(known).reduce(f64::min), 2),
            sum(|run| run.report.safety.collisions),
            sum(|run| run.report.safety.falls),
            sum(|run| run.report.safety.tips),
            number(clear.reduce(f64::min), 3),
            number(storeys.then(|| mean(|run| f64::from(run.crossings))), 2),
            match group.iter().map(|run| run.crossings).max() {
                Some(most) if storeys => most.to_string(),
                _ => "-".into(),
            },
        ]);
    }
    table
}

/// One line a run in Markdown, for the read-me.
#[must_use]
pub fn markdown(runs: &[Told]) -> String {
    let mut lines = String::from(
        "| world | time s | path m | climb m | known % | hits, falls, tips | least clearance m |\n| --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for Told { report, .. } in runs {
        let safety = &report.safety;
        lines.push_str(&format!(
            "| {} | {:.0} | {:.0} | {:.1} | {:.2} | {}, {}, {} | {} |\n",
            report.world,
            report.sim_time_s,
            report.path_length_m,
            report.climb_m,
            100.0 * report.coverage.fraction,
            safety.collisions,
            safety.falls,
            safety.tips,
            number(safety.min_clearance_m, 2)
        ));
    }
    lines
}

/// How the maps of some runs compare with the true ground, class by class: one line for each world and one for all.
#[must_use]
pub fn truths(runs: &[Told]) -> Table {
    let columns = [
        "world",
        "free P",
        "R",
        "obstacle P",
        "R",
        "negative P",
        "R",
        "unknown P",
        "R",
        "negative by name",
    ];
    let mut table = Table::new(1, &columns);
    let mut line = |name: &str, truth: &Truth| {
        let scores = [
            truth.traversable,
            truth.obstacle,
            truth.negative,
            truth.unknown,
        ];
        let shares = scores
            .iter()
            .flat_map(|score| [score.precision, score.recall]);
        let mut row = vec![name.to_owned()];
        row.extend(shares.map(|share| number(share, 4)));
        row.push(number(truth.negative_by_name, 4));
        table.row(row);
    };
    let pool = |runs: &[Told]| {
        runs.iter()
            .map(|run| run.truth)
            .fold(Truth::default(), |a, b| a + b)
    };
    for group in runs.chunk_by(|a, b| a.report.world == b.report.world) {
        line(&group[0].report.world, &pool(group));
    }
    line("all", &pool(runs));
    table
}

/// Cells of all maps of some runs by true class and class of the map.
#[must_use]
pub fn confusion(runs: &[Told]) -> Table {
    let all = runs
        .iter()
        .map(|run| run.truth)
        .fold(Truth::default(), |a, b| a + b);
    let mut table = Table::new(1, &["truly", "unknown", "free", "obstacle", "negative"]);
    for (name, row) in [
        "traversable",
        "obstacle",
        "negative",
        "either",
        "out of reach",
    ]
    .iter()
    .zip(all.cells)
    {
        let mut cells = vec![(*name).to_owned()];
        cells.extend(row.map(|count| count.to_string()));
        table.row(cells);
    }
    table
}

fn key(run: &Told) -> (&str, Preference) {
    (&run.report.world, run.preference)
}

/// Crossings mean something where there are two storeys.
fn crossings_or_dash(run: &Told) -> String {
    match run.report.world.as_str() {
        "slope" => run.crossings.to_string(),
        _ => "-".into(),
    }
}

/// A preference as the command line calls it.
#[must_use]
pub fn word(preference: Preference) -> &'static str {
    match preference {
        Preference::Off => "off",
        Preference::Height => "height",
        Preference::Global => "global",
        Preference::Both => "both",
    }
}
