//! The `elevation` key of a world file: its own keys, its image, and checks of both together.
//!
//! | key | meaning | default |
//! | --- | --- | --- |
//! | `image` | heights, PGM or PNG, grey, relative to the file | required |
//! | `z_min`, `z_max` | metres at the least and the greatest value | required |
//! | `no_data` | the value that means "no surface" | every value is a height |
//! | `bits` | 8 or 16: refuse an image of any other depth | whatever the image has |
//! | `resolution`, `origin` | as for the map | the map's |
//!
//! Refused: an image in the map's frame of another size, another depth than `bits` says, a
//! `no_data` that the image cannot hold, no surface anywhere. Legal values that may surprise
//! become notes.

use super::elevation::{Elevation, HeightScale};
use super::file::length;
use super::image::Image;
use super::occupancy::Occupancy;
use super::origin::origin;
use super::yaml::{BadKey, Node, Table};

/// Keys of an `elevation`.
const KEYS: [&str; 7] = [
    "image",
    "z_min",
    "z_max",
    "no_data",
    "bits",
    "resolution",
    "origin",
];
/// Steps between grey values above this are noted, metres: a wheel feels them.
const COARSE_M: f64 = 0.02;

/// Values of the `elevation` key.
pub(super) struct Heights<'a> {
    /// Path of the image, as written.
    pub(super) image: &'a str,
    scale: HeightScale,
    bits: Option<u32>,
    resolution_m: f64,
    origin_m: [f64; 2],
    /// True if it has its own resolution or origin; then its size need not be the map's.
    placed: bool,
}

impl<'a> Heights<'a> {
    /// Reads the table under `elevation`; resolution and origin default to the map's.
    pub(super) fn read(
        node: &'a Node,
        resolution_m: f64,
        origin_m: [f64; 2],
    ) -> Result<Self, BadKey> {
        let keys = Table::new("elevation", node, &KEYS)?;
        let z_min_m = keys.required("z_min", keys.number("z_min")?, "-2.0")?;
        let z_max_m = keys.required("z_max", keys.number("z_max")?, "3.0")?;
        if !(z_min_m.is_finite() && z_max_m.is_finite() && z_min_m < z_max_m) {
            let reason = format!("{z_max_m} is not above z_min ({z_min_m}); swap or correct them");
            return Err(keys.bad("z_max", &reason));
        }
        let scale = HeightScale {
            z_min_m,
            z_max_m,
            no_data: no_data(&keys)?,
        };
        let (own_resolution, own_origin) = (length(&keys, "resolution")?, origin(&keys)?);
        if let Some((_, yaw)) = own_origin.filter(|(_, yaw)| *yaw != 0.0) {
            let reason =
                format!("a yaw of {yaw} is not supported; rotate the image and set it to 0");
            return Err(keys.bad("origin", &reason));
        }
        let own_origin = own_origin.map(|(origin_m, _)| origin_m);
        Ok(Self {
            image: keys.required("image", keys.text("image")?, "heights.png")?,
            scale,
            bits: bits(&keys)?,
            resolution_m: own_resolution.unwrap_or(resolution_m),
            origin_m: own_origin.unwrap_or(origin_m),
            placed: own_resolution.is_some() || own_origin.is_some(),
        })
    }

    /// Builds the ground, or says why the image cannot be used.
    pub(super) fn build(
        &self,
        image: &Image,
        walls: Option<&Occupancy>,
    ) -> Result<Elevation, String> {
        if image.channels != 1 {
            return Err("heights must be grey, and this image has colours; convert it".into());
        }
        self.check_depth(image)?;
        if let Some(walls) = walls.filter(|_| !self.placed) {
            let (width, height) = (walls.width(), walls.height());
            if (image.width, image.height) != (width, height) {
                return Err(format!(
                    "{} x {} pixels of heights, but the map has {width} x {height}; \
                     give elevation a resolution and an origin of its own, \
                     or images of one size",
                    image.width, image.height
                ));
            }
        }
        let ground = Elevation::from_image(image, self.scale, self.resolution_m, self.origin_m);
        match ground.span_m() {
            Some(_) => Ok(ground),
            None => Err("no pixel of it has a surface; check no_data".into()),
        }
    }

    fn check_depth(&self, image: &Image) -> Result<(), String> {
        let (bits, full) = (depth(image), image.full);
        if let Some(claimed) = self.bits.filter(|claimed| *claimed != bits) {
            return Err(format!(
                "{bits}-bit grey (values up to {full}), but elevation.bits says {claimed}; \
                 save it with {claimed} bits, or correct bits"
            ));
        }
        match self.scale.no_data {
            Some(value) if value > full => Err(format!(
                "values go up to {full} ({bits} bits), so none can be no_data ({value}); \
                 save it with 16 bits, or correct no_data"
            )),
            _ => Ok(()),
        }
    }

    /// Notes on what may surprise about the ground.
    pub(super) fn notes(
        &self,
        image: &Image,
        ground: &Elevation,
        walls: Option<&Occupancy>,
    ) -> Vec<String> {
        let mut notes = Vec::new();
        let step_m = (self.scale.z_max_m - self.scale.z_min_m) / f64::from(image.full.max(1));
        if step_m > COARSE_M {
            notes.push(format!(
                "its heights come in steps of {step_m:.3} m ({} bits over {:.2} m): \
                 slopes become stairs; 16 bits would be smooth",
                depth(image),
                self.scale.z_max_m - self.scale.z_min_m
            ));
        }
        let missing = ground.missing();
        if missing > 0.0 {
            notes.push(format!(
                "{:.1} % of its pixels have no surface: holes without a floor",
                missing * 100.0
            ));
        }
        let bare = walls.map_or(0.0, |walls| ground.uncovered(walls));
        if bare > 0.0 {
            notes.push(format!(
                "it does not cover the map: \
                 {:.1} % of the free floor lie beyond it, without ground",
                bare * 100.0
            ));
        }
        notes
    }
}

/// Bits per sample: 8 or 16.
fn depth(image: &Image) -> u32 {
    if image.full > 255 { 16 } else { 8 }
}

fn no_data(keys: &Table<'_>) -> Result<Option<u32>, BadKey> {
    match keys.number("no_data")? {
        None => Ok(None),
        Some(value) if (0.0..=65_535.0).contains(&value) && value.fract() == 0.0 => {
            Ok(Some(value as u32))
        }
        Some(value) => {
            let reason =
                format!("{value} is not a grey value; give a whole number from 0 to 65535");
            Err(keys.bad("no_data", &reason))
        }
    }
}

fn bits(keys: &Table<'_>) -> Result<Option<u32>, BadKey> {
    match keys.number("bits")? {
        None => Ok(None),
        Some(8.0) => Ok(Some(8)),
        Some(16.0) => Ok(Some(16)),
        Some(other) => Err(keys.bad(
            "bits",
            &format!("{other} is neither 8 nor 16; give one of them"),
        )),
    }
}
