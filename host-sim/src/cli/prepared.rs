//! The arguments of one run, checked against each other, and the run that they mean.
//!
//! `explore` and `campaign` both make their runs here, so the same arguments mean the same run.

use core::time::Duration;
use std::path::Path;
use std::time::Instant;

use anyhow::{Context as _, Result, anyhow, bail};

use fieldline_protocol::message::Preference;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::link::{Link, LinkError};
use host_sim::network::carrier::Carrier;
use host_sim::network::spec::TeamSpec;
use host_sim::network::udp::Udp;
use host_sim::network::{self, Networked};
use host_sim::report::Report;
use host_sim::slam::SlamPlace;
use host_sim::state::Keeping;
use host_sim::trial::mission::{self, Mission, MissionError, on_device};
use host_sim::trial::{Record, Watch};
use host_sim::world::World;

use super::args::ExploreArgs;
use super::mission_file;
use super::recording::Recorder;
use super::strategies;
use super::{cycles, note, note_build};

/// What is kept of a run while it runs.
#[derive(Default)]
pub(super) struct Beside<'a> {
    /// Its state, or the one from which it goes on.
    pub(super) keeping: Option<&'a mut Keeping>,
    /// Its recording.
    pub(super) recorder: Option<&'a Recorder>,
    /// Where the emulated chip's cycles are counted by instruction.
    pub(super) profile: Option<&'a Path>,
}

/// Arguments that fit together, and what they mean.
pub(super) struct Prepared {
    pub(super) args: ExploreArgs,
    pub(super) link: LinkSpec,
    pub(super) mission: Mission,
    /// What the file of `--mission` says.
    pub(super) mission_text: Option<String>,
}

impl Prepared {
    /// Checks that the arguments fit together. Opens no world and no link.
    pub(super) fn new(args: &ExploreArgs) -> Result<Self> {
        let (args, mission_text) = &mission_file::applied(args)?;
        let link = strategies::link_of(&args.strategy, args.robot.link(args.link.as_ref()))?;
        strategies::check(&args.strategy, args.check_field, args.fault.is_some())?;
        strategies::check_rails(
            &args.strategy,
            args.patrol_for,
            args.tdbvp_impatience.is_some(),
        )?;
        let has_space = args.space.is_given() || args.area.is_some();
        strategies::check_space(&args.strategy, has_space)?;
        let has_relaxation = args.bvp_sweeps.is_some() || args.bvp_precision.is_some();
        strategies::check_relaxation(&args.strategy, has_relaxation)?;
        let mission = super::mission::mission(args, &link)?;
        check_reference(&mission)?;
        check_team(args)?;
        Ok(Self {
            args: args.clone(),
            link,
            mission,
            mission_text: mission_text.clone(),
        })
    }

    /// Checks that the robot can stand at the start of these arguments.
    pub(super) fn check_start(&self, world: &World) -> Result<()> {
        Ok(mission::check(&self.mission, world)?)
    }

    /// Makes the run of these arguments in `world`.
    pub(super) fn play(&self, world: &World, watch: &mut dyn Watch) -> Result<(Report, Record)> {
        self.play_kept(&self.mission, world, watch, Beside::default())
    }

    /// As [`Prepared::play`], with another mission, and with what is kept of the run beside it.
    pub(super) fn play_kept(
        &self,
        mission: &Mission,
        world: &World,
        watch: &mut dyn Watch,
        beside: Beside<'_>,
    ) -> Result<(Report, Record)> {
        let (args, link) = (&self.args, &self.link);
        note_build(link);
        let options = Options {
            faults: args
                .fault
                .as_ref()
                .map_or_else(Default::default, |f| f.faults),
            seed: args.common.seed,
            real_time: args.pace.realtime,
            tuning: args.robot.tuning(link)?,
            cycles: cycles(link),
            profile: beside.profile.map(Path::to_owned),
        };
        let mut planner = strategies::open(&args.strategy, link, &options, mission.relaxation)
            .with_context(|| format!("--link {link}"))?;
        if let LinkSpec::Serial { device, .. } = link {
            let answer = await_board(planner.as_mut(), device, args.wait);
            answer.map_err(|error| anyhow!("--link {link}: {error}"))?;
        }
        // Next to the device: what a team says to it is recorded too.
        if let Some(recorder) = beside.recorder {
            planner = recorder.tap(planner);
        }
        let (mut planner, network) = join(args, planner)?;
        let planner = planner.as_mut();
        let result = match beside.keeping {
            Some(keeping) => mission::explore_kept(mission, world, planner, watch, keeping),
            None => mission::explore(mission, world, planner, watch),
        };
        let (mut report, record) = match result {
            Err(MissionError::Link(error)) => bail!("--link {link}: {error}"),
            result => result?,
        };
        if let Some(network) = network {
            report.network = Some(network.read());
            // The device's map also has what the robot heard.
            report.debug.map_matches_mirror = None;
        }
        Ok((report, record))
    }
}

/// Says hello until the board answers, for some time. A board that still boots hears nothing.
pub(super) fn await_board(
    planner: &mut dyn Link,
    port: &str,
    wait: Duration,
) -> Result<(), LinkError> {
    let begun = Instant::now();
    let mut is_told = false;
    loop {
        match planner.hello() {
            Err(LinkError::Silent) if begun.elapsed() < wait => {
                if !is_told {
                    let seconds = wait.as_secs();
                    note(&format!(
                        "host-sim: {port}: waits up to {seconds} s for the board to boot"
                    ));
                    is_told = true;
                }
            }
            answer => return answer.map(|_| ()),
        }
    }
}

/// Refuses `--check-field` for a field with preferences, which the direct solution does not have.
fn check_reference(mission: &Mission) -> Result<()> {
    let preference = mission.uneven_ground.map(|ground| ground.preference);
    if mission.check_field && preference.is_some_and(|which| which != Preference::Off) {
        bail!(
            "--check-field has no reference for a field with preferences; \
             say --preference off, or leave --check-field out"
        );
    }
    Ok(())
}

/// Refuses a team of processes with several worlds, or with a strategy that does not talk.
fn check_team(args: &ExploreArgs) -> Result<()> {
    if args.team.is_none() {
        return Ok(());
    }
    if args.worlds.len() != 1 {
        bail!("--team is for one world; name only one");
    }
    if on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} does not talk to a team; leave --team out",
            args.strategy
        );
    }
    if args.slam != SlamPlace::Off {
        bail!(
            "--slam does not know what a robot hears by --team; say --slam off, or take host-sim \
             team, which has --slam host"
        );
    }
    Ok(())
}

/// Makes the planner a member of its team, if it has one; returns its counters too.
fn join(
    args: &ExploreArgs,
    planner: Box<dyn Link>,
) -> Result<(Box<dyn Link>, Option<network::Account>)> {
    let Some(team) = &args.team else {
        return Ok((planner, None));
    };
    let key = team.read_key().context("--team")?;
    let carrier = carrier(team).map_err(anyhow::Error::msg);
    let member = Networked::new(planner, carrier.context("--team")?, key, team.id);
    let account = member.account();
    Ok((Box::new(member), Some(account)))
}

/// Opens what carries the packets of a team.
fn carrier(team: &TeamSpec) -> Result<Box<dyn Carrier>, String> {
    if team.zenoh.is_none() && team.zenoh_listen.is_none() {
        return Ok(Box::new(Udp::open(team)?));
    }
    #[cfg(feature = "zenoh")]
    return Ok(Box::new(network::zenoh::Zenoh::open(team)?));
    #[cfg(not(feature = "zenoh"))]
    Err("this program was built without zenoh; build it with --features host-sim/zenoh".into())
}
