//! The host's copy of the map of a team's robot: a survey by the planner's own code, which takes
//! the robot's observations and what it hears, and says what it says.
//!
//! ```text
//! packets ─► hear ─┐
//! observation ─────┴─► survey ─► map, pose, peers ─► say (dropped)
//! ```
//!
//! The planner is deterministic, and only what the survey takes changes the map, but for one thing:
//! when a robot takes what came for gone, which every command tells. So the copy equals the
//! device's map, cell for cell, and nothing need be read over the wire.
//!
//! A tile is *of a peer* if the peer's version came before a cell of it was known here.
//!
//! Units: metres, milliseconds; tiles of 32 × 32 map cells.

use std::collections::{BTreeMap, BTreeSet};

use fieldline_device::convert;
use fieldline_planner::Config;
use fieldline_planner::config::Tuning;
use fieldline_planner::geometry::Pose;
use fieldline_planner::planner::host_copy;
use fieldline_protocol::message::{Body, Command, Control, INVALID_MM, Observation, Packet, Start};

use super::super::at_once::AtOnce;
use super::super::map_copy::{Key, MapCopy};
use crate::link::Link;
use crate::link::correction::{Classes, MapCorrection, Motion};
use crate::link::direct::Direct;

/// The copy.
#[derive(Debug)]
pub(super) struct TeamCopy {
    /// `None` if the device refuses the session's parameters. The map then stays empty.
    config: Option<Config>,
    survey: Direct,
    at_once: AtOnce,
    of_peers: BTreeSet<Key>,
    moved: Option<Motion>,
}

impl TeamCopy {
    /// Makes the empty map of a session.
    pub(super) fn new(start: &Start) -> Self {
        let start = Start {
            survey: true,
            ..start.clone()
        };
        let mut survey = Direct::new();
        // A device that refuses the parameters refuses them here, too.
        let _ = survey.control(&Control::Start(start.clone()));
        Self {
            config: convert::config(&start, &Tuning::DEFAULT).ok(),
            survey,
            at_once: AtOnce::default(),
            of_peers: BTreeSet::new(),
            moved: None,
        }
    }

    /// Takes an observation and the device's answer.
    pub(super) fn observe(&mut self, observation: &Observation, command: &Command) {
        let (was_own, before) = (host_copy::has_own_frame(self.survey.state()), self.pose());
        let answered = self.survey.observe(observation);
        debug_assert!(answered.is_ok(), "{answered:?}");
        if let Some(config) = &self.config {
            self.at_once.take(config, observation);
        }
        let has_joined = was_own && !host_copy::has_own_frame(self.survey.state());
        self.moved = has_joined.then(|| Motion::between(&before, &self.pose()));
        if let Some(config) = self.config.as_ref().filter(|_| command.forgot_arrivals) {
            host_copy::forget_arrivals(self.survey.state_mut(), config);
        }
    }

    /// Takes a packet that the device hears.
    pub(super) fn hear(&mut self, packet: &Packet) {
        let state = self.survey.state();
        if let Body::Tile(tile) = &packet.body
            && !host_copy::has_own_frame(state)
            && !is_known(host_copy::map(state).planes((tile.x.into(), tile.y.into())))
        {
            self.of_peers.insert((tile.x.into(), tile.y.into()));
        }
        let heard = self.survey.hear(packet);
        debug_assert!(heard.is_ok(), "{heard:?}");
    }

    /// Says what the device says: a tile that is said may be of a new version.
    pub(super) fn say(&mut self) {
        while let Ok(Some(_)) = self.survey.say() {}
    }

    /// Returns true if the device's tiles are this map.
    pub(super) fn equals(&self, link: &mut dyn Link) -> bool {
        let tiles = host_copy::map(self.survey.state()).tiles();
        let mut touched = tiles.touched().map(|(x, y)| (x as i16, y as i16));
        touched.all(|(x, y)| {
            let theirs = link.tile(x, y).ok().flatten();
            let theirs = theirs.map(|tile| tile.cells.to_vec());
            self.survey.state().tile(x, y).map(Vec::from) == theirs
        })
    }
}

fn is_known(planes: Option<Classes>) -> bool {
    planes.is_some_and(|planes| planes != Classes::default())
}

impl MapCopy for TeamCopy {
    fn pose(&self) -> Pose {
        self.survey.state().location().pose.0
    }

    fn epoch(&self) -> u16 {
        self.survey.state().map_epoch()
    }

    fn tiles(&self) -> BTreeMap<Key, Classes> {
        let map = host_copy::map(self.survey.state());
        let tiles = map.tiles().touched();
        let tiles = tiles.filter_map(|at| Some(((at.0 as i16, at.1 as i16), map.planes(at)?)));
        tiles.collect()
    }

    fn correct(&mut self, correction: &MapCorrection) {
        let corrected = self.survey.correct(correction);
        debug_assert!(corrected.is_ok(), "{corrected:?}");
    }

    fn measured(&self, observation: &Observation) -> Observation {
        let observation = self.at_once.again(observation);
        let mut seen = observation.clone();
        let Some(config) = &self.config else {
            return seen;
        };
        let Some(input) = convert::input(&observation, config.lasers()) else {
            return seen;
        };
        let measured = host_copy::without_peers(self.survey.state(), config, &input);
        for (scan, measured) in seen.scans.iter_mut().zip(&measured) {
            for (range_mm, measured_mm) in scan.ranges_mm.iter_mut().zip(measured) {
                if *measured_mm == INVALID_MM {
                    *range_mm = INVALID_MM;
                }
            }
        }
        seen
    }

    fn is_shared(&self) -> bool {
        self.config.as_ref().is_some_and(|it| it.team().is_some())
    }

    fn is_of_peer(&self, tile: Key) -> bool {
        self.of_peers.contains(&tile)
    }

    fn moved(&self) -> Option<Motion> {
        self.moved
    }
}
