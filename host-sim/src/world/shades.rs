//! Shades of a map's picture that are often something else than they seem.
//!
//! | in the picture | is |
//! | --- | --- |
//! | grey 205 | what map savers write for unknown: occupancy 0.196078 |
//! | pixels that are not opaque | unknown |
//!
//! A `free_thresh` above 0.196078 makes that grey free, and the robot explores what nobody knows.

use super::image::Image;
use super::occupancy::{Class, Thresholds};

/// Grey that map savers write for unknown, of 255.
const UNKNOWN_GREY: u32 = 205;
/// Least share of the pixels with that grey that is worth a note. A shaded wall has a few.
const LEAST_SHARE: f64 = 0.001;

/// Pixels of a picture by what they may mean.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Shades {
    pixels: usize,
    /// Pixels that are not fully opaque.
    pub(super) transparent: usize,
    /// Opaque pixels of the unknown grey.
    unknown_grey: usize,
    /// Sample of that grey, and of white.
    grey: [u32; 2],
}

impl Shades {
    /// Counts the pixels of a picture.
    pub(super) fn of(image: &Image) -> Self {
        let grey = UNKNOWN_GREY * image.full / 255;
        let of_grey =
            |(index, sample): (usize, &u32)| *sample == grey && !image.is_transparent(index);
        Self {
            pixels: image.samples.len(),
            transparent: image.transparent.iter().filter(|it| **it).count(),
            unknown_grey: image
                .samples
                .iter()
                .enumerate()
                .filter(|it| of_grey(*it))
                .count(),
            grey: [grey, image.full],
        }
    }

    /// Share of the pixels that are not fully opaque.
    pub(super) fn transparent_share(&self) -> f64 {
        self.transparent as f64 / self.pixels.max(1) as f64
    }

    /// Returns notes on what may surprise.
    pub(super) fn notes(&self, thresholds: &Thresholds) -> Vec<String> {
        let mut notes = Vec::new();
        let share = self.unknown_grey as f64 / self.pixels.max(1) as f64;
        let [grey, full] = self.grey;
        let is_free =
            !thresholds.is_raw && !thresholds.negate && thresholds.class(grey, full) == Class::Free;
        if is_free && share >= LEAST_SHARE {
            notes.push(format!(
                "free_thresh {} makes grey 205 free, which map savers write for unknown: {:.1} % \
                 of the pixels; write free_thresh: 0.196",
                thresholds.free,
                100.0 * share
            ));
        }
        if self.transparent > 0 {
            notes.push(format!(
                "{:.1} % of its pixels are transparent and count as unknown; flatten the picture \
                 onto white if they are floor",
                100.0 * self.transparent_share()
            ));
        }
        notes
    }
}
