//! The window against the map cell by cell, at every scale.

use super::*;
use crate::map::Class;
use crate::roadmap::configuration_space::is_passable;

fn room() -> Tiles<16, 64> {
    let mut tiles = Tiles::new();
    tiles.reset();
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
    let (tiles, footprint) = (room(), Footprint::new(0.3));
    let mut grid = LocalGrid::new();
    grid.update(&tiles, &footprint, Cell { x: 3, y: -2 }, 1);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let cell = grid.cell(x, y);
            assert_eq!(grid.place(cell), Some((x, y)));
            assert_eq!(
                LocalGrid::has(&grid.passable, (x, y)),
                is_passable(&tiles, &footprint, cell)
            );
            assert_eq!(
                LocalGrid::has(&grid.obstacle, (x, y)),
                tiles.class(cell) == Class::Obstacle
            );
        }
    }
}

#[test]
fn a_grown_window_is_passable_where_any_of_its_cells_is() {
    let (tiles, footprint) = (room(), Footprint::new(0.3));
    for scale in [2, 4] {
        let mut grid = LocalGrid::new();
        grid.update(&tiles, &footprint, Cell { x: -5, y: 9 }, scale);
        for y in 0..SIDE {
            for x in 0..SIDE {
                let least = Cell {
                    x: grid.origin.x + x as i32 * scale,
                    y: grid.origin.y + y as i32 * scale,
                };
                let (mut any, mut all) = (false, true);
                for k in 0..scale * scale {
                    let cell = Cell {
                        x: least.x + k % scale,
                        y: least.y + k / scale,
                    };
                    let passable = is_passable(&tiles, &footprint, cell);
                    any |= passable;
                    all &= passable;
                }
                let wanted = if scale < 4 { any } else { all };
                assert_eq!(
                    LocalGrid::has(&grid.passable, (x, y)),
                    wanted,
                    "scale {scale} ({x}, {y})"
                );
            }
        }
    }
}

/// One cell to keep off, and another that is nearer to the robot than the footprint's radius.
#[test]
fn the_centre_is_kept_off_cells_but_never_enclosed() {
    let (tiles, footprint) = (room(), Footprint::new(0.3));
    let robot = Cell { x: -10, y: 0 };
    let mut grid = LocalGrid::new();
    grid.update(&tiles, &footprint, robot, 1);
    let before = grid.passable;
    let (far, near) = (Cell { x: -16, y: 1 }, Cell { x: -10, y: 2 });
    grid.keep_off(robot, [far, near].map(Cell::centre).into_iter(), &footprint);
    for (y, row) in before.iter().enumerate() {
        for x in 0..SIDE {
            let cell = grid.cell(x, y);
            let within = |of: Cell, most2: i32| {
                let (dx, dy) = (cell.x - of.x, cell.y - of.y);
                dx * dx + dy * dy < most2
            };
            let kept = within(far, 9) || within(near, 4);
            let wanted = row >> x & 1 == 1 && !kept;
            assert_eq!(LocalGrid::has(&grid.passable, (x, y)), wanted, "{cell:?}");
        }
    }
    let place = grid.place(robot).expect("the middle");
    assert!(
        LocalGrid::has(&grid.passable, place),
        "it stands 2 cells off"
    );
}

/// A disc that the robot stands beside, and one that it stands in.
#[test]
fn a_kept_off_disc_is_the_one_cell_by_cell() {
    let footprint = Footprint::new(0.45);
    let middle = Cell { x: 0, y: 0 };
    // Also beyond each edge of the window.
    for off in [(0, 0), (29, -30), (-33, 12), (31, 33), (4, 60)] {
        let off = Cell { x: off.0, y: off.1 };
        for limit2 in [0, 1, 2, 9, 14, 400] {
            let mut grid = LocalGrid::new();
            grid.update(&room(), &footprint, middle, 1);
            grid.passable = [ROW; SIDE];
            grid.block_footprint(off, &footprint, limit2);
            for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
                let cell = grid.cell(x, y);
                let (dx, dy) = (cell.x - off.x, cell.y - off.y);
                let inside = footprint
                    .half_width(dy)
                    .is_some_and(|half| dx.abs() <= half);
                let closed = inside && dx * dx + dy * dy < limit2;
                assert_eq!(
                    LocalGrid::has(&grid.passable, (x, y)),
                    !closed,
                    "{off:?} {limit2}"
                );
            }
        }
    }
}

#[test]
fn a_disc_is_closed_up_to_the_robot() {
    let (tiles, footprint) = (room(), Footprint::new(0.3));
    let robot = Cell { x: -10, y: 0 };
    for (scale, middle) in SCALES
        .into_iter()
        .flat_map(|scale| [robot.offset(6, 1), robot.offset(2, -1)].map(|middle| (scale, middle)))
    {
        let mut grid = LocalGrid::new();
        grid.update(&tiles, &footprint, robot, scale);
        let before = grid.passable;
        grid.close_disc(middle, 0.4, robot);
        for (x, y) in (0..SIDE).flat_map(|y| (0..SIDE).map(move |x| (x, y))) {
            let far2 = grid.cell(x, y).distance2(middle);
            let is_closed = far2 < 0.16 && far2 < middle.distance2(robot);
            let wanted = LocalGrid::has(&before, (x, y)) && !is_closed;
            let is_passable = LocalGrid::has(&grid.passable, (x, y));
            assert_eq!(is_passable, wanted, "scale {scale} ({x}, {y})");
        }
        assert!(scale > 1 || grid.passable != before, "some are closed");
    }
}

#[test]
fn a_robot_too_near_to_a_wall_is_let_out() {
    let (tiles, footprint) = (room(), Footprint::new(0.3));
    let robot = Cell { x: -28, y: 0 };
    let mut grid = LocalGrid::new();
    grid.update(&tiles, &footprint, robot, 1);
    let place = grid.place(robot).unwrap();
    assert!(!LocalGrid::has(&grid.passable, place));
    grid.free_robot(robot);
    assert!(LocalGrid::has(&grid.passable, place));
    assert!(
        !LocalGrid::has(&grid.passable, (place.0 - 2, place.1)),
        "not into the wall"
    );
}
