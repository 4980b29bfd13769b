//! The arguments of `host-sim explore`.

use core::time::Duration;
use std::path::PathBuf;

use clap::{Args, Parser};

use fieldline_protocol::message::UnevenGround;
use host_sim::fence::Polygon;
use host_sim::link::spec::LinkSpec;
use host_sim::network::spec::TeamSpec;
use host_sim::robot::{Disturbances, Limits, Miswiring};
use host_sim::slam::SlamPlace;
use host_sim::slam::particles::ParticleSpec;
use host_sim::trial::itinerary::Pause;
use host_sim::trial::space::Area;
use host_sim::world::Start;

use super::words::{
    FaultArg, GroundArg, Impatience, LogArg, OdometryArg, Place, PrecisionArg, PreferenceArg,
    SwitchArg, ThenArg,
};
use crate::cli::common::{CommonArgs, FolderArgs, PaceArgs, SpaceArgs};
use crate::cli::live::LiveArg;
use crate::cli::robot::RobotArgs;
use crate::cli::strategies;
use crate::cli::values::{
    area, budget, failing, ground_parameters, home_at, impatience, imu_noise, known_pose,
    laser_noise, live, patrol_for, pause, people, period, place, slam_place, snapshots, start,
    sweeps, wait, working,
};

#[derive(Clone, Debug, Args)]
pub(in crate::cli) struct ExploreArgs {
    /// World files (YAML for ROS map servers), names of built-in worlds, or generated worlds
    /// maze:SEED, rooms:SEED, dungeon:SEED, with a size as in rooms:7:40x25; WORLD@N begins at its
    /// start N
    #[arg(value_name = "WORLD[@N]", default_values_t = [String::from("office")])]
    pub(in crate::cli) worlds: Vec<String>,
    /// Strategy: frontier, ouroboros, tdbvp, sbpf or esbpf on the device, or a baseline on the
    /// host: bvp (the converged field of the whole grid), bvp-papers (some sweeps a step, as the
    /// papers ran it) or greedy-frontier
    #[arg(long, default_value = strategies::FRONTIER, value_parser = strategies::parse)]
    pub(in crate::cli) strategy: String,
    /// Ground that the planner expects [default: flat; uneven if --preference, --levels or
    /// --ground-parameters is given]
    #[arg(long, value_enum)]
    pub(in crate::cli) ground: Option<GroundArg>,
    /// Preferences of the field on uneven ground [default: both]
    #[arg(long, value_enum, value_name = "WHICH")]
    pub(in crate::cli) preference: Option<PreferenceArg>,
    /// Height levels of goals on uneven ground: a goal on another level waits [default: on with
    /// --preference height or both, off with off or global]
    #[arg(long, value_enum, value_name = "on|off", hide_possible_values = true)]
    pub(in crate::cli) levels: Option<SwitchArg>,
    #[arg(
        long,
        help = "Parameters of uneven ground, one or more [default: h_obs=0.3, d_obs=1.5, \
                h_hole=-0.6, eps_hmin=-0.5, eps_gmax=0.5, lambda_h=2, lambda_g=0.005, climb=20, \
                roll=20, step=0.07]",
        alias = "terrain",
        value_name = "PARAMETERS",
        value_parser = ground_parameters
    )]
    pub(in crate::cli) ground_parameters: Option<UnevenGround>,
    /// direct, loopback, qemu or serial:DEVICE[@BAUD] [default: loopback; direct for baselines]
    #[arg(long)]
    pub(in crate::cli) link: Option<LinkSpec>,
    /// Index of the world's start pose, from 0; WORLD@N comes first
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = start,
        allow_negative_numbers = true
    )]
    pub(in crate::cli) start: usize,
    /// Source of the pose that the planner is told [default: noisy; truth on uneven ground, for
    /// baselines and with --team]
    #[arg(long, value_enum)]
    pub(in crate::cli) odometry: Option<OdometryArg>,
    /// Correct odometry by the level scan [default: on; off with odometry truth and for baselines]
    #[arg(long, value_enum, value_name = "on|off", hide_possible_values = true)]
    pub(in crate::cli) localise: Option<SwitchArg>,
    /// Standard deviation of roll and pitch, degrees [default: 0 with truth, else 0.5]
    #[arg(long, value_name = "DEG", value_parser = imu_noise, allow_negative_numbers = true)]
    pub(in crate::cli) imu_noise: Option<f64>,
    /// Standard deviation of the lasers' ranges, metres [default: 0.01]
    #[arg(long, value_name = "M", value_parser = laser_noise, allow_negative_numbers = true)]
    pub(in crate::cli) laser_noise: Option<f64>,
    /// Ground that counts as reachable in the report, degrees and metres, one limit or more; no
    /// effect on the planner [default: climb=20,roll=15,step=0.07,drop=0.07]
    #[arg(long, alias = "limits", value_name = "LIMITS", value_parser = working)]
    pub(in crate::cli) working_limits: Option<Limits>,
    /// Ground that stops, drops or tips the robot, one limit or more [default:
    /// climb=30,roll=25,step=0.1,drop=0.15]
    #[arg(long, alias = "failing", value_name = "LIMITS", value_parser = failing)]
    pub(in crate::cli) failing_limits: Option<Limits>,
    #[command(flatten)]
    pub(in crate::cli) pace: PaceArgs,
    /// Milliseconds from one step of the device to the next, 100 to 400
    #[arg(
        long,
        value_name = "MS",
        default_value = "200",
        value_parser = period,
        allow_negative_numbers = true
    )]
    pub(in crate::cli) period: u16,
    /// Simulated seconds of patrol after everything is explored; for tdbvp
    #[arg(
        long,
        value_name = "S",
        default_value = "0",
        value_parser = patrol_for,
        allow_negative_numbers = true
    )]
    pub(in crate::cli) patrol_for: u16,
    #[command(flatten)]
    pub(in crate::cli) space: SpaceArgs,
    /// Known area to explore, least x and y, width and height in metres, as in 0.2,0.2,10,8; for
    /// sbpf and esbpf. It is also the bounds, unless --bounds gives others [default: the bounds of
    /// the world's floor, which bound nothing]
    #[arg(long, value_name = "X,Y,W,H", value_parser = area, allow_negative_numbers = true)]
    pub(in crate::cli) area: Option<Area>,
    /// Polygon that the robot stays inside: corners x0,y0,x1,y1,... in metres of the world's frame,
    /// or two corners of a rectangle; given again, the robot stays inside of all
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    pub(in crate::cli) bounds: Vec<Polygon>,
    /// Polygon that the robot stays out of, as --bounds; may be given again. All polygons together
    /// have at most 32 corners
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    pub(in crate::cli) no_go: Vec<Polygon>,
    /// Saved map (YAML for ROS map servers) that the robot knows at its start: it explores what the
    /// map leaves unknown
    #[arg(long, value_name = "MAP.yaml")]
    pub(in crate::cli) known: Option<PathBuf>,
    /// Where the robot stands in the frame of --known at its start: metres and degrees [default:
    /// that frame is the world's]
    #[arg(long, value_name = "X,Y,DEG", value_parser = known_pose, allow_hyphen_values = true)]
    pub(in crate::cli) known_pose: Option<Start>,
    /// Places to drive to after the exploration, in metres of the world's frame
    #[arg(
        long,
        value_name = "X,Y[;X,Y]",
        value_delimiter = ';',
        value_parser = place,
        allow_hyphen_values = true
    )]
    pub(in crate::cli) goto: Vec<Place>,
    /// What the robot does at the very end: drive home, to its start and first heading
    #[arg(long, value_enum, value_name = "WHAT")]
    pub(in crate::cli) then: Option<ThenArg>,
    /// Metres that the robot may drive: it turns home in time
    #[arg(long, value_name = "M", value_parser = budget)]
    pub(in crate::cli) range_m: Option<u16>,
    /// Simulated seconds that the robot may take: it turns home in time
    #[arg(long, value_name = "S", value_parser = budget)]
    pub(in crate::cli) time_s: Option<u16>,
    /// Simulated seconds after which the robot drives home, whatever it does
    #[arg(long, value_name = "S", value_parser = home_at, allow_negative_numbers = true)]
    pub(in crate::cli) home_at: Option<u32>,
    /// Simulated seconds from which to which the robot stands and waits; may be given again
    #[arg(long, value_name = "A-B", value_parser = pause)]
    pub(in crate::cli) pause: Vec<Pause>,
    /// File of a mission: known map, bounds, no-go polygons, goals, way home, budget and pauses, as
    /// the options say them (docs/MISSIONS.md)
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) mission: Option<PathBuf>,
    /// Simulated seconds without a new place after which tdbvp follows a path to what is left to
    /// explore [default: 15]
    #[arg(
        long,
        value_name = "S|never",
        value_parser = impatience,
        allow_negative_numbers = true
    )]
    pub(in crate::cli) tdbvp_impatience: Option<Impatience>,
    /// Gauss-Seidel sweeps of the whole grid in each step, 1 to 10000; for bvp-papers [default:
    /// 100]
    #[arg(long, value_name = "N", value_parser = sweeps, allow_negative_numbers = true)]
    pub(in crate::cli) bvp_sweeps: Option<u16>,
    /// Type in which the potential is stored; for bvp-papers [default: f64]
    #[arg(long, value_enum, value_name = "TYPE")]
    pub(in crate::cli) bvp_precision: Option<PrecisionArg>,
    #[command(flatten)]
    pub(in crate::cli) folder: FolderArgs,
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
    pub(in crate::cli) live: Option<LiveArg>,
    /// Seconds to wait for a board on a serial port that still boots, at most 600
    #[arg(long, value_name = "S", default_value = "15", value_parser = wait)]
    pub(in crate::cli) wait: Duration,
    /// This robot is one of a team of processes, as in
    /// id=2,bind=0.0.0.0:47002,peers=10.0.0.3:47003+10.0.0.4:47004; also find=GROUP:PORT,
    /// interface=A, key=FILE, pace=N
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) team: Option<TeamSpec>,
    /// Inject faults into the link, as in
    /// drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.01,delay=0.01,reset@900
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) fault: Option<FaultArg>,
    /// Faults of wheels and lasers at simulated seconds, as in
    /// slip@60,spin@70-73,push@80-83,dark@90-92,missing=0.3
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) disturb: Option<Disturbances>,
    /// What is wired wrongly, one or more of mirrored, laser-turned=DEG, lasers-swapped, yaw-sign,
    /// way-sign, wheels-swapped, reversed, millimetres, odometry-times=F, yaw-times=F,
    /// ranges-times=F, turn-time-untold, clock-stands, clock-times=F
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) miswire: Option<Miswiring>,
    /// Number of people who walk about, 0 to 50, on flat ground
    #[arg(long, value_name = "N", default_value_t = 0, value_parser = people)]
    pub(in crate::cli) people: usize,
    /// Compare every step's heading with that of the converged window
    #[arg(long)]
    pub(in crate::cli) check_field: bool,
    /// Give a device that was reset its map back, and go on; with a folder, go on there with a run
    /// that was killed or interrupted
    #[arg(long, value_name = "DIR", num_args = 0..=1)]
    pub(in crate::cli) resume: Option<Option<PathBuf>>,
    /// Close loops by a pose graph, and correct the device's map: off, or host, beside the device
    #[arg(long, value_name = "WHERE", default_value = "off", value_parser = slam_place)]
    pub(in crate::cli) slam: SlamPlace,
    /// A particle filter beside the run, which judges it and changes nothing, as in `300` or
    /// `300,proposal=motion,noise=20`; proposal matched or motion, noise in multiples of the usual
    /// variances for an odometry of its own [default noise: the run's odometry, 20 if that is the
    /// truth]
    #[arg(long, value_name = "SPEC")]
    pub(in crate::cli) particles: Option<ParticleSpec>,
    /// Number of pictures during the run, evenly in simulated time, in the folder snapshots; with
    /// --slam also of the map before and after so many of the largest corrections
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = snapshots,
        allow_negative_numbers = true
    )]
    pub(in crate::cli) snapshots: usize,
    /// Show the run as a film of at most 23 s: a GIF, or an MP4 where ffmpeg is installed
    #[arg(long, value_name = "FILE.gif|FILE.mp4", conflicts_with = "snapshots")]
    pub(in crate::cli) film: Option<PathBuf>,
    /// Record the run in a file that Foxglove, Lichtblick, Rerun and rosbags read, and that
    /// `host-sim replay` runs again
    #[arg(long, value_name = "FILE.mcap")]
    pub(in crate::cli) record: Option<PathBuf>,
    /// Write the cycles of the emulated chip by stage and function, by the model, as folded stacks
    /// for flame graphs; for --link qemu
    #[arg(long, value_name = "FILE")]
    pub(in crate::cli) profile: Option<PathBuf>,
    #[command(flatten)]
    pub(in crate::cli) robot: RobotArgs,
    /// Print during the run what the robot does and why, as in the file mission.log
    #[arg(long, value_name = "WHAT")]
    pub(in crate::cli) log: Option<LogArg>,
    #[command(flatten)]
    pub(in crate::cli) common: CommonArgs,
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
