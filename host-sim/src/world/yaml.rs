//! YAML as a tree of plain values, and typed look-ups whose errors name the key.
//!
//! The parser knows the YAML syntax; this module checks the keys and their types.

use crate::near;
use core::fmt;
use serde::de::{Deserialize, Deserializer, MapAccess, SeqAccess, Visitor};

/// A value.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Node {
    Null,
    Bool(bool),
    Number(f64),
    Text(String),
    List(Vec<Self>),
    Table(Vec<(String, Self)>),
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
    entries: &'a [(String, Node)],
}

/// Parses one document.
pub(super) fn parse(text: &str) -> Result<Node, String> {
    serde_saphyr::from_str(text).map_err(|error| {
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
        match entries
            .iter()
            .find(|(key, _)| !known.contains(&key.as_str()))
        {
            None => Ok(table),
            Some((key, _)) => {
                let near = near::hint(key, known.iter().copied());
                let known = known.join(", ");
                Err(table.bad(key, &format!("unknown key; known are {known}{near}")))
            }
        }
    }

    pub(super) fn node(&self, key: &str) -> Option<&'a Node> {
        self.entries
            .iter()
            .find(|(name, _)| name == key)
            .map(|(_, node)| node)
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

    /// 0 or 1, or `true` or `false`.
    pub(super) fn flag(&self, key: &str) -> Result<Option<bool>, BadKey> {
        match self.node(key) {
            None => Ok(None),
            Some(Node::Bool(flag)) => Ok(Some(*flag)),
            Some(Node::Number(number)) if *number == 0.0 || *number == 1.0 => {
                Ok(Some(*number == 1.0))
            }
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

impl<'de> Deserialize<'de> for Node {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(NodeVisitor)
    }
}

struct NodeVisitor;

impl<'de> Visitor<'de> for NodeVisitor {
    type Value = Node;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a value")
    }

    fn visit_unit<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_none<E>(self) -> Result<Node, E> {
        Ok(Node::Null)
    }

    fn visit_some<D: Deserializer<'de>>(self, deserializer: D) -> Result<Node, D::Error> {
        Node::deserialize(deserializer)
    }

    fn visit_bool<E>(self, flag: bool) -> Result<Node, E> {
        Ok(Node::Bool(flag))
    }

    fn visit_i64<E>(self, number: i64) -> Result<Node, E> {
        Ok(Node::Number(number as f64))
    }

    fn visit_u64<E>(self, number: u64) -> Result<Node, E> {
        Ok(Node::Number(number as f64))
    }

    fn visit_f64<E>(self, number: f64) -> Result<Node, E> {
        Ok(Node::Number(number))
    }

    fn visit_str<E>(self, text: &str) -> Result<Node, E> {
        Ok(Node::Text(text.to_owned()))
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut access: A) -> Result<Node, A::Error> {
        let mut list = Vec::new();
        while let Some(node) = access.next_element()? {
            list.push(node);
        }
        Ok(Node::List(list))
    }

    fn visit_map<A: MapAccess<'de>>(self, mut access: A) -> Result<Node, A::Error> {
        let mut entries = Vec::new();
        while let Some(entry) = access.next_entry()? {
            entries.push(entry);
        }
        Ok(Node::Table(entries))
    }
}
