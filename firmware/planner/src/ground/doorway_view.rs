//! Doorway view: the part of a room that the level laser sees through a doorway \[Maffei20, IV,
//! scenario 3\].
//!
//! ```text
//!      room             beams between the jambs J all end on something that stands
//!   ___J     J___       |J J| is at most max_doorway_m; both jambs are near and stand
//!        \ /            then the cells that the beams cross are floor, and their ends are wall
//!       robot
//! ```
//!
//! The tilted laser meets the ground 1.4 m ahead, so it measures a room's floor only from inside.
//! The paper's robot senses the interior from the door and does not go in. Therefore level beams
//! count through a doorway as they do on flat ground: the room's floor continues the ground before
//! its door.
//!
//! Level beams count nowhere else. In the open they pass over holes and end on slopes. So the
//! doorway must be narrow, and every beam through it must end higher over the robot's ground than
//! `h_obs`. If the robot drives in, the heights that the tilted laser measures replace this view.
//!
//! Units: metres; ranges in millimetres; beams by their number in the sweep.

use core::ops::Range;

use crate::config::{GroundTuning, UnevenGround};
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::ground::elevation::Heights;
use crate::ground::ray::{Attitude, Mount, Ray};
use crate::input::INVALID_MM;
use crate::math;
use crate::robot::LaserMount;

/// Distance between interpolated beams at their ends, metres: they miss no cell.
const STRIDE_M: f32 = 0.5 * CELL_M;
/// Least sine of the angle between two beams: a smaller one counts as this.
const MIN_SINE: f32 = 1e-3;
/// Most looks at a beam behind a first jamb, which bounds the time of a view: each pair of jambs
/// looks at the beams between them.
const MOST_LOOKS: u32 = 4_096;

/// The part of a room that a cell belongs to.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Part {
    /// A beam crossed the cell.
    Floor,
    /// A beam ended in the cell.
    Wall,
}

/// The view of the level laser from one pose.
#[derive(Debug)]
pub(crate) struct DoorwayView<'a> {
    attitude: Attitude,
    mount: Mount<'a>,
    /// Height of the ground under the robot, metres.
    ground_m: f32,
    ground: &'a UnevenGround,
    tuning: &'a GroundTuning,
    laser: &'a LaserMount,
    ranges_mm: &'a [u16],
    /// Looks at beams that are left.
    looks: u32,
}

impl<'a> DoorwayView<'a> {
    /// Creates the view from a pose; `None` if the robot is tilted more than `max_doorway_tilt`.
    pub(crate) fn new(
        pose: &Pose,
        ground: &'a UnevenGround,
        tuning: &'a GroundTuning,
        laser: &'a LaserMount,
        ranges_mm: &'a [u16],
    ) -> Option<Self> {
        let attitude = Attitude::of(pose);
        let is_tilted = [(1.0, 0.0), (0.0, 1.0)]
            .into_iter()
            .any(|(x, y)| attitude.rise(x, y).abs() > tuning.max_doorway_tilt);
        (!is_tilted).then(|| Self {
            attitude,
            mount: Mount::new(&attitude, laser),
            ground_m: pose.z_m,
            ground,
            tuning,
            laser,
            ranges_mm,
            looks: MOST_LOOKS,
        })
    }

    /// Returns the range of a beam that hit something.
    fn range(&self, number: usize) -> Option<u16> {
        let range = *self.ranges_mm.get(number)?;
        (range != INVALID_MM && range < self.laser.range_limit_mm).then_some(range)
    }

    /// Returns a beam that hit something.
    fn ray(&self, number: usize) -> Option<Ray> {
        let range_m = f32::from(self.range(number)?) * 1e-3;
        self.attitude.ray(&self.mount, number, range_m)
    }

    /// Returns a beam that hit something; `None` as well if no look is left.
    fn look(&mut self, number: usize) -> Option<Ray> {
        self.looks = self.looks.checked_sub(1)?;
        self.ray(number)
    }

    /// Returns the beams through the first doorway whose first jamb is beam `from` or a later one;
    /// `None` as well if no look is left.
    pub(crate) fn next_doorway(
        &mut self,
        heights: &Heights<'_>,
        from: usize,
    ) -> Option<Range<usize>> {
        let beams = self.ranges_mm.len();
        for first in from..beams {
            if self.is_jamb(first, first + 1)
                && let Some(jamb) = self.ray(first).filter(|ray| self.stands(heights, ray))
                && let Some(second) = self.second_jamb(heights, (first, &jamb))
            {
                return Some(first + 1..second);
            }
        }
        None
    }

    /// Returns the beam on the second jamb of the doorway whose first jamb is this one.
    fn second_jamb(&mut self, heights: &Heights<'_>, first: (usize, &Ray)) -> Option<usize> {
        for second in first.0 + 1..self.ranges_mm.len() {
            // A beam that hit nothing ends the search: it shows no room.
            if self.looks == 0 || self.range(second).is_none() {
                return None;
            }
            if self.is_jamb(second, second - 1) && self.is_doorway(heights, first, second) {
                return Some(second);
            }
        }
        None
    }

    /// Returns true if what a beam hit stands.
    fn stands(&self, heights: &Heights<'_>, ray: &Ray) -> bool {
        heights.is_obstacle(ray.hit_cell(self.tuning.hit_depth_m), self.tuning)
    }

    /// Returns true if a beam ends near the robot, and nearer than the beam beside it.
    fn is_jamb(&self, jamb: usize, beside: usize) -> bool {
        match (self.range(jamb), self.range(beside)) {
            (Some(jamb), Some(beside)) => {
                jamb < self.tuning.max_jamb_mm && beside > jamb + self.tuning.jamb_step_mm
            }
            _ => false,
        }
    }

    /// Returns true if two beams end on the jambs of a doorway, of which the first stands, and all
    /// beams between them end on something that stands behind it.
    fn is_doorway(
        &mut self,
        heights: &Heights<'_>,
        (first, jamb): (usize, &Ray),
        second: usize,
    ) -> bool {
        let Some(other) = self.look(second) else {
            return false;
        };
        let (from, to, tuning) = (jamb.end(), other.end(), self.tuning);
        let width_m = from.distance_m(to);
        let widths_m = CELL_M..=tuning.max_doorway_m;
        if !widths_m.contains(&width_m) || !self.stands(heights, &other) {
            return false;
        }
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        // Depth behind the threshold. Bearings grow counter-clockwise, so the second jamb is on the
        // left and a positive depth is beyond the threshold.
        let depth_m =
            |point: Point| (dy * (point.x_m - from.x_m) - dx * (point.y_m - from.y_m)) / width_m;
        (first + 1..second).all(|k| {
            self.look(k).is_some_and(|ray| {
                let over_m = ray.height_m(ray.length_m) - self.ground_m;
                depth_m(ray.end()) > tuning.min_recess_m && over_m > self.ground.obstacle_m
            })
        })
    }

    /// Returns the cell of what a beam hit.
    pub(crate) fn end_cell(&self, number: usize) -> Option<Cell> {
        self.ray(number)
            .map(|ray| ray.hit_cell(self.tuning.hit_depth_m))
    }

    /// Calls `found` for the cells that a beam sees, and for those between it and the beam before:
    /// their ends are farther apart than a cell is wide. A cell may come more than once, also as
    /// both parts.
    pub(crate) fn for_each_cell(&self, number: usize, mut found: impl FnMut(Cell, Part)) {
        let Some(ray) = self.ray(number) else {
            return;
        };
        if let Some(before) = number.checked_sub(1).and_then(|before| self.ray(before)) {
            self.cells_between(&before, &ray, &mut found);
        }
        self.cells_of_ray(&ray, 0.0, &mut found);
    }
    /// Calls `found` for the cells between two neighbouring beams that end on one wall.
    /// Interpolated beams run to points on the line between the two ends.
    fn cells_between(&self, one: &Ray, other: &Ray, found: &mut impl FnMut(Cell, Part)) {
        let (from, to) = (one.end(), other.end());
        let gap_m = from.distance_m(to);
        if gap_m > self.tuning.max_wall_gap_m {
            return;
        }
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let count = math::floor(gap_m / STRIDE_M);
        // Up to here the two beams themselves cross all cells between them.
        let (ux, uy) = one.along;
        let (vx, vy) = other.along;
        let sine = (ux * vy - uy * vx).abs();
        let from_m = one
            .length_m
            .min(other.length_m)
            .min(STRIDE_M / sine.max(MIN_SINE));
        for k in 1..=count {
            let part = k as f32 / (count + 1) as f32;
            let (x, y) = (
                from.x_m + part * dx - one.from.x_m,
                from.y_m + part * dy - one.from.y_m,
            );
            let length_m = math::sqrt(x * x + y * y);
            if length_m > 0.0 {
                let along = (x / length_m, y / length_m);
                let ray = Ray {
                    along,
                    length_m,
                    ..*one
                };
                self.cells_of_ray(&ray, from_m, found);
            }
        }
    }

    /// Calls `found` for the cells of a beam from length `from_m` on.
    fn cells_of_ray(&self, ray: &Ray, from_m: f32, found: &mut impl FnMut(Cell, Part)) {
        let wall = ray.hit_cell(self.tuning.hit_depth_m);
        let mut s_m = from_m;
        while s_m < ray.length_m {
            let cell = ray.at(s_m).cell();
            if cell != wall {
                found(cell, Part::Floor);
            }
            s_m += CELL_M;
        }
        found(wall, Part::Wall);
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;
    use std::vec::Vec;

    use super::{DoorwayView, MOST_LOOKS, Part};
    use crate::config::{GroundTuning, UnevenGround};
    use crate::geometry::{Cell, Point, Pose};
    use crate::ground::elevation::tests::OwnedWindow;
    use crate::input::NO_RETURN_MM;
    use crate::robot::LaserMount;

    /// A plan of a room: a metre is two characters across and one line up, `#` stands. The robot is
    /// at (3.5, 1.0), in the middle, and looks north.
    const ROOM: [&str; 7] = [
        "################",
        "##............##",
        "##............##",
        "##............##",
        "######..########",
        "................",
        "................",
    ];

    /// Returns true if something stands at a point of the plan.
    fn stands(plan: &[&str; 7], x_m: f32, y_m: f32) -> bool {
        let line = plan.iter().rev().nth(y_m as usize);
        line.and_then(|line| line.as_bytes().get((2.0 * x_m) as usize)) == Some(&b'#')
    }

    const POSE: Pose = Pose {
        x_m: 3.5,
        y_m: 1.0,
        z_m: 0.0,
        roll_rad: 0.0,
        pitch_rad: 0.0,
        yaw_rad: core::f32::consts::FRAC_PI_2,
    };

    /// The level laser of these tests.
    const LASER: LaserMount = LaserMount::level(0.0, 0.45);

    /// Returns the ranges of a scan at [`POSE`].
    fn scan(plan: &[&str; 7]) -> Vec<u16> {
        let beam = |number: usize| {
            let angle = (number as f32).to_radians();
            let at = |mm: u16| f32::from(mm) * 1e-3;
            let meets = |&mm: &u16| {
                stands(
                    plan,
                    POSE.x_m + at(mm) * angle.cos(),
                    POSE.y_m + at(mm) * angle.sin(),
                )
            };
            (10..12_000).step_by(5).find(meets).unwrap_or(NO_RETURN_MM)
        };
        (0..181).map(beam).collect()
    }

    /// Returns the parts of the cells that the view finds; a wall replaces floor.
    fn seen(plan: &[&str; 7], pose: Pose, ranges_mm: &[u16]) -> BTreeMap<(i32, i32), Part> {
        let mut owned = OwnedWindow::new(pose.point().cell());
        let mut window = owned.write();
        for cell in (0..70).flat_map(|y| (0..80).map(move |x| Cell { x, y })) {
            let Point { x_m, y_m } = cell.centre();
            if stands(plan, x_m, y_m) {
                (0..2).for_each(|_| window.mark_obstacle(cell));
            }
        }
        assert!(LASER.is_level());
        let mut cells = BTreeMap::new();
        if let Some(mut view) = DoorwayView::new(
            &pose,
            &UnevenGround::TABLE_I,
            &GroundTuning::DEFAULT,
            &LASER,
            ranges_mm,
        ) {
            let mut from = 0;
            while let Some(beams) = view.next_doorway(&window.read(), from) {
                from = beams.end;
                for number in beams {
                    view.for_each_cell(number, |Cell { x, y }, part| {
                        let cell = cells.entry((x, y)).or_insert(part);
                        if part == Part::Wall {
                            *cell = part;
                        }
                    });
                }
            }
        }
        cells
    }

    #[test]
    fn the_robot_sees_a_room_from_before_its_door() {
        let cells = seen(&ROOM, POSE, &scan(&ROOM));
        let (mut floor, mut wall) = (0, 0);
        for (&(x, y), part) in &cells {
            let (x_m, y_m) = (0.1 * x as f32 + 0.05, 0.1 * y as f32 + 0.05);
            let near = [-0.1, 0.0, 0.1].into_iter();
            let mut near = near
                .clone()
                .flat_map(|dx| near.clone().map(move |dy| (dx, dy)));
            match part {
                Part::Floor => {
                    assert!(!stands(&ROOM, x_m, y_m), "({x}, {y})");
                    floor += i32::from(y >= 30);
                }
                Part::Wall => {
                    assert!(near.any(|(dx, dy)| stands(&ROOM, x_m + dx, y_m + dy)));
                    wall += 1;
                }
            }
        }
        // The wedge through a door of 1 m, 2 m before the robot, up to 5 m: (1.5 + 2.5) / 2 × 3 m²,
        // and the wall at its end.
        assert!(floor > 480, "{floor}");
        assert!(wall >= 24, "{wall}");
        // The wedge has no gaps.
        for y in 31..59 {
            let row: Vec<i32> = cells
                .keys()
                .filter(|cell| cell.1 == y)
                .map(|cell| cell.0)
                .collect();
            let wide = row.last().unwrap() - row.first().unwrap() + 1;
            assert_eq!(row.len() as i32, wide, "row {y}");
        }
    }

    #[test]
    fn no_view_without_a_doorway_and_a_room() {
        let silent = |plan: &[&str; 7], pose: Pose, ranges_mm: &[u16]| {
            assert!(seen(plan, pose, ranges_mm).is_empty());
        };
        // Nothing stands behind the gap.
        let mut open = ROOM;
        open[0] = "######....######";
        silent(&open, POSE, &scan(&open));
        // A wide opening.
        let mut wide = ROOM;
        wide[2] = "##............##";
        wide[4] = "####......######";
        silent(&wide, POSE, &scan(&wide));
        // A wall without a door.
        let mut shut = ROOM;
        shut[4] = "################";
        silent(&shut, POSE, &scan(&shut));
        // A tilted robot: its level beams end on the ground, or pass over the walls.
        let tilted = Pose {
            pitch_rad: 0.06,
            ..POSE
        };
        silent(&ROOM, tilted, &scan(&ROOM));
        // A robot tilted less: its beams come down so far that they may end on the floor.
        let leaning = Pose {
            pitch_rad: 0.045,
            ..POSE
        };
        silent(&ROOM, leaning, &scan(&ROOM));
    }
    /// Returns the looks that a view of this scan leaves, where everything stands.
    fn looks_left(ranges_mm: &[u16]) -> u32 {
        let mut owned = OwnedWindow::new(POSE.point().cell());
        let mut window = owned.write();
        for cell in (0..70).flat_map(|y| (0..80).map(move |x| Cell { x, y })) {
            (0..2).for_each(|_| window.mark_obstacle(cell));
        }
        let (ground, tuning) = (&UnevenGround::TABLE_I, &GroundTuning::DEFAULT);
        let mut view = DoorwayView::new(&POSE, ground, tuning, &LASER, ranges_mm).unwrap();
        let mut from = 0;
        while let Some(beams) = view.next_doorway(&window.read(), from) {
            from = beams.end;
        }
        view.looks
    }

    #[test]
    fn a_view_of_noise_ends_and_that_of_a_room_has_looks_to_spare() {
        assert!(looks_left(&scan(&ROOM)) > MOST_LOOKS / 2);
        // Every second beam is a jamb.
        let noise: Vec<u16> = (0..360).map(|k| 500 + k * 2 + k % 2 * 2_000).collect();
        assert_eq!(looks_left(&noise), 0);
    }
}
