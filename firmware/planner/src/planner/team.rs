//! What the planner says to its team, and how it takes what the team says.
//!
//! Units: metres; coarse cells of 20 cm.

use crate::config::Config;
use crate::drive::Drive;
use crate::geometry::{CELL_M, Cell, MapPose, OdomPose};
use crate::input::Input;
use crate::math;
use crate::path::{map_exits, viewpoint};
use crate::planner::state::State;
use crate::status::Status;
use crate::strategy::Strategist;
use crate::team::frame::Motion;
use crate::team::packet::{Activity, Packet, half_cm};
use crate::team::peers::Peer;
use crate::team::right_of_way::Stance;

/// Coarse cells of the path from one told place to the next: 0.8 m.
const ROAD_CELLS: usize = 4;

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Returns true if the session has a team.
    #[must_use]
    pub const fn is_in_team(&self) -> bool {
        self.team.is_member()
    }

    /// Returns the other robots of the team, as their last beacons told.
    pub fn peers(&self) -> impl Iterator<Item = &Peer> {
        self.team.peers().iter()
    }

    /// Moves all that lies in the map's coordinates into the team's. What was planned is planned
    /// anew: the robot stands in this step.
    #[inline(never)]
    pub(super) fn move_into_team(&mut self, config: &Config, motion: &Motion) {
        let by = &motion.team_from_own;
        self.localiser.move_map(by, &motion.covariance);
        let MapPose(pose) = self.localiser.pose();
        self.map.turn(by, pose.point().cell());
        self.errands.turn(by);
        self.skeleton
            .reset(Strategist::<SLOTS>::space(config.strategy));
        self.strategy.reset(config);
        self.viewpoints = viewpoint::Search::new();
        self.drive = Drive::new();
        self.has_new_skeleton = false;
        self.exits = map_exits::Search::new();
    }

    /// Enters an input without a step: the robot stands by order, or its exploration has ended.
    /// Only its team learns of it.
    pub fn stand(&mut self, config: &Config, input: &Input<'_>) {
        let Ok((input, _)) = &self.door.admit(config, input) else {
            return;
        };
        self.wiring.release();
        let odom = OdomPose(self.team.to_map(&input.pose));
        let MapPose(pose) = self.localiser.to_map(&odom);
        let motion = (&pose, input.velocity);
        self.team.begin_step(input.time_ms, motion, &mut self.map);
    }

    /// Takes a packet that another robot of the team said.
    pub fn hear(&mut self, config: &Config, packet: &Packet) {
        if !packet.is_finite() {
            self.door.note_refused();
            return;
        }
        let has_evidence = !self.ground.is_uneven();
        // Another robot sees the hull, and marks the cells behind its beams' ends.
        let stand_m = config.robot.half_diagonal_m + CELL_M;
        let tuning = &config.tuning.localise;
        self.team
            .hear(packet, &mut self.map, (stand_m, has_evidence, tuning));
    }

    /// Returns the next packet for the team; `None` until the next step, and for a robot alone. Ask
    /// after every step until there is none.
    #[must_use]
    pub fn say(&mut self, config: &Config) -> Option<Packet> {
        let robot = &config.robot;
        let path = self.strategy.frontier.path();
        let activity = match self.status {
            Status::Exploring | Status::NoScan | Status::Going(_) => self.team.way.activity(),
            Status::Finished(_) | Status::Arrived(_) | Status::Unreachable(_) => Activity::Finished,
            Status::Fault(_) => Activity::Faulted,
        };
        let (stance, refuge) = (self.team.way.stance(), self.team.way.refuge());
        let [xx, _, yy, ..] = self.localiser.location().covariance;
        let sd_m = math::sqrt(xx.max(yy));
        self.team.say(&mut self.map, |beacon| {
            let mut beacon = beacon.within(sd_m);
            beacon.half_cm = (half_cm(robot.half_length_m), half_cm(robot.half_width_m));
            beacon.activity = activity;
            if !beacon.activity.moves() {
                return beacon;
            }
            let goal = (!path.is_empty()).then(|| path.goal());
            let ahead = path.cells().iter().skip(ROAD_CELLS).step_by(ROAD_CELLS);
            let middle = |cell: &Cell| cell.offset(1, 1).corner();
            match stance {
                Stance::Free | Stance::Holding => beacon.bound_for(goal).along(ahead.map(middle)),
                // Its road is the one that it needs to make way.
                Stance::Yielding | Stance::Cornered => {
                    beacon.bound_for(goal).along(refuge.into_iter())
                }
            }
        })
    }
}
