//! A known map: what a `map_server` file knows, as the tiles that a device gets before its first
//! step.
//!
//! ```text
//! file ─ start ∘ pose⁻¹ ─► map's frame ─► cells of 0.1 m ─► tiles ─► one correction
//! ```
//!
//! `pose` is the robot's pose in the file's frame where the session begins, and `start` the same in
//! the map's. Both are equal if the file has the frame of the world, as a map that `explore` saved.
//!
//! A cell looks at the pixels that it covers, n × n of them with n = 0.1 m / resolution, at least
//! one. It is an obstacle if one of them is, free if all are, and else unknown.
//!
//! A tile that was told has no evidence: two returns close a free cell, and five beams through an
//! obstacle free it. So what has changed since the file was saved is seen.
//!
//! Units: metres, radians; cells of 0.1 m; tiles of 32 × 32 cells.

use std::path::Path;

use fieldline_protocol::message::MOST_CORRECTED;

use crate::link::correction::{Classes, CorrectedTile, MapCorrection};
use crate::robot::{Footprint, Pose};
use crate::world::{Class, Occupancy, Start, World, WorldError};

/// Side of a cell, metres, and cells along a tile.
const CELL_M: f64 = 0.1;
const TILE_CELLS: i32 = 32;
/// Most pixels that a cell looks at along a side.
const MOST_LOOKS: i32 = 10;
/// Farthest tile from the first one, along x or y.
const REACH: i32 = 126;
/// Farthest coordinate of the robot in the file, metres.
const FARTHEST_M: f64 = 3_200.0;

/// What a file knows.
#[derive(Clone, Debug, PartialEq)]
pub struct KnownMap {
    /// The file, as given.
    pub file: String,
    /// What may surprise in it, one line each.
    pub notes: Vec<String>,
    plan: Occupancy,
    pose: Option<Start>,
}

/// The file's cells in the map's frame, as a device gets them.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded {
    /// The tiles, the nearest to the robot first.
    pub correction: MapCorrection,
    /// Area of the free cells and of the obstacles, square metres.
    pub known_m2: f64,
}

impl KnownMap {
    /// Reads a file. `pose` is where the robot stands in its frame when the session begins; `None`
    /// if that frame is the world's.
    ///
    /// # Errors
    /// As [`WorldError`].
    pub fn load(path: &Path, pose: Option<Start>) -> Result<Self, WorldError> {
        let file = path.display().to_string();
        let (plan, notes) = World::load_plan(path).map_err(|error| match error {
            WorldError::Unreadable { reason, .. } => fault(
                &file,
                &format!("cannot read this map ({reason}); give the YAML file of a saved map"),
            ),
            other => other,
        })?;
        let known = Self {
            notes,
            ..Self::new(&file, plan, pose)
        };
        if known.plan.classes().iter().all(|it| *it == Class::Unknown) {
            return Err(known.fault(
                "every pixel is unknown, so nothing is known; see free_thresh, occupied_thresh \
                 and negate, or leave --known out",
            ));
        }
        Ok(known)
    }

    /// Makes the known map of a plan. `file` is for messages; `pose` is as for [`Self::load`].
    #[must_use]
    pub fn new(file: &str, plan: Occupancy, pose: Option<Start>) -> Self {
        Self {
            file: file.into(),
            notes: Vec::new(),
            plan,
            pose,
        }
    }

    /// Returns the file's cells as tiles of the map of a robot that starts at `start`.
    ///
    /// # Errors
    /// [`WorldError::Value`] if the robot does not stand in this map, or the map is larger than any
    /// device's.
    pub fn load_for(&self, start: &Pose, hull: &Footprint) -> Result<Loaded, WorldError> {
        let frame = Frame::of(start, self.pose);
        self.check_robot(&frame, start, hull)?;
        let mut tiles = self.tiles(&frame);
        let home = [start.x_m, start.y_m].map(|at| tile_of(at / CELL_M));
        let far = |tile: &CorrectedTile, from: [i32; 2]| {
            let (x, y) = tile.key;
            (i32::from(x) - from[0])
                .abs()
                .max((i32::from(y) - from[1]).abs())
        };
        tiles.sort_by_key(|tile| (far(tile, home), tile.key));
        if tiles.len() > usize::from(MOST_CORRECTED) {
            return Err(self.too_large(tiles.len(), MOST_CORRECTED.into()));
        }
        let first = tiles
            .first()
            .map_or(home, |it| [it.key.0, it.key.1].map(i32::from));
        if tiles.iter().any(|tile| far(tile, first) > REACH) {
            return Err(self.fault(
                "parts of this map lie more than 403 m apart, and the device's map reaches no \
                 farther; cut the picture",
            ));
        }
        let known = |tile: &CorrectedTile| -> u32 {
            let [low, high] = &tile.classes;
            let rows = low.iter().zip(high);
            rows.map(|(low, high)| (low | high).count_ones()).sum()
        };
        let cells: u32 = tiles.iter().map(known).sum();
        Ok(Loaded {
            correction: MapCorrection {
                epoch: 1,
                tiles,
                ..MapCorrection::default()
            },
            known_m2: f64::from(cells) / 100.0,
        })
    }

    /// Refuses a map with more tiles than the pool of a device has pages.
    ///
    /// # Errors
    /// [`WorldError::Value`].
    pub fn check_room(&self, loaded: &Loaded, pages: u16) -> Result<(), WorldError> {
        let tiles = loaded.correction.tiles.len();
        if tiles > usize::from(pages) {
            return Err(self.too_large(tiles, pages.into()));
        }
        Ok(())
    }

    fn too_large(&self, tiles: usize, most: usize) -> WorldError {
        self.fault(&format!(
            "this map takes {tiles} tiles of 3.2 m, and the device has room for {most}; cut the \
             picture, or erase what the robot does not need to unknown"
        ))
    }

    /// Refuses a robot that this map does not hold, or that would stand in one of its walls. The
    /// hull may be a cell deep in a wall: two maps of a place are as far apart.
    fn check_robot(&self, frame: &Frame, start: &Pose, hull: &Footprint) -> Result<(), WorldError> {
        let [x, y] = frame.to_file([start.x_m, start.y_m]);
        let place = format!("({x:.2}, {y:.2})");
        let remedy = "say where the robot stands in this map: --known-pose X,Y,DEG";
        if self.plan.index(self.plan.cell_at(x, y)).is_none() {
            let [x0, y0] = self.plan.origin_m();
            let side = |cells: usize| cells as f64 * self.plan.resolution_m();
            let (x1, y1) = (x0 + side(self.plan.width()), y0 + side(self.plan.height()));
            return Err(self.fault(&format!(
                "the robot's start {place} lies outside of the known part of this map, \
                 ({x0:.1}, {y0:.1}) to ({x1:.1}, {y1:.1}); {remedy}"
            )));
        }
        let half = [hull.half_length_m, hull.half_width_m].map(|it| (it - CELL_M).max(0.0));
        let (sin, cos) = start.yaw_rad.sin_cos();
        let is_wall = |[u, v]: [f64; 2]| {
            let at = [start.x_m + cos * u - sin * v, start.y_m + sin * u + cos * v];
            let [x, y] = frame.to_file(at);
            self.plan.class(self.plan.cell_at(x, y)) == Class::Wall
        };
        let steps = half.map(|half| (half / (0.5 * CELL_M)).ceil() as i32);
        let along = |k: usize, step: i32| half[k] * f64::from(step) / f64::from(steps[k].max(1));
        let mut looks = (-steps[0]..=steps[0])
            .flat_map(|i| (-steps[1]..=steps[1]).map(move |j| [i, j]))
            .map(|[i, j]| [along(0, i), along(1, j)]);
        if looks.any(is_wall) {
            return Err(self.fault(&format!(
                "the robot's start {place} lies in an obstacle of this map; {remedy}"
            )));
        }
        Ok(())
    }

    /// Returns the tiles in which something is known.
    fn tiles(&self, frame: &Frame) -> Vec<CorrectedTile> {
        let [x0, y0] = self.plan.origin_m();
        let sides = [self.plan.width(), self.plan.height()];
        let sides = sides.map(|cells| cells as f64 * self.plan.resolution_m());
        let corners = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let corners = corners.map(|[u, v]| frame.to_map([x0 + u * sides[0], y0 + v * sides[1]]));
        let span = |k: usize| {
            let of = corners.map(|it| tile_of(it[k] / CELL_M));
            let least = of.iter().min().copied().unwrap_or_default();
            least..=of.iter().max().copied().unwrap_or_default()
        };
        let keys = span(1).flat_map(|row| span(0).map(move |column| (column, row)));
        keys.filter_map(|key| self.tile(frame, key)).collect()
    }

    /// Returns a tile; `None` if nothing is known there.
    fn tile(&self, frame: &Frame, (column, row): (i32, i32)) -> Option<CorrectedTile> {
        let mut classes = Classes::default();
        for y in 0..TILE_CELLS {
            for x in 0..TILE_CELLS {
                let class = self.class(frame, [column * TILE_CELLS + x, row * TILE_CELLS + y]);
                let plane = match class {
                    Class::Free => 0,
                    Class::Wall => 1,
                    Class::Unknown => continue,
                };
                classes[plane][y as usize] |= 1 << x;
            }
        }
        (classes != Classes::default()).then_some(CorrectedTile {
            key: (column as i16, row as i16),
            shift: (0, 0),
            classes,
            trail: [0; 16],
        })
    }

    /// Returns the class of a cell of the map.
    fn class(&self, frame: &Frame, cell: [i32; 2]) -> Class {
        let looks = (CELL_M / self.plan.resolution_m()).round() as i32;
        let looks = looks.clamp(1, MOST_LOOKS);
        let mut all_free = true;
        for v in 0..looks {
            for u in 0..looks {
                let part = |k: i32| (f64::from(k) + 0.5) / f64::from(looks);
                let at = [
                    (f64::from(cell[0]) + part(u)) * CELL_M,
                    (f64::from(cell[1]) + part(v)) * CELL_M,
                ];
                let [x, y] = frame.to_file(at);
                match self.plan.class(self.plan.cell_at(x, y)) {
                    Class::Wall => return Class::Wall,
                    Class::Free => {}
                    Class::Unknown => all_free = false,
                }
            }
        }
        if all_free {
            Class::Free
        } else {
            Class::Unknown
        }
    }

    fn fault(&self, reason: &str) -> WorldError {
        fault(&self.file, reason)
    }
}

fn fault(file: &str, reason: &str) -> WorldError {
    WorldError::Value {
        file: format!("--known {file}"),
        key: String::new(),
        reason: reason.into(),
    }
}

/// Returns the tile that holds a coordinate in cells.
fn tile_of(cells: f64) -> i32 {
    (cells / f64::from(TILE_CELLS)).floor() as i32
}

/// The rigid motion from the file's frame into the map's: a turn, then a shift.
struct Frame {
    sin: f64,
    cos: f64,
    shift_m: [f64; 2],
}

impl Frame {
    /// Returns `start ∘ pose⁻¹`.
    fn of(start: &Pose, pose: Option<Start>) -> Self {
        let Some(pose) = pose else {
            return Self {
                sin: 0.0,
                cos: 1.0,
                shift_m: [0.0, 0.0],
            };
        };
        let (sin, cos) = (start.yaw_rad - pose.yaw_rad).sin_cos();
        Self {
            sin,
            cos,
            shift_m: [
                start.x_m - (cos * pose.x_m - sin * pose.y_m),
                start.y_m - (sin * pose.x_m + cos * pose.y_m),
            ],
        }
    }

    fn to_map(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [
            self.shift_m[0] + self.cos * x - self.sin * y,
            self.shift_m[1] + self.sin * x + self.cos * y,
        ]
    }

    fn to_file(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let (dx, dy) = (x - self.shift_m[0], y - self.shift_m[1]);
        [self.cos * dx + self.sin * dy, self.cos * dy - self.sin * dx]
    }
}

/// Returns a pose from metres and degrees; `None` if it is no number or too far away.
#[must_use]
pub fn pose_of([x_m, y_m, degrees]: [f64; 3]) -> Option<Start> {
    let is_near = x_m.abs().max(y_m.abs()) <= FARTHEST_M && degrees.abs() <= 360.0;
    is_near.then_some(Start {
        x_m,
        y_m,
        yaw_rad: degrees.to_radians(),
    })
}
