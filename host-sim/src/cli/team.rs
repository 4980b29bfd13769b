//! `host-sim team`: several robots explore one world; writes a folder and a report.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use anyhow::{Context as _, Result, bail};
use clap::Args;

use host_sim::baseline::bvp_papers::Relaxation;
use host_sim::fence::Polygon;
use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::picture::{TeamScene, team_png};
use host_sim::radio::{MOST_ROBOTS, RadioSpec};
use host_sim::report::tum::Stamped;
use host_sim::report::{MadeBy, TeamReport, folder};
use host_sim::slam::SlamPlace;
use host_sim::trial::mission::on_device;
use host_sim::trial::surprises::surprises;
use host_sim::trial::team::{
    Appointment, StartError, TeamError, TeamMission, TeamRecord, Timetable, explore, starts,
};
use host_sim::world::World;

use super::args::{ExploreArgs, GroundArg, OdometryArg};
use super::common::{CommonArgs, FolderArgs, PaceArgs, SpaceArgs};
use super::explore::with_start;
use super::live::LiveArg;
use super::mission::mission;
use super::pictures::Album;
use super::progress::{Interrupt, Onlooker};
use super::recording::Recorder;
use super::robot::RobotArgs;
use super::values::{live as live_place, slam_place, start};
use super::{cycles, live, made_by, note, note_build, say, strategies};

#[derive(Clone, Debug, Args)]
pub(super) struct TeamArgs {
    /// World, as for explore; WORLD@N begins at its start N
    #[arg(value_name = "WORLD[@N]", default_value = "office")]
    world: String,
    /// Number of robots, 1 to 8; their numbers begin with 0
    #[arg(
        long,
        value_name = "N",
        default_value = "2",
        value_parser = robots,
        allow_negative_numbers = true
    )]
    robots: usize,
    /// Strategy of all robots, as for explore; a baseline needs --radio off
    #[arg(long, default_value = strategies::FRONTIER, value_parser = strategies::parse)]
    strategy: String,
    /// Ground that the planners expect [default: flat]
    #[arg(long, value_enum)]
    ground: Option<GroundArg>,
    /// Start far apart, at the world's starts; else side by side around one start
    #[arg(long)]
    apart: bool,
    /// Radio between the robots: off, or any of range=M,walls=M,walls=block,loss=P,duplicate=P,
    /// delay=S,reorder=P,partition@A-B,partition@A-B:0/12 [default: perfect]
    #[arg(long, value_name = "SPEC")]
    radio: Option<RadioSpec>,
    /// A robot leaves the team after so many seconds, as in 2@90: it stands and is silent
    #[arg(
        long,
        value_name = "ROBOT@S",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    leave: Vec<Appointment>,
    /// A robot that left joins again after so many seconds, where it stands, with an empty map
    #[arg(
        long,
        value_name = "ROBOT@S",
        value_delimiter = ',',
        allow_hyphen_values = true
    )]
    join: Vec<Appointment>,
    /// Polygon that all robots stay inside: corners x0,y0,x1,y1,... in metres of the team's frame,
    /// which is the world's, or two corners of a rectangle; given again, they stay inside of all
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    bounds: Vec<Polygon>,
    /// Polygon that all robots stay out of, as --bounds; may be given again. All polygons together
    /// have at most 32 corners
    #[arg(long, value_name = "CORNERS", allow_hyphen_values = true)]
    no_go: Vec<Polygon>,
    #[command(flatten)]
    space: SpaceArgs,
    /// Link of all robots, or a list with the link of each, as in direct,direct,qemu [default:
    /// loopback; direct for baselines]
    #[arg(long, value_name = "LINK,LINK", value_delimiter = ',')]
    link: Vec<LinkSpec>,
    /// Index of the world's start pose for robot 0, from 0; WORLD@N comes first
    #[arg(
        long,
        value_name = "N",
        default_value = "0",
        value_parser = start,
        allow_negative_numbers = true
    )]
    start: usize,
    /// Source of the pose that the planners are told
    #[arg(long, value_enum, default_value_t = OdometryArg::Truth)]
    odometry: OdometryArg,
    /// Standard deviations of the starts that all robots but the first are told, metres and
    /// degrees, as in 0.3,5 [default: the starts are known]
    #[arg(long, value_name = "M,DEG")]
    start_error: Option<StartError>,
    /// Where loops are closed and the maps corrected, robot by robot: off, host
    #[arg(long, value_name = "WHERE", default_value = "off", value_parser = slam_place)]
    slam: SlamPlace,
    /// Record each robot into FOLDER/robot-N.mcap, as explore --record does; --force replaces
    /// files that are there
    #[arg(long, value_name = "FOLDER")]
    record: Option<PathBuf>,
    /// Serve a page of each robot while they run, at ports one after another from ADDR:PORT on,
    /// else from 127.0.0.1:8047; as explore --live, but a robot of a team takes no requests
    #[arg(
        long,
        value_name = "ADDR:PORT",
        num_args = 0..=1,
        default_missing_value = "usual",
        value_parser = live_place
    )]
    live: Option<LiveArg>,
    #[command(flatten)]
    pace: PaceArgs,
    #[command(flatten)]
    folder: FolderArgs,
    #[command(flatten)]
    robot: RobotArgs,
    #[command(flatten)]
    common: CommonArgs,
}

/// Parses the number of robots.
fn robots(text: &str) -> Result<usize, String> {
    let number = text.parse().ok();
    number
        .filter(|number| (1..=MOST_ROBOTS).contains(number))
        .ok_or_else(|| format!("give 1 to {MOST_ROBOTS} robots"))
}

/// Explores a world with a team; returns true if it ended explored.
pub(super) fn run(args: &TeamArgs) -> Result<bool> {
    let links = links(args)?;
    if args.slam != SlamPlace::Off && args.ground == Some(GroundArg::Uneven) {
        bail!("--slam corrects a team's maps on flat ground; say --ground flat, or --slam off");
    }
    strategies::check_space(&args.strategy, args.space.is_given())?;
    let (name, at) = with_start(&args.world);
    let world = World::open(name)?;
    let team = TeamMission {
        mission: mission(&common(args, at.unwrap_or(args.start)), &links[0])?,
        robots: args.robots,
        links: links.iter().map(ToString::to_string).collect(),
        apart: args.apart,
        places: None,
        start_error: args.start_error.unwrap_or_default(),
        radio: radio(args)?,
        timetable: Timetable {
            leave: args.leave.clone(),
            join: args.join.clone(),
        },
    };
    starts(&team, &world)?;
    let folder = args.folder.out.clone().unwrap_or_else(|| {
        let (world, strategy) = (world.name().replace(':', "-"), &args.strategy);
        let (robots, seed) = (args.robots, args.common.seed);
        Path::new("out").join(format!("{world}-{strategy}-team-{robots}-{seed}"))
    });
    let own = [("world", args.world.clone())];
    let made_by = made_by::of_run(&team.mission.robot, &own);
    args.folder.check(&folder, &made_by)?;
    folder::prepare(&folder)?;
    for text in world.notes() {
        note(&format!("host-sim: {}: {text}", world.name()));
    }
    for text in surprises(&team.mission, &world) {
        note(&format!("host-sim: {}: {text}", world.name()));
    }
    let recorders = recorders(args, &made_by)?;
    let mut planners = open(args, &links)?;
    if !recorders.is_empty() {
        let pairs = planners.into_iter().zip(&recorders);
        planners = pairs.map(|(link, recorder)| recorder.tap(link)).collect();
    }
    let interrupt = Interrupt::listen()?;
    let pace = args.pace.realtime.then_some(1.0);
    let pages = args
        .live
        .map(|place| live::open_team(place, pace, args.robots));
    let pages = pages.transpose()?.unwrap_or_default();
    let shown = pages.iter().enumerate().map(|(robot, page)| {
        let name = format!("{}, robot {robot}", world.name());
        live::observer(page, &team.mission, name, &interrupt)
    });
    let mut onlooker = Onlooker::new(world.name(), pace, interrupt.clone());
    onlooker.show(shown.collect());
    onlooker.record(recorders.clone());
    let result = explore(&team, &world, &mut planners, &mut onlooker);
    onlooker.finish();
    for (robot, recorder) in recorders.iter().enumerate() {
        let report = result
            .as_ref()
            .ok()
            .map(|(report, _)| &report.robots[robot]);
        recorder.end(report.map(|it| &it.report));
    }
    for (robot, page) in onlooker.pages().iter_mut().enumerate() {
        let report = result
            .as_ref()
            .map(|(report, _)| &report.robots[robot].report);
        live::end(page, report.map_err(ToString::to_string));
    }
    let (mut report, record) = match result {
        Err(TeamError::Robot { robot, error }) => {
            let link = links.get(robot).map(ToString::to_string);
            bail!(
                "robot {robot}, --link {}: {error}",
                link.unwrap_or_default()
            )
        }
        result => result?,
    };
    report.whole.made_by = Some(made_by);
    write(&folder, &world, &report, &record)?;
    print(args, &report, &record, &folder)?;
    live::stay(&pages, &interrupt);
    Ok(report.whole.explored())
}

/// Returns the arguments that a team has in common with a run of one robot.
fn common(args: &TeamArgs, start: usize) -> ExploreArgs {
    ExploreArgs {
        strategy: args.strategy.clone(),
        ground: args.ground,
        start,
        odometry: Some(args.odometry),
        pace: args.pace.clone(),
        space: args.space.clone(),
        bounds: args.bounds.clone(),
        no_go: args.no_go.clone(),
        slam: args.slam,
        robot: args.robot.clone(),
        common: args.common.clone(),
        ..ExploreArgs::default()
    }
}

/// Returns the link of each robot.
fn links(args: &TeamArgs) -> Result<Vec<LinkSpec>> {
    if args.strategy == strategies::TERRAIN {
        bail!("--strategy terrain is for explore; say --strategy frontier --ground uneven");
    }
    let of = |link| strategies::link_of(&args.strategy, args.robot.link(link));
    match &args.link[..] {
        [] => Ok(vec![of(None)?; args.robots]),
        [one] => Ok(vec![of(Some(one))?; args.robots]),
        list if list.len() == args.robots => list.iter().map(|link| of(Some(link))).collect(),
        list => bail!(
            "--link names {} links for {} robots; give one for all, or one for each",
            list.len(),
            args.robots
        ),
    }
}

/// Returns the radio; refuses one for a strategy that does not talk.
fn radio(args: &TeamArgs) -> Result<RadioSpec> {
    let radio = args.radio.clone().unwrap_or_default();
    if radio.on && on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} does not talk to a team; say --radio off",
            args.strategy
        );
    }
    Ok(radio)
}

fn open(args: &TeamArgs, links: &[LinkSpec]) -> Result<Vec<Box<dyn Link>>> {
    links.iter().for_each(note_build);
    let open = |link: &LinkSpec| {
        let options = Options {
            seed: args.common.seed,
            real_time: args.pace.realtime,
            tuning: args.robot.tuning(link)?,
            cycles: cycles(link),
            ..Options::default()
        };
        strategies::open(&args.strategy, link, &options, Relaxation::DEFAULT)
            .with_context(|| format!("--link {link}"))
    };
    links.iter().map(open).collect()
}

/// Begins the recording of each robot; none without `--record`.
fn recorders(args: &TeamArgs, made_by: &MadeBy) -> Result<Vec<Rc<Recorder>>> {
    let Some(folder) = &args.record else {
        return Ok(Vec::new());
    };
    std::fs::create_dir_all(folder)
        .with_context(|| format!("--record {}: the folder cannot be made", folder.display()))?;
    let begin = |robot: usize| {
        let file = folder.join(format!("robot-{robot}.mcap"));
        Recorder::open(&file, made_by, args.folder.force).map(Rc::new)
    };
    (0..args.robots).map(begin).collect()
}

/// Writes the team's files, and each robot's files into a folder of its own.
fn write(folder: &Path, world: &World, report: &TeamReport, record: &TeamRecord) -> Result<()> {
    let truths = |k: usize| record.robots[k].steps.iter().map(|step| step.truth);
    let paths: Vec<Vec<Stamped>> = (0..record.robots.len())
        .map(|k| truths(k).collect())
        .collect();
    let left = report.whole.outcome.residual_frontiers.iter();
    let residual: Vec<(f64, f64)> = left.map(|at| (at.x_m, at.y_m)).collect();
    let picture = team_png(&TeamScene {
        title: &report.headline(),
        subtitle: &report.whole.in_short(),
        map: &record.map,
        paths: &paths,
        residual: &residual,
    });
    folder::write_team(folder, report, &record.map, &picture)?;
    for (robot, record) in report.robots.iter().zip(&record.robots) {
        let folder = folder.join(format!("robot-{}", robot.robot));
        folder::prepare(&folder)?;
        let album = Album::new(world, &robot.report, record);
        folder::write(&folder, &robot.report, record, &album.end())?;
    }
    Ok(())
}

/// Prints the report on standard output, and advice on standard error.
fn print(args: &TeamArgs, report: &TeamReport, record: &TeamRecord, folder: &Path) -> Result<()> {
    say(&if args.common.json {
        report.to_json_line()
    } else {
        report.to_text()
    })?;
    let world = &report.whole.world;
    for (robot, record) in record.robots.iter().enumerate() {
        if let Some(advice) = record.ending.advice() {
            note(&format!("host-sim: {world}: robot {robot}: {advice}"));
        }
        if let Some(error) = &record.read_out_error {
            note(&format!(
                "host-sim: {world}: the map of robot {robot} could not be read: {error}"
            ));
        }
    }
    note(&format!("{world}: files in {}", folder.display()));
    Ok(())
}
