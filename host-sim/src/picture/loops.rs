//! What strategies that close loops or follow rails show: rails by age, the road, tractor point, shield, and loops given up.
//!
//! Marks of closed loops are a tint of the map's free cells ([`super::layers::map`]). Rails are bands under the path, from the
//! newest visit, dark, to the oldest, light; a centre cell that was never visited is skeleton and no more.

use super::canvas::{Canvas, Spot};
use super::layers::{links, skeleton_middle};
use super::{Frame, Scene, palette};
use crate::report::GridMap;
use crate::trial::route::{Route, middle_m};

/// Side of the tractor point's square, pixels.
const TRACTOR_PX: f32 = 10.0;
/// Shades that rails are drawn in.
const SHADES: u8 = 8;

/// The visited centre cells, the oldest first so that the newest lie on top.
pub(super) fn rails(canvas: &mut Canvas, frame: &Frame, map: &GridMap) {
    let Some((oldest, newest)) = map.dates() else {
        return;
    };
    let span = f32::from(newest - oldest).max(1.0);
    let shade = |(x, y): (i32, i32)| {
        let date = map.date(2 * x, 2 * y)?;
        let age = f32::from(newest - date) / span;
        Some((age * f32::from(SHADES - 1)).round() as u8)
    };
    let width = (frame.cell_px as f32 * 2.4).max(9.0);
    let links: Vec<_> = links(frame, map).collect();
    for now in (0..SHADES).rev() {
        let colour = palette::age(f32::from(now) / f32::from(SHADES - 1)).alpha(1.0);
        for &[from, to] in links.iter().filter(|link| shade(link[0]) == Some(now)) {
            let ends = [from, to].map(|(x, y)| skeleton_middle(frame, x, y));
            canvas.line(&ends, width, colour);
        }
    }
}

/// The road, and the tractor point and the shield of the loop that is being closed.
pub(super) fn route(canvas: &mut Canvas, frame: &Frame, route: &Route) {
    let spot = |place| {
        let [x_m, y_m] = middle_m(place);
        frame.metres(x_m, y_m)
    };
    let spots: Vec<Spot> = route.road.iter().map(|place| spot(*place)).collect();
    road(canvas, &spots);
    if let Some(ends) = route.shield {
        shield(canvas, ends.map(spot));
    }
    if let Some(place) = route.tractor {
        tractor(canvas, spot(place));
    }
}

/// Where loops were given up.
pub(super) fn given_up(canvas: &mut Canvas, frame: &Frame, places: &[(f64, f64)]) {
    for &(x_m, y_m) in places {
        cross(canvas, frame.metres(x_m, y_m));
    }
}

/// The mark of a road.
fn road(canvas: &mut Canvas, spots: &[Spot]) {
    canvas.line(spots, 4.5, palette::PAGE.alpha(0.8));
    canvas.line(spots, 2.4, palette::WINDOW.alpha(1.0));
}

/// The mark of a shield.
fn shield(canvas: &mut Canvas, ends: [Spot; 2]) {
    canvas.line(&ends, 7.0, palette::PAGE.alpha(0.9));
    canvas.line(&ends, 4.0, palette::LOOP.alpha(1.0));
}

/// The mark of a tractor point.
fn tractor(canvas: &mut Canvas, (x, y): Spot) {
    for (side, colour) in [
        (TRACTOR_PX + 4.0, palette::PAGE),
        (TRACTOR_PX, palette::LOOP),
    ] {
        let corner = (x - side / 2.0, y - side / 2.0);
        canvas.rect(corner, side, side, colour.alpha(1.0));
    }
}

/// The mark of a loop that was given up.
fn cross(canvas: &mut Canvas, (x, y): Spot) {
    for (width, colour) in [(6.0, palette::PAGE), (2.6, palette::LOOP)] {
        for side in [-1.0, 1.0] {
            let ends = [(x - 5.0, y - 5.0 * side), (x + 5.0, y + 5.0 * side)];
            canvas.line(&ends, width, colour.alpha(1.0));
        }
    }
}

/// A key of the legend: what draws its mark around a spot, and its words.
pub(super) type Key = (fn(&mut Canvas, Spot), &'static str);

/// The keys of what there is.
pub(super) fn keys(scene: &Scene<'_>) -> Vec<Key> {
    let mut keys: Vec<Key> = Vec::new();
    if scene.map.has_marks() {
        keys.push((
            |canvas, spot| patch(canvas, spot, palette::MARK),
            "loop closed near",
        ));
    }
    if scene.map.dates().is_some() {
        keys.push((age_key, "rail, newest to oldest"));
    }
    let route = scene.route;
    if route.is_some_and(|route| !route.road.is_empty()) {
        keys.push((
            |canvas, (x, y)| road(canvas, &[(x - 13.0, y), (x + 13.0, y)]),
            "road",
        ));
    }
    if route.is_some_and(|route| route.tractor.is_some()) {
        keys.push((tractor, "tractor point"));
    }
    if route.is_some_and(|route| route.shield.is_some()) {
        keys.push((
            |canvas, (x, y)| shield(canvas, [(x, y - 8.0), (x, y + 8.0)]),
            "shield",
        ));
    }
    if !scene.given_up.is_empty() {
        keys.push((cross, "loop given up"));
    }
    keys
}

fn patch(canvas: &mut Canvas, (x, y): Spot, colour: palette::Rgb) {
    canvas.rect((x - 13.0, y - 8.0), 26.0, 16.0, colour.alpha(1.0));
}

fn age_key(canvas: &mut Canvas, (x, y): Spot) {
    for column in 0..26 {
        let colour = palette::age(column as f32 / 25.0).alpha(1.0);
        canvas.rect((x - 13.0 + column as f32, y - 5.0), 1.5, 10.0, colour);
    }
}
