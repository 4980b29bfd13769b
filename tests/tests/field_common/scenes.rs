//! Seeded windows: rooms, doors, corridors, scatter, caves, slanted walls, frontiers; with and without preferences.

use fieldline_planner::field::{Preference, SIDE, Window};

use super::{Random, Rows, cells, sin_cos};

/// A kind of floor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// Rooms of a recursive division, walls of one or two cells, doors of 5 to 9.
    Rooms,
    /// One wall of one cell all across, with a door of 6 to 8.
    Door,
    /// Corridors of 5 to 11 cells carved from rock.
    Corridors,
    /// Posts of one to three cells on 2 to 12 % of the floor.
    Scatter,
    /// A cave grown by a cellular automaton.
    Cave,
    /// Walls of one cell at any angle, each with a gap.
    Slanted,
}

/// Every kind, in the order of the tables.
pub(crate) const KINDS: [Kind; 6] = [
    Kind::Rooms,
    Kind::Door,
    Kind::Corridors,
    Kind::Scatter,
    Kind::Cave,
    Kind::Slanted,
];

/// What attracts and repels inside a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Pull {
    /// No preference anywhere.
    None,
    /// Preferences from heights of rolling ground, and a global one up to 0.1 [Terrain, eqs. 3 and 5].
    Heights,
}

/// One window to solve.
pub(crate) struct Scene {
    /// The robot's cell: the reached cell nearest to the middle.
    pub(crate) robot: (usize, usize),
    /// The window, charged and not yet solved.
    pub(crate) window: Window,
}

/// The window of a seed. A quarter of them have a frontier, many goals, instead of one; a window of which the goal
/// reaches less than a tenth is drawn again.
pub(crate) fn scene(kind: Kind, pull: Pull, seed: u64) -> Scene {
    let mut random = Random::new(seed ^ (kind as u64) << 32 ^ (pull as u64) << 40);
    let side = SIDE as i32;
    loop {
        let mut free = Plan::draw(kind, side, &mut random).cut(0, 0);
        let mut goal = [0; SIDE];
        if random.chance(0.25) {
            draw_frontier(&mut free, &mut goal, &mut random);
        } else {
            let (x, y) = (random.between(1, side - 1), random.between(1, side - 1));
            goal[y as usize] = free[y as usize] & 1 << x;
        }
        let mut window = Window::new();
        window.set_boundary(&free, &goal);
        if cells().filter(|&(x, y)| window.is_reached(x, y)).count() < SIDE * SIDE / 10 {
            continue;
        }
        let robot = nearest_to_middle(&window);
        if pull == Pull::Heights {
            let ground = Ground::draw(&mut random);
            let global = 0.1 * random.unit();
            ground.prefer(&mut window, (0, 0), robot, global);
        }
        return Scene { robot, window };
    }
}

/// Turn what lies beyond a ragged border into goals: free cells not yet explored.
fn draw_frontier(free: &mut Rows, goal: &mut Rows, random: &mut Random) {
    let (ky, kx) = sin_cos(random.angle());
    let (start, wave, phase) = (
        5.0 + 20.0 * random.unit(),
        0.1 + 0.5 * random.unit(),
        random.angle(),
    );
    for (x, y) in cells() {
        let (dx, dy) = (x as f64 - 30.0, y as f64 - 30.0);
        let edge = start + 2.0 * sin_cos((dx * ky - dy * kx) * wave + phase).0 + random.unit();
        if dx * kx + dy * ky > edge {
            goal[y] |= free[y] & 1 << x;
            free[y] &= !(1 << x);
        }
    }
}

fn nearest_to_middle(window: &Window) -> (usize, usize) {
    let middle = SIDE / 2;
    let reached = cells().filter(|&(x, y)| window.is_reached(x, y));
    let distance = |&(x, y): &(usize, usize)| x.abs_diff(middle).pow(2) + y.abs_diff(middle).pow(2);
    reached.min_by_key(distance).expect("a reached cell")
}

/// What may happen to a boundary under a solved field.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Change {
    /// The goal is elsewhere.
    GoalJumps,
    /// There is one more.
    GoalAppears,
    /// There is one less.
    GoalVanishes,
    /// A wall all across, with a narrow gap or none, gets a gap of seven cells more.
    DoorOpens,
    /// The same, the other way round.
    DoorCloses,
}

/// Every change, in the order of the tables.
pub(crate) const CHANGES: [Change; 5] = [
    Change::GoalJumps,
    Change::GoalAppears,
    Change::GoalVanishes,
    Change::DoorOpens,
    Change::DoorCloses,
];

/// Boundaries (free cells, goals) before a change of the scene's and after it.
pub(crate) fn before_and_after(
    scene: &Scene,
    change: Change,
    random: &mut Random,
) -> [(Rows, Rows); 2] {
    let (mut free, mut goal, mut other): (Rows, Rows, Rows) = ([0; SIDE], [0; SIDE], [0; SIDE]);
    for (x, y) in cells() {
        goal[y] |= u64::from(scene.window.is_goal(x, y)) << x;
        free[y] |= u64::from(scene.window.is_reached(x, y)) << x | goal[y];
    }
    let reached: Vec<_> = cells()
        .filter(|&(x, y)| scene.window.is_reached(x, y))
        .collect();
    let (x, y) = reached[random.between(0, reached.len() as i32) as usize];
    if (x, y) != scene.robot {
        other[y] = 1 << x;
    }
    let both = core::array::from_fn(|y| goal[y] | other[y]);

    let side = SIDE as i32;
    let (mut closed, mut open) = (free, free);
    let wall = random.between(5, side - 5) as usize;
    let gap = if random.chance(0.3) {
        0
    } else {
        0b111 << random.between(0, side - 3)
    };
    closed[wall] &= gap;
    open[wall] &= gap | 0b111_1111 << random.between(0, side - 7);
    match change {
        Change::GoalJumps => [(free, goal), (free, other)],
        Change::GoalAppears => [(free, other), (free, both)],
        Change::GoalVanishes => [(free, both), (free, other)],
        Change::DoorOpens => [(closed, goal), (open, goal)],
        Change::DoorCloses => [(open, goal), (closed, goal)],
    }
}

/// Rolling ground: a few sine waves, heights in metres.
pub(crate) struct Ground([[f64; 4]; 4]);

impl Ground {
    /// Wavelengths of 2 to 8 m, heights up to 0.4 m.
    fn draw(random: &mut Random) -> Self {
        Self(core::array::from_fn(|_| {
            let wave = core::f64::consts::TAU / (20.0 + 60.0 * random.unit());
            let (sin, cos) = sin_cos(random.angle());
            [wave * cos, wave * sin, random.angle(), 0.1 * random.unit()]
        }))
    }

    fn height(&self, x: i32, y: i32) -> f64 {
        let wave = |&[kx, ky, phase, height]: &[f64; 4]| {
            height * sin_cos(kx * f64::from(x) + ky * f64::from(y) + phase).0
        };
        self.0.iter().map(wave).sum()
    }

    /// [Terrain, eqs. 3 and 5] in a window whose cell (0, 0) lies at `corner`, seen from its cell `robot`.
    pub(crate) fn prefer(
        &self,
        window: &mut Window,
        corner: (i32, i32),
        robot: (usize, usize),
        global: f64,
    ) {
        let height = |x: usize, y: usize| self.height(corner.0 + x as i32, corner.1 + y as i32);
        let here = height(robot.0, robot.1);
        window.set_preferences(|x, y| {
            let repulsion = (-2.0 * (here - height(x, y)).abs()).max(-0.5);
            Preference::nearest((global + repulsion).clamp(-0.5, 0.5) as f32)
        });
    }
}

/// A walk over a floor larger than the window: a path of cells, each beside the one before.
pub(crate) struct Walk {
    plan: Plan,
    path: Vec<(i32, i32)>,
    ground: Ground,
}

/// Steps of a walk.
pub(crate) const WALK_STEPS: usize = 40;

/// How far ahead on the path the local goal lies, cells.
const AHEAD: usize = 20;

impl Walk {
    /// A shortest way to the farthest place from a random one, on a floor two and a half windows wide.
    pub(crate) fn new(kind: Kind, seed: u64) -> Self {
        let mut random = Random::new(seed ^ (kind as u64) << 32 ^ 1 << 50);
        let side = 5 * SIDE as i32 / 2;
        loop {
            let plan = Plan::draw(kind, side, &mut random);
            let path = plan.longest_path((random.between(0, side), random.between(0, side)));
            if path.len() > WALK_STEPS + AHEAD {
                return Self {
                    plan,
                    path,
                    ground: Ground::draw(&mut random),
                };
            }
        }
    }

    /// Move `window` from step − 1 to `step`: the robot in the middle, the path's cell 20 steps ahead as the goal.
    pub(crate) fn step(&self, window: &mut Window, step: usize, pull: Pull) {
        let (x, y) = self.path[step];
        let (before_x, before_y) = self.path[step.saturating_sub(1)];
        let half = SIDE as i32 / 2;
        let ahead = self.path[step + AHEAD];
        let mut goal = [0; SIDE];
        goal[(ahead.1 - y + half) as usize] = 1 << (ahead.0 - x + half);
        window.shift(x - before_x, y - before_y);
        window.set_boundary(&self.plan.cut(x - half, y - half), &goal);
        if pull == Pull::Heights {
            let middle = SIDE / 2;
            self.ground
                .prefer(window, (x - half, y - half), (middle, middle), 0.05);
        }
    }
}

/// A square floor of any size.
#[derive(Clone)]
struct Plan {
    side: i32,
    free: Vec<bool>,
}

impl Plan {
    fn draw(kind: Kind, side: i32, random: &mut Random) -> Self {
        let mut plan = Self {
            side,
            free: vec![kind != Kind::Corridors; (side * side) as usize],
        };
        match kind {
            Kind::Rooms => plan.divide([0, 0, side, side], random),
            Kind::Door => plan.wall_with_door(random),
            Kind::Corridors => plan.carve_corridors(random),
            Kind::Scatter => plan.scatter_posts(random),
            Kind::Cave => plan.grow_cave(random),
            Kind::Slanted => plan.slanted_walls(random),
        }
        plan
    }

    fn is_free(&self, x: i32, y: i32) -> bool {
        let inside = 0..self.side;
        inside.contains(&x) && inside.contains(&y) && self.free[(y * self.side + x) as usize]
    }

    fn set(&mut self, x: i32, y: i32, free: bool) {
        if (0..self.side).contains(&x) && (0..self.side).contains(&y) {
            self.free[(y * self.side + x) as usize] = free;
        }
    }

    fn fill(&mut self, [x, y, width, height]: [i32; 4], free: bool) {
        for row in y..y + height {
            for column in x..x + width {
                self.set(column, row, free);
            }
        }
    }

    fn divide(&mut self, [x, y, width, height]: [i32; 4], random: &mut Random) {
        let longest = width.max(height);
        if longest < 28 || (longest < 45 && random.chance(0.25)) {
            return;
        }
        let (door, thick) = (random.between(5, 10), random.between(1, 3));
        if width >= height {
            let wall = random.between(12, width - 12 - thick);
            self.fill([x + wall, y, thick, height], false);
            self.fill(
                [x + wall, y + random.between(1, height - door), thick, door],
                true,
            );
            self.divide([x, y, wall, height], random);
            self.divide([x + wall + thick, y, width - wall - thick, height], random);
        } else {
            let wall = random.between(12, height - 12 - thick);
            self.fill([x, y + wall, width, thick], false);
            self.fill(
                [x + random.between(1, width - door), y + wall, door, thick],
                true,
            );
            self.divide([x, y, width, wall], random);
            self.divide([x, y + wall + thick, width, height - wall - thick], random);
        }
    }

    fn wall_with_door(&mut self, random: &mut Random) {
        let wall = random.between(self.side / 4, 3 * self.side / 4);
        let door = random.between(6, 9);
        self.fill([0, wall, self.side, 1], false);
        self.fill([random.between(1, self.side - door), wall, door, 1], true);
    }

    fn carve_corridors(&mut self, random: &mut Random) {
        let half = random.between(2, 6);
        let wide = 2 * half + 1;
        let (mut x, mut y) = (self.side / 2, self.side / 2);
        for leg in 0..random.between(6, 12) * (self.side / SIDE as i32) {
            let to = random.between(half + 1, self.side - half - 1);
            let (to_x, to_y) = if leg % 2 == 0 { (to, y) } else { (x, to) };
            let (left, low) = (x.min(to_x) - half, y.min(to_y) - half);
            self.fill(
                [left, low, (x - to_x).abs() + wide, (y - to_y).abs() + wide],
                true,
            );
            (x, y) = (to_x, to_y);
        }
    }

    fn scatter_posts(&mut self, random: &mut Random) {
        let density = 0.02 + 0.10 * random.unit();
        let mut left = (density * f64::from(self.side * self.side)) as i32;
        while left > 0 {
            let post = random.between(1, 4);
            self.fill(
                [
                    random.between(0, self.side),
                    random.between(0, self.side),
                    post,
                    post,
                ],
                false,
            );
            left -= post * post;
        }
    }

    fn grow_cave(&mut self, random: &mut Random) {
        for cell in &mut self.free {
            *cell = random.chance(0.58);
        }
        for _ in 0..4 {
            let before = self.clone();
            for y in 0..self.side {
                for x in 0..self.side {
                    let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (x + dx, y + dy)));
                    let walls = around.filter(|&(x, y)| !before.is_free(x, y)).count();
                    self.set(x, y, walls < 5);
                }
            }
        }
    }

    fn slanted_walls(&mut self, random: &mut Random) {
        for _ in 0..random.between(4, 9) * (self.side / SIDE as i32) {
            let (x, y) = (random.between(0, self.side), random.between(0, self.side));
            let (sin, cos) = sin_cos(random.angle());
            let length = random.between(20, 60);
            let gap = random.between(0, length);
            for step in (0..2 * length).filter(|step| (step / 2 - gap).abs() > 4) {
                let along = |origin: i32, slope: f64| {
                    (f64::from(origin) + slope * f64::from(step) / 2.0) as i32
                };
                self.set(along(x, cos), along(y, sin), false);
            }
        }
    }

    /// The window of cells from (x, y) on, as row masks.
    fn cut(&self, x: i32, y: i32) -> Rows {
        let mut rows = [0; SIDE];
        for (column, row) in cells() {
            rows[row] |= u64::from(self.is_free(x + column as i32, y + row as i32)) << column;
        }
        rows
    }

    /// From `start` to the free cell farthest from it; just `start` if that is not free.
    fn longest_path(&self, start: (i32, i32)) -> Vec<(i32, i32)> {
        let mut path = vec![start];
        if !self.is_free(start.0, start.1) {
            return path;
        }
        let mut from = std::collections::BTreeMap::from([(start, start)]);
        let mut queue = std::collections::VecDeque::from([start]);
        while let Some((x, y)) = queue.pop_front() {
            path[0] = (x, y);
            for next in [(x + 1, y), (x, y + 1), (x - 1, y), (x, y - 1)] {
                if self.is_free(next.0, next.1) && !from.contains_key(&next) {
                    from.insert(next, (x, y));
                    queue.push_back(next);
                }
            }
        }
        while path[path.len() - 1] != start {
            path.push(from[&path[path.len() - 1]]);
        }
        path.reverse();
        path
    }
}
