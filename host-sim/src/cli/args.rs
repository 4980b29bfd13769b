//! The arguments of the command line; `values.rs` parses their values.

use core::time::Duration;
use std::path::PathBuf;

use clap::{Args, Parser, Subcommand, ValueEnum};

use fieldline_protocol::message::{Preference, UnevenGround};
use host_sim::baseline::bvp_papers::Precision;
use host_sim::fence::Polygon;
use host_sim::link::fault::Faults;
use host_sim::link::spec::LinkSpec;
use host_sim::network::spec::TeamSpec;
use host_sim::robot::{Disturbances, Limits, Miswiring};
use host_sim::slam::SlamPlace;
use host_sim::slam::particles::ParticleSpec;
use host_sim::solve::Solver;
use host_sim::spec::SpecError;
use host_sim::trial::itinerary::Pause;
use host_sim::trial::mission::OdometryProfile;
use host_sim::trial::space::Area;

use super::bringup::BringupArgs;
use super::campaign::CampaignArgs;
use super::common::{CommonArgs, FolderArgs, PaceArgs, SpaceArgs};
use super::live::LiveArg;
use super::replay::ReplayArgs;
use super::robot::RobotArgs;
use super::sessions::{ReplaySessionArgs, SessionsArgs};
use super::strategies;
use super::team::TeamArgs;
use super::values::{
    area, budget, failing, ground_parameters, home_at, impatience, imu_noise, laser_noise, live,
    patrol_for, pause, people, place, slam_place, snapshots, start, sweeps, wait, working,
};

/// Explore simulated worlds with the Fieldline planner; without a command, explore the built-in
/// office
#[derive(Debug, Parser)]
#[command(name = "host-sim", version)]
pub(super) struct Cli {
    #[command(subcommand)]
    pub(super) command: Option<Command>,
}

#[derive(Debug, Subcommand)]
pub(super) enum Command {
    /// Explore worlds; write a folder with report, map, trajectory, commands and picture of each
    Explore(Box<ExploreArgs>),
    /// Bring up a device and its robot in six steps, each with what to do, what is seen and the
    /// remedy
    Bringup(Box<BringupArgs>),
    /// Compare strategies, worlds and options over starts and seeds; write every trial, tables and
    /// plots into a folder, and go on there after a kill
    Campaign(Box<CampaignArgs>),
    /// Explore a world with several robots; write a folder with report, map and picture of the team
    /// and a folder of each robot
    Team(Box<TeamArgs>),
    /// Localise and map along a recorded log; write a folder with map, trajectory and picture
    Replay(Box<ReplayArgs>),
    /// Attack devices with whole sessions, from absurd to plausible; print totals and findings
    Sessions(SessionsArgs),
    /// Replay a session from a file and judge every answer
    ReplaySession(ReplaySessionArgs),
    /// Print what the state of a run holds from which explore --resume goes on
    State {
        /// File session.state, or the folder that has it
        path: PathBuf,
        /// Print one JSON object
        #[arg(long)]
        json: bool,
    },
    /// List the built-in worlds and the kinds of generated ones
    Worlds {
        /// Print one JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// List the robots that are known by name, or print one as a robot file
    Robots {
        /// Preset to print
        #[arg(value_name = "PRESET")]
        name: Option<String>,
        /// Print one JSON object a line
        #[arg(long, conflicts_with = "name")]
        json: bool,
    },
    /// List the planner's tuned constants with meaning, unit, range and default
    Tuning {
        /// One JSON object a line
        #[arg(long)]
        json: bool,
    },
    /// Solve the potential of one window drawn in a text file
    Solve(SolveArgs),
}

#[derive(Clone, Debug, Args)]
pub(super) struct ExploreArgs {
    /// World files (YAML for ROS map servers), names of built-in worlds, or generated worlds
    /// maze:SEED, rooms:SEED, dungeon:SEED, with a size as in rooms:7:40x25; WORLD@N begins at its
    /// start N
    #[arg(value_name = "WORLD[@N]", default_values_t = [String::from("office")])]
    pub(super) worlds: Vec<String>,
    /// Strategy: frontier, ouroboros, tdbvp, sbpf or esbpf on the device, or a baseline on the
    /// host: bvp (the converged field of the whole grid), bvp-papers (some sweeps a step, as the
    /// papers ran it) or greedy-frontier
    #[arg(long, default_value = strategies::FRONTIER, value_parser = strategies::parse)]
    pub(super) strategy: String,
    /// Ground that the planner expects [default: flat; uneven if --preference, --levels or
    /// --ground-parameters is given]
    #[arg(long, value_enum)]
    pub(super) ground: Option<GroundArg>,
    /// Preferences of the field on uneven ground [default: both]
    #[arg(long, value_enum, value_name = "WHICH")]
    pub(super) preference: Option<PreferenceArg>,
    /// Height levels of goals on uneven ground: a goal on another level waits [default: on with
    /// --preference height or both, off with off or global]
    #[arg(long, value_enum, value_name = "on|off", hide_possible_values = true)]
    pub(super) levels: Option<SwitchArg>,
    #[arg(
        long,
        help = "Parameters of uneven ground, one or more [default: h_obs=0.3, d_obs=1.5, \
                h_hole=-0.6, eps_hmin=-0.5, eps_gmax=0.5, lambda_h=2, lambda_g=0.005, climb=20, \
                roll=20, step=0.07]",
        alias = "terrain",
        value_name = "PARAMETERS",
        value_parser = ground_parameters
    )]
    pub(super) ground_parameters: Option<UnevenGround>,
    /// direct, loopback, qemu or serial:DEVICE[@BAUD] [default: loopback; direct for baselines]
    #[arg(long)]
    pub(super) link: Option<LinkSpec>,
    /// Index of the world's start pose, from 0; WORLD@N comes first
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = start,
        allow_negative_numbers = true
    )]
    pub(super) start: usize,
    /// Source of the pose that the planner is told [default: noisy; truth on uneven ground, for
    /// baselines and with --team]
    #[arg(long, value_enum)]
    pub(super) odometry: Option<OdometryArg>,
    /// Correct odometry by the level scan [default: on; off with odometry truth and for baselines]
    #[arg(long, value_enum, value_name = "on|off", hide_possible_values = true)]
    pub(super) localise: Option<SwitchArg>,
    /// Standard deviation of roll and pitch, degrees [default: 0 with truth, else 0.5]
    #[arg(long, value_name = "DEG", value_parser = imu_noise, allow_negative_numbers = true)]
    pub(super) imu_noise: Option<f64>,
    /// Standard deviation of the lasers' ranges, metres [default: 0.01]
    #[arg(long, value_name = "M", value_parser = laser_noise, allow_negative_numbers = true)]
    pub(super) laser_noise: Option<f64>,
    /// Ground that counts as reachable in the report, degrees and metres, one limit or more; no
    /// effect on the planner [default: climb=20,roll=15,step=0.07,drop=0.07]
    #[arg(long, alias = "limits", value_name = "LIMITS", value_parser = working)]
    pub(super) working_limits: Option<Limits>,
    /// Ground that stops, drops or tips the robot, one limit or more [default:
    /// climb=30,roll=25,step=0.1,drop=0.15]
    #[arg(long, alias = "failing", value_name = "LIMITS", value_parser = failing)]
    pub(super) failing_limits: Option<Limits>,
    #[command(flatten)]
    pub(super) pace: PaceArgs,
    /// Simulated seconds of patrol after everything is explored; for tdbvp
    #[arg(
        long,
        value_name = "S",
        default_value = "0",
        value_parser = patrol_for,
        allow_negative_numbers = true
    )]
    pub(super) patrol_for: u16,
    #[command(flatten)]
    pub(super) space: SpaceArgs,
    /// Known area to explore, least x and y, width and height in metres, as in 0.2,0.2,10,8; for
    /// sbpf and esbpf. It is also the bounds, unless --bounds gives others [default: the bounds of
    /// the world's floor, which bound nothing]
    #[arg(long, value_name = "X,Y,W,H", value_parser = area, allow_negative_numbers = true)]
    pub(super) area: Option<Area>,
    /// Polygon that the robot stays inside: corners x0,y0,x1,y1,... in metres of the world's frame,
    /// or two corners of a rectangle; given again, the robot stays inside of all
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    pub(super) bounds: Vec<Polygon>,
    /// Polygon that the robot stays out of, as --bounds; may be given again. All polygons together
    /// have at most 32 corners
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    pub(super) no_go: Vec<Polygon>,
    /// Places to drive to after the exploration, in metres of the world's frame
    #[arg(
        long,
        value_name = "X,Y[;X,Y]",
        value_delimiter = ';',
        value_parser = place,
        allow_hyphen_values = true
    )]
    pub(super) goto: Vec<Place>,
    /// What the robot does at the very end: drive home, to its start and first heading
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(super) then: Option<ThenArg>,
    /// Metres that the robot may drive: it turns home in time
    #[arg(long, value_name = "M", value_parser = budget)]
    pub(super) range_m: Option<u16>,
    /// Simulated seconds that the robot may take: it turns home in time
    #[arg(long, value_name = "S", value_parser = budget)]
    pub(super) time_s: Option<u16>,
    /// Simulated seconds after which the robot drives home, whatever it does
    #[arg(long, value_name = "S", value_parser = home_at, allow_negative_numbers = true)]
    pub(super) home_at: Option<u32>,
    /// Simulated seconds from which to which the robot stands and waits; may be given again
    #[arg(long, value_name = "A-B", value_parser = pause)]
    pub(super) pause: Vec<Pause>,
    /// File of a mission: bounds, no-go polygons, goals, way home, budget and pauses, as the
    /// options say them (docs/MISSIONS.md)
    #[arg(long, value_name = "FILE")]
    pub(super) mission: Option<PathBuf>,
    /// Simulated seconds without a new place after which tdbvp follows a path to what is left to
    /// explore [default: 15]
    #[arg(
        long,
        value_name = "S|never",
        value_parser = impatience,
        allow_negative_numbers = true
    )]
    pub(super) tdbvp_impatience: Option<Impatience>,
    /// Gauss-Seidel sweeps of the whole grid in each step, 1 to 10000; for bvp-papers [default:
    /// 100]
    #[arg(long, value_name = "N", value_parser = sweeps, allow_negative_numbers = true)]
    pub(super) bvp_sweeps: Option<u16>,
    /// Type in which the potential is stored; for bvp-papers [default: f64]
    #[arg(long, value_enum, value_name = "TYPE")]
    pub(super) bvp_precision: Option<PrecisionArg>,
    #[command(flatten)]
    pub(super) folder: FolderArgs,
    /// Serve a page that shows the run while it runs, and takes requests: with ADDR:PORT there,
    /// else at 127.0.0.1:8047 or a free port. The page stays after the run while it is open, and
    /// 60 s; Ctrl-C ends it. Another address than loopback gets a token
    #[arg(
        long,
        value_name = "ADDR:PORT",
        num_args = 0..=1,
        default_missing_value = "usual",
        value_parser = live
    )]
    pub(super) live: Option<LiveArg>,
    /// Seconds to wait for a board on a serial port that still boots, at most 600
    #[arg(long, value_name = "S", default_value = "15", value_parser = wait)]
    pub(super) wait: Duration,
    /// This robot is one of a team of processes, as in
    /// id=2,bind=0.0.0.0:47002,peers=10.0.0.3:47003+10.0.0.4:47004; also find=GROUP:PORT,
    /// interface=A, key=FILE, pace=N
    #[arg(long, value_name = "SPEC")]
    pub(super) team: Option<TeamSpec>,
    /// Inject faults into the link, as in
    /// drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.01,delay=0.01,reset@900
    #[arg(long, value_name = "SPEC")]
    pub(super) fault: Option<FaultArg>,
    /// Faults of wheels and lasers at simulated seconds, as in
    /// slip@60,spin@70-73,push@80-83,dark@90-92,missing=0.3
    #[arg(long, value_name = "SPEC")]
    pub(super) disturb: Option<Disturbances>,
    /// What is wired wrongly, one or more of mirrored, laser-turned=DEG, lasers-swapped, yaw-sign,
    /// way-sign, wheels-swapped, reversed, millimetres, odometry-times=F, yaw-times=F,
    /// ranges-times=F, clock-stands, clock-times=F
    #[arg(long, value_name = "SPEC")]
    pub(super) miswire: Option<Miswiring>,
    /// Number of people who walk about, 0 to 50, on flat ground
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = people)]
    pub(super) people: usize,
    /// Compare every step's heading with that of the converged window
    #[arg(long)]
    pub(super) check_field: bool,
    /// Give a device that was reset its map back, and go on; with a folder, go on there with a run
    /// that was killed or interrupted
    #[arg(long, value_name = "DIR", num_args = 0..=1)]
    pub(super) resume: Option<Option<PathBuf>>,
    /// Close loops by a pose graph, and correct the device's map: off, or host, beside the device
    #[arg(long, value_name = "WHERE", default_value = "off", value_parser = slam_place)]
    pub(super) slam: SlamPlace,
    /// A particle filter beside the run, which judges it and changes nothing, as in `300` or
    /// `300,proposal=motion,noise=20`; proposal matched or motion, noise in multiples of the usual
    /// variances for an odometry of its own [default noise: the run's odometry, 20 if that is the
    /// truth]
    #[arg(long, value_name = "SPEC")]
    pub(super) particles: Option<ParticleSpec>,
    /// Number of pictures during the run, evenly in simulated time, in the folder snapshots; with
    /// --slam also of the map before and after so many of the largest corrections
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = snapshots,
        allow_negative_numbers = true
    )]
    pub(super) snapshots: usize,
    #[command(flatten)]
    pub(super) robot: RobotArgs,
    /// Print during the run what the robot does and why, as in the file mission.log
    #[arg(long, value_name = "WHAT")]
    pub(super) log: Option<LogArg>,
    #[command(flatten)]
    pub(super) common: CommonArgs,
}

impl Default for ExploreArgs {
    /// What an empty command line gives.
    fn default() -> Self {
        #[derive(Parser)]
        struct Bare {
            #[command(flatten)]
            args: ExploreArgs,
        }
        Bare::parse_from(["host-sim"]).args
    }
}

/// A log that is printed during a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum LogArg {
    /// What the robot does and why
    Mission,
}

/// What follows the exploration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum ThenArg {
    /// Drive home
    Home,
}

/// A place, metres.
pub(super) type Place = [f64; 2];

/// Seconds without a new place; `None` for never.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Impatience(pub(super) Option<u16>);

/// Faults, and the text that names them.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct FaultArg {
    pub(super) text: String,
    pub(super) faults: Faults,
}

impl core::str::FromStr for FaultArg {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        Ok(Self {
            text: text.into(),
            faults: text.parse()?,
        })
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum GroundArg {
    /// Take all ground for level
    Flat,
    /// Measure heights; avoid steps, slopes and holes
    Uneven,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PreferenceArg {
    /// No preference
    Off,
    /// Prefer ground at the robot's own height
    Height,
    /// One preference for the whole window, which grows as the field becomes flat
    Global,
    /// The sum of both
    Both,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum PrecisionArg {
    /// Single precision
    F32,
    /// Double precision
    F64,
}

impl From<PrecisionArg> for Precision {
    fn from(precision: PrecisionArg) -> Self {
        match precision {
            PrecisionArg::F32 => Self::F32,
            PrecisionArg::F64 => Self::F64,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum SwitchArg {
    On,
    Off,
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
    /// The true pose
    Truth,
    /// Wheel encoders and an inertial unit, with errors
    Noisy,
    /// Variances 20 times larger, as in the papers
    Papers,
    /// Scale errors of 0.75 %, no random walk
    Mobilesim,
}

impl From<OdometryArg> for OdometryProfile {
    fn from(which: OdometryArg) -> Self {
        match which {
            OdometryArg::Truth => Self::Truth,
            OdometryArg::Noisy => Self::Noisy,
            OdometryArg::Papers => Self::Papers,
            OdometryArg::Mobilesim => Self::MobileSim,
        }
    }
}

#[derive(Debug, Args)]
pub(super) struct SolveArgs {
    /// Text file of at most 61 x 61 characters, one a cell, greatest y first: # obstacle, G goal,
    /// . free, R robot
    pub(super) window: PathBuf,
    /// Preferences in the same layout, comma-separated, from -2 to 2
    #[arg(long, value_name = "EPS.csv")]
    pub(super) preference: Option<PathBuf>,
    /// Solver
    #[arg(long, value_enum, default_value_t = Solver::Multigrid)]
    pub(super) solver: Solver,
    /// File for q = 1 - p of every cell
    #[arg(long, value_name = "FIELD.csv")]
    pub(super) out: Option<PathBuf>,
    /// Print the answer as one JSON object
    #[arg(long)]
    pub(super) json: bool,
}

#[cfg(test)]
mod tests {
    use super::{Cli, ExploreArgs};
    use clap::{CommandFactory as _, Parser as _};

    #[test]
    fn the_definition_of_the_arguments_is_valid() {
        Cli::command().debug_assert();
    }

    #[test]
    fn no_command_is_explore_with_its_defaults() {
        let cli = Cli::parse_from(["host-sim", "explore"]);
        let Some(super::Command::Explore(args)) = cli.command else {
            panic!("explore");
        };
        let usual = ExploreArgs::default();
        assert_eq!(format!("{args:?}"), format!("{usual:?}"));
        assert_eq!(
            (usual.worlds, usual.strategy),
            (vec!["office".into()], "frontier".into())
        );
        assert_eq!(
            (usual.pace.time_limit, usual.wait.as_secs()),
            (3_600_000, 15)
        );
    }
}
