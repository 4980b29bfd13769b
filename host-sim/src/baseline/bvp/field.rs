//! The potential over the whole known grid [Prestes et al.]: obstacles p = 1, every unexplored cell p = 0, in between
//! ∇²p = 0, solved for q = 1 − p so that far cells keep their digits.
//!
//! A goal holds q = 2^1000 (the equation is homogeneous), which leaves f64 2074 binary orders of magnitude below it.
//! Departs from [Prestes et al.], who relax p itself: in p a cell whose 1 − p is below the rounding of 1 is flat, and in a
//! real building that is most of them. The baseline is better for it, never worse.
//!
//! With preferences ([`Field::prefer`]) the equation is that of [Maffei-Terrain, eq. 2], |ε| ≤ 2.
//!
//! Only free cells that the robot can come to are unknowns of the system, and those need no value for the others.
//!
//! Units: cells of the chart; headings in radians, counter-clockwise from x.

use fieldline_planner::config::KERNEL_CELLS;
use fieldline_planner::geometry::{CELL_M, Cell, Point};
use fieldline_planner::math;

use super::graph::Node;
use super::multigrid::Multigrid;
use crate::baseline::chart::{Chart, Frame};

/// q of a goal: 2^1000.
pub(super) const GOAL: f64 = f64::from_bits((1023 + 1000) << 52);

/// What a cell is in the boundary-value problem.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Kind {
    /// Not passable, or out of the robot's reach: q = 0.
    #[default]
    Obstacle,
    /// Unexplored: q = [`GOAL`].
    Goal,
    /// An unknown of the system, by number.
    Free(u32),
}

/// Boundary and field.
#[derive(Clone, Debug, Default)]
pub(super) struct Field {
    frame: Frame,
    kinds: Vec<Kind>,
    /// The chart's index of every unknown.
    homes: Vec<u32>,
    /// Unexplored cells beside free ones.
    goals: usize,
    solver: Multigrid,
}

impl Field {
    /// Take the boundary from the chart, keeping the field of cells that were free before. Unexplored cells for which
    /// `is_goal` is false are free cells of the field.
    pub(super) fn charge(&mut self, chart: &Chart, robot: Cell, is_goal: impl Fn(Cell) -> bool) {
        let frame = chart.frame();
        let (kinds, homes, goals) = bounds(chart, robot, is_goal);
        self.goals = goals;
        if frame == self.frame && kinds == self.kinds {
            return;
        }
        let updates = self.solver.updates;
        let mut solver = Multigrid::new(nodes(frame, &kinds, &homes), places(frame, &homes), GOAL);
        for (node, &home) in homes.iter().enumerate() {
            if let Some(before) = self.value(frame.cell(home as usize)) {
                solver.set(node, before);
            }
        }
        solver.updates = updates;
        *self = Self {
            frame,
            kinds,
            homes,
            goals,
            solver,
        };
    }

    /// Give every free cell a preference.
    pub(super) fn prefer(&mut self, of: impl Fn(Cell) -> f32) {
        let cells = self
            .homes
            .iter()
            .map(|&home| self.frame.cell(home as usize));
        self.solver.prefer(cells.map(of).collect());
    }

    /// Mean of |p − p(robot)| over the free cells of the kernel around the robot that have a way to a goal
    /// ([`fieldline_planner::field::preference`]); `None` where the robot has none.
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

    /// Whether any unexplored cell can be come to.
    pub(super) const fn has_goals(&self) -> bool {
        self.goals > 0
    }

    /// One multigrid cycle.
    pub(super) fn cycle(&mut self) {
        self.solver.cycle();
    }

    /// Unknowns of the system.
    pub(super) fn cells(&self) -> usize {
        self.homes.len()
    }

    /// Cell updates so far.
    pub(super) const fn updates(&self) -> u64 {
        self.solver.updates
    }

    /// What a cell is.
    pub(super) fn kind(&self, cell: Cell) -> Kind {
        let index = self.frame.index(cell);
        index.map_or(Kind::Obstacle, |index| self.kinds[index])
    }

    /// q of a cell: 0 on obstacles and outside.
    pub(super) fn q(&self, cell: Cell) -> f64 {
        self.frame.index(cell).map_or(0.0, |index| self.at(index))
    }

    /// q of a free cell that has one.
    fn value(&self, cell: Cell) -> Option<f64> {
        match self.kind(cell) {
            Kind::Free(node) => Some(self.solver.values()[node as usize]).filter(|q| *q > 0.0),
            _ => None,
        }
    }

    fn at(&self, index: usize) -> f64 {
        match self.kinds[index] {
            Kind::Obstacle => 0.0,
            Kind::Goal => GOAL,
            Kind::Free(node) => self.solver.values()[node as usize],
        }
    }

    /// The heading of −∇p at a point of a free cell, interpolated between cell centres; `None` where there is no slope.
    pub(super) fn heading_at(&self, point: Point) -> Option<f32> {
        self.gradient(point.cell())?;
        let (x, y) = (point.x_m / CELL_M - 0.5, point.y_m / CELL_M - 0.5);
        let (west, south) = (math::floor(x), math::floor(y));
        let (along, up) = (f64::from(x - west as f32), f64::from(y - south as f32));
        let mut sum = (0.0, 0.0);
        for (dx, dy, weight) in [
            (0, 0, (1.0 - along) * (1.0 - up)),
            (1, 0, along * (1.0 - up)),
            (0, 1, (1.0 - along) * up),
            (1, 1, along * up),
        ] {
            let cell = Cell {
                x: west + dx,
                y: south + dy,
            };
            if let Some((gx, gy)) = self.gradient(cell) {
                sum = (sum.0 + weight * gx, sum.1 + weight * gy);
            }
        }
        // The gradient's size means nothing, and f32 could not hold it.
        let size = sum.0.abs().max(sum.1.abs());
        (size > 0.0).then(|| math::atan2((sum.1 / size) as f32, (sum.0 / size) as f32))
    }

    /// Twice ∇q at the centre of a free cell.
    fn gradient(&self, cell: Cell) -> Option<(f64, f64)> {
        let index = self.frame.index(cell)?;
        let Kind::Free(_) = self.kinds[index] else {
            return None;
        };
        let [east, north, west, south] = self.frame.four(index).map(|near| self.at(near));
        Some((east - west, north - south))
    }

    /// The way of steepest descent of p from a free cell, cell by cell: the goal it leads to and its length, or `None` where
    /// the field has a local minimum (it has not converged yet) or is flat.
    pub(super) fn descend(&self, from: Cell) -> Option<(Cell, u32)> {
        let mut index = self.frame.index(from)?;
        for steps in 0..self.frame.len() as u32 {
            if self.kinds[index] == Kind::Goal {
                return Some((self.frame.cell(index), steps));
            }
            let Kind::Free(_) = self.kinds[index] else {
                return None;
            };
            let near = self.frame.four(index);
            let best = near
                .into_iter()
                .max_by(|&a, &b| self.at(a).total_cmp(&self.at(b)))?;
            if self.at(best) <= self.at(index) {
                return None;
            }
            index = best;
        }
        None
    }
}

/// What every cell is, the unknowns in order of their index, and the number of goals beside them.
fn bounds(
    chart: &Chart,
    robot: Cell,
    is_goal: impl Fn(Cell) -> bool,
) -> (Vec<Kind>, Vec<u32>, usize) {
    let frame = chart.frame();
    let mut kinds = vec![Kind::Obstacle; frame.len()];
    let mut pending: Vec<usize> = frame
        .index(robot)
        .filter(|&i| chart.is_passable(i))
        .into_iter()
        .collect();
    let mut goals = 0;
    for &start in &pending {
        kinds[start] = Kind::Free(0);
    }
    while let Some(index) = pending.pop() {
        for near in frame.four(index) {
            if kinds[near] != Kind::Obstacle || !chart.is_passable(near) {
                continue;
            }
            if chart.is_unexplored(near) && is_goal(frame.cell(near)) {
                kinds[near] = Kind::Goal;
                goals += 1;
            } else {
                kinds[near] = Kind::Free(0);
                pending.push(near);
            }
        }
    }
    let mut homes = Vec::new();
    for (home, kind) in (0..).zip(&mut kinds) {
        if let Kind::Free(node) = kind {
            *node = homes.len() as u32;
            homes.push(home);
        }
    }
    (kinds, homes, goals)
}

fn nodes(frame: Frame, kinds: &[Kind], homes: &[u32]) -> Vec<Node> {
    let node = |&home: &u32| {
        let near = frame.four(home as usize).map(|near| kinds[near]);
        Node {
            beside: near.map(|kind| match kind {
                Kind::Free(node) => Some(node),
                _ => None,
            }),
            goals: (0..4).fold(0, |bits, k| bits | u8::from(near[k] == Kind::Goal) << k),
        }
    };
    homes.iter().map(node).collect()
}

fn places(frame: Frame, homes: &[u32]) -> Vec<(u32, u32)> {
    let place = |&home: &u32| {
        let (x, y) = frame.place(home as usize);
        (x as u32, y as u32)
    };
    homes.iter().map(place).collect()
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
        let cells = (0..field.frame.len()).map(|index| field.frame.cell(index));
        cells
            .filter(|&cell| matches!(field.kind(cell), Kind::Free(_)))
            .collect()
    }

    /// Largest relative change that one more relaxation of any cell would make.
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

    /// As [`residual`], of the equation with these preferences.
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

    /// A corridor one cell wide: the walls' sides are equal, so along it q is that of a line with its flows tilted.
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
        let p_diff = field.p_diff(home).expect("a way");
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

    /// p itself, or q in f64 from a goal of 1, has no slope left at the far end: q falls by 2 − √3 a cell, to 1e-343.
    #[test]
    fn a_corridor_of_sixty_metres_keeps_its_slope() {
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
        // One of the two goals is given up: it becomes a free cell, and all others keep what they had.
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
    fn what_cannot_be_come_to_is_no_part_of_it() {
        let (field, robot) = solved(&["#######", "#R.#.?#", "#######"], 1);
        assert!(!field.has_goals() && field.cells() == 2);
        assert_eq!(field.kind(Cell { x: 5, y: 1 }), Kind::Obstacle);
        assert_eq!(field.heading_at(robot), None);
        assert_eq!(field.descend(robot.cell()), None);
    }
}
