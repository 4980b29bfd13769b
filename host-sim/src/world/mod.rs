//! The world that a robot explores: walls, heights of the ground, and start poses.
//!
//! A world comes from a YAML file in the ROS `map_server` convention ([`World::load`]), from the
//! built-in collection ([`World::builtin`]), from a seed ([`World::open`]), or in a test from rows
//! of characters ([`World::picture`]). It is immutable and exact. Collisions, coverage and ranges
//! are computed from it, never from the planner's map.
//!
//! Frame: x east, y north, z up, metres, angles counter-clockwise in radians.

mod builtin;
mod canvas;
mod distance;
mod elevation;
mod error;
mod file;
mod generated;
mod ground_ray;
mod heights;
mod image;
mod materials;
mod memo;
mod occupancy;
mod origin;
mod pgm;
mod png_file;
mod ray;
mod shades;
mod starts;
mod traversal;
mod yaml;

use std::path::Path;

pub use builtin::{Builtin, Place, builtins, place, places};
pub use distance::DistanceField;
pub use elevation::{Elevation, HeightScale};
pub use error::WorldError;
pub use generated::{KINDS, Kind};
pub use image::{Image, ImageError, MAX_PIXELS};
use memo::Memo;
pub use occupancy::{Class, GridCell, Occupancy, Thresholds};
pub use ray::{Hit, Ray, Surface};
pub(crate) use traversal::GridTraversal;

use crate::robot::{Footprint, Pose, stand, wrap};

/// Height of the walls if a world file does not give it, metres.
pub const WALL_HEIGHT_M: f64 = 1.5;

/// A start pose of a robot.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Start {
    /// Metres.
    pub x_m: f64,
    /// Metres.
    pub y_m: f64,
    /// Radians.
    pub yaw_rad: f64,
}

impl Start {
    /// The planar pose; height and attitude are 0.
    #[must_use]
    pub fn pose(&self) -> Pose {
        Pose {
            x_m: self.x_m,
            y_m: self.y_m,
            yaw_rad: wrap(self.yaw_rad),
            ..Pose::default()
        }
    }
}

/// A world.
#[derive(Clone, Debug)]
pub struct World {
    name: String,
    occupancy: Occupancy,
    distance: DistanceField,
    walls: ray::Walls,
    elevation: Option<Elevation>,
    wall_height_m: f64,
    /// Height of what lies outside of the grid, metres: infinite, or that of the walls for a
    /// picture that was cut, whose unknown parts lie there.
    border_m: f64,
    /// Heights of walls that are of glass or lower than the rest.
    wall_heights: Option<materials::WallHeights>,
    starts: Vec<Start>,
    notes: Vec<String>,
    seen: Memo,
}

impl World {
    /// Opens a built-in world by name, a generated world by name and seed (`maze:1`, [`KINDS`]), or
    /// else a world file by path.
    ///
    /// # Errors
    /// As [`WorldError`].
    pub fn open(name_or_path: &str) -> Result<Self, WorldError> {
        Self::builtin(name_or_path)
            .map(Ok)
            .or_else(|| generated::open(name_or_path))
            .unwrap_or_else(|| Self::load(Path::new(name_or_path)))
    }

    /// Loads a world file.
    ///
    /// # Errors
    /// As [`WorldError`].
    pub fn load(path: &Path) -> Result<Self, WorldError> {
        file::load(path)
    }

    /// Reads what the picture of a world file knows, and notes on what may surprise in it. Heights
    /// and starts of the file do not count.
    ///
    /// # Errors
    /// As [`WorldError`].
    pub fn load_plan(path: &Path) -> Result<(Occupancy, Vec<String>), WorldError> {
        file::load_plan(path)
    }

    /// Draws a built-in world; [`builtins`] lists them.
    #[must_use]
    pub fn builtin(name: &str) -> Option<Self> {
        builtin::draw(name)
    }

    /// A flat world from rows of characters, greatest y first: `#` wall, `?` unknown, anything else
    /// free. The corner of least x and y is the origin, and there are no starts.
    #[must_use]
    pub fn picture(name: &str, resolution_m: f64, rows: &[&str]) -> Self {
        let width = rows.iter().map(|row| row.len()).max().unwrap_or(0);
        let mut grid =
            Occupancy::filled(width, rows.len(), resolution_m, [0.0, 0.0], Class::Unknown);
        for (j, row) in (0..).zip(rows.iter().rev()) {
            for (i, character) in (0..).zip(row.chars()) {
                let class = match character {
                    '#' => Class::Wall,
                    '?' => Class::Unknown,
                    _ => Class::Free,
                };
                grid.set(GridCell { i, j }, class);
            }
        }
        Self::flat(name, grid, Vec::new())
    }

    /// A flat world. The starts are not checked.
    #[must_use]
    pub fn flat(name: &str, occupancy: Occupancy, starts: Vec<Start>) -> Self {
        Self::new(name, occupancy, None, WALL_HEIGHT_M, starts)
    }

    /// A world with uneven ground. The starts are not checked.
    #[must_use]
    pub fn uneven(
        name: &str,
        occupancy: Occupancy,
        elevation: Elevation,
        starts: Vec<Start>,
    ) -> Self {
        Self::new(name, occupancy, Some(elevation), WALL_HEIGHT_M, starts)
    }

    fn new(
        name: &str,
        occupancy: Occupancy,
        elevation: Option<Elevation>,
        wall_height_m: f64,
        starts: Vec<Start>,
    ) -> Self {
        let distance = DistanceField::new(&occupancy);
        Self {
            name: name.to_owned(),
            walls: ray::Walls::new(&occupancy, &distance),
            occupancy,
            distance,
            elevation,
            wall_height_m,
            border_m: f64::INFINITY,
            wall_heights: None,
            starts,
            notes: Vec::new(),
            seen: Memo::default(),
        }
    }

    /// This world with one start, which is not checked.
    fn with_start(self, start: Start) -> Self {
        Self {
            starts: vec![start],
            ..self
        }
    }

    /// The built-in name, the generated world's name with its seed, or the file's name without its
    /// extension.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Start poses; empty only in worlds of a test.
    #[must_use]
    pub fn starts(&self) -> &[Start] {
        &self.starts
    }

    /// Notes on what may surprise in a world file, one line each.
    #[must_use]
    pub fn notes(&self) -> &[String] {
        &self.notes
    }

    /// Results for this world that take long and that other runs need again.
    pub(crate) fn seen(&self) -> &Memo {
        &self.seen
    }

    /// Free, wall and unknown cells.
    #[must_use]
    pub fn occupancy(&self) -> &Occupancy {
        &self.occupancy
    }

    /// Distances to the nearest solid cell.
    #[must_use]
    pub fn distance(&self) -> &DistanceField {
        &self.distance
    }

    /// The ground's heights; `None` if all of the ground is at 0.
    #[must_use]
    pub fn elevation(&self) -> Option<&Elevation> {
        self.elevation.as_ref()
    }

    /// Height of the walls above the ground, metres.
    #[must_use]
    pub fn wall_height_m(&self) -> f64 {
        self.wall_height_m
    }

    /// Size along x and y, metres.
    #[must_use]
    pub fn size_m(&self) -> [f64; 2] {
        let grid = &self.occupancy;
        [grid.width(), grid.height()].map(|cells| cells as f64 * grid.resolution_m())
    }

    /// Returns true if a point is wall, unknown or outside.
    #[must_use]
    pub fn is_solid(&self, x_m: f64, y_m: f64) -> bool {
        self.occupancy.is_solid(self.occupancy.cell_at(x_m, y_m))
    }

    /// Height of the ground, metres; 0 in a flat world, `None` over a hole.
    #[must_use]
    pub fn ground_m(&self, x_m: f64, y_m: f64) -> Option<f64> {
        match &self.elevation {
            None => Some(0.0),
            Some(elevation) => elevation.ground_m(x_m, y_m),
        }
    }

    /// The first hit of a ray within `limit_m`, if any.
    #[must_use]
    pub fn cast(&self, ray: &Ray, limit_m: f64) -> Option<Hit> {
        let ground = match &self.elevation {
            None => ground_ray::plane(ray).filter(|hit| hit.range_m <= limit_m),
            Some(elevation) => ground_ray::ground(elevation, ray, limit_m),
        };
        let limit_m = ground.map_or(limit_m, |hit| hit.range_m);
        self.walls
            .cast(ray, limit_m, |cell| self.wall_top_m(cell))
            .or(ground)
    }

    /// Height of the top of the wall on a cell; infinite outside of a whole picture, and below
    /// everything for glass. Over a hole it counts from 0.
    fn wall_top_m(&self, cell: GridCell) -> f64 {
        let Some(index) = self.occupancy.index(cell) else {
            return self.border_m;
        };
        let own = self.wall_heights.as_ref().and_then(|it| it.of(index));
        let [x_m, y_m] = self.occupancy.centre(cell);
        self.ground_m(x_m, y_m).unwrap_or(0.0) + own.unwrap_or(self.wall_height_m)
    }

    /// Metres between a footprint at a pose and the nearest solid cell: 0 if they overlap, and at
    /// most [`crate::robot::FARTHEST_M`].
    #[must_use]
    pub fn clearance_m(&self, footprint: &Footprint, start: Start) -> f64 {
        let planar = start.pose();
        footprint.clearance_m(self, &stand(self, &planar).unwrap_or(planar))
    }
}
