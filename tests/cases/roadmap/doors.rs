//! Doors on the roadmap's grid of 20 cm: a door is open at every place of the grid and every angle.
//!
//! A wall of 15 cm with one door divides a room of 6.4 m. The wall is moved over one coarse cell in
//! steps of 25 mm in both directions, and turned from 0 to 45° (the other angles are mirrored). The
//! map is drawn twice. In the narrow map every cell that the wall touches is an obstacle. In the
//! wide map only cells whose centre the wall covers are obstacles. The case asks for a way from one
//! half of the room to the other over passable map cells of 10 cm, and for one over the skeleton of
//! 20 cm.
//!
//! `golden/doors.txt` has the answers for a radius of 0.30 m. A door of 75 cm is always open at 20
//! cm; at 10 cm the narrow map closes a door of 80 cm in a fifth of the places. The robot does not
//! fit through a gap of 50 cm, and the narrow map closes it. In the wide map, where a jamb loses up
//! to a cell, the gap may be open; then the drive refuses it.

use std::collections::VecDeque;

use fieldline_planner::geometry::{Cell, Point};
use fieldline_planner::grid::{Plane, Site};
use fieldline_planner::map::{Class, Tiles};
use fieldline_planner::roadmap::configuration_space::{Footprint, is_passable};
use fieldline_planner::roadmap::skeleton::Skeleton;
use fieldline_tests::golden;
use fieldline_tests::runs::in_parallel;
use fieldline_tests::table::Table;

/// Radius that the robot needs, metres.
const RADIUS_M: f32 = 0.30;
/// Side of the room, map cells: two tiles.
const ROOM: i32 = 64;
const WALL_M: f32 = 0.15;
/// Widths of doors, centimetres. The robot's true hull is 51 × 50 cm.
const WIDTHS_CM: [u32; 9] = [40, 45, 50, 60, 65, 70, 75, 80, 90];

type Room = Tiles<4, 16>;

/// A wall through the room with a door in it.
#[derive(Clone, Copy, Debug)]
struct Door {
    width_m: f32,
    middle: Point,
    /// Unit vector along the wall.
    along: (f32, f32),
}

impl Door {
    /// Returns a place, by metres along the wall and across it.
    fn place(&self, along_m: f32, across_m: f32) -> Point {
        let (x, y) = self.along;
        Point {
            x_m: self.middle.x_m + along_m * x - across_m * y,
            y_m: self.middle.y_m + along_m * y + across_m * x,
        }
    }

    fn covers(&self, at: Point) -> bool {
        let (dx, dy) = (at.x_m - self.middle.x_m, at.y_m - self.middle.y_m);
        let (x, y) = self.along;
        (dx * x + dy * y).abs() >= self.width_m / 2.0 && (dy * x - dx * y).abs() <= WALL_M / 2.0
    }

    /// Returns points of the wall's surface, every 5 mm up to the room's walls.
    fn surface(&self) -> impl Iterator<Item = Point> + '_ {
        let face = (0..1000)
            .map(|k| self.width_m / 2.0 + k as f32 * 0.005)
            .flat_map(|along| [(along, 0.5), (along, -0.5), (-along, 0.5), (-along, -0.5)]);
        let jamb = (0..=30)
            .map(|k| k as f32 / 30.0 - 0.5)
            .flat_map(|across| [self.width_m / 2.0, -self.width_m / 2.0].map(|at| (at, across)));
        face.chain(jamb)
            .map(|(along, across)| self.place(along, across * WALL_M))
    }

    /// Draws the map: cells that the wall touches are obstacles if `touched`, else only those whose
    /// centre it covers.
    fn draw(&self, touched: bool) -> Room {
        let mut tiles = Room::new();
        tiles.reset();
        let inside = |cell: Cell| (0..ROOM).contains(&cell.x) && (0..ROOM).contains(&cell.y);
        let mut set = |cell: Cell, class| {
            if inside(cell) {
                tiles.set(cell, class).expect("the room fits the map");
            }
        };
        for cell in (0..ROOM).flat_map(|y| (0..ROOM).map(move |x| Cell { x, y })) {
            let rim = [cell.x, cell.y].iter().any(|&at| at == 0 || at == ROOM - 1);
            let class = if rim || self.covers(cell.centre()) {
                Class::Obstacle
            } else {
                Class::Free
            };
            set(cell, class);
        }
        if touched {
            self.surface()
                .for_each(|at| set(at.cell(), Class::Obstacle));
        }
        tiles
    }

    /// Returns the middles of the two halves of the room.
    fn halves(&self) -> [Point; 2] {
        [self.place(0.0, 1.4), self.place(0.0, -1.4)]
    }
}

/// Returns the cells that can be reached from one, over four or eight neighbours.
fn flood(from: (i32, i32), diagonal: bool, open: impl Fn(i32, i32) -> bool) -> Vec<(i32, i32)> {
    let mut seen = vec![from];
    let mut is_seen = [[false; 256]; 256];
    let mut queue = VecDeque::from([from]);
    while let Some((x, y)) = queue.pop_front() {
        for (dx, dy) in (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| (dx, dy))) {
            let near = (x + dx, y + dy);
            if (!diagonal && dx * dy != 0) || !open(near.0, near.1) {
                continue;
            }
            let mark = &mut is_seen[near.1 as usize][near.0 as usize];
            if !core::mem::replace(mark, true) {
                seen.push(near);
                queue.push_back(near);
            }
        }
    }
    seen
}

/// Returns true if passable map cells join the two halves.
fn is_open_at_10_cm(door: &Door, tiles: &Room, disc: &Footprint) -> bool {
    let open = |x: i32, y: i32| {
        (0..ROOM).contains(&x) && (0..ROOM).contains(&y) && is_passable(tiles, disc, Cell { x, y })
    };
    let [one, other] = door.halves().map(|half| (half.cell().x, half.cell().y));
    flood(one, false, open).contains(&other)
}

/// Returns true if the skeleton has a way from half to half.
fn is_open_at_20_cm(door: &Door, tiles: &Room, disc: &Footprint) -> bool {
    let mut topology: Skeleton<16> = Skeleton::new();
    while !topology.advance(tiles, disc, &mut [0; 16 * 8], u32::MAX) {}
    let way = topology.skeleton().expect("it was published");
    let frame = topology.frame();
    let [one, other] = door.halves().map(|half| {
        let middle = frame.site(half.cell()).expect("it is in the room");
        nearest(way, middle)
    });
    let at = |site: Site| {
        let cell = frame.cell(site);
        (cell.x / 2, cell.y / 2)
    };
    let open = |x: i32, y: i32| {
        let site = frame.site(Cell { x: 2 * x, y: 2 * y });
        site.is_some_and(|site| way.get(site))
    };
    flood(at(one), true, open).contains(&at(other))
}

fn nearest(way: Plane<'_>, to: Site) -> Site {
    let distance2 = |site: &Site| site.x.abs_diff(to.x).pow(2) + site.y.abs_diff(to.y).pow(2);
    way.sites()
        .min_by_key(distance2)
        .expect("a room has a skeleton")
}

/// Returns doors of one width at all places of a coarse cell and all angles.
fn doors(width_cm: u32) -> impl Iterator<Item = Door> {
    let offsets = || (0..8).map(|k| 3.1 + k as f32 * 0.025);
    let places = offsets().flat_map(move |y_m| offsets().map(move |x_m| Point { x_m, y_m }));
    places.flat_map(move |middle| {
        (0..7).map(move |k| {
            let (sin, cos) = (k as f32 * 7.5).to_radians().sin_cos();
            Door {
                width_m: width_cm as f32 * 0.01,
                middle,
                along: (cos, sin),
            }
        })
    })
}

/// Returns the per cent of open doors of a width: at 10 cm and at 20 cm in the narrow map, then in
/// the wide one.
fn open_percent(width_cm: u32, disc: &Footprint) -> [f64; 4] {
    let mut open = [0_u32; 4];
    let mut all = 0;
    for door in doors(width_cm) {
        all += 1;
        for (wide, touched) in [(0, true), (1, false)] {
            let tiles = door.draw(touched);
            let fine = is_open_at_10_cm(&door, &tiles, disc);
            let coarse = is_open_at_20_cm(&door, &tiles, disc);
            assert!(
                coarse || !fine,
                "open in the map and closed in the roadmap: {door:?}"
            );
            open[2 * wide] += u32::from(fine);
            open[2 * wide + 1] += u32::from(coarse);
        }
    }
    open.map(|open| f64::from(open) * 100.0 / f64::from(all))
}

#[test]
fn doors_are_open_at_every_place_and_gaps_are_closed() {
    let disc = Footprint::new(RADIUS_M);
    let mut table = Table::new(
        0,
        &[
            "door cm",
            "narrow 10 cm %",
            "narrow 20 cm %",
            "wide 10 cm %",
            "wide 20 cm %",
        ],
    );
    let open = in_parallel(&WIDTHS_CM, |width_cm| open_percent(*width_cm, &disc));
    for (width_cm, open) in WIDTHS_CM.into_iter().zip(open) {
        let mut row = vec![width_cm.to_string()];
        row.extend(open.map(|open| format!("{open:.1}")));
        table.row(row);
        let [_, narrow, _, wide] = open;
        if width_cm >= 80 {
            assert_eq!(narrow, 100.0, "a door of {width_cm} cm must be passed");
        }
        if width_cm >= 70 {
            assert_eq!(wide, 100.0, "a door of {width_cm} cm must be passed");
        }
        if width_cm <= 50 {
            assert!(
                narrow <= 1.0,
                "the robot does not fit through {width_cm} cm"
            );
        }
    }
    golden::compare("doors.txt", &table.to_string());
}
