//! Strategies: those of the device over any link, and baselines that need a host's memory.
//!
//! A baseline is a [`Link`] of its own, without bytes: it answers observations with commands and
//! has a map.

use anyhow::{Result, bail};
use fieldline_protocol::message::{Finish, Strategy};

use host_sim::baseline::bvp_papers::Relaxation;
use host_sim::baseline::{Bvp, BvpPapers, GreedyFrontier, Session};
use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::near;
use host_sim::trial::Ending;
use host_sim::trial::mission::{BVP_PAPERS, STRATEGIES, on_device};

/// The default strategy.
pub(super) const FRONTIER: &str = "frontier";

/// An alias: the default strategy on uneven ground.
pub(super) const TERRAIN: &str = "terrain";

/// The baseline that solves the boundary-value problem over the full grid \[Prestes02\].
const BVP: &str = "bvp";

/// Constructor of a baseline.
type Make = fn(Relaxation) -> Box<dyn Link>;

/// The baselines by name.
const BASELINES: &[(&str, Make)] = &[
    (BVP, |_| Box::new(Session::new(Bvp::new()))),
    (BVP_PAPERS, |relaxation| {
        Box::new(Session::new(BvpPapers::new(relaxation)))
    }),
    ("greedy-frontier", |_| {
        Box::new(Session::new(GreedyFrontier::default()))
    }),
];

/// Parses the name of a strategy, or the alias.
pub(super) fn parse(name: &str) -> Result<String, String> {
    let known: Vec<&str> = STRATEGIES
        .iter()
        .map(|(name, _)| *name)
        .chain(BASELINES.iter().map(|(name, _)| *name))
        .collect();
    if known.contains(&name) || name == TERRAIN {
        Ok(name.into())
    } else {
        Err(format!(
            "unknown strategy '{name}'; use {}{}",
            known.join(", "),
            near::hint(name, known.iter().copied())
        ))
    }
}

/// Returns the link of a strategy: the one given or the default. Refuses bytes for a baseline.
pub(super) fn link_of(strategy: &str, link: Option<&LinkSpec>) -> Result<LinkSpec> {
    match (strategy, link) {
        (name, None) if on_device(name).is_some() => Ok(LinkSpec::Loopback),
        (name, Some(link)) if on_device(name).is_some() => Ok(link.clone()),
        (_, None | Some(LinkSpec::Direct)) => Ok(LinkSpec::Direct),
        (_, Some(link)) => bail!(
            "--strategy {strategy} runs on the host only, not over --link {link}; \
             leave --link out or say direct"
        ),
    }
}

/// Returns true if a strategy can plan on uneven ground.
pub(super) fn knows_uneven_ground(strategy: &str) -> bool {
    strategy == BVP || on_device(strategy).is_some()
}

/// Refuses `--check-field` and `--fault` for strategies without a window or without bytes.
pub(super) fn check(strategy: &str, check_field: bool, faults: bool) -> Result<()> {
    match strategy {
        "tdbvp" if check_field => {
            bail!(
                "--check-field has no reference for --strategy tdbvp, which charges rails; \
                 leave --check-field out"
            )
        }
        "sbpf" | "esbpf" if check_field => bail!(
            "--check-field has no reference for --strategy {strategy}, which sums forces; \
             leave --check-field out"
        ),
        name if on_device(name).is_some() => Ok(()),
        _ if check_field => {
            bail!("--strategy {strategy} solves no window; leave --check-field out")
        }
        _ if faults => bail!("--strategy {strategy} has no bytes to break; leave --fault out"),
        _ => Ok(()),
    }
}

/// Refuses a patrol and an impatience for strategies without rails.
pub(super) fn check_rails(strategy: &str, patrol_s: u16, has_impatience: bool) -> Result<()> {
    match on_device(strategy) {
        Some(Strategy::Tdbvp { .. }) => Ok(()),
        _ if patrol_s > 0 => {
            bail!("--strategy {strategy} does not patrol; leave --patrol-for out or say tdbvp")
        }
        _ if has_impatience => bail!(
            "--strategy {strategy} follows no rails; leave --tdbvp-impatience out or say tdbvp"
        ),
        _ => Ok(()),
    }
}

/// Refuses an area, a target coverage and its impatience for strategies without a space field.
pub(super) fn check_space(strategy: &str, has_space: bool) -> Result<()> {
    match on_device(strategy) {
        Some(Strategy::Sbpf(_) | Strategy::Esbpf(_)) => Ok(()),
        _ if has_space => bail!(
            "--strategy {strategy} knows no area; \
             leave --until, --area and --sbpf-impatience out, or say esbpf"
        ),
        _ => Ok(()),
    }
}

/// Refuses sweeps and a precision for strategies that store no potential.
pub(super) fn check_relaxation(strategy: &str, has_relaxation: bool) -> Result<()> {
    if has_relaxation && strategy != BVP_PAPERS {
        bail!(
            "--strategy {strategy} makes no fixed number of sweeps; \
             leave --bvp-sweeps and --bvp-precision out, or say {BVP_PAPERS}"
        )
    }
    Ok(())
}

/// Returns advice on the end of a run.
pub(super) fn advice(strategy: &str, ending: &Ending) -> Option<String> {
    match ending {
        Ending::Finished(Finish::NothingAttracts) if strategy == BVP_PAPERS => Some(
            "the stored potential is flat around the robot, and unexplored space is left; \
             more --bvp-sweeps may help, and --strategy bvp solves the field"
                .into(),
        ),
        _ => ending.advice(),
    }
}

/// Opens the planner of a strategy. `relaxation` is for the baseline that stores its potential.
pub(super) fn open(
    strategy: &str,
    link: &LinkSpec,
    options: &Options,
    relaxation: Relaxation,
) -> Result<Box<dyn Link>> {
    let baseline = BASELINES.iter().find(|(name, _)| *name == strategy);
    Ok(match baseline {
        Some((_, make)) => make(relaxation),
        None => link.open(options)?,
    })
}

#[cfg(test)]
mod tests {
    use super::{FRONTIER, check, link_of, parse};
    use host_sim::link::spec::LinkSpec;

    #[test]
    fn an_unknown_strategy_is_refused_with_a_list_of_the_known() {
        let error = parse("magic").unwrap_err();
        assert!(
            error.contains("'magic'") && error.contains("frontier") && error.contains("ouroboros"),
            "{error}"
        );
    }

    #[test]
    fn the_device_takes_any_link_and_a_baseline_only_the_direct_one() {
        assert_eq!(link_of(FRONTIER, None).unwrap(), LinkSpec::Loopback);
        assert_eq!(link_of("ouroboros", None).unwrap(), LinkSpec::Loopback);
        assert_eq!(
            link_of(FRONTIER, Some(&LinkSpec::Qemu)).unwrap(),
            LinkSpec::Qemu
        );
        assert_eq!(link_of("bvp", None).unwrap(), LinkSpec::Direct);
        let error = link_of("bvp", Some(&LinkSpec::Loopback))
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
