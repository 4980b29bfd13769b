//! What can plan: the device's strategies by any link, and baselines that only the host has the memory for.
//!
//! A baseline is a [`Link`] of its own, without bytes: it answers observations with commands and shows a map.

use anyhow::{Result, bail};
use fieldline_protocol::message::Strategy;

use host_sim::baseline::{Bvp, GreedyFrontier, Session};
use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::trial::mission::{STRATEGIES, on_device};

/// The strategy on the device if nothing is said.
pub(super) const FRONTIER: &str = "frontier";

/// The boundary-value problem over the full grid.
const BVP: &str = "bvp";

/// Makes a baseline.
type Make = fn() -> Box<dyn Link>;

/// The baselines by name.
const BASELINES: &[(&str, Make)] = &[
    (BVP, || Box::new(Session::new(Bvp::new()))),
    ("greedy-frontier", || {
        Box::new(Session::new(GreedyFrontier::default()))
    }),
];

/// A known strategy's name, or what the known ones are.
pub(super) fn parse(name: &str) -> Result<String, String> {
    let known: Vec<&str> = STRATEGIES
        .iter()
        .map(|(name, _)| *name)
        .chain(BASELINES.iter().map(|(name, _)| *name))
        .collect();
    if known.contains(&name) {
        Ok(name.into())
    } else {
        Err(format!(
            "unknown strategy '{name}'; use {}",
            known.join(", ")
        ))
    }
}

/// Where a strategy runs if nothing is said, and the refusal of where it cannot.
pub(super) fn place(strategy: &str, link: Option<&LinkSpec>) -> Result<LinkSpec> {
    match (strategy, link) {
        (name, None) if on_device(name).is_some() => Ok(LinkSpec::Loopback),
        (name, Some(link)) if on_device(name).is_some() => Ok(link.clone()),
        (_, None | Some(LinkSpec::Direct)) => Ok(LinkSpec::Direct),
        (_, Some(link)) => bail!(
            "--strategy {strategy} runs on the host only, not by --link {link}; leave --link out or say direct"
        ),
    }
}

/// Whether a strategy can be told to heed uneven ground.
pub(super) fn heeds_ground(strategy: &str) -> bool {
    strategy == BVP || on_device(strategy).is_some()
}

/// The refusal of what only the device's strategies have: windows to compare, bytes to break.
pub(super) fn check(strategy: &str, check_field: bool, faults: bool) -> Result<()> {
    match strategy {
        "tdbvp" if check_field => {
            bail!("--strategy tdbvp charges rails, which --check-field does not know; leave it out")
        }
        name if on_device(name).is_some() => Ok(()),
        _ if check_field => {
            bail!("--strategy {strategy} solves no window; leave --check-field out")
        }
        _ if faults => bail!("--strategy {strategy} has no bytes to break; leave --fault out"),
        _ => Ok(()),
    }
}

/// The refusal of a patrol by what has no rails to patrol on.
pub(super) fn check_patrol(strategy: &str, patrol_s: u16) -> Result<()> {
    match on_device(strategy) {
        Some(Strategy::Tdbvp { .. }) => Ok(()),
        _ if patrol_s > 0 => {
            bail!("--strategy {strategy} does not patrol; leave --patrol-for out or say tdbvp")
        }
        _ => Ok(()),
    }
}

/// What plans, ready for its hello.
pub(super) fn open(strategy: &str, link: &LinkSpec, options: &Options) -> Result<Box<dyn Link>> {
    let baseline = BASELINES.iter().find(|(name, _)| *name == strategy);
    Ok(match baseline {
        Some((_, make)) => make(),
        None => link.open(options)?,
    })
}

#[cfg(test)]
mod tests {
    use super::{FRONTIER, check, parse, place};
    use host_sim::link::spec::LinkSpec;

    #[test]
    fn unknown_strategies_are_named_with_the_known() {
        let error = parse("magic").unwrap_err();
        assert!(
            error.contains("'magic'") && error.contains("frontier") && error.contains("ouroboros"),
            "{error}"
        );
    }

    #[test]
    fn the_device_runs_anywhere_and_a_baseline_on_the_host() {
        assert_eq!(place(FRONTIER, None).unwrap(), LinkSpec::Loopback);
        assert_eq!(place("ouroboros", None).unwrap(), LinkSpec::Loopback);
        assert_eq!(
            place(FRONTIER, Some(&LinkSpec::Qemu)).unwrap(),
            LinkSpec::Qemu
        );
        assert_eq!(place("bvp", None).unwrap(), LinkSpec::Direct);
        let error = place("bvp", Some(&LinkSpec::Loopback))
            .unwrap_err()
            .to_string();
        assert!(error.contains("bvp") && error.contains("direct"), "{error}");
    }

    #[test]
    fn a_baseline_has_neither_windows_nor_bytes() {
        assert!(check(FRONTIER, true, true).is_ok() && check("bvp", false, false).is_ok());
        let words =
            |check_field, faults| check("bvp", check_field, faults).unwrap_err().to_string();
        assert!(words(true, false).contains("--check-field"));
        assert!(words(false, true).contains("--fault"));
    }
}
