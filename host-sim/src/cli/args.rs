//! The arguments and what they may be.

use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use fieldline_protocol::message::{Preference, UnevenGround};
use host_sim::link::fault::{Faults, FaultsError};
use host_sim::link::spec::LinkSpec;
use host_sim::robot::{Limits, LimitsError};
use host_sim::trial::uneven::{self, TerrainError};

use super::baselines;

/// Pictures that a run may leave on its way.
const MOST_SNAPSHOTS: usize = 500;

/// Explore simulated buildings with the Fieldline planner; without a command, explore the built-in office.
#[derive(Debug, Parser)]
#[command(name = "host-sim", version)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Explore worlds and leave a folder with report, map, trajectory, commands and picture of each
    Explore(Box<ExploreArgs>),
    /// List the built-in worlds
    Worlds {
        /// One JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// Solve the potential of one window drawn in a text file
    Solve(SolveArgs),
}

#[derive(Debug, Args)]
pub(super) struct ExploreArgs {
    /// World files (YAML for ROS map servers) or names of built-in worlds; WORLD@N starts at its start N
    #[arg(value_name = "WORLD[@N]", default_values_t = [String::from("office")])]
    pub(super) worlds: Vec<String>,
    /// What plans: frontier, ouroboros or tdbvp on the device, terrain there on uneven ground, or a baseline on the host
    #[arg(long, default_value = baselines::FRONTIER, value_parser = baselines::parse)]
    pub(super) strategy: String,
    /// Heed uneven ground, with these preferences in the field [default: both with --strategy terrain, flat ground else]
    #[arg(long, value_enum, value_name = "WHICH")]
    pub(super) preference: Option<PreferenceArg>,
    /// Heed uneven ground, with these parameters, any of [default: h_obs=0.3,d_obs=1.5,h_hole=-0.6,eps_hmin=-0.5,eps_gmax=0.5,lambda_h=2,lambda_g=0.005,climb=20,roll=20,step=0.07]
    #[arg(long, value_name = "PARAMETERS", value_parser = terrain)]
    pub(super) terrain: Option<UnevenGround>,
    /// direct, loopback, qemu or serial:DEVICE[@BAUD] [default: loopback; direct for baselines]
    #[arg(long)]
    pub(super) link: Option<LinkSpec>,
    /// Decides every random number of the run
    #[arg(long, value_name = "N", default_value = "0", value_parser = whole::<u64>, allow_negative_numbers = true)]
    pub(super) seed: u64,
    /// Which of the world's start poses, from 0, where WORLD@N does not say it
    #[arg(long, value_name = "N", default_value = "0", value_parser = whole::<usize>, allow_negative_numbers = true)]
    pub(super) start: usize,
    /// What the robot believes of its motion
    #[arg(long, value_enum, default_value_t = OdometryArg::Truth)]
    pub(super) odometry: OdometryArg,
    /// Standard deviation of roll and pitch, degrees [default: 0 with truth, 0.5 with noisy]
    #[arg(long, value_name = "DEG", value_parser = imu_noise, allow_negative_numbers = true)]
    pub(super) imu_noise: Option<f64>,
    /// Standard deviation of the lasers' ranges, metres [default: 0.01]
    #[arg(long, value_name = "M", value_parser = laser_noise, allow_negative_numbers = true)]
    pub(super) laser_noise: Option<f64>,
    /// Ground that counts as reachable, degrees and metres, any of [default: climb=20,side=15,step=0.07,drop=0.07]
    #[arg(long, value_name = "LIMITS", value_parser = working)]
    pub(super) limits: Option<Limits>,
    /// Ground that the robot does not survive, any of [default: climb=30,side=25,step=0.1,drop=0.15]
    #[arg(long, value_name = "LIMITS", value_parser = failing)]
    pub(super) failing: Option<Limits>,
    /// Simulated seconds after which a run ends
    #[arg(long, value_name = "S", default_value = "3600", value_parser = time_limit, allow_negative_numbers = true)]
    pub(super) time_limit: u32,
    /// Patrol so many simulated seconds once all is explored; for tdbvp
    #[arg(long, value_name = "S", default_value = "0", value_parser = whole::<u16>, allow_negative_numbers = true)]
    pub(super) patrol_for: u16,
    /// Folder of the run; of several runs, the folder of their folders [default: out/WORLD-STRATEGY-SEED]
    #[arg(long, value_name = "DIR")]
    pub(super) out: Option<PathBuf>,
    /// Let simulated time pass no faster than the clock on the wall
    #[arg(long)]
    pub(super) realtime: bool,
    /// Break the link on purpose, as in drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.01,delay=0.01,reset@900
    #[arg(long, value_name = "SPEC")]
    pub(super) fault: Option<FaultArg>,
    /// Extent that the device's map can hold, in metres across and up, as in 128x32 [default: chosen for the world]
    #[arg(long, value_name = "AxB", value_parser = map_shape, allow_hyphen_values = true)]
    pub(super) map_shape: Option<(u8, u8)>,
    /// Compare every step's heading with that of the converged window
    #[arg(long)]
    pub(super) check_field: bool,
    /// Leave so many pictures of the run on its way, evenly in simulated time, in the folder snapshots
    #[arg(long, value_name = "N", default_value = "0", value_parser = snapshots, allow_negative_numbers = true)]
    pub(super) snapshots: usize,
    /// Print the reports, one JSON object a line, and nothing else
    #[arg(long)]
    pub(super) json: bool,
}

impl Default for ExploreArgs {
    fn default() -> Self {
        Self {
            worlds: vec!["office".into()],
            strategy: baselines::FRONTIER.into(),
            preference: None,
            terrain: None,
            link: None,
            seed: 0,
            start: 0,
            odometry: OdometryArg::Truth,
            imu_noise: None,
            laser_noise: None,
            limits: None,
            failing: None,
            time_limit: 3_600_000,
            patrol_for: 0,
            out: None,
            realtime: false,
            fault: None,
            map_shape: None,
            check_field: false,
            snapshots: 0,
            json: false,
        }
    }
}

/// Faults, and the words they were asked for with.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FaultArg {
    pub(super) words: String,
    pub(super) faults: Faults,
}

impl core::str::FromStr for FaultArg {
    type Err = FaultsError;

    fn from_str(words: &str) -> Result<Self, FaultsError> {
        Ok(Self {
            words: words.into(),
            faults: words.parse()?,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PreferenceArg {
    /// None
    Off,
    /// For ground at the robot's own height
    Height,
    /// For all ground, against a field that grows flat
    Global,
    /// Their sum
    Both,
}

impl From<PreferenceArg> for Preference {
    fn from(which: PreferenceArg) -> Self {
        match which {
            PreferenceArg::Off => Self::Off,
            PreferenceArg::Height => Self::Height,
            PreferenceArg::Global => Self::Global,
            PreferenceArg::Both => Self::Both,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum OdometryArg {
    /// The exact pose
    Truth,
    /// Wheel encoders and an inertial unit
    Noisy,
}

#[derive(Debug, Args)]
pub(super) struct SolveArgs {
    /// One character a cell, first line = greatest y: # obstacle, G goal, . free, R robot; at most 61 x 61
    pub(super) window: PathBuf,
    /// Preferences in the same layout, comma-separated, within -2 and 2
    #[arg(long, value_name = "EPS.csv")]
    pub(super) preference: Option<PathBuf>,
    /// Which solver
    #[arg(long, value_enum, default_value_t = SolverArg::Multigrid)]
    pub(super) solver: SolverArg,
    /// Write q = 1 - p of every cell here
    #[arg(long, value_name = "FIELD.csv")]
    pub(super) out: Option<PathBuf>,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SolverArg {
    /// Multigrid, with Gauss-Seidel where it is known to be weak
    Multigrid,
    /// Gauss-Seidel from q = 0
    GaussSeidel,
}

/// A number without sign or point.
fn whole<T: core::str::FromStr>(text: &str) -> Result<T, String> {
    let number = text.parse();
    number.map_err(|_| "give a whole number from 0 on".into())
}

/// Seconds to milliseconds.
fn time_limit(text: &str) -> Result<u32, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 4e6 => Ok((seconds * 1000.0).ceil() as u32),
        _ => Err("give simulated seconds above 0, at most 4000000".into()),
    }
}

/// Pictures of a run: each is read over the link and held until the end.
fn snapshots(text: &str) -> Result<usize, String> {
    match text.parse::<usize>() {
        Ok(number) if number <= MOST_SNAPSHOTS => Ok(number),
        _ => Err(format!("give a whole number from 0 to {MOST_SNAPSHOTS}")),
    }
}

/// The usual working limits, changed.
fn working(text: &str) -> Result<Limits, LimitsError> {
    Limits::WORKING.changed(text)
}

/// The usual failing limits, changed.
fn failing(text: &str) -> Result<Limits, LimitsError> {
    Limits::FAILING.changed(text)
}

/// Table I, changed.
fn terrain(text: &str) -> Result<UnevenGround, TerrainError> {
    uneven::changed(uneven::TABLE_I, text)
}

/// Degrees.
fn imu_noise(text: &str) -> Result<f64, String> {
    deviation(text, 20.0, "degrees")
}

/// Metres.
fn laser_noise(text: &str) -> Result<f64, String> {
    deviation(text, 1.0, "metres")
}

fn deviation(text: &str, most: f64, unit: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.0..=most).contains(&number) => Ok(number),
        _ => Err(format!("give {unit} from 0 to {most}")),
    }
}

/// `AxB` metres to tiles.
fn map_shape(text: &str) -> Result<(u8, u8), String> {
    let side = |text: &str| text.trim().parse::<f64>().ok();
    let sides = text.split_once('x');
    sides
        .and_then(|(a, b)| side(a).zip(side(b)))
        .and_then(|(across_m, up_m)| host_sim::trial::shape::of_metres(across_m, up_m))
        .ok_or_else(|| {
            "give metres across and up, each above 0 and at most 812, as in 128x32".into()
        })
}

#[cfg(test)]
mod tests {
    use super::{Cli, ExploreArgs, imu_noise, laser_noise, map_shape, snapshots, time_limit};
    use clap::{CommandFactory as _, Parser as _};

    #[test]
    fn the_definition_is_sound() {
        Cli::command().debug_assert();
    }

    #[test]
    fn the_defaults_of_the_command_are_those_of_no_command() {
        let cli = Cli::parse_from(["host-sim", "explore"]);
        let Some(super::Command::Explore(args)) = cli.command else {
            panic!("explore");
        };
        assert_eq!(format!("{args:?}"), format!("{:?}", ExploreArgs::default()));
    }

    #[test]
    fn quantities_are_checked() {
        assert_eq!(time_limit("1.5"), Ok(1_500));
        for bad in ["0", "-3", "nan", "inf", "soon", "1e9"] {
            assert!(time_limit(bad).is_err(), "{bad}");
        }
        assert_eq!(imu_noise("1.5"), Ok(1.5));
        assert!(imu_noise("21").is_err() && laser_noise("-0.1").is_err());
        assert!(laser_noise("nan").is_err() && laser_noise("x").is_err());
        assert_eq!((snapshots("0"), snapshots("500")), (Ok(0), Ok(500)));
        assert!(snapshots("501").is_err() && snapshots("-1").is_err());
        assert_eq!(map_shape("128x32"), Ok((40, 10)));
        assert_eq!(map_shape("1 x 1"), Ok((4, 4)));
        for bad in ["128", "x", "-1x5", "0x5", "axb", "nanx3", "infx3", "3x1e9"] {
            assert!(map_shape(bad).is_err(), "{bad}");
        }
    }
}
