//! World files: YAML in the ROS `map_server` convention with a few keys more.
//!
//! | key | meaning | default |
//! | --- | --- | --- |
//! | `image` | occupancy, PGM or PNG, relative to the file | none, if there is an `elevation` |
//! | `resolution` | side of a pixel, metres | required |
//! | `origin` | x, y in metres of the lower left corner, yaw (must be 0) | required |
//! | `negate` | 1 if white is occupied | 0 |
//! | `occupied_thresh` | above this occupancy is wall | 0.65 |
//! | `free_thresh` | below this occupancy is free; in between is unknown | 0.196 |
//! | `mode` | `trinary`; `scale` is read the same way | `trinary` |
//! | `wall_height` | metres above the ground | 1.5 |
//! | `elevation` | `{image, z_min, z_max, no_data, resolution, origin}` | flat |
//! | `robots` | list of `[x, y, yaw]` | the origin of the frame if a robot fits there, else the widest place |
//!
//! Any other key is an error: a key misspelt would otherwise be a setting ignored.

use serde::Deserialize;
use std::fs;
use std::path::Path;

use super::elevation::{Elevation, HeightScale};
use super::image::Image;
use super::occupancy::{Class, GridCell, Occupancy, Thresholds};
use super::{Start, WALL_HEIGHT_M, World, WorldError};
use crate::robot::Footprint;

/// The file as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Description {
    image: Option<String>,
    resolution: f64,
    origin: Vec<f64>,
    #[serde(default)]
    negate: Flag,
    #[serde(default = "default_occupied")]
    occupied_thresh: f64,
    #[serde(default = "default_free")]
    free_thresh: f64,
    mode: Option<String>,
    #[serde(default = "default_wall_height")]
    wall_height: f64,
    elevation: Option<HeightDescription>,
    robots: Option<Vec<Vec<f64>>>,
}

/// The `elevation` key as written.
#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct HeightDescription {
    image: String,
    z_min: f64,
    z_max: f64,
    no_data: Option<u32>,
    resolution: Option<f64>,
    origin: Option<Vec<f64>>,
}

/// `negate` is 0 or 1 in most files, and a word in some.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(untagged)]
enum Flag {
    Word(bool),
    Number(i64),
}

impl Default for Flag {
    fn default() -> Self {
        Self::Number(0)
    }
}

fn default_occupied() -> f64 {
    0.65
}

fn default_free() -> f64 {
    0.196
}

fn default_wall_height() -> f64 {
    WALL_HEIGHT_M
}

/// Reads, checks and builds.
pub(super) fn load(path: &Path) -> Result<World, WorldError> {
    let text = fs::read_to_string(path).map_err(|e| WorldError::Unreadable {
        file: path.display().to_string(),
        reason: e.to_string(),
    })?;
    let loader = Loader {
        path,
        file: path.display().to_string(),
    };
    let description = loader.parse(&text)?;
    loader.build(&description)
}

/// The file being read, for paths and messages.
struct Loader<'a> {
    path: &'a Path,
    file: String,
}

impl Loader<'_> {
    fn parse(&self, text: &str) -> Result<Description, WorldError> {
        serde_saphyr::from_str(text).map_err(|e| WorldError::Syntax {
            file: self.file.clone(),
            reason: e.without_snippet().to_string().replace('\n', " "),
        })
    }

    fn build(&self, file: &Description) -> Result<World, WorldError> {
        self.check(file)?;
        let origin_m = self.origin("origin", &file.origin)?;
        let elevation = match &file.elevation {
            Some(heights) => Some(self.elevation(heights, file.resolution, origin_m)?),
            None => None,
        };
        let occupancy = match (&file.image, &elevation) {
            (Some(image), _) => {
                let image = self.image(image)?;
                let thresholds = Thresholds {
                    occupied: file.occupied_thresh,
                    free: file.free_thresh,
                    negate: self.negate(file.negate)?,
                };
                Occupancy::from_image(&image, thresholds, file.resolution, origin_m)
            }
            (None, Some(ground)) => Occupancy::filled(
                ground.width(),
                ground.height(),
                ground.resolution_m(),
                ground.origin_m(),
                Class::Free,
            ),
            (None, None) => {
                return Err(self.value("image", "missing; give an image, an elevation, or both"));
            }
        };
        let name = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let mut world = World::new(&name, occupancy, elevation, file.wall_height, Vec::new());
        world.starts = self.starts(&world, file.robots.as_deref())?;
        Ok(world)
    }

    fn check(&self, file: &Description) -> Result<(), WorldError> {
        self.length("resolution", file.resolution)?;
        self.length("wall_height", file.wall_height)?;
        let (free, occupied) = (file.free_thresh, file.occupied_thresh);
        if !(0.0 < free && free < 1.0) {
            return Err(self.value("free_thresh", &format!("{free} is not between 0 and 1")));
        }
        if !(free < occupied && occupied < 1.0) {
            return Err(self.value(
                "occupied_thresh",
                &format!("{occupied} is not between free_thresh ({free}) and 1"),
            ));
        }
        match file.mode.as_deref() {
            None | Some("trinary" | "scale") => Ok(()),
            Some(mode) => Err(self.value("mode", &format!("{mode} is not supported; use trinary"))),
        }
    }

    fn negate(&self, flag: Flag) -> Result<bool, WorldError> {
        match flag {
            Flag::Word(word) => Ok(word),
            Flag::Number(0) => Ok(false),
            Flag::Number(1) => Ok(true),
            Flag::Number(other) => Err(self.value("negate", &format!("{other} is not 0 or 1"))),
        }
    }

    fn length(&self, key: &'static str, metres: f64) -> Result<(), WorldError> {
        if metres.is_finite() && metres > 0.0 {
            return Ok(());
        }
        Err(self.value(key, &format!("{metres} is not a length above 0 m")))
    }

    fn origin(&self, key: &'static str, numbers: &[f64]) -> Result<[f64; 2], WorldError> {
        let (x, y, yaw) = match *numbers {
            [x, y] => (x, y, 0.0),
            [x, y, yaw] => (x, y, yaw),
            _ => return Err(self.value(key, "it must be [x, y, yaw]")),
        };
        if !(x.is_finite() && y.is_finite()) {
            return Err(self.value(key, "it must be [x, y, yaw] in finite metres"));
        }
        if yaw != 0.0 {
            return Err(self.value(
                key,
                &format!("a yaw of {yaw} is not supported; rotate the image and set it to 0"),
            ));
        }
        Ok([x, y])
    }

    fn elevation(
        &self,
        heights: &HeightDescription,
        resolution_m: f64,
        origin_m: [f64; 2],
    ) -> Result<Elevation, WorldError> {
        let key = "elevation";
        let (z_min_m, z_max_m) = (heights.z_min, heights.z_max);
        if !(z_min_m.is_finite() && z_max_m.is_finite() && z_min_m < z_max_m) {
            return Err(self.value(
                key,
                &format!("z_min {z_min_m} must be below z_max {z_max_m}, both finite"),
            ));
        }
        let resolution_m = heights.resolution.unwrap_or(resolution_m);
        self.length(key, resolution_m)?;
        let origin_m = match &heights.origin {
            Some(origin) => self.origin(key, origin)?,
            None => origin_m,
        };
        let image = self.image(&heights.image)?;
        if image.channels != 1 {
            return Err(self.image_error(
                &heights.image,
                "heights must be grey, and this image has colours; convert it",
            ));
        }
        let scale = HeightScale {
            z_min_m,
            z_max_m,
            no_data: heights.no_data,
        };
        Ok(Elevation::from_image(&image, scale, resolution_m, origin_m))
    }

    fn starts(&self, world: &World, robots: Option<&[Vec<f64>]>) -> Result<Vec<Start>, WorldError> {
        let Some(robots) = robots else {
            return self.default_start(world).map(|start| vec![start]);
        };
        if robots.is_empty() {
            return Err(self.value(
                "robots",
                "empty; give at least one [x, y, yaw], or leave it out",
            ));
        }
        let mut starts = Vec::with_capacity(robots.len());
        for (index, numbers) in robots.iter().enumerate() {
            let start = match **numbers {
                [x_m, y_m] => Start {
                    x_m,
                    y_m,
                    yaw_rad: 0.0,
                },
                [x_m, y_m, yaw_rad] => Start { x_m, y_m, yaw_rad },
                _ => return Err(self.value("robots", "each must be [x, y, yaw]")),
            };
            if ![start.x_m, start.y_m, start.yaw_rad]
                .iter()
                .all(|n| n.is_finite())
            {
                return Err(self.value("robots", "each must be [x, y, yaw], all finite"));
            }
            world.check_start(&self.file, index, start)?;
            starts.push(start);
        }
        Ok(starts)
    }

    /// The origin of the frame if the robot fits there, else the cell with most room around it.
    fn default_start(&self, world: &World) -> Result<Start, WorldError> {
        let origin = Start::default();
        if world.clearance_m(&Footprint::PIONEER_3AT, origin) > 0.0 {
            return Ok(origin);
        }
        let widest = world.widest_place();
        world.check_start(&self.file, 0, widest)?;
        Ok(widest)
    }

    fn image(&self, name: &str) -> Result<Image, WorldError> {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        Image::load(&folder.join(name)).map_err(|e| self.image_error(name, &e.to_string()))
    }

    fn image_error(&self, name: &str, reason: &str) -> WorldError {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        WorldError::Image {
            file: self.file.clone(),
            image: folder.join(name).display().to_string(),
            reason: reason.to_owned(),
        }
    }

    fn value(&self, key: &'static str, reason: &str) -> WorldError {
        WorldError::Value {
            file: self.file.clone(),
            key,
            reason: reason.to_owned(),
        }
    }
}

impl World {
    /// Does the robot fit at a start?
    pub(crate) fn check_start(
        &self,
        file: &str,
        index: usize,
        start: Start,
    ) -> Result<(), WorldError> {
        let (x, y) = (start.x_m, start.y_m);
        if self.clearance_m(&Footprint::PIONEER_3AT, start) > 0.0 {
            return Ok(());
        }
        let place = match self.occupancy.index(self.occupancy.cell_at(x, y)) {
            None => "lies outside of the map",
            Some(_) if self.is_solid(x, y) => "lies in a wall or unknown space",
            Some(_) => "is too close to a wall, the robot overlaps it",
        };
        let room_m = self.distance.from_centre_m(self.occupancy.cell_at(x, y));
        let best = self.widest_place();
        Err(WorldError::Start {
            file: file.to_owned(),
            index,
            reason: format!(
                "({x:.2}, {y:.2}) {place} (clearance {room_m:.2} m); most room is at ({:.2}, {:.2})",
                best.x_m, best.y_m
            ),
        })
    }

    /// The cell with most room around it, facing along x.
    fn widest_place(&self) -> Start {
        let mut best = (0.0, GridCell { i: 0, j: 0 });
        for j in 0..self.occupancy.height() as i64 {
            for i in 0..self.occupancy.width() as i64 {
                let cell = GridCell { i, j };
                let room_m = self.distance.from_centre_m(cell);
                if room_m > best.0 {
                    best = (room_m, cell);
                }
            }
        }
        let [x_m, y_m] = self.occupancy.centre(best.1);
        Start {
            x_m,
            y_m,
            yaw_rad: 0.0,
        }
    }
}
