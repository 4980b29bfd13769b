//! For a host: the beams of a level scan on uneven ground that end at something that stands, by the
//! rule of the localiser.
//!
//! A beam that ends beside an obstacle of the map or beside a landmark met what stands there. One
//! that runs down, or that ends anywhere else, may have met ground: from another place, or with
//! another lean, it ends elsewhere.
//!
//! Units: millimetres over ground.

use heapless::Vec;

use crate::config::Config;
use crate::geometry::{Cell, Pose};
use crate::ground::ray::{Attitude, Mount};
use crate::input::{INVALID_MM, Input, has_company};
use crate::map::integrate::level_beams;
use crate::map::{Class, Map};
use crate::robot::MAX_BEAMS;

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Returns the ranges over ground of the first level laser; invalid where nothing stands.
    #[must_use]
    pub fn standing(&self, config: &Config, input: &Input<'_>) -> Vec<u16, { MAX_BEAMS as usize }> {
        let attitude = Attitude::of(&input.pose);
        let (tuning, mut out) = (config.tuning, Vec::new());
        let lasers = config.lasers.iter().zip(input.scans);
        let level = lasers.into_iter().find(|(laser, _)| laser.is_level());
        let Some((laser, ranges_mm)) = level else {
            return out;
        };
        let mount = Mount::new(&attitude, laser);
        out.extend(ranges_mm.iter().map(|_| INVALID_MM));
        let beams = level_beams(&Pose::default(), laser, ranges_mm, &tuning.map);
        for beam in beams.filter(|beam| beam.hit && has_company(ranges_mm, beam.number)) {
            let ray = attitude.ray(&mount, beam.number, beam.length_m);
            let ray = ray.filter(|ray| ray.slope > tuning.localise.landmark_slope);
            if let Some(ray) = ray
                && self.stands_beside(ray.hit_cell(tuning.ground.hit_depth_m))
                && let Some(range_mm) = out.get_mut(beam.number)
            {
                *range_mm = (ray.length_m * 1e3) as u16;
            }
        }
        out
    }

    fn stands_beside(&self, cell: Cell) -> bool {
        let mut beside = (0..9).map(|k| cell.offset(k % 3 - 1, k / 3 - 1));
        beside.any(|cell| self.tiles.class(cell) == Class::Obstacle || self.tiles.is_landmark(cell))
    }
}
