//! The runs that judge the constants of each room.

use host_sim::trial::mission::{Mission, OdometryProfile};
use host_sim::trial::uneven::TABLE_I;

use crate::loops::{OUROBOROS, TDBVP};
use crate::runs::FRONTIER;
use Ground::{Flat, Uneven};
use Noise::{Attitude, Odometry, Ranges};

/// Strategy of forces, with paths where they lead nowhere.
const ESBPF: &str = "esbpf";
/// Duration of a patrol, seconds.
const PATROL_S: u16 = 300;
/// Standard deviation of roll and pitch of [`Attitude`], degrees.
const ATTITUDE_DEG: f64 = 0.5;

/// A room of the planner with its runs.
#[derive(Clone, Copy, Debug)]
pub struct Room {
    /// The name in front of its constants.
    pub name: &'static str,
    /// The runs.
    pub runs: &'static [Run],
    /// True if loops closed and, on patrol, ages of rails count.
    pub closes_loops: bool,
}

/// A run, apart from its seed and its tuning.
#[derive(Clone, Copy, Debug)]
pub struct Run {
    /// The built-in world.
    pub world: &'static str,
    /// Index of the start in the world.
    pub start: usize,
    strategy: &'static str,
    ground: Ground,
    noise: Noise,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Ground {
    Flat,
    Uneven,
}

/// Noise of the sensors, each with that of the line before.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Noise {
    /// Noise of the ranges.
    Ranges,
    /// Noise of roll and pitch.
    Attitude,
    /// Drift of wheels and heading.
    Odometry,
}

impl Noise {
    const fn name(self) -> &'static str {
        match self {
            Ranges => "ranges",
            Attitude => "and attitude",
            Odometry => "and odometry",
        }
    }
}

const fn run(
    world: &'static str,
    start: usize,
    strategy: &'static str,
    ground: Ground,
    noise: Noise,
) -> Run {
    Run {
        world,
        start,
        strategy,
        ground,
        noise,
    }
}

/// The rooms.
pub const ROOMS: [Room; 8] = [
    Room {
        name: "ground",
        runs: &[
            run("building", 0, FRONTIER, Uneven, Ranges),
            run("slope", 0, FRONTIER, Uneven, Attitude),
            run("holes", 0, FRONTIER, Uneven, Ranges),
            run("kerbs", 0, FRONTIER, Uneven, Ranges),
            run("kerbs", 1, FRONTIER, Uneven, Attitude),
            run("cliff", 0, FRONTIER, Uneven, Ranges),
            run("causeway", 0, FRONTIER, Uneven, Attitude),
        ],
        closes_loops: false,
    },
    Room {
        name: "map",
        runs: &[
            run("office", 0, FRONTIER, Flat, Ranges),
            run("office", 1, FRONTIER, Flat, Odometry),
            run("kerbs", 0, FRONTIER, Uneven, Ranges),
            run("causeway", 0, FRONTIER, Uneven, Attitude),
            run("cluttered", 0, FRONTIER, Flat, Ranges),
            run("narrow-doors", 0, FRONTIER, Flat, Ranges),
            run("cave", 0, FRONTIER, Flat, Ranges),
            run("loop", 0, FRONTIER, Flat, Ranges),
        ],
        closes_loops: false,
    },
    Room {
        name: "order",
        runs: &[
            run("office", 0, FRONTIER, Flat, Ranges),
            run("office", 1, FRONTIER, Flat, Odometry),
            run("hall", 0, FRONTIER, Flat, Ranges),
            run("cluttered", 0, FRONTIER, Flat, Ranges),
            run("narrow-doors", 0, FRONTIER, Flat, Ranges),
            run("cave", 0, FRONTIER, Flat, Ranges),
            run("loop", 0, FRONTIER, Flat, Ranges),
        ],
        closes_loops: false,
    },
    Room {
        name: "localise",
        runs: &[
            run("office", 0, FRONTIER, Flat, Odometry),
            run("cave", 0, FRONTIER, Flat, Odometry),
            run("loop", 0, FRONTIER, Flat, Odometry),
            run("ouroboros-a", 0, FRONTIER, Flat, Odometry),
            run("ouroboros-b", 0, FRONTIER, Flat, Odometry),
            run("hall", 0, FRONTIER, Flat, Odometry),
        ],
        closes_loops: false,
    },
    Room {
        name: "field",
        runs: &[
            run("office", 0, FRONTIER, Flat, Ranges),
            run("office", 1, FRONTIER, Flat, Ranges),
            run("cave", 0, FRONTIER, Flat, Ranges),
            run("cluttered", 0, FRONTIER, Flat, Ranges),
            run("hall", 0, FRONTIER, Flat, Ranges),
            run("empty-hall", 0, FRONTIER, Flat, Ranges),
            run("loop", 0, FRONTIER, Flat, Ranges),
            run("narrow-doors", 0, FRONTIER, Flat, Ranges),
            run("slope", 0, FRONTIER, Uneven, Ranges),
            run("kerbs", 0, FRONTIER, Uneven, Ranges),
        ],
        closes_loops: false,
    },
    Room {
        name: "tdbvp",
        runs: &[
            run("ouroboros-a", 0, TDBVP, Flat, Ranges),
            run("ouroboros-b", 0, TDBVP, Flat, Ranges),
            run("office", 0, TDBVP, Flat, Ranges),
            run("cluttered", 0, TDBVP, Flat, Ranges),
            run("ouroboros-a", 1, TDBVP, Flat, Ranges),
            run("ouroboros-b", 1, TDBVP, Flat, Ranges),
            run("office", 1, TDBVP, Flat, Ranges),
            run("cluttered", 1, TDBVP, Flat, Ranges),
        ],
        closes_loops: true,
    },
    Room {
        name: "sbpf",
        runs: &[
            run("two-rooms", 0, ESBPF, Flat, Ranges),
            run("c-room", 0, ESBPF, Flat, Ranges),
            run("partition", 0, ESBPF, Flat, Ranges),
            run("office", 0, ESBPF, Flat, Ranges),
            run("hall", 0, ESBPF, Flat, Ranges),
        ],
        closes_loops: false,
    },
    Room {
        name: "ouroboros",
        runs: &[
            run("ouroboros-a", 0, OUROBOROS, Flat, Ranges),
            run("ouroboros-b", 0, OUROBOROS, Flat, Ranges),
            run("office", 0, OUROBOROS, Flat, Ranges),
            run("loop", 0, OUROBOROS, Flat, Ranges),
            run("ouroboros-c", 0, OUROBOROS, Flat, Ranges),
            run("ouroboros-d", 0, OUROBOROS, Flat, Ranges),
            run("ouroboros-a", 1, OUROBOROS, Flat, Ranges),
            run("ouroboros-b", 1, OUROBOROS, Flat, Ranges),
            run("office", 1, OUROBOROS, Flat, Ranges),
            run("ouroboros-d", 1, OUROBOROS, Flat, Ranges),
        ],
        closes_loops: true,
    },
];

impl Room {
    /// Returns the room with its first `most` runs, at least one.
    #[must_use]
    pub fn with_first(&self, most: usize) -> Self {
        let runs = &self.runs[..most.clamp(1, self.runs.len())];
        Self { runs, ..*self }
    }
}

impl Run {
    /// Returns the words that name the run: world, start, noise.
    #[must_use]
    pub fn words(&self) -> [String; 3] {
        let noise = self.noise.name().to_owned();
        [self.world.into(), self.start.to_string(), noise]
    }

    /// Returns the run's name in a [`Store`](super::store::Store).
    #[must_use]
    pub fn key(&self) -> String {
        let Self {
            world,
            start,
            strategy,
            ground,
            noise,
        } = self;
        format!("{world}:{start}:{strategy}:{ground:?}:{noise:?}")
    }

    /// Returns true if the strategy closes loops on purpose.
    #[must_use]
    pub fn closes_loops(&self) -> bool {
        self.strategy != FRONTIER
    }

    /// Returns the duration of the patrol at the end of the run, seconds.
    #[must_use]
    pub fn patrol_s(&self) -> u16 {
        if self.strategy == TDBVP { PATROL_S } else { 0 }
    }

    /// Returns the mission.
    #[must_use]
    pub fn mission(&self, seed: u64, time_limit_ms: u32) -> Mission {
        Mission {
            strategy: self.strategy.into(),
            uneven_ground: (self.ground == Uneven).then_some(TABLE_I),
            seed,
            start: self.start,
            odometry: if self.noise == Odometry {
                OdometryProfile::Noisy
            } else {
                OdometryProfile::Truth
            },
            localise: self.noise == Odometry,
            imu_rad: (self.noise == Attitude).then_some(ATTITUDE_DEG.to_radians()),
            patrol_s: self.patrol_s(),
            time_limit_ms,
            ..Mission::default()
        }
    }
}
