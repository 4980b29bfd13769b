//! What a campaign compares, and its trials in their order.
//!
//! ```text
//! trials = worlds × odometry × arms × starts × seeds
//! arms   = (strategies and variants) × slam
//! ```
//!
//! An *arm* is what is compared: a strategy with its options. A *row* of the table is a world with
//! an odometry. Invariant: the order of the trials depends on the plan alone, so a number is a
//! trial's name.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize, Serializer};

use super::{CampaignError, numbers};
use crate::trial::mission::on_device;

/// Where no loops are closed.
pub const SLAM_OFF: &str = "off";
/// Most trials of a campaign.
const MOST_TRIALS: usize = 1_000_000;

/// Further options of `explore` by name, without the dashes.
pub type Options = BTreeMap<String, Setting>;

/// Value of an option.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(untagged)]
pub enum Setting {
    /// A flag: there, or not there.
    Flag(bool),
    /// A whole number.
    Whole(i64),
    /// A number.
    Number(f64),
    /// Text.
    Text(String),
    /// An option that is given several times.
    Several(Vec<String>),
}

/// A campaign. Written as TOML it is a campaign file again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Plan {
    /// Name, for the folder and the headings.
    pub name: String,
    /// Worlds, as `explore` names them.
    pub worlds: Vec<String>,
    /// Strategies, as `explore` names them.
    pub strategies: Vec<String>,
    /// Indices of start poses.
    #[serde(serialize_with = "as_numbers")]
    pub starts: Vec<u64>,
    /// Seeds.
    #[serde(serialize_with = "as_numbers")]
    pub seeds: Vec<u64>,
    /// Kinds of odometry; the default of `explore` if there is none.
    pub odometry: Vec<String>,
    /// Where loops are closed.
    pub slam: Vec<String>,
    /// Name of the arm with which the others are compared.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub baseline: Option<String>,
    /// Columns of the table: paths in the report.
    pub columns: Vec<String>,
    /// Options of every trial.
    #[serde(skip_serializing_if = "BTreeMap::is_empty")]
    pub options: Options,
    /// Strategies with options of their own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub variants: Vec<Variant>,
}

/// A strategy under a name of its own, with options of its own.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variant {
    /// Its name in tables and plots.
    pub name: String,
    /// The strategy.
    pub strategy: String,
    /// Its odometry, in every row.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub odometry: Option<String>,
    /// Where it closes loops.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub slam: Option<String>,
    /// Options; they come before those of the campaign.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub options: Options,
}

/// What is compared: a strategy with its options.
#[derive(Clone, Debug, PartialEq)]
pub struct Arm {
    /// Name in tables and plots.
    pub label: String,
    /// Name of the entry that it comes from: a strategy or a variant.
    pub entry: String,
    /// The strategy.
    pub strategy: String,
    /// Odometry of its own.
    pub odometry: Option<String>,
    /// Where loops are closed.
    pub slam: String,
    /// Its options and those of the campaign.
    pub options: Options,
}

/// One trial.
#[derive(Clone, Debug, PartialEq)]
pub struct Trial {
    /// Its number, from 0.
    pub index: usize,
    /// The world.
    pub world: String,
    /// Odometry of its row; the default of `explore` if none.
    pub odometry: Option<String>,
    /// What is tried.
    pub arm: Arm,
    /// Index of the start pose.
    pub start: u64,
    /// The seed.
    pub seed: u64,
}

impl Plan {
    /// Returns what is compared, in order. A strategy on the host closes no loops, so it has one
    /// arm whatever `slam` says.
    #[must_use]
    pub fn arms(&self) -> Vec<Arm> {
        let plain = self.strategies.iter().map(|name| Variant {
            name: name.clone(),
            strategy: name.clone(),
            odometry: None,
            slam: None,
            options: Options::new(),
        });
        let entries = plain.chain(self.variants.iter().cloned());
        entries.flat_map(|entry| self.arms_of(entry)).collect()
    }

    fn arms_of(&self, entry: Variant) -> Vec<Arm> {
        let places = match &entry.slam {
            Some(own) => vec![own.clone()],
            None if on_device(&entry.strategy).is_none() => vec![SLAM_OFF.into()],
            None => self.slam.clone(),
        };
        let is_one = places.len() == 1;
        let mut options = self.options.clone();
        options.extend(entry.options);
        let arm = |slam: String| Arm {
            label: match slam.as_str() {
                slam if is_one || slam == SLAM_OFF => entry.name.clone(),
                slam => format!("{} slam={slam}", entry.name),
            },
            entry: entry.name.clone(),
            strategy: entry.strategy.clone(),
            odometry: entry.odometry.clone(),
            slam,
            options: options.clone(),
        };
        places.into_iter().map(arm).collect()
    }

    /// Returns the kinds of odometry, `None` for the default.
    #[must_use]
    pub fn odometries(&self) -> Vec<Option<String>> {
        match &self.odometry[..] {
            [] => vec![None],
            some => some.iter().cloned().map(Some).collect(),
        }
    }

    /// Returns the number of trials; `None` if it overflows.
    #[must_use]
    pub fn count(&self) -> Option<usize> {
        let sides = [
            self.worlds.len(),
            self.odometries().len(),
            self.arms().len(),
            self.starts.len(),
            self.seeds.len(),
        ];
        sides
            .iter()
            .try_fold(1, |all: usize, side| all.checked_mul(*side))
    }

    /// Returns the trials, in order.
    #[must_use]
    pub fn trials(&self) -> Vec<Trial> {
        let mut trials = Vec::new();
        let (arms, odometries) = (self.arms(), self.odometries());
        for world in &self.worlds {
            for odometry in &odometries {
                for arm in &arms {
                    for &start in &self.starts {
                        trials.extend(self.seeds.iter().map(|&seed| Trial {
                            index: 0,
                            world: world.clone(),
                            odometry: odometry.clone(),
                            arm: arm.clone(),
                            start,
                            seed,
                        }));
                    }
                }
            }
        }
        for (index, trial) in trials.iter_mut().enumerate() {
            trial.index = index;
        }
        trials
    }

    /// Checks what needs no world: names that are there twice, a baseline that is not there.
    ///
    /// # Errors
    /// The fault and the remedy.
    pub fn check(&self) -> Result<(), CampaignError> {
        let arms = self.arms();
        let labels: Vec<&str> = arms.iter().map(|arm| arm.label.as_str()).collect();
        let worlds: Vec<&str> = self.worlds.iter().map(String::as_str).collect();
        for (key, list) in [("odometry", &self.odometry), ("slam", &self.slam)] {
            let names: Vec<&str> = list.iter().map(String::as_str).collect();
            if let Some(twice) = twice(&names) {
                return Err(CampaignError::new(format!("`{key}` has {twice} twice")));
            }
        }
        for (key, names) in [("worlds", &worlds), ("strategies", &labels)] {
            if names.is_empty() {
                return Err(CampaignError::new(format!(
                    "`{key}` is empty; name at least one"
                )));
            }
            if let Some(twice) = twice(names) {
                return Err(CampaignError::new(format!(
                    "`{key}` has {twice} twice; leave one out"
                )));
            }
        }
        if let Some(baseline) = &self.baseline
            && !labels.contains(&baseline.as_str())
        {
            return Err(CampaignError::new(format!(
                "`baseline` {baseline} is no strategy of this campaign; name one of {}",
                labels.join(", ")
            )));
        }
        self.check_variants(&arms)?;
        match self.count() {
            Some(count) if count <= MOST_TRIALS => Ok(()),
            _ => Err(CampaignError::new(format!(
                "the campaign has more than {MOST_TRIALS} trials; divide it"
            ))),
        }
    }

    /// Refuses an odometry of a variant beside several of the campaign, which would give equal
    /// trials several names.
    fn check_variants(&self, arms: &[Arm]) -> Result<(), CampaignError> {
        let own = arms.iter().find(|arm| arm.odometry.is_some());
        match own {
            Some(arm) if self.odometry.len() > 1 => Err(CampaignError::new(format!(
                "variant {} has an odometry of its own, and `odometry` has several; leave one out",
                arm.entry
            ))),
            _ => Ok(()),
        }
    }

    /// Refuses to compare strategies whose default odometry differs. To be called once the
    /// strategies are known to exist.
    ///
    /// # Errors
    /// Two such strategies, and the remedy.
    pub fn check_odometry(&self) -> Result<(), CampaignError> {
        let arms = self.arms();
        let open = || arms.iter().filter(|arm| arm.odometry.is_none());
        let runs_on_device = |arm: &&Arm| on_device(&arm.strategy).is_some();
        let device = open().find(runs_on_device);
        let host = open().find(|arm| !runs_on_device(arm));
        match (device, host) {
            (Some(device), Some(host)) if self.odometry.is_empty() => {
                Err(CampaignError::new(format!(
                    "{} and {} have different odometry by default; say odometry = \"truth\" or \
                     \"noisy\"",
                    device.label, host.label
                )))
            }
            _ => Ok(()),
        }
    }

    /// Returns the campaign as a file.
    #[must_use]
    pub fn to_toml(&self) -> String {
        // Every value here has a form in TOML.
        toml::to_string(self).unwrap_or_default()
    }

    /// Returns the plan without what only tables and plots need: equal results, equal trials.
    #[must_use]
    pub fn trials_only(&self) -> Self {
        Self {
            name: String::new(),
            baseline: None,
            columns: Vec::new(),
            ..self.clone()
        }
    }
}

impl Trial {
    /// Returns the arguments of `host-sim explore` that mean this trial.
    #[must_use]
    pub fn arguments(&self) -> Vec<String> {
        let mut arguments = vec![
            self.world.clone(),
            format!("--strategy={}", self.arm.strategy),
            format!("--start={}", self.start),
            format!("--seed={}", self.seed),
        ];
        let odometry = self.arm.odometry.as_ref().or(self.odometry.as_ref());
        arguments.extend(odometry.map(|name| format!("--odometry={name}")));
        if self.arm.slam != SLAM_OFF {
            arguments.push(format!("--slam={}", self.arm.slam));
        }
        for (name, setting) in &self.arm.options {
            arguments.extend(setting.arguments(name));
        }
        arguments
    }

    /// Returns the trial in short, for progress and errors.
    #[must_use]
    pub fn in_short(&self) -> String {
        format!(
            "{} · {} · start {} · seed {}",
            row_name(&self.world, self.odometry.as_deref()),
            self.arm.label,
            self.start,
            self.seed
        )
    }
}

/// Returns the name of a row of the table.
#[must_use]
pub fn row_name(world: &str, odometry: Option<&str>) -> String {
    match odometry {
        Some(odometry) => format!("{world}, odometry {odometry}"),
        None => world.to_owned(),
    }
}

impl Setting {
    fn arguments(&self, name: &str) -> Vec<String> {
        let argument = |value: &dyn core::fmt::Display| format!("--{name}={value}");
        match self {
            Self::Flag(true) => vec![format!("--{name}")],
            Self::Flag(false) => Vec::new(),
            Self::Whole(number) => vec![argument(number)],
            Self::Number(number) => vec![argument(number)],
            Self::Text(text) => vec![argument(text)],
            Self::Several(texts) => texts.iter().map(|text| argument(text)).collect(),
        }
    }
}

fn twice<'a>(names: &[&'a str]) -> Option<&'a str> {
    let mut before = std::collections::BTreeSet::new();
    names.iter().find(|name| !before.insert(**name)).copied()
}

#[expect(clippy::ptr_arg, reason = "serde gives the field")]
fn as_numbers<S: Serializer>(numbers: &Vec<u64>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&numbers::text(numbers))
}
