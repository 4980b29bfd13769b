//! A planner that takes its goals in an order of the user's, as a link.

use fieldline_device::session::{self, Boot};
use fieldline_device::{Memory, SLOTS, State, TILES, convert};
use fieldline_planner::{Config, Goal, GoalLevel, Order, Tuning, Workspace, step};
use fieldline_protocol::message::{
    Command, Control, Observation, Refusal, Reply, Request, Status, Twist,
};
use host_sim::link::{End, Link, LinkError, LinkStats};

/// Goals with less x count as 80 m farther away.
pub(super) fn to_greater_x(goal: &Goal) -> u8 {
    if goal.cell.x < 0 { 8 } else { 0 }
}

/// Goals with greater x count as 80 m farther away.
pub(super) fn to_less_x(goal: &Goal) -> u8 {
    if goal.cell.x < 0 { 0 } else { 8 }
}

/// A planner with an order of goals, behind a link without bytes.
pub(super) struct Ordered {
    level: GoalLevel,
    config: Option<Config>,
    state: Box<State>,
    workspace: Box<Workspace>,
    status: Status,
}

impl Ordered {
    pub(super) fn new(level: GoalLevel) -> Self {
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
            .goal_level(self.level)
            .localise(told.localises());
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

impl Ordered {
    /// Makes a step, or stands once the exploration has ended.
    fn command(&mut self, observation: &Observation) -> Result<Command, LinkError> {
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
}

impl Link for Ordered {
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        Ok(match request {
            Request::Hello { .. } => Reply::Hello(session::identity(Boot::default(), TILES, SLOTS)),
            Request::Control(control) => {
                if let Some(config) = self.configure(control) {
                    self.state.reset(&config);
                    (self.config, self.status) = (Some(config), Status::Exploring);
                }
                Reply::Control(self.status)
            }
            Request::Observation(observation) => Reply::Command(self.command(observation)?),
            Request::Hear(packet) => {
                let config = self.config()?;
                if let Some(packet) = convert::packet(packet) {
                    self.state.hear(&config, &packet);
                }
                Reply::Heard
            }
            Request::Say => {
                let config = self.config()?;
                Reply::Say(self.state.say(&config).map(|it| convert::wire_packet(&it)))
            }
            _ => {
                let refused = || LinkError::Refused("nobody corrects this map".into());
                self.memory().show(request).ok_or_else(refused)?
            }
        })
    }

    fn end(&self) -> &dyn End {
        self
    }
}

impl End for Ordered {
    fn stats(&self) -> LinkStats {
        LinkStats::default()
    }
}
