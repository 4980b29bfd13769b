//! [`Planner`]: configuration and memory in one value, for programs whose memory is one piece.
//!
//! A chip with split memory, as the STM32F405, holds [`State`] and [`Workspace`] itself and calls
//! [`step`]. Both ways give the same bits.

use crate::config::Config;
use crate::geometry::{Cell, Pose};
use crate::input::{Input, InputFaults};
use crate::localise::Location;
use crate::planner::{Output, State, Task, TaskError, Workspace, step};
use crate::profiling::StageTimer;
use crate::status::{ResidualFrontier, Status};
use crate::team::packet::Packet;
use crate::team::peers::{Peer, Peers};

/// The capacity of a planner: `TILES` map tiles of 3.2 × 3.2 m in the pool, and `SLOTS` tiles that
/// the map may have, wherever they lie. Tiles that are all free, or have no obstacle, need little
/// or no place in the pool.
///
/// ```
/// use fieldline_planner::{Capacity, Config, LaserMount, Memory, Planner, RobotShape};
///
/// type Small = Capacity<16, 20>;
///
/// /// A planner of any capacity, on the heap.
/// fn planner<M: Memory>(config: &Config) -> Box<Planner<M>> {
///     Box::new(Planner::new(config))
/// }
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()?;
/// let planner = planner::<Small>(&config);
/// assert!(size_of_val(&*planner) < 110_000);
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug)]
pub struct Capacity<const TILES: usize, const SLOTS: usize>;

/// The capacity of the image for an STM32F405: 368 touched tiles of 10 m².
pub type F405 = Capacity<172, 368>;

/// A capacity that a [`Planner`] can have. Only [`Capacity`] implements it.
pub trait Memory: sealed::Memory {}

impl<const TILES: usize, const SLOTS: usize> Memory for Capacity<TILES, SLOTS> {}

/// A planner with its configuration and memory.
///
/// ```
/// use fieldline_planner::{Config, F405, Input, LaserMount, Planner, RobotShape, Status};
/// use fieldline_planner::{Pose, Twist};
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .build()?;
/// let mut planner = Box::new(Planner::<F405>::new(&config));
/// // A wall 2 m away on all sides.
/// let ranges_mm = [2_000; 181];
/// let output = planner.step(&Input {
///     time_ms: 0,
///     pose: Pose::default(),
///     velocity: Twist::default(),
///     scans: [&ranges_mm, &[]],
/// });
/// assert_eq!(output.status, Status::Exploring);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct Planner<M: Memory> {
    config: Config,
    state: M::State,
    workspace: Workspace,
}

impl<M: Memory> Planner<M> {
    /// Returns a planner at the beginning of a session.
    #[must_use]
    pub fn new(config: &Config) -> Self {
        let mut planner = Self {
            config: config.clone(),
            state: sealed::Planning::empty(),
            workspace: Workspace::new(),
        };
        planner.restart(config);
        planner
    }

    /// Forgets everything and begins a session with another configuration.
    pub fn restart(&mut self, config: &Config) {
        sealed::Planning::reset(&mut self.state, config);
        self.config = config.clone();
    }

    /// Runs one step: from scans and odometry to a velocity.
    pub fn step(&mut self, input: &Input<'_>) -> Output {
        self.step_timed(input, &mut ())
    }

    /// Runs one step and marks the end of each stage on `timer`.
    pub fn step_timed(&mut self, input: &Input<'_>, timer: &mut impl StageTimer) -> Output {
        sealed::Planning::step(
            &mut self.state,
            &self.config,
            &mut self.workspace,
            *input,
            timer,
        )
    }

    /// Takes an order to drive. Returns the status that follows.
    ///
    /// # Errors
    /// [`TaskError`]. Nothing has changed then.
    pub fn order(&mut self, task: Task) -> Result<Status, TaskError> {
        sealed::Planning::order(&mut self.state, &self.config, task)
    }

    /// Sets home, a pose of the map, in the place of the first scan's: for a map that was given to
    /// the planner, or a dock elsewhere.
    ///
    /// # Errors
    /// [`TaskError::BadGoal`] if it is no number, or farther than 3200 m from the map's origin.
    pub fn set_home(&mut self, home: Pose) -> Result<(), TaskError> {
        sealed::Planning::set_home(&mut self.state, home)
    }

    /// Takes a packet that another robot of the team said.
    ///
    /// ```
    /// use fieldline_planner::{
    ///     Config, F405, Input, LaserMount, Member, Peer, Planner, Pose, RobotShape, TeamPlace,
    ///     Twist,
    /// };
    ///
    /// // Two robots, 3 m apart, that look the same way.
    /// let mut team = [0.0, 3.0].map(|x_m| {
    ///     let config = Config::builder(RobotShape::PIONEER_3AT)
    ///         .laser(LaserMount::level(0.10, 0.40))
    ///         .team(TeamPlace {
    ///             member: Member { id: x_m as u8, boot: 0 },
    ///             map_from_odom: Pose { x_m, ..Pose::default() },
    ///             sd_m: 0.0,
    ///             sd_rad: 0.0,
    ///         })
    ///         .build()
    ///         .unwrap();
    ///     Box::new(Planner::<F405>::new(&config))
    /// });
    /// let ranges_mm = [2_000; 181];
    /// let input = Input {
    ///     time_ms: 0,
    ///     pose: Pose::default(),
    ///     velocity: Twist::default(),
    ///     scans: [&ranges_mm, &[]],
    /// };
    /// for (from, to) in [(0, 1), (1, 0)] {
    ///     team[from].step(&input);
    ///     while let Some(packet) = team[from].say() {
    ///         team[to].hear(&packet);
    ///     }
    /// }
    /// let place = |peer: &Peer| peer.pose(0).x_m;
    /// assert_eq!(team[0].peers().map(place).collect::<Vec<f32>>(), [3.0]);
    /// ```
    pub fn hear(&mut self, packet: &Packet) {
        sealed::Planning::hear(&mut self.state, &self.config, packet);
    }

    /// Returns the next packet for the team; `None` until the next step, and for a robot alone. Ask
    /// after every step until there is none.
    pub fn say(&mut self) -> Option<Packet> {
        sealed::Planning::say(&mut self.state, &self.config)
    }

    /// Returns the other robots of the team, as their last beacons told.
    pub fn peers(&self) -> impl Iterator<Item = &Peer> {
        sealed::Planning::peers(&self.state).iter()
    }

    /// Returns the configuration.
    pub const fn config(&self) -> &Config {
        &self.config
    }

    /// Returns the status after the last step.
    pub fn status(&self) -> Status {
        sealed::Planning::status(&self.state)
    }

    /// Returns the numbers of inputs that were not as they should be.
    pub fn input_faults(&self) -> InputFaults {
        sealed::Planning::input_faults(&self.state)
    }

    /// Returns the robot's pose in the map after the last step.
    pub fn location(&self) -> Location {
        sealed::Planning::location(&self.state)
    }

    /// Returns the path to the current goal: coarse cells of 20 cm, each named by the least of its
    /// four map cells, the robot's end first.
    pub fn path(&self) -> &[Cell] {
        sealed::Planning::path(&self.state)
    }

    /// Returns the residual frontiers, each with its reason.
    pub fn frontiers(&self) -> &[ResidualFrontier] {
        sealed::Planning::frontiers(&self.state)
    }

    /// Returns the 32 × 32 cells of the map tile in this column and row, two bits each, least x and
    /// y first: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle. `None` if no cell of it was
    /// ever measured.
    pub fn tile(&self, column: i16, row: i16) -> Option<[u8; 256]> {
        sealed::Planning::tile(&self.state, column, row)
    }

    /// Returns the scratch memory, which holds the last step's field.
    pub const fn workspace(&self) -> &Workspace {
        &self.workspace
    }
}

/// Erases the two numbers of a [`Capacity`].
mod sealed {
    use core::fmt::Debug;

    use super::{
        Capacity, Cell, Config, Input, InputFaults, Location, Output, Packet, Peers, Pose,
        ResidualFrontier, StageTimer, State, Status, Task, TaskError, Workspace, step,
    };

    /// A capacity.
    pub trait Memory {
        /// Its state.
        type State: Planning + Debug;
    }

    impl<const TILES: usize, const SLOTS: usize> Memory for Capacity<TILES, SLOTS> {
        type State = State<TILES, SLOTS>;
    }

    /// A [`State`] of any capacity.
    pub trait Planning {
        fn empty() -> Self;
        fn reset(&mut self, config: &Config);
        fn step(
            &mut self,
            config: &Config,
            workspace: &mut Workspace,
            input: Input<'_>,
            timer: &mut impl StageTimer,
        ) -> Output;
        fn order(&mut self, config: &Config, task: Task) -> Result<Status, TaskError>;
        fn set_home(&mut self, home: Pose) -> Result<(), TaskError>;
        fn hear(&mut self, config: &Config, packet: &Packet);
        fn say(&mut self, config: &Config) -> Option<Packet>;
        fn peers(&self) -> &Peers;
        fn status(&self) -> Status;
        fn input_faults(&self) -> InputFaults;
        fn location(&self) -> Location;
        fn path(&self) -> &[Cell];
        fn frontiers(&self) -> &[ResidualFrontier];
        fn tile(&self, column: i16, row: i16) -> Option<[u8; 256]>;
    }

    impl<const TILES: usize, const SLOTS: usize> Planning for State<TILES, SLOTS> {
        fn empty() -> Self {
            Self::new()
        }

        fn reset(&mut self, config: &Config) {
            Self::reset(self, config);
        }

        fn step(
            &mut self,
            config: &Config,
            workspace: &mut Workspace,
            input: Input<'_>,
            timer: &mut impl StageTimer,
        ) -> Output {
            step(config, self, workspace, input, timer)
        }

        fn order(&mut self, config: &Config, task: Task) -> Result<Status, TaskError> {
            Self::order(self, config, task)
        }

        fn set_home(&mut self, home: Pose) -> Result<(), TaskError> {
            Self::set_home(self, home)
        }

        fn hear(&mut self, config: &Config, packet: &Packet) {
            Self::hear(self, config, packet);
        }

        fn say(&mut self, config: &Config) -> Option<Packet> {
            Self::say(self, config)
        }

        fn peers(&self) -> &Peers {
            self.team.peers()
        }

        fn status(&self) -> Status {
            Self::status(self)
        }

        fn input_faults(&self) -> InputFaults {
            Self::input_faults(self)
        }

        fn location(&self) -> Location {
            Self::location(self)
        }

        fn path(&self) -> &[Cell] {
            Self::path(self)
        }

        fn frontiers(&self) -> &[ResidualFrontier] {
            Self::frontiers(self)
        }

        fn tile(&self, column: i16, row: i16) -> Option<[u8; 256]> {
            Self::tile(self, column, row)
        }
    }
}
