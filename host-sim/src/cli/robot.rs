//! Arguments about the robot, its hull and its lidar, the order in which it takes frontiers, the
//! loops that it closes, and the planner's tuned constants.

use anyhow::{Context as _, Result, bail};
use clap::{Args, ValueEnum};
use fieldline_planner::{RobotShape, Tuning, TuningError};
use fieldline_protocol::message::{LoopLimits, Order};
use fixed::types::{I4F12, I16F16};
use host_sim::link::spec::LinkSpec;
use host_sim::near;
use host_sim::robot::{Footprint, RobotSpec, Sweep};
use host_sim::spec::{Form, SpecError};
use host_sim::trial::mission::{Mission, on_device};

#[derive(Clone, Debug, Default, Args)]
pub(super) struct RobotArgs {
    /// Robot file or preset; `host-sim robots` lists the presets [default: pioneer-3at]
    #[arg(long, value_name = "FILE|PRESET", value_parser = robot)]
    robot: Option<RobotSpec>,
    /// Sweep of the level lidar: first angle and step in degrees, beams, range in metres, as in
    /// -135,0.5,541,12; and, of a lidar that turns, seconds from the first beam to the last one
    /// [default: the robot's]
    #[arg(
        long,
        value_name = "FIRST,STEP,BEAMS,RANGE[,TURN]",
        value_parser = sweep,
        allow_hyphen_values = true
    )]
    laser: Option<Sweep>,
    /// Length, width and height of the robot's hull, metres [default: the robot's]
    #[arg(long, value_name = "LxWxH", value_parser = hull)]
    hull: Option<Footprint>,
    /// Radius around the robot's centre that the planner keeps clear, metres: 0.05 to 0.6 [default:
    /// the robot's; with --hull half its width and 0.05, rounded up to 0.01]
    #[arg(long, value_name = "M", value_parser = radius)]
    radius: Option<f64>,
    /// Limits of the loops that ouroboros closes, metres: any of
    /// `least=20,most=120,per_frontier=10,detour=2,slack=20`, the defaults; `revisits=off` ends
    /// where nothing is left to explore, as in the paper, though a loop is open
    #[arg(long, value_name = "LIMITS", value_parser = loops)]
    loops: Option<Loops>,
    /// Order in which frontiers are taken [default: gain for frontier, nearest for the others]
    #[arg(long, value_name = "ORDER")]
    order: Option<OrderArg>,
    /// Least gain of a trip, square metres for each metre of way: what is not worth it is left; 0
    /// for everything that can be seen [default: 0.25; 0 for sbpf and esbpf]
    #[arg(long, value_name = "M2_PER_M", value_parser = worth)]
    worth: Option<I4F12>,
    #[command(flatten)]
    tune: TuneArgs,
}

/// Arguments about the planner's tuned constants.
#[derive(Clone, Debug, Default, Args)]
pub(super) struct TuneArgs {
    /// Sets a tuned constant, as in `ground.blind_radius_m=1.2`; `host-sim tuning` lists them
    #[arg(long, value_name = "NAME=VALUE")]
    tune: Vec<String>,
}

/// The loops that ouroboros closes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Loops {
    limits: LoopLimits,
    /// True if the robot drives back to loops that are open when nothing is left to explore.
    revisits: bool,
}

/// An order of frontiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum OrderArg {
    /// The greatest gain for its cost first
    Gain,
    /// The nearest first
    Nearest,
}

impl RobotArgs {
    /// Returns `mission` with this robot and these loops.
    pub(super) fn applied(&self, mission: Mission) -> Mission {
        let mut robot = self.spec();
        if let Some(hull) = self.hull {
            robot.hull = hull;
            robot.radius_m = planning_radius_m(&hull);
        }
        robot.radius_m = self.radius.unwrap_or(robot.radius_m);
        Mission {
            loops: self.loops.map_or(mission.loops, |loops| loops.limits),
            ..mission.with_robot(&robot)
        }
    }

    /// Returns the robot, with the lidar that was asked for.
    fn spec(&self) -> RobotSpec {
        let robot = self.robot.clone().unwrap_or_default();
        match &self.laser {
            Some(sweep) => robot.with_sweep(sweep),
            None => robot,
        }
    }

    /// Refuses uneven ground for a robot without a second lidar.
    ///
    /// # Errors
    /// As said.
    pub(super) fn check_uneven(&self) -> Result<()> {
        let robot = self.spec();
        if robot.lidars.len() < 2 {
            bail!(
                "uneven ground needs a second laser that looks down, and robot {} has one; add it \
                 to the robot file, or say --ground flat",
                robot.name
            );
        }
        Ok(())
    }

    /// Returns the order of frontiers for a strategy.
    ///
    /// # Errors
    /// If the strategy has none.
    pub(super) fn order(&self, strategy: &str) -> Result<Option<Order>> {
        if self.order.is_none() && self.worth.is_none() {
            return Ok(None);
        }
        let Some(known) = on_device(strategy) else {
            bail!("--strategy {strategy} has an order of its own; leave --order and --worth out");
        };
        let own = known.order();
        let worth = self.worth.unwrap_or(own.worth());
        Ok(Some(match (self.order, own) {
            (Some(OrderArg::Gain), _) | (None, Order::Gain { .. }) => Order::Gain { worth },
            _ => Order::Nearest { worth },
        }))
    }

    /// As [`TuneArgs::link`]; revisits that are off ask for a direct link too.
    pub(super) fn link<'a>(&self, link: Option<&'a LinkSpec>) -> Option<&'a LinkSpec> {
        let link = self.tune.link(link);
        link.or(self.leaves_loops_open().then_some(&LinkSpec::Direct))
    }

    /// As [`TuneArgs::tuning`], with revisits off if that was asked for.
    pub(super) fn tuning(&self, link: &LinkSpec) -> Result<Option<&'static Tuning>> {
        let tuning = self.tune.tuning(link)?;
        if !self.leaves_loops_open() {
            return Ok(tuning);
        }
        if *link != LinkSpec::Direct {
            bail!("--loops revisits=off changes a planner in this process only; say --link direct");
        }
        let mut tuning = *tuning.unwrap_or(&Tuning::DEFAULT);
        tuning.ouroboros.most_branches = 0;
        Ok(Some(Box::leak(Box::new(tuning))))
    }

    /// Returns true if revisits are off.
    fn leaves_loops_open(&self) -> bool {
        self.loops.is_some_and(|loops| !loops.revisits)
    }
}

impl TuneArgs {
    /// Returns the link that was asked for: a direct one if only tuned constants ask for it.
    pub(super) fn link<'a>(&self, link: Option<&'a LinkSpec>) -> Option<&'a LinkSpec> {
        let is_tuned = !self.tune.is_empty();
        link.or(is_tuned.then_some(&LinkSpec::Direct))
    }

    /// Returns the tuned constants; `None` if all have their defaults.
    pub(super) fn tuning(&self, link: &LinkSpec) -> Result<Option<&'static Tuning>> {
        if self.tune.is_empty() {
            return Ok(None);
        }
        if *link != LinkSpec::Direct {
            bail!("--tune changes a planner in this process only; say --link direct");
        }
        let mut tuning = Tuning::DEFAULT;
        for text in &self.tune {
            let (name, value) = text
                .split_once('=')
                .with_context(|| format!("--tune {text} has no value; say NAME=VALUE"))?;
            let value = number(value).map_err(anyhow::Error::msg);
            let value = value.with_context(|| format!("--tune {text}"))? as f32;
            match tuning.set(name, value) {
                Err(TuningError::Unknown) => bail!(
                    "--tune {text}: no tuned constant has this name; host-sim tuning lists them{}",
                    near_constant(name)
                ),
                set => set.with_context(|| format!("--tune {text}"))?,
            }
        }
        Ok(Some(Box::leak(Box::new(tuning))))
    }
}

/// Returns `; did you mean X?` if a constant has nearly this name.
fn near_constant(name: &str) -> String {
    let mut known = Vec::new();
    Tuning::DEFAULT.parameters(|tuned| known.push(format!("{}.{}", tuned.room, tuned.name)));
    near::hint(name, known.iter().map(String::as_str))
}

/// Returns the radius that the planner gives a hull without another one.
fn planning_radius_m(hull: &Footprint) -> f64 {
    let shape = RobotShape::rectangle(0.0, 2.0 * hull.half_width_m as f32, 0.0);
    f64::from(shape.planning_radius_m())
}

fn number(text: &str) -> Result<f64, String> {
    let number = text.parse::<f64>().ok().filter(|number| number.is_finite());
    number.ok_or_else(|| format!("'{text}' is not a number"))
}

pub(super) fn robot(text: &str) -> Result<RobotSpec, String> {
    RobotSpec::open(text).map_err(|error| error.to_string())
}

pub(super) fn sweep(text: &str) -> Result<Sweep, SpecError> {
    text.parse()
}

fn hull(text: &str) -> Result<Footprint, String> {
    let remedy = "say length, width and height in metres, as in 0.9x0.6x0.4";
    let sides: Vec<f64> = text.split('x').map(number).collect::<Result<_, _>>()?;
    let [length, width, height] = sides[..] else {
        return Err(remedy.into());
    };
    let is_side = |side: f64| (0.001..=4.0).contains(&side);
    if !is_side(length) || !is_side(width) || !(0.0..=2.0).contains(&height) {
        return Err(format!(
            "length and width must be 0.001 to 4 m and the height at most 2 m; {remedy}"
        ));
    }
    Ok(Footprint::rectangle(length, width, height))
}

fn radius(text: &str) -> Result<f64, String> {
    let radius = number(text)?;
    if (0.05..=0.6).contains(&radius) {
        return Ok(radius);
    }
    Err("the radius must be 0.05 to 0.6 m".into())
}

fn worth(text: &str) -> Result<I4F12, String> {
    let worth = number(text)?;
    if (0.0..=7.0).contains(&worth) {
        return Ok(I4F12::from_num(worth));
    }
    Err("the worth of a trip must be 0 to 7 m²/m".into())
}

/// The limits of loops and whether closed ones are driven again.
const LOOPS: Form = Form {
    what: "limit",
    usage: "least, most, per_frontier, detour and slack as in least=20, or revisits=off, separated \
            by commas",
    repeated: "",
};

fn loops(text: &str) -> Result<Loops, SpecError> {
    let mut limits = LoopLimits::default();
    let mut revisits = true;
    LOOPS.read(text, |word| {
        let field = match word.key.as_str() {
            "least=" => &mut limits.least,
            "most=" => &mut limits.most,
            "per_frontier=" => &mut limits.most_per_frontier,
            "detour=" => &mut limits.detour,
            "slack=" => &mut limits.slack,
            "revisits=" => {
                revisits = match word.value {
                    "on" => true,
                    "off" => false,
                    _ => return Err(word.bad("on or off")),
                };
                return Ok(());
            }
            _ => return Err(word.unknown()),
        };
        *field = I16F16::saturating_from_num(word.number(0.0..=32_767.0, "from 0 to 32767")?);
        Ok(())
    })?;
    Ok(Loops { limits, revisits })
}
