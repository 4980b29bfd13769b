//! A simulated robot in a world, whose reports are spoilt now and then, among real and strange
//! peers.

use std::collections::VecDeque;
use std::sync::OnceLock;

use fieldline_protocol::message::{
    Body, Command, FIELD_SIDE, Fault, Observation, Packet, Start, Status,
};

use super::companion::Companion;
use super::corrections::Corrections;
use super::fences;
use super::packets::Team;
use super::quantities::{centimetres, origin_ms};
use super::spoil::{Fate, Faults};
use super::{Host, starts};
use crate::robot::{Lidar, OdometryModel, OdometryNoise, usual_lidars};
use crate::session::ask::{Answer, Ask};
use crate::session::choices::Choices;
use crate::sim::{SimConfig, Simulator};
use crate::trial::uneven::TABLE_I;
use crate::world::World;

/// The worlds, flat ones first.
const NAMES: [&str; 20] = [
    "office",
    "cave",
    "loop",
    "cluttered",
    "hall",
    "narrow-doors",
    "boxed-in",
    "ouroboros-a",
    "tdbvp-nested",
    "two-rooms",
    "c-room",
    "partition",
    "maze:1:15x12",
    "rooms:3:15x12",
    "dungeon:5:15x12",
    "slope",
    "holes",
    "kerbs",
    "building",
    "causeway",
];
/// Steps between two readings of the map.
const READ_EVERY: u64 = 100;
/// Steps between two corrections.
const CORRECT_EVERY: u64 = 150;
/// Steps between two orders to drive.
const ORDER_EVERY: u64 = 80;
/// Steps that a session goes on after the robot has finished.
const AFTER_END: usize = 20;
/// Packets of this robot that its peers repeat.
const MOST_ECHOES: usize = 16;

/// Returns a world. Each is drawn once.
fn world(index: usize) -> Option<&'static World> {
    static WORLDS: [OnceLock<Option<World>>; NAMES.len()] =
        [const { OnceLock::new() }; NAMES.len()];
    let slot = WORLDS.get(index)?;
    slot.get_or_init(|| World::open(NAMES[index]).ok()).as_ref()
}

/// A host with a simulated robot.
pub(super) struct Plausible<C> {
    choices: C,
    robot: Option<Simulator<'static>>,
    start: Start,
    /// Steps that are left.
    left: usize,
    steps: u64,
    has_begun: bool,
    /// A fault strikes once in so many steps.
    once_in: u64,
    /// Most packets that are heard in a step.
    crowd: u64,
    origin_ms: u32,
    faults: Faults,
    team: Team,
    corrections: Corrections,
    /// A real robot of the team.
    companion: Option<Companion>,
    /// What this robot said, for peers that repeat it.
    echoes: VecDeque<Packet>,
    /// The rest of the requests of this step.
    queue: VecDeque<Ask>,
}

impl<C: Choices> Plausible<C> {
    pub(super) fn new(mut choices: C, length: usize) -> Self {
        let robot = robot(&mut choices);
        let mut start = starts::pioneer(&mut choices);
        if let Some(robot) = &robot {
            start.lasers = robot.start_message(start.strategy).lasers;
        }
        let is_uneven = robot
            .as_ref()
            .is_some_and(|it| it.world().elevation().is_some());
        if is_uneven {
            start.uneven_ground = Some(TABLE_I);
        }
        let companion = if choices.once_in(2) {
            robot
                .as_ref()
                .and_then(|it| Companion::beside(&mut choices, it.world(), &it.start(), &mut start))
        } else {
            None
        };
        Self {
            robot,
            companion,
            left: length,
            steps: 0,
            has_begun: false,
            once_in: choices.pick(&[8, 60, 400, u64::MAX]),
            crowd: choices.pick(&[0, 0, 1, 4]),
            origin_ms: origin_ms(&mut choices),
            faults: Faults::default(),
            team: Team {
                own: start.team.map_or(0, |team| team.member.id),
                ..Team::default()
            },
            corrections: Corrections::default(),
            echoes: VecDeque::new(),
            queue: VecDeque::new(),
            start,
            choices,
        }
    }

    /// Makes the requests of a step.
    fn step(&mut self) {
        let Some(robot) = &mut self.robot else {
            self.left = 0;
            return;
        };
        self.left -= 1;
        self.steps += 1;
        let mut observation = robot.observe();
        let choices = &mut self.choices;
        let fate = if choices.once_in(self.once_in) {
            self.faults.strike(choices, &mut observation)
        } else {
            Fate::Sent
        };
        self.faults.spoil(&mut observation);
        observation.time_ms = observation.time_ms.wrapping_add(self.origin_ms);
        if fate == Fate::Missing {
            robot.drive(None);
            return;
        }
        let pose = observation.pose;
        self.team.near_cm = (centimetres(pose.x), centimetres(pose.y));
        self.report(observation, fate);
        if self.start.team.is_some() {
            self.queue.push_back(Ask::Say);
            self.hear();
        }
        if self.choices.once_in(READ_EVERY) {
            self.read();
        }
        if self.choices.once_in(CORRECT_EVERY) {
            let asks = self.corrections.requests(&mut self.choices);
            self.queue.extend(asks);
        }
        if self.choices.once_in(ORDER_EVERY) {
            self.queue.push_back(fences::order(&mut self.choices));
        }
    }

    fn report(&mut self, observation: Observation, fate: Fate) {
        let ask = Ask::Observation(Box::new(observation));
        match fate {
            Fate::Twice => self.queue.push_back(ask.clone()),
            Fate::Paused => self.queue.extend([Ask::Pause, ask.clone(), Ask::Resume]),
            Fate::Sent | Fate::Missing => {}
        }
        self.queue.push_back(ask);
    }

    /// Peers say something, at random or what this robot said.
    fn hear(&mut self) {
        let said = self.companion.as_mut().map(Companion::step);
        for packet in said.unwrap_or_default() {
            self.queue.push_back(Ask::Hear(Box::new(packet)));
        }
        for _ in 0..self.choices.below(self.crowd + 1) {
            let choices = &mut self.choices;
            let echo = if choices.once_in(3) {
                self.echoes.pop_front()
            } else {
                None
            };
            let packet = match echo {
                Some(mut packet) => {
                    packet.from.id = packet.from.id.wrapping_add(1);
                    displace(choices, &mut packet);
                    packet
                }
                None => self.team.packet(choices),
            };
            self.queue.push_back(Ask::Hear(Box::new(packet)));
        }
    }

    /// Reads what a picture of the run needs.
    fn read(&mut self) {
        let choices = &mut self.choices;
        for _ in 0..4 {
            self.queue.push_back(Ask::Tile {
                x: choices.between(-4, 8) as i16,
                y: choices.between(-4, 8) as i16,
            });
        }
        let rows = (0..FIELD_SIDE as u8).step_by(5);
        self.queue.extend(rows.map(|row| Ask::FieldRow { row }));
        self.queue.extend([Ask::Path { from: 0 }, Ask::Frontiers]);
    }

    /// The robot drives what it was told.
    fn obey(&mut self, command: &Command) {
        let Some(robot) = &mut self.robot else { return };
        robot.drive(Some(command.velocity));
        let goes_on = matches!(
            command.status,
            Status::Exploring
                | Status::NoScan
                | Status::Going(_)
                | Status::Arrived(_)
                | Status::Unreachable(_)
                | Status::Paused
                | Status::Fault(Fault::BadObservation)
        );
        if !goes_on || robot.loss().is_some() {
            self.left = self.left.min(AFTER_END);
        }
    }
}

/// Moves what a packet says by a few tiles or centimetres; sometimes not.
fn displace(choices: &mut impl Choices, packet: &mut Packet) {
    let by = choices.between(-2, 2) as i8;
    match &mut packet.body {
        Body::Beacon(beacon) => beacon.x_cm = beacon.x_cm.saturating_add(i16::from(by) * 40),
        Body::Tile(tile) => tile.x = tile.x.saturating_add(by),
        Body::Digest(digest) => {
            if let Some(tile) = digest.tiles.first_mut() {
                tile.hash ^= by as u16;
            }
        }
        Body::Wanted(_) => {}
    }
}

/// Puts the robot into a world.
fn robot(choices: &mut impl Choices) -> Option<Simulator<'static>> {
    let world = world(choices.below(NAMES.len() as u64) as usize)?;
    let is_flat = world.elevation().is_none();
    let config = SimConfig {
        seed: choices.bits(16),
        start: choices.below(world.starts().len() as u64) as usize,
        odometry: if choices.once_in(2) {
            OdometryModel::Truth
        } else {
            OdometryModel::Noisy(OdometryNoise::default())
        },
        people: if is_flat && choices.once_in(6) { 4 } else { 0 },
        lidars: lidars(choices),
        ..SimConfig::default()
    };
    let alone = SimConfig {
        people: 0,
        ..config.clone()
    };
    // People may find no room; then there are none.
    let robot = Simulator::new(world, config).or_else(|_| Simulator::new(world, alone));
    robot.ok()
}

/// Returns the usual lidars, of which the level one may turn while the robot moves.
fn lidars(choices: &mut impl Choices) -> Vec<Lidar> {
    let mut lidars = usual_lidars();
    if let Some(level) = lidars.first_mut().filter(|_| choices.once_in(3)) {
        level.turn_time_s = choices.between(1, 500) as f64 / 1000.0;
        level.newest_first = choices.once_in(2);
    }
    lidars
}

impl<C: Choices> Host for Plausible<C> {
    fn next(&mut self, last: Option<&Answer>) -> Option<Ask> {
        match last {
            Some(Answer::Command(command)) => self.obey(command),
            Some(Answer::Said(packet)) => {
                self.queue.push_front(Ask::Say);
                if let Some(companion) = &mut self.companion {
                    companion.hear(packet);
                }
                self.echoes.truncate(MOST_ECHOES - 1);
                self.echoes.push_front((**packet).clone());
            }
            _ => {}
        }
        if !self.has_begun {
            self.has_begun = true;
            return Some(Ask::Start(Box::new(self.start.clone())));
        }
        while self.queue.is_empty() {
            if self.left == 0 || self.choices.is_over() {
                return None;
            }
            self.step();
        }
        self.queue.pop_front()
    }
}
