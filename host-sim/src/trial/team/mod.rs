//! Several robots explore one world, each with its own link and planner.
//!
//! The loop is lockstep: in each period the robots take part one after another, in the order of
//! their numbers, then all drive. In its part a robot hears what the radio brought until then,
//! makes its step, and says what its planner has to say. So a packet is heard in the next period at
//! the earliest. The same settings give the same records, except for measured times.
//!
//! The team has ended when no robot explores and none is to join. Then the robots stand and talk
//! for [`SETTLE_MS`] more, and until nobody said more than beacons for [`QUIET_MS`], at most
//! [`MOST_SETTLE_MS`]. So what was lost is repaired. That time counts nowhere.

mod agreement;
mod copy;
mod error;
mod member;
mod misplaced;
mod seat;
mod settings;
mod starts;
mod summary;
mod timetable;

use fieldline_protocol::message as wire;

use super::account::Account;
use super::mission::{self, Mission, MissionError};
use super::{Ending, Flow, Progress, REST_MS, Record, Watch};
use crate::link::Link;
use crate::metrics::Coverage;
use crate::radio::{MOST_ROBOTS, Radio, Station};
use crate::report::{GridMap, TeamReport};
use crate::sim::{Fleet, SimConfig, Simulator};
use crate::slam::SlamPlace;
use crate::world::{Start, World, WorldError};
pub use error::TeamError;
use member::{Common, Member, Presence};
pub use misplaced::StartError;
pub use settings::TeamMission;
use starts::Places;
pub use timetable::{Appointment, Timetable, TimetableError};

/// Time for the last exchange after the team has ended, milliseconds. A digest of every tile of a
/// full map takes 8 s.
pub const SETTLE_MS: u32 = 20_000;

/// Silence after which the last exchange is over, milliseconds: five digests of one robot.
pub const QUIET_MS: u32 = 5_000;
/// Greatest time for the last exchange, milliseconds. With half of the packets lost a tile needs
/// eight digests in the mean.
pub const MOST_SETTLE_MS: u32 = 180_000;

/// The records of a team's run.
#[derive(Clone, Debug)]
pub struct TeamRecord {
    /// Each robot's record.
    pub robots: Vec<Record>,
    /// What the robots' maps know together.
    pub map: GridMap,
}

/// Returns the starts of a team's robots.
///
/// # Errors
/// [`TeamError`] if not all settings are possible, or not all robots fit.
pub fn starts(team: &TeamMission, world: &World) -> Result<Vec<Start>, TeamError> {
    let robots = team.robots;
    if robots == 0 || robots > MOST_ROBOTS {
        return Err(TeamError::Robots(robots));
    }
    team.timetable.check(robots).map_err(TeamError::Timetable)?;
    if let Some(stranger) = team.radio.stranger(robots) {
        return Err(TeamError::Stranger(stranger));
    }
    let starts = match &team.places {
        Some(places) => places.clone(),
        None => {
            let places = Places::new(world, team.mission.sim_config())?;
            if team.apart {
                places.apart(robots)
            } else {
                places.side_by_side(robots)
            }
        }
    };
    if starts.len() < robots {
        return Err(TeamError::Room {
            fitting: starts.len(),
            robots,
            apart: team.apart,
            is_fenced: !team.mission.fence.is_empty(),
        });
    }
    for (robot, start) in starts.iter().enumerate() {
        let stands = team
            .mission
            .fence
            .check_start(&team.mission.hull, &start.pose());
        stands.map_err(|reason| TeamError::Robot {
            robot,
            error: MissionError::World(WorldError::Start {
                file: world.name().into(),
                index: team.mission.start,
                reason,
            }),
        })?;
    }
    Ok(starts)
}

/// Explores `world` with a team; the links are in the order of the robots' numbers.
///
/// # Errors
/// As [`TeamError`], before a robot moves. Later failures are in the report.
pub fn explore(
    team: &TeamMission,
    world: &World,
    links: &mut [Box<dyn Link>],
    watch: &mut dyn Watch,
) -> Result<(TeamReport, TeamRecord), TeamError> {
    let starts = starts(team, world)?;
    let missions = (0..)
        .zip(&starts)
        .map(|(k, start)| team.mission_of(k, *start));
    let missions: Vec<Mission> = missions.collect();
    let configs: Vec<SimConfig> = missions.iter().map(Mission::sim_config).collect();
    let mut fleet = Fleet::new(world, &configs).map_err(TeamError::Fleet)?;
    let radio = Radio::new(world, team.radio.clone(), team.mission.seed);
    let members = begin(team, &missions, &fleet, links)?;
    let coverage = members[0].account.coverage.clone();
    let mut run = Run {
        team,
        members,
        radio,
        coverage,
        interrupted: false,
    };
    let ended_ms = run.explore(&mut fleet, watch);
    let traffic = run.radio.traffic();
    run.settle(&mut fleet);
    let places: Vec<[f64; 2]> = starts.iter().map(|start| [start.x_m, start.y_m]).collect();
    for member in &mut run.members {
        member.read_out(&places);
    }
    let whole = summary::Whole {
        team,
        missions: &missions,
        starts: &starts,
        fleet: &fleet,
        members: &run.members,
        coverage: &run.coverage,
        traffic,
        ended_ms,
    };
    let report = whole.report();
    let record = TeamRecord {
        map: GridMap::united(run.members.iter().map(|member| &member.record.map)),
        robots: run.members.into_iter().map(|it| it.record).collect(),
    };
    Ok((report, record))
}

/// Begins the session of every robot.
fn begin<'a>(
    team: &TeamMission,
    missions: &[Mission],
    fleet: &Fleet<'_>,
    links: &'a mut [Box<dyn Link>],
) -> Result<Vec<Member<'a>>, TeamError> {
    let mut members: Vec<Member<'a>> = Vec::new();
    for (robot, link) in links.iter_mut().enumerate().take(fleet.len()) {
        let of_robot = |error: MissionError| TeamError::Robot { robot, error };
        link.hello().map_err(|error| of_robot(error.into()))?;
        let simulator: &Simulator<'_> = &fleet.robots()[robot];
        let mut setup = mission::setup(&missions[robot], simulator);
        setup.corrects = missions[robot].slam == SlamPlace::Host;
        setup.start.team = team.radio.on.then(|| {
            let (seed, start) = (missions[robot].seed, simulator.start());
            let known = Member::of_wire(robot);
            team.start_error.tell(known, seed, &start)
        });
        let account = match members.first() {
            Some(first) => first.account.beside(&setup, simulator),
            None => Account::new(&setup, simulator),
        };
        let mut member = Member::begin(robot, link.as_mut(), setup, account);
        if missions[robot].slam == SlamPlace::Host {
            member.close_loops(missions[robot].motion());
        }
        members.push(member);
    }
    Ok(members)
}

/// A run in progress.
struct Run<'a, 'w> {
    team: &'a TeamMission,
    members: Vec<Member<'a>>,
    radio: Radio<'w>,
    coverage: Coverage,
    interrupted: bool,
}

impl<'w> Run<'_, 'w> {
    /// Explores until the team has ended; returns when, in milliseconds.
    fn explore(&mut self, fleet: &mut Fleet<'w>, watch: &mut dyn Watch) -> u32 {
        let mut last_ms = 0;
        loop {
            let now_ms = fleet.robots()[0].time_ms();
            self.come_and_go([last_ms, now_ms]);
            last_ms = now_ms;
            self.period(fleet, watch);
            let progress = self.progress(now_ms);
            if !self.interrupted && watch.step(&progress) == Flow::Interrupt {
                self.interrupted = true;
                self.end_all(&Ending::Interrupted);
            }
            if self.has_ended(now_ms) {
                return now_ms;
            }
            if now_ms >= self.team.mission.time_limit_ms {
                self.end_all(&Ending::TimeLimit);
                return now_ms;
            }
        }
    }

    /// Lets the robots stand and talk after the end.
    fn settle(&mut self, fleet: &mut Fleet<'w>) {
        let period_ms = fleet.robots()[0].config().period_ms;
        let talks = self.team.radio.on && !self.interrupted;
        let (least_ms, most_ms) = if talks {
            (SETTLE_MS, MOST_SETTLE_MS)
        } else {
            (REST_MS, REST_MS)
        };
        let (mut passed_ms, mut quiet_ms) = (0, 0);
        while passed_ms < least_ms || (passed_ms < most_ms && quiet_ms < QUIET_MS) {
            let said = self.said();
            self.period(fleet, &mut ());
            // Every robot that talks says a beacon.
            let is_quiet = self.said() - said <= self.members.len() as u64;
            passed_ms += period_ms.max(1);
            quiet_ms = if is_quiet { quiet_ms + period_ms } else { 0 };
        }
    }

    /// Returns the number of packets that all robots said so far.
    fn said(&self) -> u64 {
        self.members.iter().map(|member| member.talk.said).sum()
    }

    fn end_all(&mut self, ending: &Ending) {
        let exploring = |member: &&mut Member<'_>| member.presence == Presence::Exploring;
        for member in self.members.iter_mut().filter(exploring) {
            member.end(ending.clone());
        }
    }

    fn come_and_go(&mut self, span_ms: [u32; 2]) {
        for (robot, member) in self.members.iter_mut().enumerate() {
            if self.team.timetable.leaves(robot, span_ms) {
                member.leave();
            }
            if self.team.timetable.joins(robot, span_ms) {
                member.join();
            }
        }
    }

    /// Returns true if no robot explores, and none that is away is to join.
    fn has_ended(&self, now_ms: u32) -> bool {
        let will_join = |robot: usize| {
            let timetable = &self.team.timetable;
            timetable.joins(robot, [now_ms, u32::MAX])
        };
        let mut members = self.members.iter().enumerate();
        self.interrupted
            || members.all(|(robot, member)| match member.presence {
                Presence::Exploring => false,
                Presence::Away => !will_join(robot),
                Presence::Standing | Presence::Silent => true,
            })
    }

    /// Lets every robot take part, and all drive.
    fn period(&mut self, fleet: &mut Fleet<'w>, watch: &mut dyn Watch) {
        let listens = self.members.iter().map(Member::listens);
        let stations: Vec<Station> = fleet
            .robots()
            .iter()
            .zip(listens)
            .map(|(robot, listens)| Station {
                at_m: [robot.pose().x_m, robot.pose().y_m],
                listens,
            })
            .collect();
        let mut common = Common {
            fleet,
            radio: &mut self.radio,
            stations: &stations,
            coverage: &mut self.coverage,
            watch,
        };
        let members = self.members.iter_mut();
        let commands: Vec<Option<wire::Twist>> = members
            .map(|member| member.take_part(&mut common))
            .collect();
        fleet.drive(&commands);
        for (member, robot) in self.members.iter_mut().zip(fleet.robots()) {
            member.note_loss(robot.loss());
        }
    }

    fn progress(&self, time_ms: u32) -> Progress {
        let mut exploring = self.members.iter();
        let exploring = exploring.find(|member| member.presence == Presence::Exploring);
        let shown = exploring.or(self.members.first());
        let path_m = self.members.iter().map(|member| member.record.path_m).sum();
        Progress {
            time_ms,
            coverage: self.coverage.fraction(),
            path_m,
            ..shown.map_or_else(|| Record::default().progress(), |it| it.record.progress())
        }
    }
}
