//! A changed set of runs against the same runs with the defaults, and the verdict on a constant.
//!
//! ```text
//! change = mean over the runs that explored with both of (changed / default − 1)
//! noise  = root mean square of that change over other seeds of the defaults
//! ```

use core::fmt;

use host_sim::report::Report;

use super::rooms::Run;

/// Change of a mean time below which a constant is insensitive, per cent.
pub const INSENSITIVE_PCT: f64 = 2.0;
/// Multiple of the noise below which a change may be chance.
pub const NOISES: f64 = 2.0;
/// Share known below which a run misses ground.
pub const WHOLE: f64 = 0.99;

/// The outcome of a run.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Outcome {
    /// Digest of the command stream.
    pub digest: String,
    /// Status and reason of the end.
    pub ending: String,
    /// Collisions, falls and tips.
    pub touched: u32,
    /// Loops of the world that the robot drove round, if its strategy closes loops.
    pub loops: u32,
    /// Share known at the end.
    pub known: f64,
    /// Time to the end without the patrol, seconds.
    pub time_s: f64,
    /// Time to the end, seconds.
    pub end_s: f64,
    /// Time to 99 % known, seconds.
    pub t99_s: Option<f64>,
    /// Mean age of the rails on patrol, seconds.
    pub age_s: Option<f64>,
}

impl Outcome {
    /// Takes the outcome from a report.
    #[must_use]
    pub fn of(report: &Report, run: &Run) -> Self {
        let (outcome, safety) = (&report.outcome, &report.safety);
        let patrol_s = if report.explored() { run.patrol_s() } else { 0 };
        Self {
            digest: report.digest.clone(),
            ending: format!("{}({})", outcome.status, outcome.reason),
            touched: safety.collisions + safety.falls + safety.tips,
            loops: if run.closes_loops() {
                report.loops.circled
            } else {
                0
            },
            known: report.coverage.fraction,
            time_s: report.sim_time_s - f64::from(patrol_s),
            end_s: report.sim_time_s,
            t99_s: report.coverage.t99_s,
            age_s: report.patrol.map(|patrol| patrol.mean_rail_age_s),
        }
    }

    /// Returns the outcome of a run whose planner panicked.
    #[must_use]
    pub fn panicked() -> Self {
        Self {
            digest: "-".into(),
            ending: "panicked".into(),
            ..Self::default()
        }
    }

    /// Returns true if everything is explored.
    #[must_use]
    pub fn explored(&self) -> bool {
        self.ending == "finished(explored)"
    }

    /// Reads the text that [`fmt::Display`] writes.
    #[must_use]
    pub fn parse(line: &str) -> Option<Self> {
        let words: Vec<&str> = line.split(' ').collect();
        let [
            digest,
            ending,
            touched,
            loops,
            known,
            time,
            end,
            t99,
            age,
            ".",
        ] = words[..]
        else {
            return None;
        };
        Some(Self {
            digest: digest.into(),
            ending: ending.into(),
            touched: touched.parse().ok()?,
            loops: loops.parse().ok()?,
            known: known.parse().ok()?,
            time_s: time.parse().ok()?,
            end_s: end.parse().ok()?,
            t99_s: t99.parse().ok(),
            age_s: age.parse().ok(),
        })
    }
}

impl fmt::Display for Outcome {
    /// Writes nine words and a full stop, which an interrupted line lacks.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let maybe = |value: Option<f64>| value.map_or_else(|| "-".into(), |it| it.to_string());
        let (digest, ending, touched, loops) =
            (&self.digest, &self.ending, self.touched, self.loops);
        let (known, time_s, end_s) = (self.known, self.time_s, self.end_s);
        let (t99, age) = (maybe(self.t99_s), maybe(self.age_s));
        write!(
            f,
            "{digest} {ending} {touched} {loops} {known} {time_s} {end_s} {t99} {age} ."
        )
    }
}

/// Changes of the figures that have noise.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Figures {
    /// Mean change of the time to the end, per cent; `None` without a run that explored.
    pub time_pct: Option<f64>,
    /// Mean change of the time to 99 % known, per cent.
    pub t99_pct: Option<f64>,
    /// Mean change of the mean age of the rails on patrol, per cent.
    pub age_pct: Option<f64>,
    /// Change of the number of loops closed in all runs.
    pub loops: f64,
}

impl Figures {
    /// Returns the root mean square of each figure. Figures that are missing are left out.
    #[must_use]
    pub fn root_mean_square(all: &[Self]) -> Self {
        let rms = |of: fn(&Self) -> Option<f64>| {
            mean(all.iter().filter_map(of).map(|x| x * x)).map(f64::sqrt)
        };
        Self {
            time_pct: rms(|it| it.time_pct),
            t99_pct: rms(|it| it.t99_pct),
            age_pct: rms(|it| it.age_pct),
            loops: rms(|it| Some(it.loops)).unwrap_or(0.0),
        }
    }

    fn percentages(&self) -> [Option<f64>; 3] {
        [self.time_pct, self.t99_pct, self.age_pct]
    }
}

/// The effect of a change on a room's runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Effect {
    /// Runs.
    pub runs: usize,
    /// Runs whose digest changed.
    pub changed: usize,
    /// Runs that ended explored.
    pub explored: usize,
    /// Runs that ended otherwise than with the defaults.
    pub otherwise: usize,
    /// Collisions, falls and tips.
    pub touched: u32,
    /// Collisions, falls and tips that the defaults do not have.
    pub touched_more: u32,
    /// Least share known by a run that knew the whole with the defaults.
    pub least_known: f64,
    /// Changes of the figures.
    pub figures: Figures,
}

impl Effect {
    /// Compares outcomes with those of the same runs with the defaults.
    #[must_use]
    pub fn of(defaults: &[Outcome], outcomes: &[Outcome]) -> Self {
        let pairs = || defaults.iter().zip(outcomes);
        let count = |is: fn(&Outcome, &Outcome) -> bool| pairs().filter(|(d, o)| is(d, o)).count();
        let touched = |all: &[Outcome]| all.iter().map(|it| it.touched).sum::<u32>();
        let loops = |all: &[Outcome]| f64::from(all.iter().map(|it| it.loops).sum::<u32>());
        let whole = || pairs().filter(|(d, _)| d.known >= WHOLE);
        let both = || pairs().filter(|(d, o)| d.explored() && o.explored());
        let change = |of: fn(&Outcome) -> Option<f64>| {
            mean(both().filter_map(|(d, o)| Some(100.0 * (of(o)? / of(d)? - 1.0))))
        };
        Self {
            runs: outcomes.len(),
            changed: count(|d, o| d.digest != o.digest),
            explored: outcomes.iter().filter(|it| it.explored()).count(),
            otherwise: count(|d, o| d.ending != o.ending),
            touched: touched(outcomes),
            touched_more: touched(outcomes).saturating_sub(touched(defaults)),
            least_known: whole().map(|(_, o)| o.known).fold(1.0, f64::min),
            figures: Figures {
                time_pct: change(|it| Some(it.time_s)),
                t99_pct: change(|it| it.t99_s),
                age_pct: change(|it| it.age_s),
                loops: loops(outcomes) - loops(defaults),
            },
        }
    }

    /// Returns true if every run ended as with the defaults, nothing more was touched, and no
    /// ground was missed.
    fn ends_alike(&self) -> bool {
        self.otherwise == 0 && self.touched_more == 0 && self.least_known >= WHOLE
    }

    /// Returns true if all figures changed by less than the limits. Where the figures have no
    /// limit, no change is enough.
    fn is_below(&self, limits: &Figures) -> bool {
        let figures = self.figures.percentages();
        let mut pairs = figures.iter().zip(limits.percentages());
        pairs.all(|(figure, limit)| {
            figure.is_none_or(|x| x == 0.0 || limit.is_some_and(|most| x.abs() < most))
        }) && self.figures.loops.abs() <= limits.loops
    }
}

/// The verdict on a constant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Verdict {
    /// No digest changed.
    Idle,
    /// Every run ended alike, and every mean changed by less than [`INSENSITIVE_PCT`].
    Insensitive,
    /// Every run ended alike, and every mean changed by less than [`NOISES`] times its noise.
    Noise,
    /// The constant matters.
    Matters,
}

impl Verdict {
    /// All verdicts.
    pub const ALL: [Self; 4] = [Self::Idle, Self::Insensitive, Self::Noise, Self::Matters];

    /// Judges the effects of a constant's changes.
    #[must_use]
    pub fn of(effects: &[Effect], noise: &Figures) -> Self {
        let insensitive = Figures {
            time_pct: Some(INSENSITIVE_PCT),
            t99_pct: Some(INSENSITIVE_PCT),
            age_pct: Some(INSENSITIVE_PCT),
            loops: 0.0,
        };
        let times = |figure: Option<f64>| figure.map(|x| INSENSITIVE_PCT.max(NOISES * x));
        let chance = Figures {
            time_pct: times(noise.time_pct),
            t99_pct: times(noise.t99_pct),
            age_pct: times(noise.age_pct),
            loops: NOISES * noise.loops,
        };
        let all = |is: &dyn Fn(&Effect) -> bool| effects.iter().all(is);
        if all(&|it| it.changed == 0) {
            Self::Idle
        } else if all(&|it| it.ends_alike() && it.is_below(&insensitive)) {
            Self::Insensitive
        } else if all(&|it| it.ends_alike() && it.is_below(&chance)) {
            Self::Noise
        } else {
            Self::Matters
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Idle => "idle",
            Self::Insensitive => "insensitive",
            Self::Noise => "within noise",
            Self::Matters => "matters",
        })
    }
}

/// Returns the mean; `None` of no values.
fn mean(values: impl Iterator<Item = f64>) -> Option<f64> {
    let (count, sum) = values.fold((0, 0.0), |(count, sum), x| (count + 1, sum + x));
    (count > 0).then(|| sum / f64::from(count))
}

#[cfg(test)]
mod tests {
    use super::{Effect, Figures, Outcome, Verdict};

    fn explored(digest: &str, time_s: f64) -> Outcome {
        Outcome {
            digest: digest.into(),
            ending: "finished(explored)".into(),
            known: 1.0,
            loops: 1,
            time_s,
            end_s: time_s + 300.0,
            t99_s: Some(0.5 * time_s),
            ..Outcome::default()
        }
    }

    fn verdict(outcomes: &[&[Outcome]]) -> Verdict {
        let noise = Figures {
            time_pct: Some(3.0),
            t99_pct: Some(3.0),
            ..Figures::default()
        };
        let defaults = [explored("a", 100.0), explored("b", 200.0)];
        let effects: Vec<_> = outcomes
            .iter()
            .map(|it| Effect::of(&defaults, it))
            .collect();
        Verdict::of(&effects, &noise)
    }

    #[test]
    fn a_change_is_the_mean_over_runs_that_explored_with_both() {
        let defaults = [100.0, 200.0, 50.0].map(|time_s| explored("a", time_s));
        let mut outcomes = [110.0, 160.0, 500.0].map(|time_s| explored("b", time_s));
        outcomes[2].ending = "time-limit(simulated-time)".into();
        outcomes[2].known = 0.7;
        outcomes[1].digest = "a".into();
        outcomes[1].touched = 2;
        outcomes[0].loops = 4;
        let effect = Effect::of(&defaults, &outcomes);
        let time_pct = effect.figures.time_pct.unwrap();
        // +10 % and −20 %.
        assert!((time_pct + 5.0).abs() < 1e-9, "{time_pct}");
        assert_eq!((effect.runs, effect.changed, effect.explored), (3, 2, 2));
        assert_eq!(
            (effect.otherwise, effect.touched, effect.touched_more),
            (1, 2, 2)
        );
        assert_eq!(effect.least_known, 0.7);
        assert_eq!((effect.figures.loops, effect.figures.age_pct), (3.0, None));
    }

    #[test]
    fn the_verdict_needs_both_directions() {
        let same = [explored("a", 100.0), explored("b", 200.0)];
        let near = [explored("c", 101.0), explored("b", 202.0)];
        let far = [explored("c", 105.0), explored("b", 210.0)];
        let farther = [explored("c", 107.0), explored("b", 214.0)];
        assert_eq!(verdict(&[&same, &same]), Verdict::Idle);
        assert_eq!(verdict(&[&same, &near]), Verdict::Insensitive);
        assert_eq!(verdict(&[&far, &near]), Verdict::Noise);
        assert_eq!(verdict(&[&far, &farther]), Verdict::Matters);
    }

    #[test]
    fn another_end_a_touch_or_missed_ground_matters() {
        let change = |change: fn(&mut Outcome)| {
            let mut outcomes = [explored("c", 100.0), explored("b", 200.0)];
            change(&mut outcomes[0]);
            verdict(&[&outcomes])
        };
        assert_eq!(change(|_| ()), Verdict::Insensitive);
        assert_eq!(
            change(|it| it.ending = "fault(stuck)".into()),
            Verdict::Matters
        );
        assert_eq!(change(|it| it.touched = 1), Verdict::Matters);
        assert_eq!(change(|it| it.known = 0.98), Verdict::Matters);
        assert_eq!(change(|it| it.loops = 2), Verdict::Matters);
        assert_eq!(change(|it| *it = Outcome::panicked()), Verdict::Matters);
    }

    #[test]
    fn the_noise_is_the_root_mean_square() {
        let figures = [3.0, -4.0].map(|pct| Figures {
            time_pct: Some(pct),
            loops: pct,
            ..Figures::default()
        });
        let noise = Figures::root_mean_square(&figures);
        assert_eq!(noise.time_pct, Some(12.5_f64.sqrt()));
        assert_eq!((noise.loops, noise.t99_pct), (12.5_f64.sqrt(), None));
    }

    #[test]
    fn an_outcome_survives_its_line_and_half_a_line_is_none() {
        let mut outcome = explored("a", 0.1 + 0.2);
        for t99_s in [None, Some(1.0 / 3.0)] {
            outcome.t99_s = t99_s;
            let line = outcome.to_string();
            assert_eq!(Outcome::parse(&line), Some(outcome.clone()));
            assert_eq!(Outcome::parse(&line[..line.len() - 1]), None);
        }
    }
}
