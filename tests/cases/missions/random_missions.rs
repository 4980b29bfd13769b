//! Missions drawn at random, with resets of the device and kills of its host: bounds, touches, the
//! way home, and ends beside those of undisturbed runs.
//!
//! The table does not say that every run is good. It says how many are not, and names their seeds.

use core::fmt::Write as _;
use core::ops::Range;

use fieldline_tests::golden;
use fieldline_tests::random_missions::{Draw, Home, Outcome};
use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::Table;

/// Missions of the golden table.
const FEW: u64 = 20;
/// Missions of the full table, which is printed.
const MANY: u64 = 1_000;

fn missions(seeds: Range<u64>) -> Vec<(Draw, Outcome)> {
    let draws: Vec<Draw> = seeds.map(Draw::new).collect();
    let outcomes = in_parallel(&draws, Draw::go);
    draws.into_iter().zip(outcomes).collect()
}

fn table(missions: &[(Draw, Outcome)]) -> String {
    let columns = [
        "world",
        "runs",
        "left bounds",
        "deepest m",
        "touches",
        "home",
        "cannot get home",
        "neither",
        "resumed",
        "end alike",
        "known m2",
        "undisturbed m2",
    ];
    let mut table = Table::new(1, &columns);
    let mut kinds: Vec<&str> = missions.iter().map(|(draw, _)| draw.kind).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        let of: Vec<&Outcome> = missions
            .iter()
            .filter(|(draw, _)| draw.kind == kind)
            .map(|(_, outcome)| outcome)
            .collect();
        table.row(row(kind, &of));
    }
    let all: Vec<&Outcome> = missions.iter().map(|(_, outcome)| outcome).collect();
    table.row(row("all", &all));
    let mut text = format!("{} missions.\n\n{table}\n", missions.len());
    let _ = writeln!(
        text,
        "Missions that left their bounds, touched something or are not home.\n"
    );
    for (draw, outcome) in missions {
        let faults = outcome.faults().join(", ");
        if !faults.is_empty() {
            let strategy = &outcome.report.strategy;
            let _ = writeln!(
                text,
                "seed {}, {}, {strategy}: {faults}",
                draw.seed, draw.world
            );
        }
    }
    text
}

fn row(kind: &str, all: &[&Outcome]) -> Vec<String> {
    let count = |is: &dyn Fn(&Outcome) -> bool| all.iter().filter(|it| is(it)).count().to_string();
    let deepest = all.iter().map(|it| it.deepest_m()).fold(0.0, f64::max);
    let touches: u32 = all.iter().map(|it| it.report.safety.collisions).sum();
    let pairs = all
        .iter()
        .filter_map(|it| Some((&it.report, it.undisturbed.as_ref()?)));
    let known: Vec<[f64; 2]> = pairs
        .map(|(a, b)| [a.coverage.known_m2, b.coverage.known_m2])
        .collect();
    let mean = |k: usize| match known.len() {
        0 => "-".into(),
        many => format!(
            "{:.1}",
            known.iter().map(|it| it[k]).sum::<f64>() / many as f64
        ),
    };
    vec![
        kind.into(),
        all.len().to_string(),
        count(&Outcome::left_its_bounds),
        format!("{deepest:.3}"),
        touches.to_string(),
        count(&|it| it.home() == Home::Reached),
        count(&|it| it.home() == Home::Typed),
        count(&|it| it.home() == Home::Neither),
        count(&|it| it.resumed > 0),
        count(&|it| it.ends_alike() == Some(true)),
        mean(0),
        mean(1),
    ]
}

#[test]
fn a_few_missions_at_random() {
    let missions = missions(0..FEW);
    for (draw, outcome) in &missions {
        assert!(!outcome.left_its_bounds(), "seed {}", draw.seed);
        assert_eq!(outcome.report.safety.collisions, 0, "seed {}", draw.seed);
        assert_ne!(outcome.home(), Home::Neither, "seed {}", draw.seed);
    }
    golden::compare("random-missions.txt", &table(&missions));
}

mod full {
    use super::*;

    /// Prints the table. `FIELDLINE_SEEDS=K` makes the first K missions, `FIELDLINE_SEEDS=A..B`
    /// those of the seeds from A on and before B.
    #[test]
    #[ignore = "takes an hour: 1000 missions; tests/run --full runs it"]
    fn many_missions_at_random() {
        let asked = std::env::var("FIELDLINE_SEEDS").ok();
        let seeds = asked.map_or(0..MANY, |text| seeds(&text));
        println!("{}", table(&missions(seeds)));
    }

    fn seeds(text: &str) -> Range<u64> {
        let number = |part: &str| -> u64 {
            part.parse().unwrap_or_else(|_| {
                panic!("FIELDLINE_SEEDS must be a number of seeds or A..B, and not {text}")
            })
        };
        match text.split_once("..") {
            Some((first, end)) => number(first)..number(end),
            None => 0..number(text),
        }
    }
}
