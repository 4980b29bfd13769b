//! What a host needs that follows a robot of a team with a planner of its own: a survey that takes
//! the same inputs, hears the same packets, and so has the same map. A host that keeps scans brings
//! them to one instant first, as the planner does.
//!
//! Units: metres, milliseconds, millimetres of range.

use crate::config::Config;
use crate::input::Input;
use crate::map::Map;
use crate::planner::deskew::{Room, deskew};
use crate::planner::door::Door;
use crate::planner::sight::{Ranges, hide_peers};
use crate::planner::state::State;
use crate::robot::MAX_BEAMS;

/// Brings the scans of one input after the other to the instant of their pose.
#[derive(Debug)]
pub struct AtOnce {
    door: Door,
    room: Room,
}

impl AtOnce {
    /// Returns that of a new session.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            door: Door::new(),
            room: [[0; MAX_BEAMS as usize]; 2],
        }
    }

    /// Returns the scans of an input as a step reads them. It takes all inputs, also those of a
    /// robot that stands by order.
    pub fn scans<'a>(&'a mut self, config: &Config, input: &Input<'a>) -> [&'a [u16]; 2] {
        let moved = self.door.admit(config, input).ok();
        let moved = moved.and_then(|(_, moved)| moved);
        deskew(config, input, moved.as_ref(), &mut self.room).scans
    }
}

impl Default for AtOnce {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the map.
#[must_use]
pub const fn map<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
) -> &Map<TILES, SLOTS> {
    &state.map
}

/// Returns true if the map does not lie in the team's coordinates yet.
#[must_use]
pub const fn has_own_frame<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
) -> bool {
    state.team.has_own_frame()
}

/// Takes what came for gone, as the robot did in this step. A survey does not plan, so it does not
/// know when.
pub fn forget_arrivals<const TILES: usize, const SLOTS: usize>(
    state: &mut State<TILES, SLOTS>,
    config: &Config,
) {
    let robot = state.location().pose.0.point().cell();
    state.forget_arrivals(config, robot);
}

/// Returns the ranges of the last step's input without the beams that end in a peer.
#[must_use]
pub fn without_peers<const TILES: usize, const SLOTS: usize>(
    state: &State<TILES, SLOTS>,
    config: &Config,
    input: &Input<'_>,
) -> [Ranges; 2] {
    let at = state.location().pose.0;
    let time_ms = state.team.now_ms();
    let mut seen = [const { Ranges::new() }; 2];
    let input = &Input { time_ms, ..*input };
    hide_peers(config, state.team.peers(), input, &at, &mut seen);
    seen
}
