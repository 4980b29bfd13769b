//! The map of a run with its corrected poses: every scan entered anew, by the planner's own code.
//!
//! It has room for floors that the chip has none for.
//!
//! Units: map cells of 10 cm.

use std::collections::BTreeMap;

use fieldline_device::convert;
use fieldline_planner::Input;
use fieldline_planner::config::{Config, Tuning};
use fieldline_planner::map::Map;
use fieldline_planner::map::tiles::TILE_SIDE;
use fieldline_protocol::message::{Observation, Start, TILE_STAMPS, Tile};

use super::made_on_a_large_stack;
use super::votes::Votes;
use crate::link::correction::Classes;
use crate::replay::relations::Pose;

/// Tiles of 3.2 m that have room.
const TILES: usize = 2048;
/// Tiles that the directory can list.
const SLOTS: usize = 4096;

/// The map.
#[derive(Debug)]
pub struct Canvas {
    map: Box<Map<TILES, SLOTS>>,
    votes: Votes,
    /// Least and greatest tile that a scan may have reached.
    reach: Option<[(i16, i16); 2]>,
}

impl Canvas {
    /// Enters scans at these poses. `None` if the session's parameters are ones that a device
    /// refuses.
    #[must_use]
    pub fn of<'a>(
        start: &Start,
        scans: impl IntoIterator<Item = (&'a Observation, Pose)>,
    ) -> Option<Self> {
        let config = convert::config(start, &Tuning::DEFAULT).ok()?;
        let mut canvas = Self {
            map: made_on_a_large_stack(Map::new),
            votes: Votes::default(),
            reach: None,
        };
        canvas.map.begin(&config);
        for (observation, pose) in scans {
            canvas.enter(&config, observation, pose);
        }
        Some(canvas)
    }

    fn enter(&mut self, config: &Config, observation: &Observation, [x, y, yaw]: Pose) {
        let Some(input) = convert::input(observation, config.lasers()) else {
            return;
        };
        let mut pose = input.pose;
        (pose.x_m, pose.y_m, pose.yaw_rad) = (x as f32, y as f32, yaw as f32);
        self.map.observe(config, &Input { pose, ..input });
        for (laser, ranges_mm) in config.lasers().iter().zip(input.scans) {
            self.votes.enter(laser, ranges_mm, [x, y, yaw]);
        }
        let farthest_mm = observation.scans.iter().flat_map(|scan| &scan.ranges_mm);
        // A code for no return is farther than any range.
        let farthest_m = f64::from(farthest_mm.copied().max().unwrap_or(0)) * 1e-3;
        let side_m = f64::from(TILE_SIDE) * 0.1;
        let tile = |m: f64| (m / side_m).floor() as i16;
        let least = (tile(x - farthest_m), tile(y - farthest_m));
        let most = (tile(x + farthest_m), tile(y + farthest_m));
        let [low, high] = self.reach.unwrap_or([least, most]);
        self.reach = Some([
            (low.0.min(least.0), low.1.min(least.1)),
            (high.0.max(most.0), high.1.max(most.1)),
        ]);
    }

    /// Returns the cells of a tile, as a device shows them; `None` if it was never touched.
    #[must_use]
    pub fn tile(&self, x: i16, y: i16) -> Option<[u8; 256]> {
        self.map.shown(x.into(), y.into())
    }

    /// Returns the planes of a tile; `None` if it was never touched.
    #[must_use]
    pub fn planes(&self, (x, y): (i16, i16)) -> Option<Classes> {
        let mut planes = self.map.planes((x.into(), y.into()))?;
        self.votes.mark((x, y), &mut planes);
        Some(planes)
    }

    /// Returns the planes of all tiles.
    pub fn all_planes(&self) -> impl Iterator<Item = ((i16, i16), Classes)> {
        self.keys().filter_map(|key| Some((key, self.planes(key)?)))
    }

    /// Returns the tiles that scans may have reached.
    pub fn keys(&self) -> impl Iterator<Item = (i16, i16)> + use<> {
        let reach = self.reach.into_iter();
        reach.flat_map(|[low, high]| {
            let rows = low.1..=high.1;
            rows.flat_map(move |y| (low.0..=high.0).map(move |x| (x, y)))
        })
    }

    /// Returns all tiles, without a skeleton.
    #[must_use]
    pub fn tiles(&self) -> BTreeMap<(i16, i16), Tile> {
        let tiles = self.keys().filter_map(|(x, y)| {
            let cells = self.tile(x, y)?;
            let tile = Tile {
                x,
                y,
                cells: cells.into_iter().collect(),
                skeleton: heapless::Vec::new(),
                closed_regions: 0,
                given_up_regions: 0,
                visit_stamps: [0; TILE_STAMPS],
            };
            Some(((x, y), tile))
        });
        tiles.collect()
    }
}
