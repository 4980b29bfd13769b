//! The campaign file: strict TOML.
//!
//! ```toml
//! worlds = ["office", "maps/lab.yaml"]
//! strategies = ["bvp", "frontier"]
//! seeds = "0..10"
//! odometry = "truth"
//! baseline = "bvp"
//!
//! [options]
//! time-limit = 1800
//! ```
//!
//! Every fault has the line of the file that caused it. [`Source`] keeps the lines, for faults that
//! show later, when worlds are opened and options meet.

use core::ops::Range;
use std::collections::BTreeMap;
use std::fs;
use std::path::Path;

use serde::Deserialize;
use toml::{Spanned, Value};

use super::plan::{Options, Plan, SLAM_OFF, Setting, Variant};
use super::shards::Shard;
use super::source::Source;
use super::{CampaignError, columns, numbers};
use crate::near;

/// Options of `explore` that a campaign has keys for, or that make no sense in one.
const NOT_OPTIONS: [(&str, &str); 14] = [
    ("strategy", "list `strategies`"),
    ("seed", "list `seeds`"),
    ("start", "list `starts`"),
    ("odometry", "set the key `odometry` outside of [options]"),
    ("slam", "set the key `slam` outside of [options]"),
    ("out", "give --out to host-sim campaign"),
    ("json", "leave it out; trials.jsonl has the reports"),
    ("realtime", "leave it out; trials run as fast as they can"),
    ("live", "leave it out; explore shows a run of its own"),
    ("profile", "leave it out; explore profiles a run of its own"),
    ("team", "leave it out; a trial has one robot"),
    (
        "film",
        "leave it out; a campaign keeps no pictures of a run",
    ),
    (
        "snapshots",
        "leave it out; a campaign keeps no pictures of a run",
    ),
    ("help", "leave it out"),
];

/// A file that was read.
#[derive(Clone, Debug)]
pub struct Spec {
    /// The campaign.
    pub plan: Plan,
    /// The part of it, in the file of a folder.
    pub shard: Option<Shard>,
    /// Where its parts come from.
    pub source: Source,
}

/// The file as it is written.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    name: Option<Spanned<String>>,
    worlds: Vec<Spanned<String>>,
    #[serde(default)]
    strategies: Vec<Spanned<String>>,
    starts: Option<Spanned<Value>>,
    seeds: Option<Spanned<Value>>,
    odometry: Option<Spanned<Value>>,
    slam: Option<Spanned<Value>>,
    baseline: Option<Spanned<String>>,
    columns: Option<Vec<Spanned<String>>>,
    shard: Option<Spanned<String>>,
    #[serde(default)]
    options: BTreeMap<String, Spanned<Value>>,
    #[serde(default)]
    variants: Vec<Spanned<VariantTable>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct VariantTable {
    name: Spanned<String>,
    strategy: Spanned<String>,
    odometry: Option<String>,
    slam: Option<String>,
    #[serde(default)]
    options: BTreeMap<String, Spanned<Value>>,
}

/// Reads a campaign file.
///
/// # Errors
/// The fault, with file and line.
pub fn read(path: &Path) -> Result<Spec, CampaignError> {
    let text = fs::read_to_string(path)
        .map_err(|error| CampaignError::io("read this campaign file", path, &error))?;
    let stem = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    parse(&text, path, &stem.unwrap_or_default())
}

/// Parses the text of a campaign file; `name` is its name if the text has none.
///
/// # Errors
/// The fault, with file and line.
pub fn parse(text: &str, path: &Path, name: &str) -> Result<Spec, CampaignError> {
    let mut reader = Reader {
        text,
        source: Source::new(path),
    };
    let file: File = toml::from_str(text).map_err(|error| {
        let reason = with_hint(error.message());
        match error.span() {
            Some(span) => reader.error(&span, reason),
            None => CampaignError::new(reason),
        }
        .in_file(path)
    })?;
    let shard = file.shard.as_ref().map(|text| {
        let shard = text.get_ref().parse();
        shard.map_err(|reason: String| reader.error(&text.span(), reason))
    });
    let shard = shard.transpose();
    let shard = shard.map_err(|error: CampaignError| error.in_file(path))?;
    let plan = reader
        .plan(file, name)
        .map_err(|error| error.in_file(path))?;
    let source = reader.source;
    plan.check().map_err(|error| source.placed(error))?;
    Ok(Spec {
        plan,
        shard,
        source,
    })
}

/// Turns words after `--` on the command line into options: `--time-limit 60 --check-field`.
///
/// # Errors
/// The word that is no option.
pub fn options(words: &[String]) -> Result<Options, CampaignError> {
    let mut options = Options::new();
    let mut words = words.iter().peekable();
    while let Some(word) = words.next() {
        let bare = word.strip_prefix("--").filter(|bare| !bare.is_empty());
        let bare = bare.ok_or_else(|| {
            CampaignError::new(format!(
                "'{word}' after -- is no option of explore; say for example --time-limit 600"
            ))
        })?;
        let mut value = || words.next_if(|next| !next.starts_with("--")).cloned();
        let (name, value) = match bare.split_once('=') {
            Some((name, value)) => (name, Some(value.to_owned())),
            None => (bare, value()),
        };
        check_option(name)?;
        let setting = match (options.remove(name), value) {
            (None, Some(value)) => Setting::Text(value),
            (Some(Setting::Text(first)), Some(second)) => Setting::Several(vec![first, second]),
            (Some(Setting::Several(mut all)), Some(next)) => {
                all.push(next);
                Setting::Several(all)
            }
            (_, None) => Setting::Flag(true),
            (Some(_), Some(_)) => {
                let reason = format!("--{name} is there with and without a value");
                return Err(CampaignError::new(reason));
            }
        };
        options.insert(name.to_owned(), setting);
    }
    Ok(options)
}

/// Refuses an option that is none of a campaign's trials.
fn check_option(name: &str) -> Result<(), CampaignError> {
    match NOT_OPTIONS.iter().find(|(other, _)| *other == name) {
        Some((_, remedy)) => Err(CampaignError::new(format!(
            "`{name}` is no option of a campaign's trials; {remedy}"
        ))),
        None => Ok(()),
    }
}

/// Reads the parts of a file, and notes their lines.
struct Reader<'a> {
    text: &'a str,
    source: Source,
}

impl Reader<'_> {
    fn plan(&mut self, file: File, name: &str) -> Result<Plan, CampaignError> {
        let name = match file.name {
            Some(name) => self.noted("name", "", name),
            None => name.to_owned(),
        };
        check_name(&name).map_err(|reason| self.source.error("name", "", reason))?;
        let wanted = file.columns.map(|columns| self.names("columns", columns));
        if let Some(columns) = &wanted {
            for column in columns {
                columns::check(column)
                    .map_err(|reason| self.source.error("columns", column, reason))?;
            }
        }
        Ok(Plan {
            name,
            worlds: self.names("worlds", file.worlds),
            strategies: self.names("strategies", file.strategies),
            starts: self.numbers("starts", file.starts)?,
            seeds: self.numbers("seeds", file.seeds)?,
            odometry: self
                .one_or_several("odometry", file.odometry)?
                .unwrap_or_default(),
            slam: self
                .one_or_several("slam", file.slam)?
                .unwrap_or_else(|| vec![SLAM_OFF.into()]),
            baseline: file.baseline.map(|name| self.noted("baseline", "", name)),
            columns: wanted.unwrap_or_else(columns::default),
            options: self.options("options", file.options)?,
            variants: file
                .variants
                .into_iter()
                .map(|table| self.variant(table.into_inner()))
                .collect::<Result<_, _>>()?,
        })
    }

    fn variant(&mut self, table: VariantTable) -> Result<Variant, CampaignError> {
        let name = table.name.get_ref().clone();
        let name = self.noted("strategies", &name, table.name);
        Ok(Variant {
            strategy: table.strategy.into_inner(),
            odometry: table.odometry,
            slam: table.slam,
            options: self.options(&format!("variants/{name}/options"), table.options)?,
            name,
        })
    }

    /// Notes the line of an entry, and returns its text.
    fn noted(&mut self, key: &str, name: &str, text: Spanned<String>) -> String {
        let line = self.line(&text.span());
        self.source.note(key, name, line);
        text.into_inner()
    }

    fn names(&mut self, key: &str, names: Vec<Spanned<String>>) -> Vec<String> {
        let noted = |name: Spanned<String>| {
            let text = name.get_ref().clone();
            self.noted(key, &text, name)
        };
        names.into_iter().map(noted).collect()
    }

    fn numbers(
        &mut self,
        key: &str,
        value: Option<Spanned<Value>>,
    ) -> Result<Vec<u64>, CampaignError> {
        let Some(value) = value else {
            return Ok(vec![0]);
        };
        let line = self.line(&value.span());
        self.source.note(key, "", line);
        let text = |value: &Value| match value {
            Value::Integer(number) => Some(number.to_string()),
            Value::String(text) => Some(text.clone()),
            _ => None,
        };
        let parts: Option<Vec<String>> = match value.get_ref() {
            Value::Array(parts) => parts.iter().map(text).collect(),
            one => text(one).map(|one| vec![one]),
        };
        let parts = parts.ok_or_else(|| "give numbers, or a range as in \"0..10\"".to_owned());
        let read = parts.and_then(|parts| numbers::parse(&parts.join(",")));
        read.map_err(|reason| self.error(&value.span(), format!("`{key}`: {reason}")))
    }

    fn one_or_several(
        &mut self,
        key: &str,
        value: Option<Spanned<Value>>,
    ) -> Result<Option<Vec<String>>, CampaignError> {
        let Some(value) = value else { return Ok(None) };
        let line = self.line(&value.span());
        self.source.note(key, "", line);
        let texts: Option<Vec<String>> = match value.get_ref() {
            Value::String(text) => Some(vec![text.clone()]),
            Value::Array(texts) => texts
                .iter()
                .map(|text| text.as_str().map(ToOwned::to_owned))
                .collect(),
            _ => None,
        };
        let texts = texts.ok_or_else(|| {
            let reason = format!("`{key}` is neither text nor a list of texts");
            self.error(&value.span(), reason)
        });
        texts.map(Some)
    }

    fn options(
        &mut self,
        key: &str,
        table: BTreeMap<String, Spanned<Value>>,
    ) -> Result<Options, CampaignError> {
        let mut options = Options::new();
        for (name, value) in table {
            let line = self.line(&value.span());
            self.source.note(key, &name, line);
            check_option(&name).map_err(|error| error.at_line(line))?;
            let span = value.span();
            let setting = value.into_inner().try_into().map_err(|_| {
                let reason = format!(
                    "option `{name}` is neither text, a number, true, false nor a list of texts"
                );
                self.error(&span, reason)
            })?;
            options.insert(name, setting);
        }
        Ok(options)
    }

    fn line(&self, span: &Range<usize>) -> usize {
        let before = self.text.get(..span.start).unwrap_or(self.text);
        before.matches('\n').count() + 1
    }

    fn error(&self, span: &Range<usize>, reason: impl Into<String>) -> CampaignError {
        CampaignError::new(reason).at_line(self.line(span))
    }
}

/// Refuses a name that is no good name of a folder.
///
/// # Errors
/// The fault and the remedy.
pub fn check_name(name: &str) -> Result<(), String> {
    let is_good = |it: char| it.is_alphanumeric() || "-_.".contains(it);
    if name.is_empty() || name.starts_with('.') || !name.chars().all(is_good) {
        return Err(format!(
            "'{name}' is no good name of a campaign; take letters, digits, '-', '_' and '.'"
        ));
    }
    Ok(())
}

/// Adds the nearest known name to serde's message of an unknown one.
fn with_hint(message: &str) -> String {
    let message = message.replace('\n', " ");
    let quoted: Vec<&str> = message.split('`').skip(1).step_by(2).collect();
    match &quoted[..] {
        [unknown, known @ ..] if message.starts_with("unknown field") => {
            format!("{message}{}", near::hint(unknown, known.iter().copied()))
        }
        _ => message,
    }
}

#[cfg(test)]
mod tests;
