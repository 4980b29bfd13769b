//! Whole explorations of uneven ground, and their tables.
//!
//! Units in tables: seconds of simulated time, metres, per cent of the ground that can be reached.
//! `climb` is the sum of all changes of the true height, up and down. A crossing is a change
//! between the lowest and the highest tenth of the world's heights along the true path.

use fieldline_protocol::message::{Preference, UnevenGround};
use host_sim::baseline::{Bvp, Session};
use host_sim::link::direct::Direct;
use host_sim::metrics::{MapScore as Truth, crossings};
use host_sim::report::Report;
use host_sim::trial::Record;
use host_sim::trial::mission::Mission;
use host_sim::trial::uneven::{TABLE_I, has_levels, radians};
use host_sim::trial::wording;
use host_sim::world::World;

use crate::digests::Digest;
use crate::flatness::Flatness;
use crate::runs::{FRONTIER, explored};
use crate::table::{Table, number};
use crate::watched::Watched;

/// Share of the world's heights, at either end, that counts as a height level.
const LEVEL: f64 = 0.1;

/// One exploration to run.
#[derive(Clone, Copy, Debug)]
pub struct UnevenRun<'a> {
    /// World to explore.
    pub world: &'a World,
    /// Strategy that plans: [`FRONTIER`] or `bvp`.
    pub strategy: &'a str,
    /// Index of the start in the world.
    pub start: usize,
    /// Seed of the noise.
    pub seed: u64,
    /// Preferences of the field.
    pub preference: Preference,
    /// True if goals have height levels; what is usual with the preference if `None`. A baseline
    /// has none.
    pub levels: Option<bool>,
    /// Standard deviations of ranges, metres, and of roll and pitch, degrees; the usual ones if
    /// `None`.
    pub noise: Option<[f64; 2]>,
    /// Steepest slope that may be driven across, degrees; the usual one if `None`.
    pub roll_deg: Option<f64>,
}

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Summary {
    /// The report.
    pub report: Report,
    /// Preferences of the field, and height levels if they are not the usual ones with them.
    pub preference: String,
    /// How flat the field was.
    pub flatness: Flatness,
    /// Its settings in [`crate::digests`].
    settings: String,
    /// Changes of height level.
    pub crossings: u32,
    /// The map against the true ground.
    pub truth: Truth,
}

impl<'a> UnevenRun<'a> {
    /// Makes a run with the usual preferences and noise.
    #[must_use]
    pub fn of(world: &'a World, start: usize, seed: u64) -> Self {
        Self {
            world,
            strategy: FRONTIER,
            start,
            seed,
            preference: Preference::Both,
            levels: None,
            noise: None,
            roll_deg: None,
        }
    }

    /// Returns the mission.
    #[must_use]
    pub fn mission(&self) -> Mission {
        Mission {
            strategy: self.strategy.into(),
            uneven_ground: Some(UnevenGround {
                preference: self.preference,
                levels: self.levels.unwrap_or(has_levels(self.preference)),
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

    /// Returns the name of the preference in tables.
    fn preference(&self) -> String {
        let name = wording::preference(self.preference).to_owned();
        match self
            .levels
            .filter(|levels| *levels != has_levels(self.preference))
        {
            Some(true) => name + ",levels=on",
            Some(false) => name + ",levels=off",
            None => name,
        }
    }

    /// Returns the settings in [`crate::digests`].
    fn settings(&self) -> String {
        let mut settings = format!("preference={}", self.preference());
        if let Some([laser_m, degrees]) = self.noise {
            let laser_cm = 100.0 * laser_m;
            settings += &format!(",laser={laser_cm:.0}cm,attitude={degrees}deg");
        }
        if let Some(degrees) = self.roll_deg {
            settings += &format!(",roll={degrees}deg");
        }
        settings
    }

    /// Explores over the direct link.
    ///
    /// # Panics
    /// If it cannot begin.
    #[must_use]
    pub fn go(&self) -> Summary {
        let mut flatness = Flatness::default();
        let (report, record) = if self.strategy == "bvp" {
            let planner = Session::new(Bvp::new());
            let mut link = Watched::new(planner, |link, _, _| {
                flatness.note(link.strategy.preferences());
                Ok(())
            });
            explored(&self.mission(), self.world, &mut link)
        } else {
            let mut link = Watched::new(Direct::new(), |link, _, _| {
                flatness.note(link.state().preferences());
                Ok(())
            });
            explored(&self.mission(), self.world, &mut link)
        };
        self.summary(report, &record, flatness)
    }

    /// Summarises a run.
    #[must_use]
    pub fn summary(&self, report: Report, record: &Record, flatness: Flatness) -> Summary {
        Summary {
            report,
            preference: self.preference(),
            flatness,
            settings: self.settings(),
            crossings: crossings_of(self.world, record),
            truth: truth_of(record),
        }
    }
}

/// Counts changes between the lowest and the highest tenth of a world's heights.
fn crossings_of(world: &World, record: &Record) -> u32 {
    let span_m = world.elevation().and_then(|ground| ground.span_m());
    let [low_m, high_m] = span_m.unwrap_or_default();
    let level_m = LEVEL * (high_m - low_m);
    let steps = record.steps.iter();
    let under = steps.filter_map(|step| world.ground_m(step.truth.x_m, step.truth.y_m));
    crossings(under, [low_m + level_m, high_m - level_m])
}

/// Compares the record's map with the true ground.
fn truth_of(record: &Record) -> Truth {
    let ground = record.ground.as_ref();
    ground.map_or_else(Truth::default, |ground| {
        ground.compare(|cell| record.map.get(cell.x, cell.y))
    })
}

/// Makes a table with one line for each run.
#[must_use]
pub fn table(runs: &[Summary]) -> Table {
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
    ];
    let mut table = Table::new(3, &columns);
    for run in runs {
        let (report, safety) = (&run.report, &run.report.safety);
        let ride = report.true_ground.unwrap_or_default();
        table.row(vec![
            report.world.clone(),
            run.preference.clone(),
            format!("{}({})", report.outcome.status, report.outcome.reason),
            report.start.to_string(),
            report.seed.to_string(),
            format!("{:.1}", report.sim_time_s),
            format!("{:.1}", report.path_length_m),
            format!("{:.2}", report.height_change_m),
            format!("{:.2}", 100.0 * report.coverage.fraction),
            safety.collisions.to_string(),
            safety.falls.to_string(),
            safety.tips.to_string(),
            number(safety.min_clearance_m, 3),
            format!("{:.1}", ride.max_pitch_deg),
            format!("{:.1}", ride.max_roll_deg),
            crossings_or_dash(run),
        ]);
    }
    table
}

/// Makes a table with one line for each world and preference: means, sums and extremes.
#[must_use]
pub fn means(runs: &[Summary]) -> Table {
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
        let mean = |of: fn(&Summary) -> f64| group.iter().map(of).sum::<f64>() / count;
        let sum = |of: fn(&Summary) -> u32| group.iter().map(of).sum::<u32>().to_string();
        let known = |run: &Summary| 100.0 * run.report.coverage.fraction;
        let clear = group
            .iter()
            .filter_map(|run| run.report.safety.min_clearance_m);
        let two_levels = first.report.world == "slope";
        table.row(vec![
            first.report.world.clone(),
            first.preference.clone(),
            group.len().to_string(),
            sum(|run| u32::from(run.report.explored())),
            format!("{:.1}", mean(|run| run.report.sim_time_s)),
            format!("{:.1}", mean(|run| run.report.path_length_m)),
            format!("{:.2}", mean(|run| run.report.height_change_m)),
            format!("{:.2}", mean(|run| 100.0 * run.report.coverage.fraction)),
            number(group.iter().map(known).reduce(f64::min), 2),
            sum(|run| run.report.safety.collisions),
            sum(|run| run.report.safety.falls),
            sum(|run| run.report.safety.tips),
            number(clear.reduce(f64::min), 3),
            number(two_levels.then(|| mean(|run| f64::from(run.crossings))), 2),
            match group.iter().map(|run| run.crossings).max() {
                Some(most) if two_levels => most.to_string(),
                _ => "-".into(),
            },
        ]);
    }
    table
}

/// Returns the digests of some runs.
#[must_use]
pub fn digests(runs: &[Summary]) -> Vec<Digest> {
    let digest = |run: &Summary| Digest::of(&run.report, &run.settings);
    runs.iter().map(digest).collect()
}

/// Makes a table in Markdown, for the documentation.
#[must_use]
pub fn markdown(runs: &[Summary]) -> String {
    let mut lines = String::from(
        "| world | time s | path m | climb m | known % | hits, falls, tips | least clearance m |\n\
         | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    for Summary { report, .. } in runs {
        let safety = &report.safety;
        lines.push_str(&format!(
            "| {} | {:.0} | {:.0} | {:.1} | {:.2} | {}, {}, {} | {} |\n",
            report.world,
            report.sim_time_s,
            report.path_length_m,
            report.height_change_m,
            100.0 * report.coverage.fraction,
            safety.collisions,
            safety.falls,
            safety.tips,
            number(safety.min_clearance_m, 2)
        ));
    }
    lines
}

fn key(run: &Summary) -> (&str, &str) {
    (&run.report.world, &run.preference)
}

/// Formats crossings; only the slope has two height levels to cross between.
fn crossings_or_dash(run: &Summary) -> String {
    match run.report.world.as_str() {
        "slope" => run.crossings.to_string(),
        _ => "-".into(),
    }
}
