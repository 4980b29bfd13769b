//! Explorations with odometry that drifts: runs, sweeps over its profiles, and their tables.
//!
//! Every table has the same columns in its middle: how the run ended, its seed, the share of the
//! ground that the robot truly saw, the simulated time, and the mean and greatest position error.
//!
//! Units: per cent, seconds, metres.

use core::ops::Range;

use fieldline_planner::Tuning;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::world::World;

use crate::runs;
use crate::table::{Table, number};
use crate::uneven::UnevenRun;

/// Columns in the middle of every table, and the one of them that holds words.
const SHARED: [&str; 6] = ["end", "seed", "seen %", "s", "mean m", "max m"];
const SHARED_WORDS: usize = 1;

/// Errors of the odometry, and what the device does about them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Setting {
    /// Errors of the odometry.
    pub odometry: OdometryProfile,
    /// True if the device corrects odometry.
    pub localise: bool,
}

impl Setting {
    /// The true pose.
    pub const TRUTH: Self = Self::uncorrected(OdometryProfile::Truth);

    /// Returns odometry that the device corrects.
    #[must_use]
    pub const fn corrected(odometry: OdometryProfile) -> Self {
        Self {
            odometry,
            localise: true,
        }
    }

    /// Returns odometry that the device takes as it is.
    #[must_use]
    pub const fn uncorrected(odometry: OdometryProfile) -> Self {
        Self {
            odometry,
            localise: false,
        }
    }

    /// Returns the usual mission with this odometry.
    #[must_use]
    pub fn mission(self, seed: u64) -> Mission {
        Mission {
            seed,
            odometry: self.odometry,
            localise: self.localise,
            ..Mission::default()
        }
    }

    /// Returns the true pose, then each profile corrected and as it is.
    #[must_use]
    pub fn beside_truth(noise: &[OdometryProfile]) -> Vec<Self> {
        let both = |&odometry| [Self::corrected(odometry), Self::uncorrected(odometry)];
        let noise = noise.iter().flat_map(both);
        core::iter::once(Self::TRUTH).chain(noise).collect()
    }
}

/// One exploration from a world's first start.
#[derive(Clone, Copy, Debug)]
pub struct Drive<'a> {
    /// World to explore. On uneven ground the preferences are the usual ones.
    pub world: &'a World,
    /// Seed of the noise.
    pub seed: u64,
    /// Odometry.
    pub setting: Setting,
    /// Tuned constants.
    pub tuning: &'static Tuning,
    /// Number of people who walk about.
    pub people: usize,
}

impl Drive<'_> {
    /// Explores over the direct link.
    ///
    /// # Panics
    /// If it cannot begin.
    #[must_use]
    pub fn go(&self) -> Report {
        let usual = match self.world.elevation() {
            Some(_) => UnevenRun::of(self.world, 0, self.seed).mission(),
            None => Mission::default(),
        };
        let mission = Mission {
            seed: self.seed,
            odometry: self.setting.odometry,
            localise: self.setting.localise,
            people: self.people,
            ..usual
        };
        runs::explored(&mission, self.world, &mut Direct::tuned(self.tuning)).0
    }
}

/// Returns the runs of each world, seed and setting, in this order, with the usual constants and
/// without people.
#[must_use]
pub fn sweep<'a>(worlds: &'a [World], seeds: &Range<u64>, settings: &[Setting]) -> Vec<Drive<'a>> {
    let mut drives = Vec::new();
    for world in worlds {
        for seed in seeds.clone() {
            drives.extend(settings.iter().map(|&setting| Drive {
                world,
                seed,
                setting,
                tuning: &Tuning::DEFAULT,
                people: 0,
            }));
        }
    }
    drives
}

/// Makes a table of runs: the world, columns that tell the setting (words), the shared ones, and
/// more (numbers). `cells` returns those of a run in the columns before and after the shared ones.
#[must_use]
pub fn table(
    reports: &[Report],
    setting: &[&str],
    more: &[&str],
    cells: impl Fn(&Report) -> (Vec<String>, Vec<String>),
) -> Table {
    let columns = [&["world"], setting, &SHARED, more].concat();
    let mut table = Table::new(1 + setting.len() + SHARED_WORDS, &columns);
    for report in reports {
        let (setting, more) = cells(report);
        table.row([vec![report.world.clone()], setting, shared(report), more].concat());
    }
    table
}

fn shared(report: &Report) -> Vec<String> {
    let at = &report.localization;
    vec![
        report.outcome.reason.clone(),
        report.seed.to_string(),
        number(Some(100.0 * report.coverage.fraction), 2),
        number(Some(report.sim_time_s), 1),
        number(at.mean_error_m, 3),
        number(at.max_error_m, 3),
    ]
}

/// Lists what is wrong with an exploration whose odometry is corrected: as [`runs::faults`], and a
/// mean position error above `most_mean_m`.
#[must_use]
pub fn faults(report: &Report, least_seen: f64, most_mean_m: f64) -> Vec<String> {
    let mut faults = runs::faults(report, least_seen);
    let mean_m = report.localization.mean_error_m.unwrap_or(f64::MAX);
    if mean_m > most_mean_m {
        faults.push(format!("mean error {mean_m:.3} m"));
    }
    faults
}
