//! Parts of a campaign that run apart, and their merge.
//!
//! Shard i of n has the trials whose number leaves i when divided by n. So every shard has a share
//! of each world and each strategy, and shards take about equally long.

use std::fs;
use std::path::{Path, PathBuf};

use super::plan::{Plan, Trial};
use super::store::{self, Finished};
use super::{CampaignError, PLAN_FILE};

/// Most shards of a campaign.
const MOST: usize = 100_000;

/// One of several parts of a campaign.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    /// Which part, from 0.
    pub index: usize,
    /// How many parts there are.
    pub of: usize,
}

impl core::str::FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/');
        let parts = parts.and_then(|(index, of)| Some((index.parse().ok()?, of.parse().ok()?)));
        match parts {
            Some((index, of)) if index < of && of <= MOST => Ok(Self { index, of }),
            Some((index, of)) if (1..=MOST).contains(&of) => Err(format!(
                "shard {index} of {of} is out of range; say 0/{of} to {}/{of}",
                of - 1
            )),
            _ => Err(format!(
                "'{text}' is no shard; say I/N with I from 0, as in 0/4"
            )),
        }
    }
}

impl core::fmt::Display for Shard {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(f, "{}/{}", self.index, self.of)
    }
}

impl Shard {
    /// Returns true if a trial is in this part.
    #[must_use]
    pub const fn has(&self, trial: &Trial) -> bool {
        trial.index % self.of == self.index
    }

    /// Returns the trials of a part, or all of them.
    #[must_use]
    pub fn trials(shard: Option<Self>, plan: &Plan) -> Vec<Trial> {
        let mut trials = plan.trials();
        if let Some(shard) = shard {
            trials.retain(|trial| shard.has(trial));
        }
        trials
    }
}

/// Reads all shards of a campaign, checks that they belong together, and writes the whole to
/// `out`. Returns the campaign and its trials.
///
/// # Errors
/// Shards of different campaigns, a missing or double shard, one that has not ended, or a bad file.
pub fn merge(folders: &[PathBuf], out: &Path) -> Result<(Plan, Vec<Finished>), CampaignError> {
    let mut whole: Option<(Plan, usize, &Path)> = None;
    let mut places: Vec<Option<&Path>> = Vec::new();
    let mut finished = Vec::new();
    for folder in folders {
        let file = folder.join(PLAN_FILE);
        let (plan, shard) = store::read_plan(folder)?;
        let refuse = |reason: String| CampaignError::new(reason).in_file(&file);
        let Some(shard) = shard else {
            return Err(refuse(
                "this is a whole campaign, no shard of one; leave it out".into(),
            ));
        };
        let (first, of, first_folder) =
            whole.get_or_insert_with(|| (plan.clone(), shard.of, folder.as_path()));
        if let Some(what) = store::difference(&plan, first) {
            let other = first_folder.display();
            return Err(refuse(format!(
                "not the campaign of {other}: {what}; merge them apart"
            )));
        }
        if shard.of != *of {
            return Err(refuse(format!(
                "this is one of {} shards, and {} is one of {of}; merge shards of one division",
                shard.of,
                first_folder.display()
            )));
        }
        places.resize(*of, None);
        if let Some(other) = places[shard.index].replace(folder) {
            let other = other.display();
            return Err(refuse(format!(
                "shard {shard} is also in {other}; name one of them"
            )));
        }
        finished.extend(whole_shard(folder, &plan, shard)?);
    }
    let Some((plan, of, _)) = whole else {
        return Err(CampaignError::new("name the folders of the shards"));
    };
    check_all_there(&places, of)?;
    finished.sort_by_key(|line| line.index);
    write(out, &plan, &finished)?;
    Ok((plan, finished))
}

/// Reads the trials of a shard; refuses one that has not ended.
fn whole_shard(folder: &Path, plan: &Plan, shard: Shard) -> Result<Vec<Finished>, CampaignError> {
    let finished = store::read_finished(folder, plan)?;
    let trials = Shard::trials(Some(shard), plan);
    let refuse = |reason: String| CampaignError::new(reason).in_file(folder);
    if let Some(alien) = finished
        .iter()
        .find(|it| it.index % shard.of != shard.index)
    {
        return Err(refuse(format!(
            "trial {} is not of shard {shard}; run the shard again",
            alien.index
        )));
    }
    if finished.len() < trials.len() {
        return Err(refuse(format!(
            "shard {shard} has {} of its {} trials; go on with it by the same command",
            finished.len(),
            trials.len()
        )));
    }
    Ok(finished)
}

fn check_all_there(places: &[Option<&Path>], of: usize) -> Result<(), CampaignError> {
    let there = places.iter().enumerate();
    let missing: Vec<String> = there
        .filter(|(_, place)| place.is_none())
        .map(|(index, _)| format!("{index}/{of}"))
        .collect();
    if missing.is_empty() {
        return Ok(());
    }
    let shown = missing
        .iter()
        .take(8)
        .cloned()
        .collect::<Vec<_>>()
        .join(", ");
    let more = if missing.len() > 8 { ", …" } else { "" };
    Err(CampaignError::new(format!(
        "{} of {of} shards are missing: {shown}{more}; name their folders too",
        missing.len()
    )))
}

/// Writes a merged campaign. A folder that has one may be written again.
fn write(out: &Path, plan: &Plan, finished: &[Finished]) -> Result<(), CampaignError> {
    fs::create_dir_all(out).map_err(|error| CampaignError::io("make this folder", out, &error))?;
    let file = out.join(PLAN_FILE);
    if file.exists() {
        let (there, shard) = store::read_plan(out)?;
        if shard.is_some() || store::difference(&there, plan).is_some() {
            let reason = "this folder has another campaign or a shard; choose another --out";
            return Err(CampaignError::new(reason).in_file(&file));
        }
    }
    store::put(&file, &store::plan_text(plan, None))?;
    store::write_trials(out, finished).map(|_| ())
}

#[cfg(test)]
mod tests {
    use super::Shard;

    #[test]
    fn a_shard_has_an_index_below_its_number() {
        assert_eq!("3/4".parse(), Ok(Shard { index: 3, of: 4 }));
        assert_eq!(Shard { index: 3, of: 4 }.to_string(), "3/4");
        let error = |text: &str| text.parse::<Shard>().unwrap_err();
        assert!(error("4/4").contains("say 0/4 to 3/4"), "{}", error("4/4"));
        for bad in ["", "1", "a/2", "0/0", "-1/2", "0/9999999"] {
            assert!(error(bad).contains("is no shard"), "{}", error(bad));
        }
    }
}
