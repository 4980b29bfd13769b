//! Meetings of robots where there is no room to pass: worlds, starts and goals.
//!
//! Each robot wants to explore the side on which another one is, or to leave by the same door, so
//! they meet. A user's order of goals says so: what lies on the robot's own side of x = 0 counts as
//! 80 m farther away.
//!
//! ```text
//!  corridor   ▭ ═════ ▭    1.2 m wide, 8 m long, one robot in the room at each end
//!  door       ▭ | ▭        0.9 m wide, one robot on each side
//!  dead end   ▭ ═════╝     1.2 m wide; the first robot wants out, the other two want in
//!  abreast    ▭ | ▭        0.9 m wide, two robots beside each other want out by one door
//! ```
//!
//! Robots have *met* if their centres were less than 2 m apart. They are *blocked* for good if not
//! all have explored everything within [`LIMIT_S`]. Units: metres, seconds, radians.

use core::f64::consts::PI;

use fieldline_device::session::{self, Boot};
use fieldline_device::{Memory, Pilot, SLOTS, State, TILES, convert};
use fieldline_planner::{Config, Goal, GoalLevel, Order, Tuning, Workspace, step};
use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Observation,
    Packet, Path, Recall, Refusal, ResidualFrontier, Status, Tile, Twist,
};
use host_sim::link::inside::Inside;
use host_sim::link::{Link, LinkError, LinkStats};
use host_sim::report::TeamReport;
use host_sim::trial::mission::Mission;
use host_sim::trial::team::{TeamMission, TeamRecord, explore};
use host_sim::world::{Class, GridCell, Occupancy, Start, World};

use crate::random::Random;
use crate::table::Table;
use crate::teams::longest_stand_s;

/// Simulated time within which all is explored.
pub const LIMIT_S: u32 = 300;
/// Side of a world's cell.
const CELL_M: f64 = 0.05;
/// Corner of least x and y of the worlds, and their size.
const ORIGIN_M: [f64; 2] = [-10.0, -6.0];
const SIZE_M: [f64; 2] = [20.0, 12.0];
/// Robots whose centres are nearer have met.
const MET_M: f64 = 2.0;

/// A place without room to pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Narrow {
    /// A corridor between two rooms.
    Corridor,
    /// A door between two rooms.
    Door,
    /// A corridor with a corner and no other end.
    DeadEnd,
    /// A door with two robots on one side, beside each other.
    Abreast,
}

/// All of them.
pub const ALL: [Narrow; 4] = [
    Narrow::Corridor,
    Narrow::Door,
    Narrow::DeadEnd,
    Narrow::Abreast,
];

/// A rectangle: least x, least y, greatest x, greatest y.
type Rectangle = [f64; 4];

impl Narrow {
    /// Returns its name.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Corridor => "corridor",
            Self::Door => "door",
            Self::DeadEnd => "dead end",
            Self::Abreast => "abreast",
        }
    }

    /// Draws the world.
    #[must_use]
    pub fn world(self) -> World {
        let mut free: Vec<Rectangle> = match self {
            // A room, an opening that the other side does not look into, and a side room.
            Self::Corridor => vec![
                [-8.0, -2.0, -4.0, 2.0],
                [-7.5, 2.0, -6.5, 2.2],
                [-8.0, 2.2, -5.0, 4.5],
                [-4.0, -0.6, 0.0, 0.6],
            ],
            Self::Door | Self::Abreast => vec![
                [-5.0, -2.0, -0.1, 2.0],
                [-4.5, 2.0, -3.5, 2.2],
                [-5.0, 2.2, -2.0, 4.5],
                [-0.1, -0.45, 0.0, 0.45],
            ],
            Self::DeadEnd => vec![
                [-9.0, -2.5, -4.0, 2.5],
                [-8.0, 2.5, -7.0, 2.7],
                [-9.0, 2.7, -6.0, 4.8],
                [-4.0, -0.6, 4.0, 0.6],
                [2.8, 0.6, 4.0, 3.0],
            ],
        };
        if self != Self::DeadEnd {
            let turned = free.clone().into_iter();
            free.extend(turned.map(|[x0, y0, x1, y1]| [-x1, -y1, -x0, -y0]));
        }
        let [width, height] = SIZE_M.map(|side_m| (side_m / CELL_M) as usize);
        let mut grid = Occupancy::filled(width, height, CELL_M, ORIGIN_M, Class::Wall);
        for (i, j) in (0..width as i64).flat_map(|i| (0..height as i64).map(move |j| (i, j))) {
            let cell = GridCell { i, j };
            let [x, y] = grid.centre(cell);
            let holds = |of: &Rectangle| of[0] <= x && x <= of[2] && of[1] <= y && y <= of[3];
            if free.iter().any(holds) {
                grid.set(cell, Class::Free);
            }
        }
        World::flat(self.name(), grid, Vec::new())
    }

    /// Returns where each robot starts, and true if it wants to the side of greater x.
    fn starts(self, seed: u64) -> Vec<(Start, bool)> {
        let mut random = Random::mixed(seed);
        let mut within = |from: f64, to: f64| from + (to - from) * random.unit();
        let far_m = match self {
            Self::Corridor => within(4.6, 5.8),
            Self::Door | Self::DeadEnd => within(1.2, 2.2),
            Self::Abreast => within(0.7, 1.0),
        };
        let mut start = |x_m: f64, y_m: f64, yaw_rad: f64, turned: bool| {
            let side = if turned { -1.0 } else { 1.0 };
            Start {
                x_m: side * (x_m + within(-0.2, 0.2)),
                y_m: within(-y_m, y_m),
                yaw_rad: within(-yaw_rad, yaw_rad) + if turned { PI } else { 0.0 },
            }
        };
        let mut starts = match self {
            Self::Corridor => vec![
                (start(-far_m, 0.8, 0.6, false), true),
                (start(-far_m, 0.8, 0.6, true), false),
            ],
            Self::Door => vec![
                (start(-far_m, 1.0, 0.6, false), true),
                (start(-far_m, 1.0, 0.6, true), false),
            ],
            Self::DeadEnd => vec![
                (start(-far_m, 0.05, 0.3, true), false),
                (start(-far_m, 0.05, 0.3, false), true),
                (start(-far_m - 3.6, 0.2, 0.5, false), true),
            ],
            Self::Abreast => [-1.0, 1.0]
                .map(|side| {
                    let start = start(-far_m, 0.06, 0.3, false);
                    let beside = Start {
                        y_m: start.y_m + 0.48 * side,
                        yaw_rad: start.yaw_rad - 0.7 * side,
                        ..start
                    };
                    (beside, true)
                })
                .to_vec(),
        };
        // Every place has every number.
        let robots = starts.len();
        starts.rotate_left(seed as usize % robots);
        starts
    }
}

/// Goals with less x count as 80 m farther away.
fn to_greater_x(goal: &Goal) -> u8 {
    if goal.cell.x < 0 { 8 } else { 0 }
}

/// Goals with greater x count as 80 m farther away.
fn to_less_x(goal: &Goal) -> u8 {
    if goal.cell.x < 0 { 0 } else { 8 }
}

/// A planner with an order of goals, behind a link without bytes.
struct Ordered {
    level: GoalLevel,
    config: Option<Config>,
    state: Box<State>,
    workspace: Box<Workspace>,
    status: Status,
}

impl Ordered {
    fn new(level: GoalLevel) -> Self {
        Self {
            level,
            config: None,
            state: Box::new(State::new()),
            workspace: Box::new(Workspace::new()),
            status: Status::Idle,
        }
    }

    /// Returns the configuration of a session, with the order.
    fn configure(&self, control: &Control) -> Option<Config> {
        let Control::Start(start) = control else {
            return None;
        };
        let told = convert::config(start, &Tuning::DEFAULT).expect("a start");
        let mut builder = Config::builder(*told.robot())
            .radius_m(told.radius_m())
            .order(Order::Gain { worth: 0.0 })
            .goal_level(self.level);
        for laser in told.lasers() {
            builder = builder.laser(*laser);
        }
        if let Some(place) = told.team() {
            builder = builder.team(*place);
        }
        Some(builder.build().expect("a configuration"))
    }

    fn memory(&mut self) -> Memory<'_, TILES, SLOTS> {
        Memory {
            state: &mut self.state,
            workspace: &mut self.workspace,
            tuning: &Tuning::DEFAULT,
        }
    }

    fn config(&self) -> Result<Config, LinkError> {
        let refused = || LinkError::Refused(Refusal::NotStarted.to_string());
        self.config.clone().ok_or_else(refused)
    }
}

impl Link for Ordered {
    fn hello(&mut self) -> Result<Identity, LinkError> {
        Ok(session::identity(Boot::default(), TILES, SLOTS))
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        if let Some(config) = self.configure(control) {
            self.state.reset(&config);
            (self.config, self.status) = (Some(config), Status::Exploring);
        }
        Ok(self.status)
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        let config = self.config()?;
        let input = convert::input(observation, config.lasers()).expect("an observation");
        if self.status != Status::Exploring {
            self.state.stand(&config, &input);
            return Ok(Command {
                status: self.status,
                ..Command::default()
            });
        }
        let (state, workspace) = (&mut *self.state, &mut *self.workspace);
        let output = step(&config, state, workspace, input, &mut ());
        self.status = convert::wire_status(output.status);
        let velocity = match self.status {
            Status::Exploring => convert::wire_twist(&output.velocity),
            _ => Twist::default(),
        };
        Ok(Command {
            velocity,
            status: self.status,
            forgot_arrivals: output.forgot_arrivals,
            ..Command::default()
        })
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        Ok(Pilot::tile(&self.memory(), x, y))
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        Ok(Pilot::field_row(&self.memory(), row))
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        Ok(Pilot::frontiers(&self.memory()).iter().copied().collect())
    }

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        Ok(Pilot::path(&self.memory(), from))
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        let config = self.config()?;
        if let Some(packet) = convert::packet(packet) {
            self.state.hear(&config, &packet);
        }
        Ok(())
    }

    fn open_correction(&mut self, _: &Correct) -> Result<CorrectionProgress, LinkError> {
        Err(LinkError::Refused("nobody corrects this map".into()))
    }

    fn send_tiles(&mut self, _: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        Err(LinkError::Refused("nobody corrects this map".into()))
    }

    fn recall(&mut self, _: &Recall) -> Result<(), LinkError> {
        Err(LinkError::Refused("nobody corrects this map".into()))
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        let config = self.config()?;
        Ok(self.state.say(&config).map(|it| convert::wire_packet(&it)))
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        None
    }

    fn stats(&self) -> LinkStats {
        LinkStats::default()
    }

    fn take_log(&mut self) -> Vec<u8> {
        Vec::new()
    }
}

/// What came of a meeting.
#[derive(Clone, Debug)]
pub struct Meeting {
    /// Where it was.
    pub narrow: Narrow,
    /// Its seed.
    pub seed: u64,
    /// The least distance between the centres of two robots that explored.
    pub least_m: f64,
    /// The longest time that a robot stood while it explored.
    pub stood_s: f64,
    /// The team's report.
    pub report: TeamReport,
    /// The robots' records.
    pub record: TeamRecord,
}

impl Meeting {
    /// Lets robots meet.
    ///
    /// # Panics
    /// If the robots do not fit at their starts.
    #[must_use]
    pub fn of(narrow: Narrow, seed: u64) -> Self {
        let (world, starts) = (narrow.world(), narrow.starts(seed));
        let mission = Mission {
            seed,
            time_limit_ms: LIMIT_S * 1000,
            ..Mission::default()
        };
        let team = TeamMission {
            places: Some(starts.iter().map(|(start, _)| *start).collect()),
            ..TeamMission::of(mission, starts.len())
        };
        let link = |(_, wants): &(Start, bool)| -> Box<dyn Link> {
            let level: GoalLevel = if *wants { to_greater_x } else { to_less_x };
            Box::new(Ordered::new(level))
        };
        let mut links: Vec<Box<dyn Link>> = starts.iter().map(link).collect();
        let (report, record) = match explore(&team, &world, &mut links, &mut ()) {
            Ok(run) => run,
            Err(error) => panic!("{}, seed {seed}: {error}", narrow.name()),
        };
        Self {
            narrow,
            seed,
            least_m: least_m(&record),
            stood_s: longest_stand_s(&record),
            report,
            record,
        }
    }

    /// Returns true if two robots met.
    #[must_use]
    pub fn has_met(&self) -> bool {
        self.least_m < MET_M
    }

    /// Returns true if the robots blocked each other for good.
    #[must_use]
    pub fn is_blocked(&self) -> bool {
        !self.report.whole.explored()
    }

    /// Returns the touches of two robots, and of a robot and a wall.
    #[must_use]
    pub fn touches(&self) -> (u32, u32) {
        let safety = &self.report.whole.safety;
        (safety.robot_contacts.unwrap_or(0), safety.collisions)
    }
}

/// Returns the least distance between the centres of two robots that explored.
fn least_m(record: &TeamRecord) -> f64 {
    let robots = &record.robots;
    let pairs = (0..robots.len()).flat_map(|a| (0..a).map(move |b| (&robots[a], &robots[b])));
    let gaps = pairs.flat_map(|(a, b)| {
        let both = a.steps.iter().zip(&b.steps);
        both.map(|(a, b)| (a.truth.x_m - b.truth.x_m).hypot(a.truth.y_m - b.truth.y_m))
    });
    gaps.fold(f64::INFINITY, f64::min)
}

/// Makes a table with one line for each place, over the seeds.
#[must_use]
pub fn summary(meetings: &[Meeting]) -> Table {
    let mut table = Table::new(
        1,
        &[
            "place",
            "runs",
            "met",
            "contacts",
            "hits",
            "blocked",
            "end s",
            "at most",
            "stood s",
            "at most",
            "centres m",
        ],
    );
    for same in meetings.chunk_by(|a, b| a.narrow == b.narrow) {
        let count = same.len() as f64;
        let sum = |of: fn(&Meeting) -> u32| same.iter().map(of).sum::<u32>().to_string();
        let ends: Vec<f64> = same.iter().map(|it| it.report.whole.sim_time_s).collect();
        let stood: Vec<f64> = same.iter().map(|it| it.stood_s).collect();
        let least_m = same
            .iter()
            .map(|it| it.least_m)
            .fold(f64::INFINITY, f64::min);
        let most = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
        table.row(vec![
            same[0].narrow.name().into(),
            same.len().to_string(),
            sum(|it| u32::from(it.has_met())),
            sum(|it| it.touches().0),
            sum(|it| it.touches().1),
            sum(|it| u32::from(it.is_blocked())),
            format!("{:.1}", ends.iter().sum::<f64>() / count),
            format!("{:.1}", most(&ends)),
            format!("{:.1}", stood.iter().sum::<f64>() / count),
            format!("{:.1}", most(&stood)),
            format!("{least_m:.2}"),
        ]);
    }
    table
}

/// Makes a table with one line for each meeting.
#[must_use]
pub fn table(meetings: &[Meeting]) -> Table {
    let mut table = Table::new(
        1,
        &[
            "place",
            "seed",
            "ended",
            "end s",
            "stood s",
            "contacts",
            "hits",
            "centres m",
        ],
    );
    for meeting in meetings {
        let whole = &meeting.report.whole;
        let (contacts, hits) = meeting.touches();
        table.row(vec![
            meeting.narrow.name().into(),
            meeting.seed.to_string(),
            format!("{}({})", whole.outcome.status, whole.outcome.reason),
            format!("{:.1}", whole.sim_time_s),
            format!("{:.1}", meeting.stood_s),
            contacts.to_string(),
            hits.to_string(),
            format!("{:.2}", meeting.least_m),
        ]);
    }
    table
}
