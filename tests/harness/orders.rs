//! Explorations in one order of frontiers beside another, as ratios to a baseline in the same world
//! with the same seed.
//!
//! A ratio of times is below 1 where the order is quicker. The mean of ratios is geometric. A ratio
//! counts only where both runs know that share of the world.

use fieldline_planner::Tuning;
use fieldline_protocol::message::Order;
use fixed::types::I4F12;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::report::Report;
use host_sim::trial::mission::Mission;
use host_sim::world::World;

use crate::runs::{self, BASELINES, FRONTIER, Run, explored};
use crate::table::{Table, number};

/// The baseline of the ratios: `explore_lite`'s rule with distances along paths.
const REFERENCE: &str = BASELINES[1];

/// An order to compare.
#[derive(Clone, Copy, Debug)]
pub struct Variant {
    /// Its name in the table.
    pub name: &'static str,
    /// The strategy.
    pub strategy: &'static str,
    /// The order; the strategy's own if `None`.
    pub order: Option<Order>,
    /// Tuned constants with other values than their defaults.
    pub tuned: &'static [(&'static str, f32)],
}

/// The strategies for one robot in flat worlds, the usual one first, then the reference.
#[must_use]
pub fn strategies() -> Vec<Variant> {
    let named = |name| Variant {
        name,
        strategy: name,
        order: None,
        tuned: &[],
    };
    [FRONTIER, "ouroboros", "tdbvp", REFERENCE]
        .map(named)
        .into()
}

/// The orders with the strategy's own first, then each part of it left out, then the baselines.
#[must_use]
pub fn variants() -> Vec<Variant> {
    let own = Variant {
        name: "by gain",
        strategy: FRONTIER,
        order: None,
        tuned: &[],
    };
    let worth = |worth: f64| {
        Some(Order::Gain {
            worth: I4F12::from_num(worth),
        })
    };
    let nearest = |worth: f64| {
        Some(Order::Nearest {
            worth: I4F12::from_num(worth),
        })
    };
    let with = |name, tuned| Variant { name, tuned, ..own };
    let by = |name, order| Variant { name, order, ..own };
    let baseline = |name| Variant {
        name,
        strategy: name,
        ..own
    };
    let mut all = vec![
        own,
        by("everything seen (worth 0)", worth(0.0)),
        by("worth 0.1", worth(0.1)),
        by("nearest first", nearest(0.25)),
        by("nearest first, worth 0", nearest(0.0)),
        with("a gain counts in full", &[("order.power", 1.0)]),
        with("a gain counts by its root", &[("order.power", 0.5)]),
        with("gain within 2 m", &[("order.gain_m", 2.0)]),
        with("turning is free", &[("order.turn_m", 0.0)]),
        with("turning costs twice", &[("order.turn_m", 7.6)]),
        with("no hysteresis", &[("order.keep", 1.0)]),
        with("hysteresis of 100 %", &[("order.keep", 2.0)]),
    ];
    all.extend(BASELINES.map(baseline));
    all
}

/// Explores every world with every seed in every order. Returns the reports of each order.
///
/// # Panics
/// If a run cannot begin, or a tuned constant is unknown.
#[must_use]
pub fn sweep(worlds: &[World], seeds: &[u64], variants: &[Variant]) -> Vec<Vec<Report>> {
    let mut jobs = Vec::new();
    for variant in variants {
        let tuning = runs::tuned(variant.tuned);
        for world in worlds {
            jobs.extend(seeds.iter().map(|&seed| (variant, tuning, world, seed)));
        }
    }
    let reports = runs::in_parallel(&jobs, |&(variant, tuning, world, seed)| {
        explore(variant, tuning, world, seed)
    });
    let each = worlds.len() * seeds.len();
    reports.chunks(each).map(<[Report]>::to_vec).collect()
}

fn explore(variant: &Variant, tuning: &'static Tuning, world: &World, seed: u64) -> Report {
    if variant.strategy != FRONTIER {
        let run = Run {
            seed,
            ..Run::first(world, variant.strategy)
        };
        return run.go();
    }
    let mission = Mission {
        seed,
        order: variant.order,
        ..Mission::default()
    };
    let mut link: Box<dyn Link> = Box::new(Direct::tuned(tuning));
    explored(&mission, world, link.as_mut()).0
}

/// The figures of a run that have ratios.
const FIGURES: [fn(&Report) -> Option<f64>; 5] = [
    |report| report.coverage.t90_s,
    |report| report.coverage.t95_s,
    |report| report.coverage.t99_s,
    |report| Some(report.sim_time_s),
    |report| Some(report.path_length_m),
];

/// Makes a table with one line for each order: means of ratios to the baseline.
///
/// # Panics
/// If the baseline is not among the variants.
#[must_use]
pub fn table(variants: &[Variant], reports: &[Vec<Report>]) -> Table {
    let mut table = Table::new(
        1,
        &[
            "order",
            "T90",
            "T95",
            "T99",
            "end",
            "path",
            "most T90",
            "most T99",
            "known %",
            "never 99 %",
            "faults",
            "hits",
        ],
    );
    let reference = reference(variants, reports);
    for (variant, own) in variants.iter().zip(reports) {
        let ratios = FIGURES.map(|of| ratios(own, reference, of));
        let known = own.iter().map(|report| report.coverage.fraction * 100.0);
        let most = |ratios: &[f64]| ratios.iter().copied().reduce(f64::max);
        let mut row = vec![variant.name.into()];
        row.extend(ratios.iter().map(|ratios| number(mean(ratios), 3)));
        row.extend([number(most(&ratios[0]), 2), number(most(&ratios[2]), 2)]);
        row.push(format!("{:.2}", known.sum::<f64>() / own.len() as f64));
        let count = |is: fn(&Report) -> bool| own.iter().filter(|report| is(report)).count();
        row.push(count(|report| report.coverage.t99_s.is_none()).to_string());
        row.push(count(|report| !report.explored()).to_string());
        row.push(count(|report| report.safety.collisions > 0).to_string());
        table.row(row);
    }
    table
}

/// Makes a table with one line for each world: means of ratios of the first order to the baseline
/// over the seeds.
///
/// # Panics
/// As [`table`].
#[must_use]
pub fn by_world(variants: &[Variant], reports: &[Vec<Report>]) -> Table {
    let mut table = Table::new(
        1,
        &[
            "world", "T90", "T95", "T99", "end", "path", "known %", "its %",
        ],
    );
    let reference = reference(variants, reports);
    let Some(own) = reports.first() else {
        return table;
    };
    let groups = |all: &'_ [Report]| -> Vec<Vec<Report>> {
        all.chunk_by(|a, b| a.world == b.world)
            .map(<[Report]>::to_vec)
            .collect()
    };
    for (own, its) in groups(own).iter().zip(&groups(reference)) {
        let known = |all: &[Report]| {
            let sum: f64 = all.iter().map(|report| report.coverage.fraction).sum();
            format!("{:.2}", 100.0 * sum / all.len() as f64)
        };
        let mut row = vec![own[0].world.clone()];
        row.extend(FIGURES.map(|of| number(mean(&ratios(own, its, of)), 2)));
        row.extend([known(own), known(its)]);
        table.row(row);
    }
    table
}

fn reference<'a>(variants: &[Variant], reports: &'a [Vec<Report>]) -> &'a [Report] {
    let mut pairs = variants.iter().zip(reports);
    match pairs.find(|(variant, _)| variant.strategy == REFERENCE) {
        Some((_, reports)) => reports,
        None => panic!("{REFERENCE} is not among the orders"),
    }
}

/// Returns the ratios of a figure, run by run, where both have it.
fn ratios(own: &[Report], its: &[Report], of: fn(&Report) -> Option<f64>) -> Vec<f64> {
    let pairs = own.iter().zip(its);
    pairs
        .filter_map(|(own, its)| Some(of(own)? / of(its)?))
        .collect()
}

/// Returns the geometric mean; `None` without ratios.
fn mean(ratios: &[f64]) -> Option<f64> {
    let sum: f64 = ratios.iter().map(|ratio| ratio.ln()).sum();
    (!ratios.is_empty()).then(|| (sum / ratios.len() as f64).exp())
}

#[cfg(test)]
mod tests {
    use super::{by_world, mean, table, variants};
    use crate::runs::{FRONTIER, Run};
    use crate::worlds::builtin;

    #[test]
    fn a_mean_of_ratios_is_geometric() {
        assert_eq!(mean(&[]), None);
        assert!((mean(&[0.5, 2.0]).unwrap() - 1.0).abs() < 1e-12);
    }

    #[test]
    fn a_share_that_one_run_never_knew_makes_no_ratio() {
        let blank = Run::first(&builtin("boxed-in"), FRONTIER).go();
        let variants = variants();
        let mut reports = vec![vec![blank.clone()]; variants.len()];
        for (k, reports) in reports.iter_mut().enumerate() {
            reports[0].coverage.t90_s = Some(10.0 * (k + 1) as f64);
            reports[0].coverage.t99_s = (k > 0).then_some(100.0);
        }
        let text = table(&variants, &reports).to_string();
        let last = variants.len() as f64;
        let row = text.lines().nth(1).unwrap();
        assert!(row.starts_with("by gain"), "{text}");
        let first: Vec<&str> = row["by gain".len()..].split_whitespace().collect();
        assert_eq!(first[0], format!("{:.3}", 1.0 / last), "{text}");
        assert_eq!((first[2], first[8]), ("-", "1"), "{text}");
        assert_eq!(by_world(&variants, &reports).to_string().lines().count(), 2);
    }
}
