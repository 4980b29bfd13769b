//! Compact JSON of messages: fields that have their default are left out, and long lists of numbers
//! are runs of text.
//!
//! A field that is missing takes the default that the type has today. So a file outlives a new
//! field of a message. A field that no message has is an error.

use fieldline_protocol::message::{
    Beacon, Budget, Correct, CorrectedTiles, Digest, Fence, Hull, Laser, LoopLimits, Member,
    Motion, Observation, Pose, Recall, SpaceField, Start, Team, TeamTile, Twist, UnevenGround,
    Wanted,
};
use serde::Serialize;
use serde_json::{Map, Number, Value};

/// Lists of more numbers than this are written as runs.
const LONGEST_LIST: usize = 8;
/// Names of lists that may be written as runs.
const LISTS: [&str; 2] = ["ranges_mm", "cells"];

/// Returns the default of the object that stands under `key`.
fn default_of(key: &str) -> Option<Map<String, Value>> {
    fn json(value: impl Serialize) -> Option<Value> {
        serde_json::to_value(value).ok()
    }
    let value = match key {
        "start" => json(Start::default()),
        "observation" => json(Observation::default()),
        "lasers" => json(Laser::default()),
        "hull" => json(Hull::default()),
        "loops" => json(LoopLimits::default()),
        "fence" => json(Fence::default()),
        "budget" => json(Budget::default()),
        "uneven_ground" => json(UnevenGround::default()),
        "team" => json(Team::default()),
        "member" | "from" => json(Member::default()),
        "pose" => json(Pose::default()),
        "velocity" => json(Twist::default()),
        "sbpf" | "esbpf" | "Sbpf" | "Esbpf" => json(SpaceField::default()),
        "correct" => json(Correct::default()),
        "correct_tiles" => json(CorrectedTiles::default()),
        "recall" => json(Recall::default()),
        "motion" => json(Motion::default()),
        "Beacon" => json(Beacon::default()),
        "Digest" => json(Digest::default()),
        "Wanted" => json(Wanted::default()),
        "Tile" => json(TeamTile::default()),
        _ => None,
    };
    match value {
        Some(Value::Object(fields)) => Some(fields),
        _ => None,
    }
}

/// Leaves defaults out and writes lists as runs. `key` is the name under which `value` stands.
pub(super) fn pack(key: &str, value: Value) -> Value {
    match value {
        Value::Object(fields) => {
            let defaults = default_of(key).unwrap_or_default();
            let differs = |(name, value): &(String, Value)| defaults.get(name) != Some(value);
            let kept = fields.into_iter().filter(differs);
            Value::Object(
                kept.map(|(name, value)| (name.clone(), pack(&name, value)))
                    .collect(),
            )
        }
        Value::Array(items) if LISTS.contains(&key) && items.len() > LONGEST_LIST => {
            Value::String(runs(&items))
        }
        Value::Array(items) => {
            Value::Array(items.into_iter().map(|item| pack(key, item)).collect())
        }
        plain => plain,
    }
}

/// Fills defaults in and reads runs.
///
/// # Errors
/// What is wrong: a field that no message has, or text that is no list of runs.
pub(super) fn unpack(key: &str, value: Value) -> Result<Value, String> {
    match value {
        Value::Object(fields) => {
            let defaults = default_of(key);
            let mut filled = defaults.clone().unwrap_or_default();
            for (name, value) in fields {
                if defaults.as_ref().is_some_and(|it| !it.contains_key(&name)) {
                    return Err(format!("'{key}' has no field '{name}'"));
                }
                let value = unpack(&name, value)?;
                filled.insert(name, value);
            }
            Ok(Value::Object(filled))
        }
        Value::String(text) if LISTS.contains(&key) => numbers(key, &text),
        Value::Array(items) => {
            let items = items.into_iter().map(|item| unpack(key, item));
            Ok(Value::Array(items.collect::<Result<_, _>>()?))
        }
        plain => Ok(plain),
    }
}

/// Writes equal neighbours as `NUMBERxTIMES`.
fn runs(items: &[Value]) -> String {
    let run = |run: &[Value]| match run {
        [one] => one.to_string(),
        [first, ..] => format!("{first}x{}", run.len()),
        [] => String::new(),
    };
    let runs: Vec<String> = items.chunk_by(PartialEq::eq).map(run).collect();
    runs.join(" ")
}

fn numbers(key: &str, text: &str) -> Result<Value, String> {
    let mut list = Vec::new();
    for word in text.split_whitespace() {
        let (number, times) = word.split_once('x').unwrap_or((word, "1"));
        match (number.parse::<u64>(), times.parse::<u16>()) {
            (Ok(number), Ok(times)) => {
                let number = Value::Number(Number::from(number));
                list.extend((0..times).map(|_| number.clone()));
            }
            _ => {
                return Err(format!(
                    "'{word}' in '{key}' is no number and no run such as 9x4"
                ));
            }
        }
    }
    Ok(Value::Array(list))
}

#[cfg(test)]
mod tests {
    use serde_json::json;

    use super::{pack, unpack};

    #[test]
    fn defaults_are_left_out_and_filled_in() {
        let pose = json!({"x": "1.5", "y": "0", "z": "0", "roll": "0", "pitch": "0", "yaw": "0"});
        let packed = pack("pose", pose.clone());
        assert_eq!(packed, json!({"x": "1.5"}));
        assert_eq!(unpack("pose", packed), Ok(pose));
    }

    #[test]
    fn long_lists_are_runs() {
        let list = json!([5, 5, 5, 0, 7, 7, 1, 2, 3, 4]);
        let packed = pack("ranges_mm", list.clone());
        assert_eq!(packed, json!("5x3 0 7x2 1 2 3 4"));
        assert_eq!(unpack("ranges_mm", packed), Ok(list));
    }

    #[test]
    fn what_is_unknown_is_named() {
        let error = unpack("pose", json!({"w": 1})).unwrap_err();
        assert!(error.contains("'pose'") && error.contains("'w'"), "{error}");
        let error = unpack("cells", json!("3x4 z")).unwrap_err();
        assert!(error.contains("'z'"), "{error}");
    }
}
