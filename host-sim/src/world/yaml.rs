//! YAML as a tree of plain values, and typed look-ups whose errors name the key.
//!
//! The parser knows the YAML syntax; this module checks the keys and their types.

use core::fmt;
use std::collections::BTreeMap;

use serde::Deserialize;

use crate::near;

/// A value; the first form that it has.
#[derive(Clone, Debug, Deserialize, PartialEq)]
#[serde(untagged)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Self>),
    Table(BTreeMap<String, Self>),
}

/// A fault in a key or in its value.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct BadKey {
    /// The key, with the tables it lies in, as in `elevation.bits`.
    pub(super) key: String,
    /// The fault and the remedy.
    pub(super) reason: String,
}

/// The keys and values of one table, and the key of the table.
pub(super) struct Table<'a> {
    path: &'a str,
    entries: &'a BTreeMap<String, Node>,
}

/// Parses one document.
pub(super) fn parse(text: &str) -> Result<Node, String> {
    // With the truth values of YAML 1.1, a key `y` would be one.
    let options = serde_saphyr::options! { strict_booleans: true };
    serde_saphyr::from_str_with_options(text, options).map_err(|error| {
        let reason = error
            .without_snippet()
            .render_with_formatter(&serde_saphyr::UserMessageFormatter)
            .replace('\n', " ");
        // The parser refuses it before the key is known.
        let is_origin =
            |line: &str| line.starts_with("origin:") && line.to_ascii_lowercase().contains(".nan");
        if text.lines().any(is_origin) {
            return reason + "; some map savers write NaN for the yaw of an origin: write 0 there";
        }
        reason
    })
}

impl<'a> Table<'a> {
    /// The table under a key (empty for the whole document); every key in it must be in `known`.
    pub(super) fn new(path: &'a str, node: &'a Node, known: &[&str]) -> Result<Self, BadKey> {
        let Node::Table(entries) = node else {
            return Err(BadKey {
                key: path.to_owned(),
                reason: format!(
                    "{node} is not a table; write `key: value` with {}",
                    known.join(", ")
                ),
            });
        };
        let table = Self { path, entries };
        match entries.keys().find(|key| !known.contains(&key.as_str())) {
            None => Ok(table),
            Some(key) => {
                let near = near::hint(key, known.iter().copied());
                let known = known.join(", ");
                Err(table.bad(key, &format!("unknown key; known are {known}{near}")))
            }
        }
    }

    pub(super) fn node(&self, key: &str) -> Option<&'a Node> {
        self.entries.get(key)
    }

    pub(super) fn number(&self, key: &str) -> Result<Option<f64>, BadKey> {
        match self.node(key) {
            None => Ok(None),
            Some(Node::Number(number)) => Ok(Some(*number)),
            Some(other) => Err(self.bad(key, &format!("{other} is not a number; give one"))),
        }
    }

    pub(super) fn text(&self, key: &str) -> Result<Option<&'a str>, BadKey> {
        match self.node(key) {
            None => Ok(None),
            Some(Node::Text(text)) => Ok(Some(text)),
            Some(other) => Err(self.bad(key, &format!("{other} is not a text; give one"))),
        }
    }

    /// 0 or 1, or `true` or `false`, or `yes` or `no`.
    pub(super) fn flag(&self, key: &str) -> Result<Option<bool>, BadKey> {
        match self.node(key) {
            None => Ok(None),
            Some(Node::Bool(flag)) => Ok(Some(*flag)),
            Some(Node::Number(number)) if *number == 0.0 || *number == 1.0 => {
                Ok(Some(*number == 1.0))
            }
            Some(Node::Text(text)) if text == "yes" || text == "no" => Ok(Some(text == "yes")),
            Some(other) => Err(self.bad(key, &format!("{other} is not 0 or 1; give one of them"))),
        }
    }

    /// Returns the value of a required key, or an error with an example.
    pub(super) fn required<T>(
        &self,
        key: &str,
        value: Option<T>,
        example: &str,
    ) -> Result<T, BadKey> {
        value.ok_or_else(|| {
            self.bad(
                key,
                &format!("missing; add for instance `{key}: {example}`"),
            )
        })
    }

    pub(super) fn bad(&self, key: &str, reason: &str) -> BadKey {
        let dot = if self.path.is_empty() { "" } else { "." };
        BadKey {
            key: format!("{}{dot}{key}", self.path),
            reason: reason.to_owned(),
        }
    }
}

impl Node {
    /// A list of finite numbers whose length is in `lengths`.
    pub(super) fn numbers(&self, lengths: core::ops::RangeInclusive<usize>) -> Option<Vec<f64>> {
        let Self::List(list) = self else {
            return None;
        };
        let numbers: Vec<f64> = list
            .iter()
            .filter_map(|node| match node {
                Self::Number(number) if number.is_finite() => Some(*number),
                _ => None,
            })
            .collect();
        (numbers.len() == list.len() && lengths.contains(&numbers.len())).then_some(numbers)
    }
}

impl fmt::Display for Node {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Null => write!(f, "nothing"),
            Self::Bool(flag) => write!(f, "{flag}"),
            Self::Number(number) => write!(f, "{number}"),
            Self::Text(text) => write!(f, "`{}`", text.replace('\n', " ")),
            Self::List(list) => write!(f, "a list of {}", list.len()),
            Self::Table(_) => write!(f, "a table"),
        }
    }
}
