//! A real robot of the team in the same world, with a planner of its own: what it says makes maps
//! meet, and with a rough start they are aligned.
//!
//! The two robots do not see each other; a peer may be a ghost.

use fieldline_protocol::message::{Control, Member, Packet, Start, Team};
use fixed::types::I16F16;

use super::quantities::wide_within;
use crate::link::Link as _;
use crate::link::direct::Direct;
use crate::session::choices::Choices;
use crate::sim::{SimConfig, Simulator};
use crate::world::{self, World};

/// Greatest errors of a rough start, in the wire's bits: 0.5 m and 0.1 rad.
const OFF: (i64, i64) = (32_768, 6_554);
/// Most packets that a planner says in a step.
const MOST_SAID: usize = 8;

/// A robot of the team.
#[derive(Debug)]
pub(super) struct Companion {
    robot: Simulator<'static>,
    link: Direct,
}

impl Companion {
    /// Puts a robot beside one that starts with `start` at `own`, and tells that one a start that
    /// is off by as much as its deviations allow. `None` if there is no place.
    pub(super) fn beside(
        choices: &mut impl Choices,
        world: &'static World,
        own: &world::Start,
        start: &mut Start,
    ) -> Option<Self> {
        let team = start.team.as_mut()?;
        *team = misplaced(choices, own, team);
        let id = team.member.id.wrapping_add(1);
        let config = SimConfig {
            seed: choices.bits(16),
            start: choices.below(world.starts().len() as u64) as usize,
            ..SimConfig::default()
        };
        let robot = Simulator::new(world, config).ok()?;
        let mut theirs = start.clone();
        theirs.localise = false;
        theirs.survey = false;
        theirs.team = Some(Team {
            member: Member { id, boot: 1 },
            ..Team::default()
        });
        let mut link = Direct::new();
        link.control(&Control::Start(theirs)).ok()?;
        Some(Self { robot, link })
    }

    /// Makes a step; returns what the robot says.
    pub(super) fn step(&mut self) -> Vec<Packet> {
        let command = self.link.observe(&self.robot.observe());
        self.robot.drive(command.ok().map(|it| it.velocity));
        let link = &mut self.link;
        let said = core::iter::from_fn(|| link.say().ok().flatten());
        said.take(MOST_SAID).collect()
    }

    /// Hears what the other robot said.
    pub(super) fn hear(&mut self, packet: &Packet) {
        // A refused packet is not heard.
        let _ = self.link.hear(packet);
    }
}

/// Returns the pose of the odometry's origin that a robot at `start` is told: off by draws within
/// the deviations that it is told. The odometry of both robots is in the world's coordinates.
fn misplaced(choices: &mut impl Choices, start: &world::Start, team: &Team) -> Team {
    let (most_m, most_rad) = OFF;
    let mut draw = |most: i64| wide_within(choices, -most, most).to_num::<f64>();
    let [x_m, y_m] = if team.sd_mm > 0 {
        [draw(most_m), draw(most_m)]
    } else {
        [0.0; 2]
    };
    let yaw_rad = if team.sd_mrad > 0 {
        draw(most_rad)
    } else {
        0.0
    };
    let (sin, cos) = yaw_rad.sin_cos();
    Team {
        origin: (
            I16F16::saturating_from_num(start.x_m + x_m - (cos * start.x_m - sin * start.y_m)),
            I16F16::saturating_from_num(start.y_m + y_m - (sin * start.x_m + cos * start.y_m)),
        ),
        yaw: I16F16::saturating_from_num(yaw_rad),
        ..*team
    }
}
