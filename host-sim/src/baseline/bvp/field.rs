//! The potential over the whole known grid \[Prestes02\]: p = 1 on obstacles, p = 0 in every
//! unexplored cell, ∇²p = 0 in between. It is solved for q = 1 − p, so that far cells stay precise.
//!
//! A goal holds q = 2^1000. This changes nothing, because the equation is homogeneous, and leaves
//! 2074 binary orders of magnitude below it in f64.
//!
//! Departs from \[Prestes02\]: the paper relaxes p itself. There, all cells whose 1 − p is below
//! the rounding of 1 are flat, which in a real building is most of them. The baseline can only
//! gain.
//!
//! With preferences ([`Field::prefer`]) the equation is \[Maffei20, eq. 2\], |ε| ≤ 2.
//!
//! Units: cells of the chart; headings in radians, counter-clockwise from x.

use fieldline_planner::config::KERNEL_CELLS;
use fieldline_planner::geometry::{Cell, Point};

use super::boundary::{Boundary, Kind};
use super::multigrid::Multigrid;
use crate::baseline::chart::Chart;
use crate::baseline::slope;

/// q of a goal: 2^1000.
pub(super) const GOAL: f64 = f64::from_bits((1023 + 1000) << 52);

/// The field: a boundary and the solution for it.
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    boundary: Boundary,
    solver: Multigrid,
}

impl Field {
    /// Takes the boundary from the chart. Cells that were free before keep their q. Unexplored
    /// cells for which `is_goal` is false are free.
    pub(super) fn charge(&mut self, chart: &Chart, robot: Cell, is_goal: impl Fn(Cell) -> bool) {
        let boundary = Boundary::new(chart, robot, is_goal);
        if boundary == self.boundary {
            return;
        }
        let mut solver = Multigrid::new(boundary.nodes(), boundary.places(), GOAL);
        for (node, cell) in boundary.cells().enumerate() {
            if let Some(before) = self.value(cell) {
                solver.set(node, before);
            }
        }
        solver.updates = self.solver.updates;
        *self = Self { boundary, solver };
    }

    /// Sets the preference ε of every free cell.
    pub(super) fn prefer(&mut self, epsilon: impl Fn(Cell) -> f32) {
        self.solver
            .prefer(self.boundary.cells().map(epsilon).collect());
    }

    /// Returns the mean of |p − p(robot)| over the free cells of the kernel around the robot that
    /// have a path to a goal ([`fieldline_planner::field::preference`]); `None` if the robot has
    /// none.
    pub(super) fn p_diff(&self, robot: Cell) -> Option<f64> {
        let here = self.value(robot)?;
        let half = KERNEL_CELLS as i32 / 2;
        let (mut sum, mut count) = (0.0, 0.0);
        for (dx, dy) in (-half..half).flat_map(|dy| (-half..half).map(move |dx| (dx, dy))) {
            let near = Cell {
                x: robot.x + dx,
                y: robot.y + dy,
            };
            if let Some(q) = self.value(near).filter(|_| (dx, dy) != (0, 0)) {
                sum += (q - here).abs() / GOAL;
                count += 1.0;
            }
        }
        Some(if count > 0.0 { sum / count } else { 0.0 })
    }

    /// Returns true if the robot can reach an unexplored cell.
    pub(super) const fn has_goals(&self) -> bool {
        self.boundary.has_goals()
    }

    /// Runs one cycle of the solver.
    pub(super) fn cycle(&mut self) {
        self.solver.cycle();
    }

    /// Returns the number of unknowns.
    pub(super) fn cells(&self) -> usize {
        self.boundary.len()
    }

    /// Returns the number of cell updates so far.
    pub(super) const fn updates(&self) -> u64 {
        self.solver.updates
    }

    /// Returns the role of a cell.
    pub(super) fn kind(&self, cell: Cell) -> Kind {
        self.boundary.kind(cell)
    }

    /// Returns q of a cell: 0 on obstacles and outside.
    pub(super) fn q(&self, cell: Cell) -> f64 {
        let index = self.boundary.area.index(cell);
        index.map_or(0.0, |index| self.at(index))
    }

    /// Returns q of a free cell, if it is above 0.
    fn value(&self, cell: Cell) -> Option<f64> {
        match self.kind(cell) {
            Kind::Free(node) => Some(self.solver.values()[node as usize]).filter(|q| *q > 0.0),
            _ => None,
        }
    }

    /// Returns q of a cell by its index.
    fn at(&self, index: usize) -> f64 {
        match self.boundary.at(index) {
            Kind::Obstacle => 0.0,
            Kind::Goal => GOAL,
            Kind::Free(node) => self.solver.values()[node as usize],
        }
    }

    /// Returns the heading of −∇p at a point of a free cell, interpolated between cell centres;
    /// `None` where p is flat.
    pub(super) fn heading_at(&self, point: Point) -> Option<f32> {
        slope::heading(point, |cell| self.gradient(cell))
    }

    /// Returns 2 ∇q at the centre of a free cell.
    fn gradient(&self, cell: Cell) -> Option<(f64, f64)> {
        let area = &self.boundary.area;
        let index = area.index(cell)?;
        let Kind::Free(_) = self.boundary.at(index) else {
            return None;
        };
        let [east, north, west, south] = area.four(index).map(|near| self.at(near));
        Some((east - west, north - south))
    }

    /// Follows the steepest descent of p from a free cell, cell by cell. Returns the goal at its
    /// end and its length in cells; `None` if it ends in a local minimum (before convergence) or
    /// where p is flat.
    pub(super) fn descend(&self, from: Cell) -> Option<(Cell, u32)> {
        let area = &self.boundary.area;
        let mut index = area.index(from)?;
        for steps in 0..area.len() as u32 {
            match self.boundary.at(index) {
                Kind::Goal => return Some((area.cell(index), steps)),
                Kind::Obstacle => return None,
                Kind::Free(_) => {}
            }
            let near = area.four(index).into_iter();
            let best = near.max_by(|&a, &b| self.at(a).total_cmp(&self.at(b)))?;
            if self.at(best) <= self.at(index) {
                return None;
            }
            index = best;
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::{Field, GOAL, Kind};
    use crate::baseline::chart::sketch::chart;
    use fieldline_planner::geometry::{Cell, Point};

    const ROOMS: [&str; 17] = [
        "##################################",
        "#..............#.................#",
        "#..............#.................#",
        "#................................?",
        "#..............#.................?",
        "#..............#.................#",
        "######..########.................#",
        "#..............#.....#####.......#",
        "#..............#.....#...#.......#",
        "#.......R......#.....#...#.......#",
        "#....................#...#.......#",
        "#..............#.....##.##.......#",
        "#..............#.................#",
        "###.############.................#",
        "#..#.............................#",
        "#..#.............................#",
        "##################################",
    ];

    fn solved(rows: &[&str], cycles: u32) -> (Field, Point) {
        let (chart, robot) = chart(rows);
        let mut field = Field::default();
        field.charge(&chart, robot.cell(), |_| true);
        (0..cycles).for_each(|_| field.cycle());
        (field, robot)
    }

    fn cells(field: &Field) -> Vec<Cell> {
        field.boundary.cells().collect()
    }

    /// Returns the greatest relative change that one more relaxation of any cell would make.
    fn residual(field: &Field) -> f64 {
        let one = |cell: Cell| {
            let near = [(1, 0), (0, 1), (-1, 0), (0, -1)];
            let sum: f64 = near
                .into_iter()
                .map(|(dx, dy)| {
                    field.q(Cell {
                        x: cell.x + dx,
                        y: cell.y + dy,
                    })
                })
                .sum();
            (sum / 4.0 / field.q(cell) - 1.0).abs()
        };
        cells(field).into_iter().map(one).fold(0.0, f64::max)
    }

    #[test]
    fn it_converges_to_the_harmonic_field_in_a_few_cycles() {
        let (field, _) = solved(&ROOMS, 12);
        assert!(field.cells() > 300);
        assert!(residual(&field) < 1e-3, "{:e}", residual(&field));
        let (field, _) = solved(&ROOMS, 60);
        assert!(residual(&field) < 1e-12, "{:e}", residual(&field));
    }

    /// Does the same for the equation with these preferences.
    fn residual_with(field: &Field, epsilon: impl Fn(Cell) -> f32) -> f64 {
        let one = |cell: Cell| {
            let q = |dx: i32, dy: i32| {
                let near = Cell {
                    x: cell.x + dx,
                    y: cell.y + dy,
                };
                field.q(near)
            };
            let ([east, west], [north, south]) = ([q(1, 0), q(-1, 0)], [q(0, 1), q(0, -1)]);
            let tilt = (east - west).abs() + (north - south).abs();
            let sum = east + west + north + south + 0.5 * f64::from(epsilon(cell)) * tilt;
            (sum / 4.0 / field.q(cell) - 1.0).abs()
        };
        cells(field).into_iter().map(one).fold(0.0, f64::max)
    }

    #[test]
    fn with_preferences_it_converges_to_their_equation() {
        let (chart, robot) = chart(&ROOMS);
        let level = |_: Cell| 0.5;
        let mixed = |cell: Cell| ((cell.x * 7 + cell.y * 13) % 11 - 5) as f32 / 10.0;
        let banded = |cell: Cell| if cell.x % 8 < 4 { -0.5 } else { 0.1 };
        let firm = |cell: Cell| if cell.x % 8 < 4 { -1.0 } else { 1.0 };
        let strong = |cell: Cell| if cell.x % 8 < 4 { -1.5 } else { 1.5 };
        let check = |epsilon: &dyn Fn(Cell) -> f32, cycles: u32, most: f64| {
            let mut field = Field::default();
            field.charge(&chart, robot.cell(), |_| true);
            field.prefer(epsilon);
            (0..cycles).for_each(|_| field.cycle());
            let residual = residual_with(&field, epsilon);
            assert!(residual < most, "{residual:e}");
            for cell in cells(&field) {
                assert!(field.q(cell) > 0.0 && field.q(cell) < GOAL);
                assert!(field.descend(cell).is_some(), "no local minimum");
            }
        };
        check(&|_| 0.0, 60, 1e-12);
        check(&level, 60, 1e-9);
        check(&mixed, 60, 1e-9);
        check(&banded, 60, 1e-9);
        check(&firm, 60, 1e-9);
        check(&strong, 200, 1e-3);
        check(&mixed, 12, 1e-2);
    }

    /// In a corridor one cell wide only its own cells have q above 0.
    #[test]
    fn p_diff_is_the_mean_over_the_kernel() {
        let wall = "#".repeat(42);
        let corridor = format!("#{}R{}?", ".".repeat(19), ".".repeat(20));
        let (field, robot) = solved(&[&wall, &corridor, &wall], 60);
        let home = robot.cell();
        let q = |dx: i32| {
            field.q(Cell {
                x: home.x + dx,
                y: home.y,
            }) / GOAL
        };
        let sum: f64 = (-10..10).map(|dx| (q(dx) - q(0)).abs()).sum();
        let p_diff = field.p_diff(home).expect("a path");
        assert!((p_diff / (sum / 19.0) - 1.0).abs() < 1e-12);
        assert_eq!(field.p_diff(Cell { x: 0, y: 0 }), None);
    }

    #[test]
    fn from_every_cell_the_descent_ends_in_a_goal() {
        let (field, _) = solved(&ROOMS, 12);
        for cell in cells(&field) {
            let (goal, steps) = field.descend(cell).expect("no local minimum");
            assert_eq!((field.kind(goal), field.q(goal)), (Kind::Goal, GOAL));
            assert!(steps >= (goal.x - cell.x).unsigned_abs());
        }
    }

    /// With a goal of 1, q would have no slope at the far end: it falls by 2 − √3 per cell, to
    /// 1e-343.
    #[test]
    fn a_corridor_of_sixty_metres_is_nowhere_flat() {
        let wall = "#".repeat(602);
        let corridor = format!("#R{}?", ".".repeat(599));
        let (field, robot) = solved(&[&wall, &corridor, &wall], 40);
        let (far, next) = (robot.cell(), Cell { x: 2, y: 1 });
        assert!(field.q(far) / GOAL == 0.0 && field.q(far) > 0.0);
        // At the closed end q₁ = q₂ / 4.
        assert!((field.q(far) / field.q(next) - 0.25).abs() < 1e-9);
        let (five, six) = (Cell { x: 50, y: 1 }, Cell { x: 51, y: 1 });
        let ratio = field.q(five) / field.q(six);
        assert!((ratio - (2.0 - 3.0_f64.sqrt())).abs() < 1e-9, "{ratio}");
        assert!(field.heading_at(robot).unwrap().abs() < 1e-6);
    }

    #[test]
    fn a_warm_start_needs_fewer_cycles_than_a_cold_one() {
        let (chart, robot) = chart(&ROOMS);
        let (mut field, _) = solved(&ROOMS, 30);
        // One of the two goals is dropped. It becomes a free cell, and all others keep their q.
        let upper = Cell { x: 33, y: 13 };
        field.charge(&chart, robot.cell(), |cell| cell != upper);
        assert_eq!(field.kind(Cell { x: 33, y: 12 }), Kind::Goal);
        let cycles = |mut field: Field| {
            let mut count = 0;
            while residual(&field) > 1e-6 {
                field.cycle();
                count += 1;
            }
            count
        };
        let mut cold = Field::default();
        cold.charge(&chart, robot.cell(), |cell| cell != upper);
        let (warm, cold) = (cycles(field), cycles(cold));
        assert!(warm < cold, "{warm} {cold}");
    }

    #[test]
    fn unreachable_cells_are_no_part_of_it() {
        let (field, robot) = solved(&["#######", "#R.#.?#", "#######"], 1);
        assert!(!field.has_goals() && field.cells() == 2);
        assert_eq!(field.kind(Cell { x: 5, y: 1 }), Kind::Obstacle);
        assert_eq!(field.heading_at(robot), None);
        assert_eq!(field.descend(robot.cell()), None);
    }
}
