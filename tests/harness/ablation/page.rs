//! The tables of `docs/ABLATION.md`, one part a room.

use super::effect::{Effect, Figures, Outcome, Verdict, WHOLE};
use super::rooms::{ROOMS, Room};
use super::{Change, Findings, Row};
use crate::table::number;

/// Writes the part of a room.
#[must_use]
pub fn part(room: &Room, findings: &Findings) -> String {
    let loops = room.closes_loops;
    format!(
        "{}\n{} {}\n\n{}\n{}",
        defaults(room, &findings.defaults),
        runs(room),
        noise(&findings.noise, loops),
        verdicts(findings),
        constants(findings, loops)
    )
}

/// Makes the table of the runs with the defaults.
fn defaults(room: &Room, outcomes: &[Outcome]) -> String {
    let mut names = vec![
        "run", "start", "noise", "end", "known %", "touched", "time s", "T99 s",
    ];
    if room.closes_loops {
        names.extend(["loops", "age s"]);
    }
    let mut lines = head(&names);
    for (run, outcome) in room.runs.iter().zip(outcomes) {
        let mut cells = run.words().to_vec();
        cells.extend([
            outcome.ending.clone(),
            format!("{:.2}", 100.0 * outcome.known),
            outcome.touched.to_string(),
            format!("{:.1}", outcome.time_s),
            number(outcome.t99_s, 1),
        ]);
        if room.closes_loops {
            cells.extend([outcome.loops.to_string(), number(outcome.age_s, 1)]);
        }
        lines += &line(&cells);
    }
    lines
}

/// Writes the sentence that counts the runs.
fn runs(room: &Room) -> String {
    let made = room.runs.len();
    let all = ROOMS.iter().find(|all| all.name == room.name);
    let all = all.map_or(made, |all| all.runs.len());
    if made == all {
        format!("All {all} runs of the room.")
    } else {
        format!("The first {made} of {all} runs of the room (`ABLATION_RUNS={made}`).")
    }
}

/// Writes the sentence of the noise.
fn noise(noise: &Figures, loops: bool) -> String {
    let mut text = format!(
        "Noise: time {} %, T99 {} %",
        number(noise.time_pct, 1),
        number(noise.t99_pct, 1)
    );
    if loops {
        text += &format!(", loops {:.1}", noise.loops);
        if noise.age_pct.is_some() {
            text += &format!(", age {} %", number(noise.age_pct, 1));
        }
    }
    text + "."
}

fn verdict(row: &Row, noise: &Figures) -> Verdict {
    let changes = row.changes.iter().flatten();
    let effects: Vec<Effect> = changes.map(|change| change.effect).collect();
    Verdict::of(&effects, noise)
}

/// Writes the sentence that counts the verdicts.
fn verdicts(findings: &Findings) -> String {
    let count = |verdict_of| {
        let rows = findings.rows.iter();
        let count = rows
            .filter(|row| verdict(row, &findings.noise) == verdict_of)
            .count();
        format!("{count} {verdict_of}")
    };
    let counts = Verdict::ALL.map(count).join(", ");
    format!("{} constants: {counts}.\n", findings.rows.len())
}

/// Makes the table of the constants.
fn constants(findings: &Findings, loops: bool) -> String {
    let mut names = vec![
        "constant",
        "default",
        "half / double",
        "changed",
        "explored",
        "touched",
        "time %",
        "T99 %",
        "known %",
    ];
    if loops {
        names.extend(["loops", "age %"]);
    }
    names.push("verdict");
    let mut lines = head(&names);
    for row in &findings.rows {
        let tuned = &row.tuned;
        let mut cells = vec![
            format!("`{}`", tuned.name),
            tuned.default.to_string(),
            both(row, |it| it.value.to_string()),
            both(row, |it| format!("{}", it.effect.changed)),
            both(row, |it| it.effect.explored.to_string()),
            both(row, |it| it.effect.touched.to_string()),
            both(row, |it| signed(it.effect.figures.time_pct)),
            both(row, |it| signed(it.effect.figures.t99_pct)),
            both(row, |it| least_known(&it.effect)),
        ];
        if loops {
            cells.push(both(row, |it| format!("{:+}", it.effect.figures.loops)));
            cells.push(both(row, |it| signed(it.effect.figures.age_pct)));
        }
        cells.push(verdict(row, &findings.noise).to_string());
        lines += &line(&cells);
    }
    lines
}

/// Writes a cell for both changes.
fn both(row: &Row, of: impl Fn(&Change) -> String) -> String {
    let cell = |change: &Option<Change>| change.as_ref().map_or_else(|| "-".into(), &of);
    let [half, double] = &row.changes;
    format!("{} / {}", cell(half), cell(double))
}

/// Formats a change in per cent.
fn signed(change: Option<f64>) -> String {
    match change {
        None => "-".into(),
        Some(0.0) => "0".into(),
        Some(change) => format!("{change:+.1}"),
    }
}

/// Formats the least share known if it is small.
fn least_known(effect: &Effect) -> String {
    let is_small = effect.least_known < WHOLE;
    number(is_small.then_some(100.0 * effect.least_known), 1)
}

fn head(names: &[&str]) -> String {
    let rule = names.iter().map(|_| "---".to_owned());
    line(&names.iter().map(|&it| it.to_owned()).collect::<Vec<_>>())
        + &line(&rule.collect::<Vec<_>>())
}

fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}
