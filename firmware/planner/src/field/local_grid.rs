//! What stands in the local window: 61 × 61 cells around the robot, as bit rows.
//!
//! A window cell is `scale` × `scale` map cells (1, 2 or 4): where no centre cell is near, the window grows [Jorge15,
//! III-B] by growing its cells, at the same memory and time. It is passable if any of its map cells is: passable cells
//! on the two sides of a wall are five cells apart, so no wall is lost at 20 cm. At 40 cm one would be, so there all of
//! its map cells must be passable; that closes doors, but a window of this scale is only asked for in the open.
//!
//! Invariant: `origin` is a multiple of `scale`; bit x of row y is the window cell whose least map cell is
//! origin + scale·(x, y).

use crate::field::SIDE;
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::bits::halve;
use crate::grid::{at, flood};
use crate::map::Tiles;
use crate::roadmap::configuration_space::{Footprint, Strip, for_each_strip};

/// Scales that a window may grow to.
pub const SCALES: [i32; 3] = [1, 2, 4];

/// Bit rows of the window.
pub type Rows = [u64; SIDE];

/// The bits of a row that are cells.
const INSIDE: u64 = (1 << SIDE) - 1;

/// The window's cells.
#[derive(Clone, Debug)]
pub struct LocalGrid {
    /// Least map cell.
    pub origin: Cell,
    /// Map cells along a window cell; 0 before the first look.
    pub scale: i32,
    /// The robot's centre may be here.
    pub passable: Rows,
    /// Something stands here.
    pub obstacle: Rows,
}

/// OR of adjacent groups of `scale` bits; 32 / scale bits remain.
fn squeeze(word: u32, scale: i32) -> u64 {
    let halve = |word| u32::from(halve(word));
    u64::from(match scale {
        1 => word,
        2 => halve(word),
        _ => halve(halve(word)),
    })
}

impl LocalGrid {
    /// A window of nothing: all zeros, so that a static one costs no flash.
    #[must_use]
    pub const fn new() -> Self {
        let origin = Cell { x: 0, y: 0 };
        Self {
            origin,
            scale: 0,
            passable: [0; SIDE],
            obstacle: [0; SIDE],
        }
    }

    /// See the window around `centre`.
    pub fn look_around<const TILES: usize, const SLOTS: usize>(
        &mut self,
        tiles: &Tiles<TILES, SLOTS>,
        disc: &Footprint,
        centre: Cell,
        scale: i32,
    ) {
        let half = SIDE as i32 / 2;
        let least = |at: i32| (at.div_euclid(scale) - half) * scale;
        let origin = Cell {
            x: least(centre.x),
            y: least(centre.y),
        };
        (self.origin, self.scale) = (origin, scale);
        self.passable.fill(0);
        self.obstacle.fill(0);
        let mut blocked: Rows = [0; SIDE];
        let across = SIDE as i32 * scale;
        for block in 0..(across + 31) / 32 {
            let shift = (block * 32 / scale) as u32;
            let corner = (origin.x + block * 32, origin.y);
            for_each_strip(tiles, disc, corner, across, |y, strip: Strip| {
                let row = ((y - origin.y) / scale) as usize;
                let put = |rows: &mut Rows, word: u32| {
                    if let Some(out) = rows.get_mut(row) {
                        *out |= squeeze(word, scale) << shift;
                    }
                };
                put(&mut self.passable, strip.passable);
                put(&mut self.obstacle, strip.obstacle);
                put(&mut blocked, !strip.passable);
            });
        }
        for (passable, blocked) in self.passable.iter_mut().zip(blocked) {
            *passable &= if scale == 4 {
                INSIDE & !blocked
            } else {
                INSIDE
            };
        }
        for row in &mut self.obstacle {
            *row &= INSIDE;
        }
    }

    /// The window cell of a map cell, if it is in the window.
    #[must_use]
    pub fn place(&self, cell: Cell) -> Option<(usize, usize)> {
        let x = (cell.x - self.origin.x).checked_div_euclid(self.scale)?;
        let y = (cell.y - self.origin.y).checked_div_euclid(self.scale)?;
        let inside = |at: i32| (0..SIDE as i32).contains(&at);
        (inside(x) && inside(y)).then_some((x as usize, y as usize))
    }

    /// The map cell of a window cell (its middle).
    #[must_use]
    pub const fn cell(&self, x: usize, y: usize) -> Cell {
        let middle = self.scale / 2;
        Cell {
            x: self.origin.x + x as i32 * self.scale + middle,
            y: self.origin.y + y as i32 * self.scale + middle,
        }
    }

    /// Whether a window cell is set in `rows`.
    #[must_use]
    pub fn has(rows: &Rows, (x, y): (usize, usize)) -> bool {
        rows.get(y).is_some_and(|row| row >> x & 1 == 1)
    }

    /// Set a window cell in `rows`.
    pub fn put(rows: &mut Rows, (x, y): (usize, usize)) {
        if let Some(row) = rows.get_mut(y) {
            *row |= 1 << x;
        }
    }

    /// Returns the passable cells that a path of passable cells joins to `from`, and its own;
    /// `None` if `from` lies outside the window.
    pub(crate) fn reachable(&self, from: Cell) -> Option<Rows> {
        let mut seeds: Rows = [0; SIDE];
        Self::put(&mut seeds, self.place(from)?);
        Some(flood::reach(&self.passable, &seeds))
    }

    /// Set the passable window cells of a coarse cell, whose least map cell is `least`; whether there are any.
    pub fn mark(&self, rows: &mut Rows, least: Cell) -> bool {
        let mut any = false;
        for k in 0..4 {
            let part = Cell {
                x: least.x + (k & 1),
                y: least.y + (k >> 1),
            };
            let passable = |place: &_| Self::has(&self.passable, *place);
            if let Some(place) = self.place(part).filter(passable) {
                Self::put(rows, place);
                any = true;
            }
        }
        any
    }

    /// Take a coarse cell, whose least map cell is `least`, out of what is passable.
    pub fn block(&mut self, least: Cell) {
        for k in 0..4 {
            let part = Cell {
                x: least.x + (k & 1),
                y: least.y + (k >> 1),
            };
            if let Some((x, y)) = self.place(part)
                && let Some(row) = self.passable.get_mut(y)
            {
                *row &= !(1 << x);
            }
        }
    }

    /// Keep the robot's centre off cells (their middles) by the disc, or by as much as it keeps now where that is less: so it is never shut in.
    /// Where a window cell is a map cell; in a larger one there is no telling.
    pub fn keep_off(&mut self, robot: Cell, cells: impl Iterator<Item = Point>, disc: &Footprint) {
        if self.scale != 1 {
            return;
        }
        for cell in cells.map(Point::cell) {
            let (dx, dy) = (robot.x - cell.x, robot.y - cell.y);
            self.clear_disc(cell, disc, dx * dx + dy * dy);
        }
    }

    /// Nothing in the disc around a cell, and nearer to it than the root of `near2`, is passable.
    fn clear_disc(&mut self, cell: Cell, disc: &Footprint, near2: i32) {
        let (x, y) = (cell.x - self.origin.x, cell.y - self.origin.y);
        for dy in -disc.reach()..=disc.reach() {
            let row = usize::try_from(y + dy).unwrap_or(SIDE);
            let (Some(row), Some(half)) = (self.passable.get_mut(row), disc.half_width(dy)) else {
                continue;
            };
            for dx in -half..=half {
                if dx * dx + dy * dy < near2 && (0..SIDE as i32).contains(&(x + dx)) {
                    *row &= !(1 << (x + dx));
                }
            }
        }
    }

    /// Let the robot out where its own cell is not passable (it stands nearer to something than its radius, or the map is
    /// wrong by a cell): within four cells of it, whatever does not touch an obstacle counts as passable; failing
    /// that, whatever is no obstacle.
    pub fn free_robot(&mut self, robot: Cell) {
        let Some(place) = self.place(robot) else {
            return;
        };
        if Self::has(&self.passable, place) {
            return;
        }
        let (x, y) = place;
        let columns = (0x1ff_u64 << x) >> 4;
        let touched = |rows: &Rows, row: usize| {
            let here = at(rows, row);
            let (below, above) = (at(rows, row.wrapping_sub(1)), at(rows, row + 1));
            here | here << 1 | here >> 1 | above | below
        };
        let roomy = touched(&self.obstacle, y) >> x & 1 == 0;
        let obstacle = self.obstacle;
        for (row, passable) in self.passable.iter_mut().enumerate() {
            if row.abs_diff(y) <= 4 {
                let taken = if roomy {
                    touched(&obstacle, row)
                } else {
                    at(&obstacle, row)
                };
                *passable |= columns & !taken;
            }
        }
        Self::put(&mut self.passable, place);
        for row in &mut self.passable {
            *row &= INSIDE;
        }
    }
}

impl Default for LocalGrid {
    fn default() -> Self {
        Self::new()
    }
}

/// A point in cells of the window whose least map cell and scale are given.
#[must_use]
pub fn position((origin, scale): (Cell, i32), point: Point) -> (f32, f32) {
    let side = CELL_M * scale as f32;
    let along = |at: f32, origin: i32| (at - origin as f32 * CELL_M) / side;
    (along(point.x_m, origin.x), along(point.y_m, origin.y))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::map::Class;
    use crate::roadmap::configuration_space::is_passable;

    fn room() -> Tiles<16, 64> {
        let mut tiles = Tiles::new();
        tiles.reset(8, 8);
        for y in -40..40 {
            for x in -40..40 {
                let wall = x == -30 || y == 21 || (x == 7 && y % 9 != 0);
                tiles
                    .set(
                        Cell { x, y },
                        if wall { Class::Obstacle } else { Class::Free },
                    )
                    .unwrap();
            }
        }
        tiles
    }

    #[test]
    fn the_window_at_scale_one_is_the_map() {
        let (tiles, disc) = (room(), Footprint::new(0.3));
        let mut view = LocalGrid::new();
        view.look_around(&tiles, &disc, Cell { x: 3, y: -2 }, 1);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let cell = view.cell(x, y);
                assert_eq!(view.place(cell), Some((x, y)));
                assert_eq!(
                    LocalGrid::has(&view.passable, (x, y)),
                    is_passable(&tiles, &disc, cell)
                );
                assert_eq!(
                    LocalGrid::has(&view.obstacle, (x, y)),
                    tiles.class(cell) == Class::Obstacle
                );
            }
        }
    }

    #[test]
    fn a_grown_window_is_passable_where_any_of_its_cells_is() {
        let (tiles, disc) = (room(), Footprint::new(0.3));
        for scale in [2, 4] {
            let mut view = LocalGrid::new();
            view.look_around(&tiles, &disc, Cell { x: -5, y: 9 }, scale);
            for y in 0..SIDE {
                for x in 0..SIDE {
                    let least = Cell {
                        x: view.origin.x + x as i32 * scale,
                        y: view.origin.y + y as i32 * scale,
                    };
                    let (mut any, mut all) = (false, true);
                    for k in 0..scale * scale {
                        let cell = Cell {
                            x: least.x + k % scale,
                            y: least.y + k / scale,
                        };
                        let passable = is_passable(&tiles, &disc, cell);
                        any |= passable;
                        all &= passable;
                    }
                    let wanted = if scale < 4 { any } else { all };
                    assert_eq!(
                        LocalGrid::has(&view.passable, (x, y)),
                        wanted,
                        "scale {scale} ({x}, {y})"
                    );
                }
            }
        }
    }

    /// GroundModel a cell to be kept off, and a robot that stands nearer to another one than that.
    #[test]
    fn the_centre_is_kept_off_cells_but_never_shut_in() {
        let (tiles, disc) = (room(), Footprint::new(0.3));
        let robot = Cell { x: -10, y: 0 };
        let mut view = LocalGrid::new();
        view.look_around(&tiles, &disc, robot, 1);
        let before = view.passable;
        let (far, near) = (Cell { x: -16, y: 1 }, Cell { x: -10, y: 2 });
        view.keep_off(robot, [far, near].map(Cell::centre).into_iter(), &disc);
        for (y, row) in before.iter().enumerate() {
            for x in 0..SIDE {
                let cell = view.cell(x, y);
                let within = |of: Cell, most2: i32| {
                    let (dx, dy) = (cell.x - of.x, cell.y - of.y);
                    dx * dx + dy * dy < most2
                };
                let kept = within(far, 9) || within(near, 4);
                let wanted = row >> x & 1 == 1 && !kept;
                assert_eq!(LocalGrid::has(&view.passable, (x, y)), wanted, "{cell:?}");
            }
        }
        let place = view.place(robot).expect("the middle");
        assert!(
            LocalGrid::has(&view.passable, place),
            "it stands 2 cells off"
        );
    }

    #[test]
    fn a_robot_too_near_to_a_wall_is_let_out() {
        let (tiles, disc) = (room(), Footprint::new(0.3));
        let robot = Cell { x: -28, y: 0 };
        let mut view = LocalGrid::new();
        view.look_around(&tiles, &disc, robot, 1);
        let place = view.place(robot).unwrap();
        assert!(!LocalGrid::has(&view.passable, place));
        view.free_robot(robot);
        assert!(LocalGrid::has(&view.passable, place));
        assert!(
            !LocalGrid::has(&view.passable, (place.0 - 2, place.1)),
            "not into the wall"
        );
    }
}
