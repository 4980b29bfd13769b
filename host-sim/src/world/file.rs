//! World files: YAML in the ROS `map_server` convention with a few more keys.
//!
//! | key | meaning | default |
//! | --- | --- | --- |
//! | `image` | occupancy, PGM or PNG, relative to the file | none, if there is an `elevation` |
//! | `resolution` | side of a pixel, metres | required |
//! | `origin` | x, y of the lower left corner, metres; yaw of the picture, radians | required |
//! | `negate` | 1 if white is occupied | 0 |
//! | `occupied_thresh` | above this occupancy is wall | 0.65 |
//! | `free_thresh` | below this occupancy is free; in between is unknown | 0.196 |
//! | `mode` | `trinary`; `scale` is read the same way; `raw`, see below | `trinary` |
//! | `wall_height` | metres above the ground | 1.5 |
//! | `glass`, `low` | walls that beams go through or over, see [`super::materials`] | none |
//! | `elevation` | heights of the ground, see [`super::heights`] | flat |
//! | `robots` | list of `[x, y, yaw]` | the origin of the frame, or else the widest place |
//!
//! A `raw` value of 0 to 100 is the occupancy in percent, any other is unknown. A bad start is
//! noted, and refused if a run begins there.
//!
//! A picture of more than [`WHOLE_PIXELS`] pixels is cut to its known part, and so is a turned one.
//! What is built afterwards takes [`CELL_BYTES`] a cell; more than [`MOST_BYTES`] is refused.
//!
//! Any other key is an error, so that a misspelt key is not a setting that is silently ignored.

mod plan;

use std::fs;
use std::path::{Path, PathBuf};

use super::elevation::Elevation;
use super::heights::Heights;
use super::image::Image;
use super::occupancy::Occupancy;
use super::shades::Shades;
use super::yaml::{self, BadKey, Node, Table};
use super::{World, WorldError};
pub(super) use plan::length;
use plan::{KEYS, Plan};

/// Pixels of a picture that is kept whole, unknown parts and all.
const WHOLE_PIXELS: usize = 4_000_000;
/// Memory of a cell of the world in a run: classes, distances, rays, reach and coverage.
const CELL_BYTES: usize = 90;
/// Most memory of a world, bytes.
const MOST_BYTES: usize = 2_000_000_000;

/// Greatest side of a world, metres.
const LARGEST_M: f64 = 1_000.0;
/// Greatest distance of a world's corner from the frame's axes, metres: the wire has frontiers as
/// cells of 0.1 m in 16 bits.
const FARTHEST_M: f64 = 3_000.0;

/// Reads a world file, checks it and builds the world.
pub(super) fn load(path: &Path) -> Result<World, WorldError> {
    let (loader, document) = read(path)?;
    loader.build(&document)
}

/// Reads what the picture of a world file knows, and what may surprise in it. Heights and starts
/// are checked and not used.
pub(super) fn load_plan(path: &Path) -> Result<(Occupancy, Vec<String>), WorldError> {
    let (loader, document) = read(path)?;
    loader.plan(&document)
}

fn read(path: &Path) -> Result<(Loader<'_>, Node), WorldError> {
    let file = path.display().to_string();
    let text = fs::read_to_string(path).map_err(|e| WorldError::Unreadable {
        file: file.clone(),
        reason: e.to_string(),
    })?;
    let document = yaml::parse(&text).map_err(|reason| WorldError::Syntax {
        file: file.clone(),
        reason,
    })?;
    Ok((Loader { path, file }, document))
}

/// The file that is read, for paths and messages.
struct Loader<'a> {
    path: &'a Path,
    file: String,
}

impl Loader<'_> {
    fn build(&self, document: &Node) -> Result<World, WorldError> {
        let keys = Table::new("", document, &KEYS).map_err(|bad| self.value(bad))?;
        let plan = Plan::read(&keys).map_err(|bad| self.value(bad))?;
        let (walls, mut notes) = match plan.image {
            Some(name) => self
                .walls(name, &plan)
                .map(|(walls, notes)| (Some(walls), notes))?,
            None => (None, Vec::new()),
        };
        let elevation = match &plan.heights {
            Some(heights) => Some(self.elevation(heights, walls.as_ref(), &mut notes)?),
            None => None,
        };
        let occupancy = match (walls, &elevation) {
            (Some(walls), _) => walls,
            (None, Some(ground)) => ground.floor(),
            (None, None) => {
                let reason = "missing; give an image, an elevation, or both";
                return Err(self.value(keys.bad("image", reason)));
            }
        };
        self.check_extent(&occupancy, &keys)?;
        let is_cut = plan.yaw_rad != 0.0 || occupancy.width() * occupancy.height() > WHOLE_PIXELS;
        let occupancy = if is_cut {
            Self::cut(&occupancy, &plan)
        } else {
            occupancy
        };
        self.check_memory(&occupancy, elevation.as_ref(), &keys)?;
        let name = self.path.file_stem().unwrap_or_default().to_string_lossy();
        let wall_heights = plan.materials.heights(&occupancy, &keys);
        let wall_heights = wall_heights.map_err(|bad| self.value(bad))?;
        let mut world = World::new(&name, occupancy, elevation, plan.wall_height_m, Vec::new());
        world.wall_heights = wall_heights;
        if is_cut {
            world.border_m = world.wall_height_m;
        }
        world.notes = notes;
        world.starts = match plan.starts {
            Some(starts) => starts,
            None => vec![world.default_start()],
        };
        self.check_starts(&mut world)?;
        Ok(world)
    }

    /// Reads the walls alone, cut to their known part, and turned.
    fn plan(&self, document: &Node) -> Result<(Occupancy, Vec<String>), WorldError> {
        let keys = Table::new("", document, &KEYS).map_err(|bad| self.value(bad))?;
        let plan = Plan::read(&keys).map_err(|bad| self.value(bad))?;
        let Some(name) = plan.image else {
            return Err(self.value(keys.bad("image", "missing; give the picture of the map")));
        };
        let (walls, notes) = self.walls(name, &plan)?;
        self.check_extent(&walls, &keys)?;
        Ok((Self::cut(&walls, &plan), notes))
    }

    /// Refuses a world of which no start can be used. Notes those that cannot.
    fn check_starts(&self, world: &mut World) -> Result<(), WorldError> {
        let starts = world.starts.iter().enumerate();
        let checks = starts.map(|(index, start)| world.check_start(&self.file, index, *start));
        let mut bad: Vec<WorldError> = checks.filter_map(Result::err).collect();
        if bad.len() == world.starts.len() && !bad.is_empty() {
            return Err(bad.swap_remove(0));
        }
        let notes = bad.into_iter().filter_map(|bad| match bad {
            WorldError::Start { index, reason, .. } => Some(format!(
                "robots[{index}]: {reason}; no run begins there, the other starts are good"
            )),
            _ => None,
        });
        world.notes.extend(notes);
        Ok(())
    }

    /// Returns a large or turned plan cut to its known part, and turned.
    fn cut(plan: &Occupancy, read: &Plan<'_>) -> Occupancy {
        let known = plan.known_part();
        if read.yaw_rad == 0.0 {
            known
        } else {
            known.turned(read.origin_m, read.yaw_rad)
        }
    }

    /// Refuses a world that takes more than [`MOST_BYTES`].
    fn check_memory(
        &self,
        plan: &Occupancy,
        ground: Option<&Elevation>,
        keys: &Table<'_>,
    ) -> Result<(), WorldError> {
        let cells = plan.width() * plan.height();
        let heights = ground.map_or(0, |ground| ground.width() * ground.height());
        let bytes = cells * CELL_BYTES + heights * size_of::<f64>();
        if bytes <= MOST_BYTES {
            return Ok(());
        }
        let reason = format!(
            "the known part has {} x {} cells of {} m, which take about {:.1} GB, and {:.1} GB is \
             the limit; scale the picture down, or cut it",
            plan.width(),
            plan.height(),
            plan.resolution_m(),
            bytes as f64 / 1e9,
            MOST_BYTES as f64 / 1e9
        );
        Err(self.value(keys.bad("image", &reason)))
    }

    /// Refuses a world that the wire's cells or the memory cannot hold: its resolution or origin is
    /// wrong.
    fn check_extent(&self, plan: &Occupancy, keys: &Table<'_>) -> Result<(), WorldError> {
        let sides = [plan.width(), plan.height()].map(|cells| cells as f64 * plan.resolution_m());
        if sides.iter().any(|side| *side > LARGEST_M) {
            let reason = format!(
                "{} x {} pixels of {} m are more than {LARGEST_M} m a side; give metres a pixel",
                plan.width(),
                plan.height(),
                plan.resolution_m()
            );
            return Err(self.value(keys.bad("resolution", &reason)));
        }
        let [x, y] = plan.origin_m();
        let reach = [x, y, x + sides[0], y + sides[1]];
        if reach.iter().any(|at| at.abs() > FARTHEST_M) {
            let reason = format!(
                "({x}, {y}) is farther than {FARTHEST_M} m; move the frame's origin to the world"
            );
            return Err(self.value(keys.bad("origin", &reason)));
        }
        Ok(())
    }

    /// Reads the walls, and notes what may surprise in their picture.
    fn walls(&self, name: &str, plan: &Plan<'_>) -> Result<(Occupancy, Vec<String>), WorldError> {
        let image = self.image(name)?;
        let (resolution_m, origin_m) = (plan.resolution_m, plan.origin_m);
        let shades = Shades::of(&image);
        if plan.thresholds.is_raw && image.full != 255 * image.channels {
            let reason = "mode raw needs values of 8 bits; save the picture with 8 bits";
            return Err(self.image_error(name, reason));
        }
        let walls = Occupancy::from_image(&image, plan.thresholds, resolution_m, origin_m);
        if shades.transparent > 0 && walls.free_bounds_m().is_none() {
            let reason = format!(
                "it has no free floor, and {:.1} % of its pixels are transparent, which count as \
                 unknown; flatten the picture onto white and save it without alpha",
                100.0 * shades.transparent_share()
            );
            return Err(self.image_error(name, &reason));
        }
        Ok((walls, shades.notes(&plan.thresholds)))
    }

    fn elevation(
        &self,
        heights: &Heights<'_>,
        walls: Option<&Occupancy>,
        notes: &mut Vec<String>,
    ) -> Result<Elevation, WorldError> {
        let image = self.image(heights.image)?;
        let ground = heights
            .build(&image, walls)
            .map_err(|reason| self.image_error(heights.image, &reason))?;
        notes.extend(heights.notes(&image, &ground, walls));
        Ok(ground)
    }

    fn image(&self, name: &str) -> Result<Image, WorldError> {
        Image::load(&self.beside(name)).map_err(|e| self.image_error(name, &e.to_string()))
    }

    fn image_error(&self, name: &str, reason: &str) -> WorldError {
        WorldError::Image {
            file: self.file.clone(),
            image: self.beside(name).display().to_string(),
            reason: reason.to_owned(),
        }
    }

    /// A path relative to the world file.
    fn beside(&self, name: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(name)
    }

    fn value(&self, BadKey { key, reason }: BadKey) -> WorldError {
        WorldError::Value {
            file: self.file.clone(),
            key,
            reason,
        }
    }
}
