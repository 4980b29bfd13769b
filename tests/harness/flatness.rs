//! How flat the field around the robot was in a run: `p_diff`, and what follows from it \[Maffei20,
//! III-C\].
//!
//! Heights are left out of the preference below a `p_diff` of 1e-10 until it is above 1e-4 again.
//! `ε_global` grows as `p_diff` falls. The formulas are in
//! [`fieldline_planner::field::preference`].
//!
//! `p_diff` and ε are pure numbers.

use fieldline_planner::config::UnevenGround;
use fieldline_planner::field::preference::{Preferences, of_flatness};

use crate::table::Table;

/// `p_diff` of the last field, after every step since the first field.
#[derive(Clone, Debug, Default)]
pub struct Flatness {
    p_diffs: Vec<f32>,
    without_heights: usize,
}

impl Flatness {
    /// Notes the preferences after a step.
    pub fn note(&mut self, preferences: &Preferences) {
        self.p_diffs.extend(preferences.p_diff());
        self.without_heights += usize::from(preferences.ignores_heights());
    }

    /// Joins runs.
    fn joined<'a>(runs: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut all = Self::default();
        for run in runs {
            all.p_diffs.extend(&run.p_diffs);
            all.without_heights += run.without_heights;
        }
        all.p_diffs.sort_by(f32::total_cmp);
        all
    }
}

/// Makes a table with one line for each group of runs. `ε_global` is that of the parameters of
/// \[Maffei20, Table I\], also for runs without it.
#[must_use]
pub fn table<'a, R>(groups: impl IntoIterator<Item = (String, R)>) -> Table
where
    R: IntoIterator<Item = &'a Flatness>,
{
    let columns = [
        "runs of",
        "steps",
        "p_diff least",
        "median",
        "most",
        "eps_global least",
        "most",
        "steps without heights",
    ];
    let mut table = Table::new(1, &columns);
    for (name, runs) in groups {
        let all = Flatness::joined(runs);
        let p_diffs = &all.p_diffs;
        let (Some(&least), Some(&most)) = (p_diffs.first(), p_diffs.last()) else {
            continue;
        };
        let global = |p_diff| of_flatness(&UnevenGround::TABLE_I, p_diff);
        table.row(vec![
            name,
            p_diffs.len().to_string(),
            format!("{least:.1e}"),
            format!("{:.1e}", p_diffs[p_diffs.len() / 2]),
            format!("{most:.1e}"),
            format!("{:.4}", global(most)),
            format!("{:.4}", global(least)),
            all.without_heights.to_string(),
        ]);
    }
    table
}

#[cfg(test)]
mod tests {
    use super::{Flatness, table};
    use fieldline_planner::field::preference::Preferences;

    #[test]
    fn a_line_has_the_range_and_the_steps_without_heights() {
        let (mut preferences, mut flatness) = (Preferences::new(), Flatness::default());
        flatness.note(&preferences);
        for p_diff in [1e-2, 1e-11, 1e-6, 1e-3] {
            preferences.note(p_diff);
            flatness.note(&preferences);
        }
        let text = table([("slope".to_owned(), [&flatness])]).to_string();
        let line: Vec<&str> = text
            .lines()
            .last()
            .expect("a line")
            .split_whitespace()
            .collect();
        assert_eq!(
            line,
            [
                "slope", "4", "1.0e-11", "1.0e-3", "1.0e-2", "0.0230", "0.1266", "2"
            ]
        );
    }
}
