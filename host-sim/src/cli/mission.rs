//! The mission that the arguments of explore describe, or why they describe none.

use anyhow::{Result, bail};

use fieldline_protocol::message::{Budget, UnevenGround};
use host_sim::baseline::bvp_papers::Relaxation;
use host_sim::fence::{Fence, Polygon};
use host_sim::known_map::KnownMap;
use host_sim::link::spec::LinkSpec;
use host_sim::robot::Limits;
use host_sim::slam::SlamPlace;
use host_sim::trial::itinerary::Orders;
use host_sim::trial::mission::{IMPATIENCE_S, Mission, on_device};
use host_sim::trial::space::SpaceMission;
use host_sim::trial::uneven;

use super::args::{ExploreArgs, GroundArg, OdometryArg, SwitchArg, ThenArg};
use super::{film, strategies};

/// Returns the parameters of uneven ground; `None` on flat ground.
fn uneven_ground(args: &ExploreArgs) -> Result<Option<UnevenGround>> {
    let implied =
        args.preference.is_some() || args.levels.is_some() || args.ground_parameters.is_some();
    let flat = match args.ground {
        Some(ground) => ground == GroundArg::Flat,
        None => !implied,
    };
    if flat && implied {
        bail!(
            "--ground flat has no preferences, levels and parameters; say --ground uneven, \
             or leave --preference, --levels and --ground-parameters out"
        );
    }
    if flat {
        return Ok(None);
    }
    if !strategies::knows_uneven_ground(&args.strategy) {
        bail!(
            "--strategy {} takes all ground for flat; \
             leave --ground, --preference, --levels and --ground-parameters out",
            args.strategy
        );
    }
    if args.levels.is_some() && on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} has no height levels; leave --levels out",
            args.strategy
        );
    }
    let parameters = args.ground_parameters.unwrap_or(uneven::TABLE_I);
    let preference = args.preference.map_or(parameters.preference, Into::into);
    Ok(Some(UnevenGround {
        preference,
        levels: args.levels.map_or_else(
            || uneven::has_levels(preference),
            |switch| switch == SwitchArg::On,
        ),
        ..parameters
    }))
}

/// Returns the odometry of a run whose user names none: it drifts where the device corrects it, and
/// is true where nothing does, or nothing aligns the maps of several robots.
fn default_odometry(args: &ExploreArgs, is_flat: bool) -> OdometryArg {
    if is_flat && on_device(&args.strategy).is_some() && args.team.is_none() {
        OdometryArg::Noisy
    } else {
        OdometryArg::Truth
    }
}

/// Refuses options that need a device, or level ground, where there is none.
fn check_device(args: &ExploreArgs, is_uneven: bool) -> Result<()> {
    if args.slam != SlamPlace::Off && on_device(&args.strategy).is_none() {
        bail!(
            "--slam corrects the map of a device; take a strategy on the device, or say --slam off"
        );
    }
    if args.localise == Some(SwitchArg::On) && on_device(&args.strategy).is_none() {
        bail!(
            "--localise corrects the pose on the device, and --strategy {} runs on the host; \
             take a strategy on the device, or leave --localise out",
            args.strategy
        );
    }
    if args.period != 200 && on_device(&args.strategy).is_none() {
        bail!(
            "--period is the device's, and --strategy {} runs on the host; leave --period out, or \
             take a strategy on the device",
            args.strategy
        );
    }
    if args.particles.is_some() && is_uneven {
        bail!("--particles takes level scans; leave it out, or say --ground flat");
    }
    if args.miswire.is_some() && on_device(&args.strategy).is_none() {
        bail!(
            "--miswire is noticed by a device, and --strategy {} runs on the host; take a strategy \
             on the device, or leave --miswire out",
            args.strategy
        );
    }
    Ok(())
}

/// Returns the settings of a run.
pub(super) fn mission(args: &ExploreArgs, link: &LinkSpec) -> Result<Mission> {
    let working = args.working_limits.unwrap_or(Limits::WORKING);
    let failing = args.failing_limits.unwrap_or(Limits::FAILING);
    if !working.is_within(&failing) {
        bail!(
            "--working-limits {working} exceed --failing-limits {failing}; \
             lower the first or raise the second"
        );
    }
    let uneven_ground = uneven_ground(args)?;
    if uneven_ground.is_some() {
        args.robot.check_uneven()?;
    }
    let odometry = args
        .odometry
        .unwrap_or_else(|| default_odometry(args, uneven_ground.is_none()));
    check_device(args, uneven_ground.is_some())?;
    let is_localised = match args.localise {
        Some(switch) => switch == SwitchArg::On,
        None => odometry != OdometryArg::Truth,
    };
    let disturbances = args.disturb.unwrap_or_default();
    if disturbances.needs_wheels() && odometry == OdometryArg::Truth {
        bail!(
            "--disturb {disturbances} needs odometry that counts wheels; say --odometry noisy, \
             or leave slip, spin and push out"
        );
    }
    Ok(args.robot.applied(Mission {
        disturbances,
        miswiring: args.miswire.unwrap_or_default(),
        people: args.people,
        order: args.robot.order(&args.strategy)?,
        strategy: args.strategy.clone(),
        uneven_ground,
        link: link.to_string(),
        fault: args.fault.as_ref().map(|fault| fault.text.clone()),
        seed: args.common.seed,
        start: args.start,
        odometry: odometry.into(),
        localise: is_localised,
        imu_rad: args.imu_noise.map(f64::to_radians),
        laser_m: args.laser_noise,
        working,
        failing,
        time_limit_ms: args.pace.time_limit,
        period_ms: args.period.into(),
        patrol_s: args.patrol_for,
        space: space(args),
        fence: fence(args)?,
        known: known(args, uneven_ground.is_some())?,
        orders: orders(args)?,
        relaxation: relaxation(args),
        impatience_s: args.tdbvp_impatience.map_or(IMPATIENCE_S, |it| it.0),
        check_field: args.check_field,
        snapshots: film::frames(args),
        resumes: args.resume.is_some(),
        slam: args.slam,
        particles: args.particles,
        ..Mission::default()
    }))
}

/// Returns the area and the end of a space-based potential field.
fn space(args: &ExploreArgs) -> SpaceMission {
    SpaceMission {
        area_m: args.area,
        until_permille: args.space.until.unwrap_or(1_000),
        impatience_s: args.space.sbpf_impatience.map(|it| it.0),
    }
}

/// Returns the bounds and the no-go polygons. An area that was asked for is bounds as well: a robot
/// that is told what to explore has nothing to do elsewhere.
fn fence(args: &ExploreArgs) -> Result<Fence> {
    let mut bounds = args.bounds.clone();
    if bounds.is_empty() {
        bounds.extend(args.area.map(Polygon::rectangle));
    }
    let no_go = args.no_go.clone();
    let fence = Fence { bounds, no_go };
    if fence.is_empty() {
        return Ok(fence);
    }
    if on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} knows no bounds; leave --bounds and --no-go out, or take a strategy on \
             the device",
            args.strategy
        );
    }
    match fence.check() {
        Ok(()) => Ok(fence),
        Err(reason) => bail!("--bounds and --no-go: {reason}"),
    }
}

/// Reads the map that the robot knows at its start.
fn known(args: &ExploreArgs, is_uneven: bool) -> Result<Option<KnownMap>> {
    let Some(path) = &args.known else {
        if args.known_pose.is_some() {
            bail!("--known-pose is a place in a known map; give the map with --known");
        }
        return Ok(None);
    };
    let file = path.display();
    if on_device(&args.strategy).is_none() {
        bail!(
            "--known {file} is loaded into a device, and --strategy {} runs on the host; take a \
             strategy on the device, or leave --known out",
            args.strategy
        );
    }
    if is_uneven {
        bail!("--known {file} has no heights of the ground; say --ground flat, or leave it out");
    }
    if args.slam != SlamPlace::Off {
        bail!(
            "--slam makes the map of scans alone, and would take what --known {file} has out of \
             it; say --slam off, or leave --known out"
        );
    }
    if args.team.is_some() {
        bail!("--known {file} is for a robot alone; leave --known or --team out");
    }
    Ok(Some(KnownMap::load(path, args.known_pose)?))
}

/// Returns what the robot does after its exploration.
fn orders(args: &ExploreArgs) -> Result<Orders> {
    let orders = Orders {
        goals_m: args.goto.clone(),
        home: args.then == Some(ThenArg::Home),
        budget: Budget {
            range_m: args.range_m,
            time_s: args.time_s,
        },
        home_at_ms: args.home_at,
        pauses: args.pause.clone(),
    };
    if orders != Orders::default() && on_device(&args.strategy).is_none() {
        bail!(
            "--strategy {} takes no orders; leave --goto, --then, --range-m, --time-s, --home-at \
             and --pause out, or take a strategy on the device",
            args.strategy
        );
    }
    Ok(orders)
}

/// Returns how the stored potential of a baseline is relaxed.
fn relaxation(args: &ExploreArgs) -> Relaxation {
    let usual = Relaxation::DEFAULT;
    Relaxation {
        sweeps: args.bvp_sweeps.unwrap_or(usual.sweeps),
        precision: args.bvp_precision.map_or(usual.precision, Into::into),
    }
}
