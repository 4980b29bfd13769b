//! Loops and rails: rails by age, the path to the goal, tractor point, shield, and loops given up.
//!
//! Closed and given up regions are tints of the map's free cells ([`super::layers::map`]). Rails
//! are bands below the path of the robot, from dark (the newest visit) to light (the oldest). A
//! skeleton cell that was never visited has no band.

use super::canvas::{Canvas, Spot};
use super::layers::{links, skeleton_middle};
use super::{Frame, Scene, layers, palette};
use crate::report::GridMap;
use crate::trial::planned_path::{PlannedPath, middle_m};

/// Side of the tractor point's square, pixels.
const TRACTOR_PX: f32 = 10.0;
/// Number of shades of the rails.
const SHADES: u8 = 8;

/// Draws the visited skeleton cells, the oldest first, so that the newest lie on top.
pub(super) fn rails(canvas: &mut Canvas, frame: &Frame, map: &GridMap) {
    let Some((oldest, newest)) = map.visit_stamp_span() else {
        return;
    };
    let span = f32::from(newest - oldest).max(1.0);
    let shade = |(x, y): (i32, i32)| {
        let date = map.visit_stamp(2 * x, 2 * y)?;
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

/// Draws the path to the goal, and tractor point and shield of the loop that is being closed.
pub(super) fn planned_path(canvas: &mut Canvas, frame: &Frame, planned_path: &PlannedPath) {
    let spot = |place| {
        let [x_m, y_m] = middle_m(place);
        frame.metres(x_m, y_m)
    };
    let spots: Vec<Spot> = planned_path
        .cells
        .iter()
        .map(|place| spot(*place))
        .collect();
    path(canvas, &spots);
    if let Some(ends) = planned_path.shield {
        shield(canvas, ends.map(spot));
    }
    if let Some(place) = planned_path.tractor {
        tractor(canvas, spot(place));
    }
}

/// Draws a cross where each loop was given up.
pub(super) fn given_up(canvas: &mut Canvas, frame: &Frame, places: &[(f64, f64)]) {
    for &(x_m, y_m) in places {
        cross(canvas, frame.metres(x_m, y_m));
    }
}

/// Draws the path to the goal.
fn path(canvas: &mut Canvas, spots: &[Spot]) {
    canvas.line(spots, 4.5, palette::PAGE.alpha(0.8));
    canvas.line(spots, 2.4, palette::WINDOW.alpha(1.0));
}

/// Draws a shield.
fn shield(canvas: &mut Canvas, ends: [Spot; 2]) {
    canvas.line(&ends, 7.0, palette::PAGE.alpha(0.9));
    canvas.line(&ends, 4.0, palette::LOOP.alpha(1.0));
}

/// Draws a tractor point.
fn tractor(canvas: &mut Canvas, (x, y): Spot) {
    for (side, colour) in [
        (TRACTOR_PX + 4.0, palette::PAGE),
        (TRACTOR_PX, palette::LOOP),
    ] {
        let corner = (x - side / 2.0, y - side / 2.0);
        canvas.rect(corner, side, side, colour.alpha(1.0));
    }
}

/// Draws the mark of a loop that was given up.
fn cross(canvas: &mut Canvas, (x, y): Spot) {
    for (width, colour) in [(6.0, palette::PAGE), (2.6, palette::LOOP)] {
        for side in [-1.0, 1.0] {
            let ends = [(x - 5.0, y - 5.0 * side), (x + 5.0, y + 5.0 * side)];
            canvas.line(&ends, width, colour.alpha(1.0));
        }
    }
}

/// A key of the legend: a function that draws its mark at a spot, and its words.
pub(super) type Key = (fn(&mut Canvas, Spot), &'static str);

/// Returns the keys of the marks in a scene.
pub(super) fn keys(scene: &Scene<'_>) -> Vec<Key> {
    let mut keys: Vec<Key> = Vec::new();
    if scene.map.has_closed_regions() {
        keys.push((
            |canvas, spot| patch(canvas, spot, palette::CLOSED),
            "near a closed loop",
        ));
    }
    if scene.map.has_given_up_regions() {
        keys.push((
            |canvas, spot| patch(canvas, spot, palette::GIVEN_UP),
            "no loop closed here",
        ));
    }
    if scene.map.visit_stamp_span().is_some() {
        keys.push((age_key, "rail, newest to oldest"));
    }
    if !scene.believed.is_empty() {
        keys.push((
            |canvas, spot| thin(canvas, spot, palette::BELIEVED),
            "path as believed",
        ));
    }
    if !scene.corrected.is_empty() {
        keys.push((
            |canvas, spot| thin(canvas, spot, palette::CORRECTED),
            "path as corrected",
        ));
    }
    let planned_path = scene.planned_path;
    if planned_path.is_some_and(|planned_path| !planned_path.cells.is_empty()) {
        keys.push((
            |canvas, (x, y)| path(canvas, &[(x - 13.0, y), (x + 13.0, y)]),
            "path to the goal",
        ));
    }
    if planned_path.is_some_and(|planned_path| planned_path.tractor.is_some()) {
        keys.push((tractor, "tractor point"));
    }
    if planned_path.is_some_and(|planned_path| planned_path.shield.is_some()) {
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

fn thin(canvas: &mut Canvas, (x, y): Spot, colour: palette::Rgb) {
    let ends = [(x - 13.0, y), (x + 13.0, y)];
    canvas.line(&ends, layers::THIN, colour.alpha(1.0));
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
