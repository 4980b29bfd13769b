//! A dungeon: caves and tilted rooms, joined by winding passages with doors in some of them.
//!
//! Passages along a minimum spanning tree join all caves, and a few more close loops. Smooth noise
//! moves the walls in and out. Some passages end blind, some caves are walled in, and pillars and
//! boulders stand about.

use core::f64::consts::PI;

use super::dice::Dice;
use super::sheet::{Door, Sheet, around, squared};
use super::{DOOR_M, SLIT_M};
use crate::world::canvas::roughness;
use crate::world::occupancy::Class;

/// Half width of passages, least and most, metres.
const HALF_M: [f64; 2] = [0.42, 1.0];
/// Half width of a passage at its narrowest, after the noise, metres.
const LEAST_HALF_M: f64 = 0.35;
/// Radius of a cave, least and most, metres.
const CAVE_M: [f64; 2] = [0.9, 2.6];
/// Area of the plan for each cave that is tried, square metres.
const CAVE_AREA_M2: f64 = 3.0;
/// Distance of everything from the border, metres.
const BORDER_M: f64 = 0.4;
/// Thickness of the wall around a door, least and most, metres.
const WALL_M: [f64; 2] = [0.1, 0.2];
/// Least distance between two doors, metres.
const APART_M: f64 = 3.5;

/// The noise that moves walls.
#[derive(Clone, Copy, Debug)]
struct Rough {
    /// How far, metres.
    most_m: f64,
    /// Place of the plan in the noise.
    shift: [f64; 2],
}

/// A cave or a room.
#[derive(Clone, Copy, Debug)]
struct Cave {
    centre: [f64; 2],
    radius_m: f64,
}

/// A piece of a passage.
#[derive(Clone, Copy, Debug)]
struct Reach {
    from: [f64; 2],
    to: [f64; 2],
    half_m: f64,
}

/// Draws it.
pub(super) fn draw(dice: &mut Dice, size_m: Option<[f64; 2]>) -> Sheet {
    let free_m = super::free_size_m(dice);
    let mut sheet = Sheet::straight(size_m.unwrap_or(free_m));
    let rough = Rough {
        most_m: dice.between(0.05, 0.35),
        shift: [0; 2].map(|_| dice.between(0.0, 5000.0).floor()),
    };
    let caves = caves(dice, sheet.size_m());
    for cave in &caves {
        hollow(dice, &mut sheet, *cave, rough);
    }
    let mut reaches = Vec::new();
    for [a, b] in joints(dice, &caves) {
        passage(dice, sheet.size_m(), [caves[a], caves[b]], &mut reaches);
    }
    blind_ends(dice, &caves, sheet.size_m(), &mut reaches);
    for reach in &reaches {
        dig(&mut sheet, *reach, rough);
    }
    slits(dice, &mut sheet, &caves);
    doors(dice, &mut sheet, (&reaches, &caves), rough);
    pillars(dice, &mut sheet, &caves);
    pockets(dice, &mut sheet);
    sheet
}

/// Places caves that do not overlap.
fn caves(dice: &mut Dice, [w, h]: [f64; 2]) -> Vec<Cave> {
    let mut caves: Vec<Cave> = Vec::new();
    for _ in 0..((w * h / CAVE_AREA_M2) as usize).max(4) {
        let radius_m = dice.between(CAVE_M[0], CAVE_M[1]);
        let margin_m = radius_m + BORDER_M;
        let centre = [w, h].map(|m| dice.between(margin_m, m - margin_m));
        let clear = caves.iter().all(|other| {
            let apart = radius_m + other.radius_m + 0.6;
            squared(centre, other.centre) > apart * apart
        });
        if clear {
            caves.push(Cave { centre, radius_m });
        }
    }
    caves
}

/// Clears a cave with rough walls, or a tilted room.
fn hollow(dice: &mut Dice, sheet: &mut Sheet, cave: Cave, rough: Rough) {
    let Cave { centre, radius_m } = cave;
    if dice.chance(0.4) {
        let half = [radius_m * 0.8, radius_m * dice.between(0.4, 0.6)];
        let along = dice.turn(PI);
        sheet.slab(Class::Free, centre, half, along);
        return;
    }
    let reach = Reach {
        from: centre,
        to: centre,
        half_m: radius_m,
    };
    dig(sheet, reach, rough);
}

/// Clears a thick line whose border the noise moves.
fn dig(sheet: &mut Sheet, reach: Reach, rough: Rough) {
    let Reach { from, to, half_m } = reach;
    let [w, h] = sheet.size_m();
    let margin_m = half_m + rough.most_m;
    let bounds = [
        (from[0].min(to[0]) - margin_m).max(BORDER_M / 2.0),
        (from[1].min(to[1]) - margin_m).max(BORDER_M / 2.0),
        (from[0].max(to[0]) + margin_m).min(w - BORDER_M / 2.0),
        (from[1].max(to[1]) + margin_m).min(h - BORDER_M / 2.0),
    ];
    sheet.fill(Class::Free, bounds, |point| {
        let noise = roughness(point[0] + rough.shift[0], point[1] + rough.shift[1]);
        let wide_m = (half_m + rough.most_m * noise).max(LEAST_HALF_M);
        squared(point, nearest(point, from, to)) < wide_m * wide_m
    });
}

/// Returns the point of a line that is nearest to a point.
fn nearest([px, py]: [f64; 2], [x0, y0]: [f64; 2], [x1, y1]: [f64; 2]) -> [f64; 2] {
    let (dx, dy) = (x1 - x0, y1 - y0);
    let length2 = (dx * dx + dy * dy).max(1e-9);
    let along = (((px - x0) * dx + (py - y0) * dy) / length2).clamp(0.0, 1.0);
    [x0 + along * dx, y0 + along * dy]
}

/// Pairs of caves to join: a minimum spanning tree, and some other neighbours.
fn joints(dice: &mut Dice, caves: &[Cave]) -> Vec<[usize; 2]> {
    let distance2 = |a: usize, b: usize| squared(caves[a].centre, caves[b].centre);
    let mut joints = Vec::new();
    let mut joined = vec![0];
    while joined.len() < caves.len() {
        let outside = (0..caves.len()).filter(|cave| !joined.contains(cave));
        let pairs = outside.flat_map(|b| joined.iter().map(move |&a| [a, b]));
        let nearest =
            pairs.min_by(|[a, b], [c, d]| distance2(*a, *b).total_cmp(&distance2(*c, *d)));
        let Some([a, b]) = nearest else { break };
        joined.push(b);
        joints.push([a, b]);
    }
    let share = dice.between(0.05, 0.4);
    for b in 0..caves.len() {
        for a in 0..b {
            let new = !joints.contains(&[a, b]) && !joints.contains(&[b, a]);
            if new && distance2(a, b) < 49.0 && dice.chance(share) {
                joints.push([a, b]);
            }
        }
    }
    joints
}

/// Adds a winding passage between two caves.
fn passage(dice: &mut Dice, size_m: [f64; 2], [a, b]: [Cave; 2], reaches: &mut Vec<Reach>) {
    let half_m = dice.between(HALF_M[0], HALF_M[1]);
    let length_m = squared(a.centre, b.centre).sqrt();
    let bends = 1 + (length_m / 4.0) as usize;
    let mut from = a.centre;
    for k in 1..=bends + 1 {
        let along = k as f64 / (bends + 1) as f64;
        let swing = if k <= bends {
            length_m * dice.between(-0.2, 0.2)
        } else {
            0.0
        };
        let [dx, dy] = [0, 1].map(|i| b.centre[i] - a.centre[i]);
        let point = [
            a.centre[0] + along * dx - swing * dy / length_m,
            a.centre[1] + along * dy + swing * dx / length_m,
        ];
        let to = within(point, size_m, half_m + BORDER_M);
        reaches.push(Reach { from, to, half_m });
        from = to;
    }
}

/// Adds passages that lead nowhere.
fn blind_ends(dice: &mut Dice, caves: &[Cave], size_m: [f64; 2], reaches: &mut Vec<Reach>) {
    for cave in caves {
        if dice.chance(0.25) {
            let half_m = dice.between(HALF_M[0], HALF_M[1]);
            let ([cos, sin], long_m) = (dice.turn(PI), cave.radius_m + dice.between(1.0, 4.0));
            let [x, y] = cave.centre;
            let to = within(
                [x + cos * long_m, y + sin * long_m],
                size_m,
                half_m + BORDER_M,
            );
            reaches.push(Reach {
                from: cave.centre,
                to,
                half_m,
            });
        }
    }
}

fn within([x, y]: [f64; 2], [w, h]: [f64; 2], margin_m: f64) -> [f64; 2] {
    [
        x.clamp(margin_m, w - margin_m),
        y.clamp(margin_m, h - margin_m),
    ]
}

/// Cuts straight slits between near caves: lasers see through, the robot does not fit.
fn slits(dice: &mut Dice, sheet: &mut Sheet, caves: &[Cave]) {
    for (k, a) in caves.iter().enumerate() {
        for b in &caves[..k] {
            let length_m = squared(a.centre, b.centre).sqrt();
            if length_m < a.radius_m + b.radius_m + 1.5 && dice.chance(0.2) {
                let middle = [0, 1].map(|i| (a.centre[i] + b.centre[i]) / 2.0);
                let along = [0, 1].map(|i| (b.centre[i] - a.centre[i]) / length_m);
                let half = [length_m / 2.0, SLIT_M / 2.0];
                sheet.slab(Class::Free, middle, half, along);
            }
        }
    }
}

/// Puts a wall with a door across some passages, where no cave and no other door is near.
fn doors(dice: &mut Dice, sheet: &mut Sheet, (reaches, caves): (&[Reach], &[Cave]), rough: Rough) {
    for reach in reaches {
        let length_m = squared(reach.from, reach.to).sqrt();
        let middle = [0, 1].map(|i| (reach.from[i] + reach.to[i]) / 2.0);
        let open = caves.iter().all(|cave| {
            let apart = cave.radius_m + 0.5;
            squared(cave.centre, middle) > apart * apart
        });
        let alone = sheet
            .doors()
            .iter()
            .all(|door| !door.is_near(middle, APART_M));
        if length_m < 0.8 || !open || !alone || !dice.chance(0.5) {
            continue;
        }
        let across = [
            -(reach.to[1] - reach.from[1]) / length_m,
            (reach.to[0] - reach.from[0]) / length_m,
        ];
        let width_m = dice.metres(DOOR_M[0], DOOR_M[1]);
        let thick_m = dice.metres(WALL_M[0], WALL_M[1]);
        let long_m = (reach.half_m + rough.most_m + 0.1).max(width_m / 2.0 + 0.2);
        sheet.slab(Class::Wall, middle, [long_m, thick_m / 2.0], across);
        let door = Door {
            middle,
            along: across,
            width_m,
        };
        sheet.door(door, thick_m);
    }
}

/// Puts pillars into large caves, and boulders into some.
fn pillars(dice: &mut Dice, sheet: &mut Sheet, caves: &[Cave]) {
    for cave in caves {
        if cave.radius_m > 1.8 && dice.chance(0.4) {
            sheet.disc(
                Class::Wall,
                cave.centre,
                dice.between(0.2, cave.radius_m - 1.3),
            );
        }
        for _ in 0..dice.index(4) {
            let ([cos, sin], far_m) = (dice.turn(PI), dice.between(0.3, cave.radius_m));
            let centre = [cave.centre[0] + cos * far_m, cave.centre[1] + sin * far_m];
            let clear = sheet.doors().iter().all(|door| !door.is_near(centre, 1.5));
            if clear && dice.chance(0.5) {
                sheet.disc(Class::Wall, centre, dice.between(0.03, 0.3));
            }
        }
    }
}

/// Hides small patches from the map: solid, and nobody knows why.
fn pockets(dice: &mut Dice, sheet: &mut Sheet) {
    let [w, h] = sheet.size_m();
    for _ in 0..dice.index(5) {
        let centre = [w, h].map(|m| dice.between(1.0, m - 1.0));
        let clear = sheet.doors().iter().all(|door| !door.is_near(centre, 1.5));
        if clear {
            sheet.rect(Class::Unknown, around(centre, dice.between(0.1, 0.4)));
        }
    }
}
