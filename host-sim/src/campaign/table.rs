//! The table of a campaign: for each world and strategy the numbers of each column, and how they
//! differ from those of the baseline.
//!
//! Trials of equal world, odometry, start and seed are pairs. A trial without a value in a column
//! (it failed, or never reached 99 %) is left out there, and so is its pair: `n` says how many
//! count. So a column of times that only some trials reached flatters those that often fail.

use std::collections::BTreeMap;

use super::columns::{Cell, Row};
use super::plan::{Plan, row_name};
use super::statistics::{RankSum, SignedRank, Signs, Summary, rank_sum, sign_test, signed_rank};
use super::store::Finished;

/// A table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Name of the campaign.
    pub name: String,
    /// Number of trials in the campaign.
    pub trials: usize,
    /// Number of trials that are here.
    pub finished: usize,
    /// Paths of the columns.
    pub columns: Vec<String>,
    /// Name of the arm with which the others are compared.
    pub baseline: Option<String>,
    /// One for each world and odometry; with several of them, all together at the end.
    pub groups: Vec<Group>,
    /// Command and failure of the trials that failed.
    pub failures: Vec<(String, String)>,
}

/// The trials of a world with an odometry, or all trials.
#[derive(Clone, Debug)]
pub struct Group {
    /// Its name in headings.
    pub title: String,
    /// World; empty for all.
    pub world: String,
    /// Odometry, if the campaign says one.
    pub odometry: Option<String>,
    /// One for each arm, in order.
    pub entries: Vec<Entry>,
}

/// The trials of an arm in a group.
#[derive(Clone, Debug)]
pub struct Entry {
    /// Name of the arm.
    pub arm: String,
    /// Number of trials.
    pub trials: usize,
    /// Number of those that failed.
    pub failed: usize,
    /// Numbers of each column.
    pub figures: Vec<Figures>,
    /// Differences to the baseline in each column; empty for the baseline, or without one.
    pub differences: Vec<Option<Difference>>,
}

/// Numbers of a column.
#[derive(Clone, Debug, PartialEq)]
pub enum Figures {
    /// No trial has a value.
    Nothing,
    /// Numbers.
    Numbers(Summary),
    /// Yes or no: how many of how many.
    Share([usize; 2]),
    /// Texts, and how often each is there; the most frequent first.
    Texts(Vec<(String, usize)>),
}

/// How an arm differs from the baseline in a column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Difference {
    /// Difference of the means, per cent of the baseline's; `None` if that is 0.
    pub percent: Option<f64>,
    /// All values against all; `None` where worlds are thrown together.
    pub rank_sum: Option<RankSum>,
    /// The pairs.
    pub signed_rank: SignedRank,
    /// The signs of the pairs.
    pub signs: Signs,
    /// Number of pairs.
    pub pairs: usize,
}

/// World, odometry, start and seed: what a pair has in common.
type Key = (String, Option<String>, u64, u64);

/// Returns the table of these trials.
#[must_use]
pub fn table(plan: &Plan, finished: &[Finished]) -> Table {
    let mut ordered: Vec<&Finished> = finished.iter().collect();
    ordered.sort_by_key(|line| line.index);
    let rows: Vec<Row<'_>> = ordered.into_iter().map(Row::new).collect();
    let mut groups = Vec::new();
    for world in &plan.worlds {
        for odometry in plan.odometries() {
            let here = |row: &&Row<'_>| row.line.world == *world && row.line.odometry == odometry;
            let rows: Vec<&Row<'_>> = rows.iter().filter(here).collect();
            groups.push(Group {
                title: row_name(world, odometry.as_deref()),
                world: world.clone(),
                entries: entries(plan, &rows, true),
                odometry,
            });
        }
    }
    if groups.len() > 1 {
        let all: Vec<&Row<'_>> = rows.iter().collect();
        groups.push(Group {
            title: "all together".into(),
            world: String::new(),
            odometry: None,
            entries: entries(plan, &all, false),
        });
    }
    let failure = |row: &Row<'_>| Some((row.line.command.clone(), row.line.failure.clone()?));
    Table {
        name: plan.name.clone(),
        trials: plan.count().unwrap_or(0),
        finished: rows.len(),
        columns: plan.columns.clone(),
        baseline: plan.baseline.clone(),
        groups,
        failures: rows.iter().filter_map(failure).collect(),
    }
}

/// Returns the entries of a group; `is_one_world` says if unpaired values can be compared.
fn entries(plan: &Plan, rows: &[&Row<'_>], is_one_world: bool) -> Vec<Entry> {
    let of = |arm: &str| -> Vec<&Row<'_>> {
        rows.iter()
            .copied()
            .filter(|row| row.line.strategy == arm)
            .collect()
    };
    let baseline = plan.baseline.as_deref().map(of);
    let entry = |arm: String| {
        let rows = of(&arm);
        let difference = |column: &String| {
            let baseline = baseline.as_ref()?;
            difference(
                &numbers(&rows, column),
                &numbers(baseline, column),
                is_one_world,
            )
        };
        let is_baseline = plan.baseline.is_none() || plan.baseline.as_ref() == Some(&arm);
        Entry {
            trials: rows.len(),
            failed: rows.iter().filter(|row| row.line.failure.is_some()).count(),
            figures: plan
                .columns
                .iter()
                .map(|column| figures(&rows, column))
                .collect(),
            differences: match is_baseline {
                true => Vec::new(),
                false => plan.columns.iter().map(difference).collect(),
            },
            arm,
        }
    };
    plan.arms()
        .into_iter()
        .map(|arm| entry(arm.label))
        .collect()
}

/// Returns the numbers of a column.
fn figures(rows: &[&Row<'_>], column: &str) -> Figures {
    let cells: Vec<Cell> = rows.iter().map(|row| row.cell(column)).collect();
    let mut texts: BTreeMap<String, usize> = BTreeMap::new();
    for cell in &cells {
        if let Cell::Text(text) = cell {
            *texts.entry(text.clone()).or_default() += 1;
        }
    }
    if !texts.is_empty() {
        let mut texts: Vec<(String, usize)> = texts.into_iter().collect();
        texts.sort_by_key(|(_, count)| core::cmp::Reverse(*count));
        return Figures::Texts(texts);
    }
    let truths = cells.iter().filter_map(|cell| match cell {
        Cell::Truth(truth) => Some(*truth),
        _ => None,
    });
    let (yes, known) = (truths.clone().filter(|it| *it).count(), truths.count());
    if known > 0 {
        return Figures::Share([yes, known]);
    }
    let values: Vec<f64> = cells.iter().filter_map(number).collect();
    Summary::of(&values).map_or(Figures::Nothing, Figures::Numbers)
}

fn number(cell: &Cell) -> Option<f64> {
    match cell {
        Cell::Number(number) => Some(*number),
        Cell::Truth(truth) => Some(f64::from(u8::from(*truth))),
        Cell::Missing | Cell::Text(_) => None,
    }
}

/// Returns the numbers of a column, by what pairs them.
pub(super) fn numbers(rows: &[&Row<'_>], column: &str) -> BTreeMap<Key, f64> {
    let numbers = rows.iter().filter_map(|row| {
        let line = row.line;
        let key = (
            line.world.clone(),
            line.odometry.clone(),
            line.start,
            line.seed,
        );
        Some((key, number(&row.cell(column))?))
    });
    numbers.collect()
}

/// Returns the difference of two samples; `None` if one of them is empty.
fn difference(
    own: &BTreeMap<Key, f64>,
    baseline: &BTreeMap<Key, f64>,
    is_one_world: bool,
) -> Option<Difference> {
    let values = |of: &BTreeMap<Key, f64>| -> Vec<f64> { of.values().copied().collect() };
    let (all, of_baseline) = (values(own), values(baseline));
    let (mean, usual) = (Summary::of(&all)?.mean, Summary::of(&of_baseline)?.mean);
    let pair = |(key, value): (&Key, &f64)| baseline.get(key).map(|other| value - other);
    let pairs: Vec<f64> = own.iter().filter_map(pair).collect();
    Some(Difference {
        percent: (usual != 0.0).then(|| 100.0 * (mean - usual) / usual.abs()),
        rank_sum: rank_sum(&all, &of_baseline).filter(|_| is_one_world),
        signed_rank: signed_rank(&pairs),
        signs: sign_test(&pairs),
        pairs: pairs.len(),
    })
}

#[cfg(test)]
mod tests;
