//! The keys of a world file, read and checked except for the images.

use super::super::heights::Heights;
use super::super::materials::Materials;
use super::super::occupancy::Thresholds;
use super::super::origin::origin;
use super::super::yaml::{BadKey, Node, Table};
use super::super::{Start, WALL_HEIGHT_M};

/// Keys of a world file.
pub(super) const KEYS: [&str; 12] = [
    "image",
    "resolution",
    "origin",
    "negate",
    "occupied_thresh",
    "free_thresh",
    "mode",
    "wall_height",
    "glass",
    "low",
    "elevation",
    "robots",
];

/// The values of the file, checked except for the images.
pub(super) struct Plan<'a> {
    pub(super) image: Option<&'a str>,
    pub(super) resolution_m: f64,
    pub(super) origin_m: [f64; 2],
    pub(super) yaw_rad: f64,
    pub(super) thresholds: Thresholds,
    pub(super) wall_height_m: f64,
    pub(super) materials: Materials,
    pub(super) heights: Option<Heights<'a>>,
    pub(super) starts: Option<Vec<Start>>,
}

impl<'a> Plan<'a> {
    pub(super) fn read(keys: &Table<'a>) -> Result<Self, BadKey> {
        let resolution_m = keys.required("resolution", length(keys, "resolution")?, "0.05")?;
        let (origin_m, yaw_rad) = keys.required("origin", origin(keys)?, "[0, 0, 0]")?;
        let is_raw = match keys.text("mode")? {
            None | Some("trinary" | "scale") => false,
            Some("raw") => true,
            Some(mode) => {
                let reason = format!("{mode} is not supported; use trinary, scale or raw");
                return Err(keys.bad("mode", &reason));
            }
        };
        if is_raw && keys.flag("negate")? == Some(true) {
            let reason =
                "1 has no meaning with mode raw, whose values are occupancies; set it to 0";
            return Err(keys.bad("negate", reason));
        }
        if yaw_rad != 0.0 && keys.node("elevation").is_some() {
            let reason = format!(
                "a yaw of {yaw_rad} is not supported with an elevation; turn both pictures and set \
                 it to 0"
            );
            return Err(keys.bad("origin", &reason));
        }
        Ok(Self {
            image: keys.text("image")?,
            resolution_m,
            origin_m,
            yaw_rad,
            thresholds: Thresholds {
                is_raw,
                ..thresholds(keys)?
            },
            wall_height_m: length(keys, "wall_height")?.unwrap_or(WALL_HEIGHT_M),
            materials: Materials::read(keys)?,
            heights: match keys.node("elevation") {
                Some(node) => Some(Heights::read(node, resolution_m, origin_m)?),
                None => None,
            },
            starts: starts(keys)?,
        })
    }
}

/// A length above 0 m, if the key is present.
pub(in crate::world) fn length(keys: &Table<'_>, key: &str) -> Result<Option<f64>, BadKey> {
    let metres = keys.number(key)?;
    match metres.filter(|metres| !(metres.is_finite() && *metres > 0.0)) {
        None => Ok(metres),
        Some(bad) => {
            let reason = format!("{bad} is not a length above 0 m; give metres");
            Err(keys.bad(key, &reason))
        }
    }
}

fn thresholds(keys: &Table<'_>) -> Result<Thresholds, BadKey> {
    let free = keys.number("free_thresh")?.unwrap_or(0.196);
    let occupied = keys.number("occupied_thresh")?.unwrap_or(0.65);
    if !(0.0 < free && free < 1.0) {
        let reason = format!("{free} is not between 0 and 1; the usual value is 0.196");
        return Err(keys.bad("free_thresh", &reason));
    }
    if !(free < occupied && occupied < 1.0) {
        let reason = format!(
            "{occupied} is not between free_thresh ({free}) and 1; the usual value is 0.65"
        );
        return Err(keys.bad("occupied_thresh", &reason));
    }
    Ok(Thresholds {
        occupied,
        free,
        negate: keys.flag("negate")?.unwrap_or(false),
        is_raw: false,
    })
}

fn starts(keys: &Table<'_>) -> Result<Option<Vec<Start>>, BadKey> {
    let list = match keys.node("robots") {
        None => return Ok(None),
        Some(Node::List(list)) if !list.is_empty() => list,
        Some(other) => {
            let reason = format!("{other} is not a list of [x, y, yaw]; give at least one start");
            return Err(keys.bad("robots", &reason));
        }
    };
    let mut starts = Vec::with_capacity(list.len());
    for (index, node) in list.iter().enumerate() {
        let Some(numbers) = node.numbers(2..=3) else {
            let key = format!("robots[{index}]");
            let reason = format!("{node} is not [x, y, yaw]; give metres and radians");
            return Err(keys.bad(&key, &reason));
        };
        starts.push(Start {
            x_m: numbers[0],
            y_m: numbers[1],
            yaw_rad: numbers.get(2).copied().unwrap_or(0.0),
        });
    }
    Ok(Some(starts))
}

#[cfg(test)]
mod tests {
    use super::super::super::yaml;
    use super::*;
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    const WHOLE: &str = concat!(
        "image: walls.png  # a plan\nresolution: 0.05\norigin: [-12.0, -8.0, 0.0]\nnegate: 0\n",
        "occupied_thresh: 0.65\nfree_thresh: 0.196\nwall_height: 1.5\n",
        "elevation: {image: heights.png, z_min: -2.0, z_max: 3.0, no_data: 0}\n",
        "robots: [[0.0, 0.0, 0.0]]\n",
    );

    fn read(text: &str) -> Result<(), String> {
        let document = yaml::parse(text)?;
        let said = |bad: BadKey| format!("{}: {}", bad.key, bad.reason);
        let keys = Table::new("", &document, &KEYS).map_err(said)?;
        Plan::read(&keys).map(|_| ()).map_err(said)
    }

    #[test]
    fn damaged_world_files_are_refused_in_one_line_or_read() {
        assert_eq!(read(WHOLE), Ok(()));
        let mut rng = ChaCha8Rng::seed_from_u64(13);
        let marks = b"[]{}:,-#'\"|>&*!%\t\n 0a.~?";
        let mut refused = 0;
        for _ in 0..20_000 {
            let mut bytes = WHOLE.as_bytes().to_vec();
            for _ in 0..1 + rng.next_u32() % 3 {
                let at = rng.next_u32() as usize % bytes.len();
                let mark = marks[rng.next_u32() as usize % marks.len()];
                match rng.next_u32() % 3 {
                    0 => bytes[at] = mark,
                    1 => bytes.insert(at, mark),
                    _ => bytes.truncate(at.max(1)),
                }
            }
            if let Err(reason) = read(&String::from_utf8_lossy(&bytes)) {
                assert!(!reason.contains('\n'), "{reason}");
                refused += 1;
            }
        }
        assert!(refused > 10_000, "{refused}");
    }
}
