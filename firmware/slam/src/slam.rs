//! The front end: scans become keyframes, keyframes are aligned with the last ones, and loops are
//! closed.
//!
//! ```text
//! a scan ─► moved or turned enough? ─► grid of the last keyframes
//!             │ no: last keyframe ∘ motion      │
//!             ▼                                 ▼
//!            pose            starts: odometry, the pose that others located, a search if both fail
//!                                               │ the one with most ends near a wall
//!                                               ▼
//!                                 a keyframe, and a try to close a loop ─► solve
//! ```
//!
//! Units: metres, radians, millimetres where a name says so.

use crate::alignment::{Alignment, Prior, align};
use crate::closing::{Tried, Waiting, try_to_close};
use crate::correlation::Reach;
use crate::graph::Graph;
use crate::matrix::{Cholesky, turned};
use crate::motion::Motion;
use crate::pose::{Pose, sqrt};
use crate::scan::{LASERS, Laser, Scan};
use crate::solver;
use crate::workspace::Workspace;

/// The local grid holds the keyframes of so much way, metres, and at least so many.
const LOCAL: (f32, usize) = (6.0, 12);
/// Share of ends near a wall from which on a start is good.
const GOOD: f32 = 0.8;
/// Another start than odometry must bring so much more.
const BETTER: f32 = 0.05;
/// A located motion that odometry errs more from is wrong: χ² of three numbers, one in a hundred.
const MOST_CHI2: f32 = 11.3;
/// How far the local search goes, metres.
const SEARCH_M: f32 = 0.3;
/// Least and greatest turn of the local search, radians.
const SEARCH_RAD: (f32, f32) = (0.05, 0.35);
/// Rounds of the solver at a closure.
const ROUNDS: usize = 2;
/// Rounds of the solver at the end.
const LAST_ROUNDS: usize = 8;

/// What a session says once.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Config {
    /// The lasers; those without beams are not there.
    pub lasers: [Laser; LASERS],
    /// What odometry may err.
    pub motion: Motion,
    /// Way after which a scan becomes a keyframe, metres.
    pub key_m: f32,
    /// Turn after which a scan becomes a keyframe, radians.
    pub key_rad: f32,
    /// What may be left out.
    pub rules: Rules,
}

/// Rules of the graph. Each can be left out, to see what it buys.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rules {
    /// Φ of the robust weights: a closure whose χ² is greater loses weight. It is positive, and at
    /// most [`Rules::NEVER`].
    pub scaling: f32,
    /// A closure waits until a second one agrees.
    pub agreement: bool,
    /// The motion that others located is a start of an alignment.
    pub located: bool,
}

impl Rules {
    /// Φ by which no closure loses weight.
    pub const NEVER: f32 = 1e37;

    /// All rules.
    pub const ALL: Self = Self {
        scaling: 20.0,
        agreement: true,
        located: true,
    };
}

impl Config {
    /// The usual distances of keyframes, for a laser and wheels.
    #[must_use]
    pub const fn new(laser: Laser, motion: Motion) -> Self {
        Self {
            lasers: [laser, Laser::NONE],
            motion,
            key_m: 0.25,
            key_rad: 0.2,
            rules: Rules::ALL,
        }
    }

    /// The same with a second laser.
    #[must_use]
    pub const fn with_second(self, laser: Laser) -> Self {
        let [first, _] = self.lasers;
        Self {
            lasers: [first, laser],
            ..self
        }
    }
}

/// What a scan did.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Observed {
    /// Pose in the graph's map.
    pub pose: Pose,
    /// The keyframe that the pose hangs on; the newest one.
    pub key: usize,
    /// Pose in the frame of that keyframe. With it the pose can be corrected later.
    pub from_key: Pose,
    /// A loop was closed: poses of the past have moved.
    pub closed: bool,
    /// How far the closure moved the newest keyframe, metres.
    pub moved_m: f32,
    /// The graph has no room: from now on poses only hang on the last keyframe.
    pub is_full: bool,
}

/// Counts of a session.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counts {
    /// Keyframes.
    pub keyframes: usize,
    /// Closures in the graph.
    pub closed: usize,
    /// Tries that brought none.
    pub refused: usize,
}

/// A pose graph of at most `KEYS` keyframes with `BEAMS` ranges each, and `LOOPS` closures.
#[derive(Clone, Debug)]
pub struct Slam<const KEYS: usize, const LOOPS: usize, const BEAMS: usize> {
    config: Config,
    graph: Graph<KEYS, LOOPS, BEAMS>,
    waiting: Option<Waiting>,
    refused: usize,
    /// Odometry and located pose at the last keyframe.
    odom: Pose,
    located: Option<Pose>,
    /// Loops are closed now.
    closes: bool,
}

impl<const KEYS: usize, const LOOPS: usize, const BEAMS: usize> Slam<KEYS, LOOPS, BEAMS> {
    /// Returns an empty graph.
    #[must_use]
    pub const fn new(config: Config) -> Self {
        const {
            assert!(
                KEYS <= u16::MAX as usize,
                "a closure counts keyframes by 16 bits"
            );
        }
        const ORIGIN: Pose = Pose {
            x_m: 0.0,
            y_m: 0.0,
            yaw_rad: 0.0,
        };
        Self {
            config,
            graph: Graph::new(config.rules.scaling),
            waiting: None,
            refused: 0,
            odom: ORIGIN,
            located: None,
            closes: true,
        }
    }

    /// Takes the ranges of all lasers, one laser after the other, with odometry's pose and the pose
    /// that someone else located, if they did. The first scan's located pose, or else odometry's,
    /// is its pose in the map.
    pub fn observe<const SIDE: usize>(
        &mut self,
        odom: &Pose,
        located: Option<&Pose>,
        ranges_mm: &[u16],
        workspace: &mut Workspace<KEYS, SIDE>,
    ) -> Observed {
        let is_first = self.graph.keys.is_empty();
        let motion = self.odom.between(odom);
        let located_motion = self.located.as_ref().zip(located);
        let located_motion = located_motion.map(|(from, to)| from.between(to));
        let is_key = is_first
            || motion.length_m() > self.config.key_m
            || motion.yaw_rad.abs() > self.config.key_rad;
        if !is_key || self.graph.keys.is_full() {
            let motion = located_motion.unwrap_or(motion);
            return self.observed(motion);
        }
        let scan = Scan::of(&self.config.lasers, ranges_mm);
        let (motion, factor) = if is_first {
            (*located.unwrap_or(odom), Cholesky::UNIT)
        } else {
            let found = self.place(&scan, (&motion, located_motion.as_ref()), workspace);
            self.chained(&found)
        };
        // There is room.
        let _ = self.graph.add(&motion, factor, ranges_mm);
        (self.odom, self.located) = (*odom, located.copied());
        let number = self.graph.keys.len() - 1;
        let before = self.graph.pose(number).unwrap_or_default();
        let closed = self.close(&scan, workspace);
        let seen = self.observed(Pose::default());
        Observed {
            closed,
            moved_m: before.between(&seen.pose).length_m(),
            ..seen
        }
    }

    /// Solves the graph until it rests.
    pub fn finish<const SIDE: usize>(&mut self, workspace: &mut Workspace<KEYS, SIDE>) {
        solver::solve(&mut self.graph, &mut workspace.vectors, LAST_ROUNDS);
    }

    /// Says whether loops are closed from now on. At first they are.
    pub fn set_closing(&mut self, closes: bool) {
        self.closes = closes;
    }

    /// Tells that the frame of located poses has moved: all later ones are given in the new one.
    pub fn relocate(&mut self, motion: &Pose) {
        self.located = self.located.map(|located| motion.compose(&located));
    }

    /// Returns a keyframe's pose.
    #[must_use]
    pub fn pose(&self, key: usize) -> Option<Pose> {
        self.graph.pose(key)
    }

    /// Returns the counts so far.
    #[must_use]
    pub fn counts(&self) -> Counts {
        Counts {
            keyframes: self.graph.keys.len(),
            closed: self.graph.closures.len(),
            refused: self.refused,
        }
    }

    /// Returns the session's configuration.
    #[must_use]
    pub const fn config(&self) -> &Config {
        &self.config
    }

    fn observed(&self, from_key: Pose) -> Observed {
        let key = self.graph.keys.len().saturating_sub(1);
        let last = self.graph.pose(key).unwrap_or_default();
        Observed {
            pose: last.compose(&from_key),
            key,
            from_key,
            closed: false,
            moved_m: 0.0,
            is_full: self.graph.keys.is_full(),
        }
    }

    /// Aligns a scan with the last keyframes.
    fn place<const SIDE: usize>(
        &self,
        scan: &Scan<BEAMS>,
        (motion, located): (&Pose, Option<&Pose>),
        workspace: &mut Workspace<KEYS, SIDE>,
    ) -> Alignment {
        let keys = &self.graph.keys;
        let last = keys.last();
        let (last, way_m) = last.map_or_else(Default::default, |key| (key.pose, key.way_m));
        workspace.grid.clear(&last);
        let first = keys.partition_point(|key| key.way_m < way_m - LOCAL.0);
        let first = first.min(keys.len().saturating_sub(LOCAL.1));
        for key in keys.iter().skip(first) {
            let scan: Scan<BEAMS> = Scan::of(&self.config.lasers, &key.ranges_mm);
            workspace.grid.enter(&key.pose, &scan);
        }
        let grid = &workspace.grid;
        let predicted = last.compose(motion);
        let variances = self.config.motion.variances(motion);
        let prior = Prior {
            pose: predicted,
            information: turned(&self.config.motion.information(motion), -predicted.yaw_rad),
        };
        let mut best = align(grid, scan, &predicted, &prior);
        let located = located.filter(|_| self.config.rules.located);
        let located = located.filter(|located| {
            let off = located.minus(motion);
            let parts = off.iter().zip(&variances);
            parts
                .map(|(off, variance)| off * off / variance)
                .sum::<f32>()
                < MOST_CHI2
        });
        if let Some(located) = located {
            // Who located the robot has a whole map, and a grid of the last keyframes is a part.
            let pose = last.compose(located);
            let other = align(grid, scan, &pose, &Prior { pose, ..prior });
            if other.share + BETTER >= best.share {
                best = other;
            }
        }
        if best.share < GOOD {
            let [_, _, turn] = variances;
            let reach = Reach {
                way_m: SEARCH_M,
                turn_rad: (3.0 * sqrt(turn)).clamp(SEARCH_RAD.0, SEARCH_RAD.1),
            };
            if let Some(start) = workspace.planes.search(grid, scan, &predicted, reach) {
                let other = align(grid, scan, &start, &prior);
                if other.share > best.share + BETTER {
                    best = other;
                }
            }
        }
        best
    }

    /// Returns an alignment as a motion from the last keyframe, with its factor.
    fn chained(&self, found: &Alignment) -> (Pose, Cholesky) {
        let last = self
            .graph
            .keys
            .last()
            .map(|key| key.pose)
            .unwrap_or_default();
        let information = turned(&found.information, last.yaw_rad);
        let factor = Cholesky::of(&information).unwrap_or(Cholesky::UNIT);
        (last.between(&found.pose), factor)
    }

    /// Tries to close a loop at the newest keyframe. Returns true if poses have moved.
    fn close<const SIDE: usize>(
        &mut self,
        scan: &Scan<BEAMS>,
        workspace: &mut Workspace<KEYS, SIDE>,
    ) -> bool {
        if !self.closes {
            return false;
        }
        let scan = (&self.config.lasers, scan);
        let agreement = self.config.rules.agreement;
        let waiting = &mut self.waiting;
        let tried = try_to_close(&mut self.graph, waiting, scan, workspace, agreement);
        self.refused += usize::from(tried == Tried::Refused);
        if tried != Tried::Closed {
            return false;
        }
        solver::solve(&mut self.graph, &mut workspace.vectors, ROUNDS);
        true
    }
}

#[cfg(test)]
mod aliases;
#[cfg(test)]
mod tests;
