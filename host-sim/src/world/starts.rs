//! Checks of start poses, and the choice of a start where a world file has none.

use super::distance::DistanceField;
use super::occupancy::{Class, GridCell};
use super::{Start, World, WorldError};
use crate::robot::{Footprint, Limits, Pose, stand};

/// Number of headings that are tried, all around.
const HEADINGS: u32 = 8;
/// Distance over which a slope is measured, metres.
const SLOPE_M: f64 = 0.1;

impl World {
    /// The origin of the frame if the robot stands there within its working limits, else the place
    /// with the most room around it.
    pub(super) fn default_start(&self) -> Start {
        let origin = Start::default();
        if self.check_start("", 0, origin).is_ok() && self.is_easy(origin.x_m, origin.y_m) {
            origin
        } else {
            self.widest_place()
        }
    }

    /// Checks that the robot fits at a start and has ground under all of its wheels.
    pub(crate) fn check_start(
        &self,
        file: &str,
        index: usize,
        start: Start,
    ) -> Result<(), WorldError> {
        let (x, y) = (start.x_m, start.y_m);
        let inside = self.occupancy.index(self.occupancy.cell_at(x, y));
        let place = match inside.map(|index| self.occupancy.classes()[index]) {
            None => "lies outside of the map",
            Some(Class::Wall) => "lies in a wall",
            Some(Class::Unknown) => "lies in unknown space",
            Some(Class::Free) if self.clearance_m(&Footprint::PIONEER_3AT, start) == 0.0 => {
                "is too close to a wall, the robot overlaps it"
            }
            Some(Class::Free) if stand(self, &start.pose()).is_none() => {
                "has no ground under the robot's wheels"
            }
            Some(Class::Free) => return Ok(()),
        };
        let reason = format!("({x:.2}, {y:.2}) {place}");
        Err(self.bad_start(file, index, &reason))
    }

    /// The error of a start, with the best place of the world as its remedy.
    pub(crate) fn bad_start(&self, file: &str, index: usize, reason: &str) -> WorldError {
        let best = self.widest_place();
        let remedy = if self.is_solid(best.x_m, best.y_m) {
            "no place in the world is free; check negate and the thresholds".to_owned()
        } else {
            format!("the most room is at ({:.2}, {:.2})", best.x_m, best.y_m)
        };
        WorldError::Start {
            file: file.to_owned(),
            index,
            reason: format!("{reason}; {remedy}"),
        }
    }

    /// The cell with the most room around it on easy ground, facing along x; on any ground if there
    /// is no easy ground.
    fn widest_place(&self) -> Start {
        let barriers = self.elevation.is_some().then(|| self.barriers());
        let room = barriers.as_ref().unwrap_or(&self.distance);
        let best = self
            .widest_cell(room, |[x, y]| self.is_easy(x, y))
            .or_else(|| self.widest_cell(&self.distance, |_| true));
        let [x_m, y_m] = self
            .occupancy
            .centre(best.unwrap_or(GridCell { i: 0, j: 0 }));
        Start {
            x_m,
            y_m,
            yaw_rad: 0.0,
        }
    }

    /// Distances to everything that a robot should not start beside: solid cells, holes, and ground
    /// that is too steep to cross in every direction.
    fn barriers(&self) -> DistanceField {
        let mut plan = self.occupancy.clone();
        for j in 0..plan.height() as i64 {
            for i in 0..plan.width() as i64 {
                let cell = GridCell { i, j };
                let [x, y] = plan.centre(cell);
                if !self.is_even(x, y) {
                    plan.set(cell, Class::Wall);
                }
            }
        }
        DistanceField::new(&plan)
    }

    /// Returns true if there is ground whose slope is within the working limit to the side.
    fn is_even(&self, x_m: f64, y_m: f64) -> bool {
        let Some(here_m) = self.ground_m(x_m, y_m) else {
            return false;
        };
        let steepest = libm::tan(Limits::WORKING.roll_rad);
        // Beyond the border the ground counts as level.
        [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]]
            .into_iter()
            .filter_map(|[x, y]| self.ground_m(x_m + SLOPE_M * x, y_m + SLOPE_M * y))
            .all(|beside_m| (beside_m - here_m).abs() <= steepest * SLOPE_M)
    }

    fn widest_cell(
        &self,
        room: &DistanceField,
        admit: impl Fn([f64; 2]) -> bool,
    ) -> Option<GridCell> {
        let mut best = None;
        let mut most_m = 0.0;
        for j in 0..self.occupancy.height() as i64 {
            for i in 0..self.occupancy.width() as i64 {
                let cell = GridCell { i, j };
                let room_m = room.from_centre_m(cell);
                if room_m > most_m && admit(self.occupancy.centre(cell)) {
                    (most_m, best) = (room_m, Some(cell));
                }
            }
        }
        best
    }

    /// Returns true if the robot is within its working limits here in every heading.
    fn is_easy(&self, x_m: f64, y_m: f64) -> bool {
        self.elevation.is_none()
            || (0..HEADINGS).all(|k| {
                let pose = Pose {
                    x_m,
                    y_m,
                    yaw_rad: f64::from(k) * core::f64::consts::TAU / f64::from(HEADINGS),
                    ..Pose::default()
                };
                stand(self, &pose)
                    .is_some_and(|p| Limits::WORKING.holds_attitude(p.pitch_rad, p.roll_rad))
            })
    }
}
