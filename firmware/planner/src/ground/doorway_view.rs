//! Rooms: what the level laser sees through a doorway [Maffei20, IV, scenario 3].
//!
//! ```text
//!      room             beams between the jambs J all end on something that stands
//!   ___J     J___       |J J| at most MAX_DOORWAY_M, both near and standing
//!        \ /            then what they cross is floor, and what they end on is wall
//!       robot
//! ```
//!
//! The tilted laser measures ground where it meets it, 1.4 m ahead; the floor of a room it meets only from inside. The paper's robot does not go in,
//! for it senses the interior from the door. So there, and nowhere else, level beams say what they say in the plane: a room's floor is taken to go
//! on as the ground before its door does. Over open ground they pass over holes and end on slopes, so they say nothing of it; this is why the
//! doorway must be narrow, and every beam through it must end higher over the robot's ground than `h_obs`. Whoever goes in nevertheless has
//! the tilted laser ahead of him, and what that measures counts for more.
//!
//! Units: metres; ranges in millimetres; beams by their number in the sweep.

use core::ops::Range;

use crate::config::UnevenGround;
use crate::geometry::{CELL_M, Cell, Point, Pose};
use crate::ground::elevation::Heights;
use crate::ground::ray::{Attitude, Mount, Ray};
use crate::math;
use crate::robot::LaserMount;

/// Widest doorway, metres.
const MAX_DOORWAY_M: f32 = 2.0;
/// Narrowest one, metres: through a gap there is too little to be seen.
const MIN_DOORWAY_M: f32 = 0.6;
/// A jamb ends a beam nearer than the beam beside it, by this, millimetres.
const JAMB_STEP_MM: u16 = 100;
/// Everything through the doorway ends behind its threshold by this, metres.
const RECESS_M: f32 = 0.08;
/// And something by this: less is a niche.
const MIN_DEPTH_M: f32 = 1.0;
/// Jambs are nearer than this, millimetres: in the window of heights.
const MAX_JAMB_MM: u16 = 3_000;
/// The robot is_tilted less than this, a tangent.
const MAX_TILT: f32 = 0.05;
/// What stands begins at a beam's end and is marked so much behind, metres.
const BEHIND_M: f32 = 0.03;
/// Ends of beams side by side belong to one wall if they are nearer to each other than this, metres.
const ONE_WALL_M: f32 = 0.7;
/// From one beam between them to the next, at their ends, metres.
const STRIDE_M: f32 = 0.5 * CELL_M;

/// What a room's cell is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Part {
    /// A beam crossed it.
    Floor,
    /// A beam ended in it.
    Wall,
}

/// A view with the level laser.
#[derive(Debug)]
pub struct DoorwayView<'a> {
    attitude: Attitude,
    mount: Mount<'a>,
    /// Height of the ground that the robot stands on, metres.
    ground_m: f32,
    ground: &'a UnevenGround,
    laser: &'a LaserMount,
    ranges_mm: &'a [u16],
}

impl<'a> DoorwayView<'a> {
    /// A view from a pose; `None` if the robot is_tilted.
    #[must_use]
    pub fn new(
        pose: &Pose,
        ground: &'a UnevenGround,
        laser: &'a LaserMount,
        ranges_mm: &'a [u16],
    ) -> Option<Self> {
        let attitude = Attitude::of(pose);
        let is_tilted = [(1.0, 0.0), (0.0, 1.0)]
            .into_iter()
            .any(|(x, y)| attitude.rise(x, y).abs() > MAX_TILT);
        (!is_tilted).then(|| Self {
            attitude,
            mount: Mount::new(&attitude, laser),
            ground_m: pose.z_m,
            ground,
            laser,
            ranges_mm,
        })
    }

    fn range(&self, number: usize) -> Option<u16> {
        let range = *self.ranges_mm.get(number)?;
        (range != 0 && range < self.laser.range_limit_mm).then_some(range)
    }

    fn ray(&self, number: usize) -> Option<Ray> {
        let range_m = f32::from(self.range(number)?) * 1e-3;
        self.attitude.ray(&self.mount, number, range_m)
    }

    /// The beams through the first doorway whose one jamb is a beam or one behind it.
    #[must_use]
    pub fn next_doorway(&self, heights: &Heights<'_>, from: usize) -> Option<Range<usize>> {
        let last = self.ranges_mm.len();
        (from..last)
            .filter(|&left| self.is_jamb(left, left + 1))
            .find_map(|left| {
                // Beyond a beam that met nothing there is no room.
                let mut beyond = (left + 1..last).take_while(|&k| self.range(k).is_some());
                let right = beyond.find(|&right| {
                    self.is_jamb(right, right - 1) && self.is_doorway(heights, left, right)
                })?;
                Some(left + 1..right)
            })
    }

    /// Whether a beam ends near, and nearer than the one beside it.
    fn is_jamb(&self, jamb: usize, beside: usize) -> bool {
        match (self.range(jamb), self.range(beside)) {
            (Some(jamb), Some(beside)) => jamb < MAX_JAMB_MM && beside > jamb + JAMB_STEP_MM,
            _ => false,
        }
    }

    /// Whether two ends are the jambs of a doorway, and everything seen through it stands.
    fn is_doorway(&self, heights: &Heights<'_>, left: usize, right: usize) -> bool {
        let (Some(a), Some(b)) = (self.ray(left), self.ray(right)) else {
            return false;
        };
        let [from, to] = [&a, &b].map(|ray| ray.at(ray.length_m));
        let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
        let width_m = math::sqrt(dx * dx + dy * dy);
        let stands = |ray: &Ray| heights.is_obstacle(wall(ray));
        if !(MIN_DOORWAY_M..=MAX_DOORWAY_M).contains(&width_m) || !stands(&a) || !stands(&b) {
            return false;
        }
        // How far behind the threshold a point lies. Bearings grow counter-clockwise, so the second jamb is the left one.
        let behind_m =
            |point: Point| (dy * (point.x_m - from.x_m) - dx * (point.y_m - from.y_m)) / width_m;
        let mut deepest_m = 0.0_f32;
        let all = (left + 1..right).all(|k| {
            self.ray(k).is_some_and(|ray| {
                let depth_m = behind_m(ray.at(ray.length_m));
                deepest_m = deepest_m.max(depth_m);
                let over_m = ray.height_m(ray.length_m) - self.ground_m;
                depth_m > RECESS_M && over_m > self.ground.obstacle_m
            })
        });
        all && deepest_m > MIN_DEPTH_M
    }

    /// The cell that a beam ends in.
    #[must_use]
    pub fn end_cell(&self, number: usize) -> Option<Cell> {
        self.ray(number).map(|ray| wall(&ray))
    }

    /// Tell of what a beam sees, and of the space between it and the one before: they are farther apart than cells are wide, most of all
    /// where a wall runs along them. A cell may be told of more than once, and as both.
    pub fn for_each_cell(&self, number: usize, mut found: impl FnMut(Cell, Part)) {
        let Some(ray) = self.ray(number) else {
            return;
        };
        if let Some(before) = number.checked_sub(1).and_then(|before| self.ray(before)) {
            cells_between(&before, &ray, &mut found);
        }
        cells_of_ray(&ray, 0.0, &mut found);
    }
}

fn wall(ray: &Ray) -> Cell {
    ray.at(ray.length_m + BEHIND_M).cell()
}

/// Beams between two side by side, if these end on one wall: to points on the line between their ends.
fn cells_between(one: &Ray, other: &Ray, found: &mut impl FnMut(Cell, Part)) {
    let [from, to] = [one, other].map(|ray| ray.at(ray.length_m));
    let (dx, dy) = (to.x_m - from.x_m, to.y_m - from.y_m);
    let apart_m = math::sqrt(dx * dx + dy * dy);
    if apart_m > ONE_WALL_M {
        return;
    }
    let count = math::floor(apart_m / STRIDE_M);
    // So far the two themselves cross all there is between them.
    let (ux, uy) = one.along;
    let (vx, vy) = other.along;
    let parting = (ux * vy - uy * vx).abs();
    let from_m = one
        .length_m
        .min(other.length_m)
        .min(STRIDE_M / parting.max(1e-3));
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
            cells_of_ray(&ray, from_m, found);
        }
    }
}

/// A beam from a length on.
fn cells_of_ray(ray: &Ray, from_m: f32, found: &mut impl FnMut(Cell, Part)) {
    let wall = wall(ray);
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

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::collections::BTreeMap;
    use std::vec::Vec;

    use super::{DoorwayView, Part};
    use crate::config::UnevenGround;
    use crate::geometry::{Cell, Point, Pose};
    use crate::ground::elevation::{Elevation, WINDOW_CELLS};
    use crate::input::NO_RETURN_MM;
    use crate::robot::LaserMount;
    use crate::robot::is_level;

    /// A metre is two characters across and one line up; `#` stands. The robot is at (4, 1.5), in the middle, and looks north.
    const ROOM: [&str; 7] = [
        "################",
        "##............##",
        "##............##",
        "##............##",
        "######..########",
        "................",
        "................",
    ];

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

    fn laser() -> LaserMount {
        LaserMount {
            x_m: 0.0,
            y_m: 0.0,
            z_m: 0.45,
            pitch_rad: 0.0,
            first_bearing_rad: -core::f32::consts::FRAC_PI_2,
            bearing_step_rad: core::f32::consts::PI / 180.0,
            beams: 181,
            range_limit_mm: 12_000,
        }
    }

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

    /// What is told of the cells, with walls before floor.
    fn seen(plan: &[&str; 7], pose: Pose, ranges_mm: &[u16]) -> BTreeMap<(i32, i32), Part> {
        let (mut heights, mut marks) = (std::vec![0; 2 * WINDOW_CELLS], std::vec![0; WINDOW_CELLS]);
        let mut origin = Cell::default();
        let mut window = Elevation::new(&mut heights, &mut marks, &mut origin);
        window.follow(pose.point().cell());
        for cell in (0..70).flat_map(|y| (0..80).map(move |x| Cell { x, y })) {
            let Point { x_m, y_m } = cell.centre();
            if stands(plan, x_m, y_m) {
                (0..2).for_each(|_| window.mark_obstacle(cell));
            }
        }
        let (ground, laser) = (UnevenGround::TABLE_I, Box::new(laser()));
        assert!(is_level(&laser));
        let mut cells = BTreeMap::new();
        if let Some(view) = DoorwayView::new(&pose, &ground, &laser, ranges_mm) {
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
    fn a_room_is_known_from_before_its_door() {
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
        // The wedge through a door of 1 m, 2 m before the robot, up to 5 m: (1.5 + 2.5) / 2 × 3 m², and the wall at its end.
        assert!(floor > 480, "{floor}");
        assert!(wall >= 24, "{wall}");
        // Without gaps: every floor cell's neighbour in the wedge is told of as well.
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
    fn what_is_no_room_says_nothing() {
        let silent = |plan: &[&str; 7], pose: Pose, ranges_mm: &[u16]| {
            assert!(seen(plan, pose, ranges_mm).is_empty());
        };
        // Nothing behind the gap.
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
        // A robot that is_tilted: its level beams end on the ground, or over the walls.
        let is_tilted = Pose {
            pitch_rad: 0.06,
            ..POSE
        };
        silent(&ROOM, is_tilted, &scan(&ROOM));
        // One that is_tilted less, whose beams come down so far that they may end on the floor.
        let stoops = Pose {
            pitch_rad: 0.045,
            ..POSE
        };
        silent(&ROOM, stoops, &scan(&ROOM));
    }
}
