//! The `origin` of a world file: where the picture's lower left corner lies, and its yaw.
//!
//! Invariant: all three numbers are finite, and the yaw is within a turn. Metres, radians.

use super::yaml::{BadKey, Node, Table};

/// x, y and yaw of `origin`, if the key is present: metres and radians, the yaw within a turn.
pub(super) fn origin(keys: &Table<'_>) -> Result<Option<([f64; 2], f64)>, BadKey> {
    let Some(node) = keys.node("origin") else {
        return Ok(None);
    };
    if let Some((name, word)) = not_a_number(node) {
        let remedy = match name {
            "yaw" => "some map savers write that for an orientation of zeros; write 0",
            _ => "write where the picture's lower left corner lies, metres",
        };
        return Err(keys.bad("origin", &format!("{name} is NaN (`{word}`); {remedy}")));
    }
    let Some(numbers) = node.numbers(2..=3) else {
        return Err(keys.bad(
            "origin",
            &format!("{node} is not [x, y, yaw]; give metres and radians"),
        ));
    };
    let yaw = numbers.get(2).copied().unwrap_or(0.0);
    let turns = core::f64::consts::TAU;
    if yaw.abs() > turns {
        let reason = format!("a yaw of {yaw} is more than a turn; give radians");
        return Err(keys.bad("origin", &reason));
    }
    Ok(Some(([numbers[0], numbers[1]], yaw)))
}

/// Returns which number of an origin is NaN, and the word: `.nan` of YAML, or `nan` and `-nan` as
/// other programs write it.
fn not_a_number(node: &Node) -> Option<(&'static str, String)> {
    let Node::List(list) = node else {
        return None;
    };
    let is_nan = |node: &Node| match node {
        Node::Number(number) => number.is_nan(),
        Node::Text(text) => text.parse::<f64>().is_ok_and(f64::is_nan),
        _ => false,
    };
    let named = ["x", "y", "yaw"].into_iter().zip(list);
    let mut bad = named.filter(|(_, node)| is_nan(node));
    bad.next().map(|(name, node)| {
        let word = match node {
            Node::Text(text) => text.clone(),
            other => other.to_string(),
        };
        (name, word)
    })
}
