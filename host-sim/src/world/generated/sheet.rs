//! The sheet of a generated plan: shapes in the plan's own frame, which may be turned against the
//! grid, and the ragged edges of a scanned map.
//!
//! Plan frame: origin at the lower left corner of the building, metres. The building stands in the
//! middle of the grid; what lies around it is unknown. Only sums, products, comparisons and `libm`
//! are used: the same drawing has the same cells on every machine.

use super::dice::Dice;
use crate::world::canvas::Canvas;
use crate::world::occupancy::{Class, GridCell, Occupancy};

/// Most angle between a turned plan and the grid, radians; less in a long plan, because the turned
/// building must fit into the grid.
const MOST_TURN_RAD: f64 = 0.22;
/// Distance from the edge of a door within which edges stay straight, metres.
const STRAIGHT_M: f64 = 0.3;

/// A door of a plan.
#[derive(Clone, Copy, Debug)]
pub(super) struct Door {
    /// Its middle. Plan frame; world frame in a finished [`Drawing`].
    pub(super) middle: [f64; 2],
    /// Unit vector along its wall.
    pub(super) along: [f64; 2],
    /// Free width, metres.
    pub(super) width_m: f64,
}

impl Door {
    /// True if a point is at most `reach_m` from the middle.
    pub(super) fn is_near(&self, point: [f64; 2], reach_m: f64) -> bool {
        squared(point, self.middle) < reach_m * reach_m
    }
}

/// A finished drawing.
#[derive(Clone, Debug)]
pub(super) struct Drawing {
    /// The cells.
    pub(super) plan: Occupancy,
    /// The doors, in the world's frame.
    pub(super) doors: Vec<Door>,
}

/// The sheet being drawn on.
pub(super) struct Sheet {
    canvas: Canvas,
    size_m: [f64; 2],
    /// Cosine and sine of the angle from the grid to the plan.
    turn: [f64; 2],
    doors: Vec<Door>,
}

impl Sheet {
    /// A building that fills a grid of this size, without an angle to it: solid wall.
    pub(super) fn straight(size_m: [f64; 2]) -> Self {
        Self::new(size_m, size_m, [1.0, 0.0])
    }

    /// A building in a grid of this size, turned in every other seed: solid wall.
    pub(super) fn maybe_turned(dice: &mut Dice, grid_m: [f64; 2]) -> Self {
        if dice.chance(0.5) {
            return Self::straight(grid_m);
        }
        let [w, h] = grid_m;
        let turn = dice.turn(MOST_TURN_RAD * (w / h).min(h / w));
        let [cos, sin] = turn.map(f64::abs);
        let scale = (w / (w * cos + h * sin)).min(h / (w * sin + h * cos));
        Self::new(grid_m, [w * scale, h * scale], turn)
    }

    fn new(grid_m: [f64; 2], size_m: [f64; 2], turn: [f64; 2]) -> Self {
        let mut sheet = Self {
            canvas: Canvas::new(grid_m[0], grid_m[1], Class::Unknown),
            size_m,
            turn,
            doors: Vec::new(),
        };
        sheet.rect(Class::Wall, [0.0, 0.0, size_m[0], size_m[1]]);
        sheet
    }

    /// Width and height of the building, metres.
    pub(super) fn size_m(&self) -> [f64; 2] {
        self.size_m
    }

    /// The doors so far, in the plan's frame.
    pub(super) fn doors(&self) -> &[Door] {
        &self.doors
    }

    /// Fills the cells in a rectangle of the plan whose centre satisfies `inside`.
    pub(super) fn fill(
        &mut self,
        class: Class,
        [x0, y0, x1, y1]: [f64; 4],
        inside: impl Fn([f64; 2]) -> bool,
    ) {
        let corners = [[x0, y0], [x0, y1], [x1, y0], [x1, y1]].map(|corner| self.to_grid(corner));
        let bound = |axis: usize, pick: fn(f64, f64) -> f64| {
            corners[1..]
                .iter()
                .fold(corners[0][axis], |m, c| pick(m, c[axis]))
        };
        let bounds = [
            bound(0, f64::min),
            bound(1, f64::min),
            bound(0, f64::max),
            bound(1, f64::max),
        ];
        let (turn, origin) = (self.turn, self.to_plan([0.0, 0.0]));
        self.canvas.fill_within(class, bounds, |x, y| {
            let [dx, dy] = turned([x, y], [turn[0], -turn[1]]);
            let (px, py) = (origin[0] + dx, origin[1] + dy);
            px >= x0 && px < x1 && py >= y0 && py < y1 && inside([px, py])
        });
    }

    /// Fills a rectangle of the plan, from (x0, y0) to (x1, y1).
    pub(super) fn rect(&mut self, class: Class, corners: [f64; 4]) {
        self.fill(class, corners, |_| true);
    }

    /// Fills a rectangle around a centre, `2 half[0]` long in the direction of unit vector `along`.
    pub(super) fn slab(
        &mut self,
        class: Class,
        centre: [f64; 2],
        half: [f64; 2],
        [ux, uy]: [f64; 2],
    ) {
        self.fill(class, around(centre, half[0] + half[1]), |[x, y]| {
            let (dx, dy) = (x - centre[0], y - centre[1]);
            (dx * ux + dy * uy).abs() < half[0] && (dy * ux - dx * uy).abs() < half[1]
        });
    }

    /// Fills a disc.
    pub(super) fn disc(&mut self, class: Class, centre: [f64; 2], radius_m: f64) {
        self.fill(class, around(centre, radius_m), |point| {
            squared(point, centre) < radius_m * radius_m
        });
    }

    /// Puts a post of one cell: the leg of a chair or a table.
    pub(super) fn post(&mut self, point: [f64; 2]) {
        let point = self.to_grid(point);
        self.canvas.dot(Class::Wall, point);
    }

    /// Opens a door through a wall of `thickness_m`.
    pub(super) fn door(&mut self, door: Door, thickness_m: f64) {
        // Plans without an angle have their walls on whole cells; the margin decides nothing there.
        let half = [door.width_m / 2.0, thickness_m / 2.0 + 1e-6];
        self.slab(Class::Free, door.middle, half, door.along);
        self.doors.push(door);
    }

    /// Moves edges by one cell, in or out, each with probability `share`, as in a scanned map. A
    /// wall of less than three cells gets no hole, and edges near doors stay straight.
    pub(super) fn finish(self, dice: &mut Dice, share: f64) -> Drawing {
        let doors = self.doors.iter().map(|door| Door {
            middle: self.to_grid(door.middle),
            along: turned(door.along, self.turn),
            ..*door
        });
        let doors: Vec<Door> = doors.collect();
        let plan = ragged(self.canvas.finish(), &doors, || dice.chance(share));
        Drawing { plan, doors }
    }

    fn to_grid(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let centre = self.canvas.size_m().map(|m| m / 2.0);
        let from_middle = [x - self.size_m[0] / 2.0, y - self.size_m[1] / 2.0];
        let [dx, dy] = turned(from_middle, self.turn);
        [centre[0] + dx, centre[1] + dy]
    }

    fn to_plan(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let centre = self.canvas.size_m().map(|m| m / 2.0);
        let [dx, dy] = turned(
            [x - centre[0], y - centre[1]],
            [self.turn[0], -self.turn[1]],
        );
        [self.size_m[0] / 2.0 + dx, self.size_m[1] / 2.0 + dy]
    }
}

/// Returns the square around a point.
pub(super) fn around([x, y]: [f64; 2], reach_m: f64) -> [f64; 4] {
    [x - reach_m, y - reach_m, x + reach_m, y + reach_m]
}

/// Returns the squared distance of two points.
pub(super) fn squared(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1])
}

fn turned([x, y]: [f64; 2], [cos, sin]: [f64; 2]) -> [f64; 2] {
    [x * cos - y * sin, x * sin + y * cos]
}

/// Moves edges; `happens` is asked once for each edge.
fn ragged(plan: Occupancy, doors: &[Door], mut happens: impl FnMut() -> bool) -> Occupancy {
    let mut changed = plan.clone();
    for j in 1..plan.height() as i64 - 1 {
        for i in 1..plan.width() as i64 - 1 {
            let cell = GridCell { i, j };
            let class = plan.class(cell);
            let at = |di, dj| {
                plan.class(GridCell {
                    i: i + di,
                    j: j + dj,
                })
            };
            let sides = [(1, 0), (-1, 0), (0, 1), (0, -1)];
            let to = match class {
                // Two solid cells behind it, so that no hole appears.
                Class::Wall => sides
                    .iter()
                    .any(|&(x, y)| {
                        at(x, y) == Class::Free
                            && at(-x, -y) != Class::Free
                            && at(-2 * x, -2 * y) != Class::Free
                    })
                    .then_some(Class::Free),
                Class::Free => sides
                    .iter()
                    .any(|&(x, y)| at(x, y) == Class::Wall && at(-x, -y) == Class::Free)
                    .then_some(Class::Wall),
                Class::Unknown => None,
            };
            let Some(to) = to else { continue };
            let centre = plan.centre(cell);
            let straight = doors
                .iter()
                .any(|door| door.is_near(centre, door.width_m / 2.0 + STRAIGHT_M));
            if happens() && !straight {
                changed.set(cell, to);
            }
        }
    }
    changed
}
