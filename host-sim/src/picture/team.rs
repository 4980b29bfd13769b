//! The picture of a team's run: what the robots know together, and the path of each robot in its
//! own colour.

use super::canvas::{Canvas, Spot};
use super::legend::{self, label, swatch};
use super::palette::{self, Rgb};
use super::{FOOTER, Frame, GOOD_SIDE, HEADER, LEAST_WIDTH, LINE, MARGIN, PANEL, area, layers};
use crate::report::GridMap;
use crate::report::tum::Stamped;

/// Colours of robots 0 to 7, distinct to colour-blind eyes \[Wong11\].
///
/// \[Wong11\]: B. Wong, "Points of view: Color blindness", Nature Methods 8, 2011. The yellow is
/// darker here, because it lies on white.
const ROBOTS: [Rgb; 8] = [
    Rgb(0x00, 0x72, 0xb2),
    Rgb(0xd5, 0x5e, 0x00),
    Rgb(0x00, 0x9e, 0x73),
    Rgb(0xcc, 0x79, 0xa7),
    Rgb(0x56, 0xb4, 0xe9),
    Rgb(0xe6, 0x9f, 0x00),
    Rgb(0x4d, 0x4d, 0x4d),
    Rgb(0xb3, 0xa1, 0x00),
];

/// Contents of the picture.
#[derive(Clone, Copy, Debug)]
pub struct TeamScene<'a> {
    /// First line.
    pub title: &'a str,
    /// Second line.
    pub subtitle: &'a str,
    /// What the robots know together.
    pub map: &'a GridMap,
    /// The path of each robot, in the order of their numbers.
    pub paths: &'a [Vec<Stamped>],
    /// Residual frontiers, metres.
    pub residual: &'a [(f64, f64)],
}

/// Draws the PNG file of a team's run; empty only if the page does not fit into memory.
#[must_use]
pub fn team_png(scene: &TeamScene<'_>) -> Vec<u8> {
    let frame = Frame::around(area(scene.map), GOOD_SIDE);
    let maps = (frame.left + frame.width()).max(MARGIN + LEAST_WIDTH);
    let keys = LINE * (scene.paths.len() as i32 + 7);
    let height = (HEADER + frame.height() + FOOTER).max(HEADER + keys) + MARGIN;
    let width = maps + PANEL + MARGIN;
    let page = Canvas::new(width.unsigned_abs(), height.unsigned_abs(), palette::PAGE);
    let Some(mut canvas) = page else {
        return Vec::new();
    };
    layers::map(&mut canvas, &frame, scene.map);
    layers::skeleton(&mut canvas, &frame, scene.map);
    for (path, colour) in scene.paths.iter().zip(ROBOTS) {
        draw(&mut canvas, &frame, path, colour);
    }
    layers::residual(&mut canvas, &frame, scene.residual);
    for path in scene.paths {
        layers::ends(&mut canvas, &frame, path);
    }
    legend::lines(&mut canvas, scene.title, scene.subtitle);
    legend::scale_bar(&mut canvas, &frame);
    panel(&mut canvas, maps + 32, scene);
    canvas.png().unwrap_or_default()
}

fn draw(canvas: &mut Canvas, frame: &Frame, path: &[Stamped], colour: Rgb) {
    let spots: Vec<Spot> = path.iter().map(|p| frame.metres(p.x_m, p.y_m)).collect();
    let width = (frame.cell_px as f32 * 0.5).clamp(1.6, 3.0);
    canvas.line(&spots, width + 2.0, palette::PAGE.alpha(0.75));
    canvas.line(&spots, width, colour.alpha(1.0));
}

/// Draws the keys, from `left` on.
fn panel(canvas: &mut Canvas, left: i32, scene: &TeamScene<'_>) {
    let line = LINE as f32;
    let (left, mut y) = (left as f32, HEADER as f32 + 8.0);
    for (colour, words) in [
        (palette::FREE, "free"),
        (palette::OBSTACLE, "obstacle"),
        (palette::UNKNOWN, "not measured"),
    ] {
        swatch(canvas, (left, y), colour);
        label(canvas, left, y, words);
        y += line;
    }
    for (robot, (_, colour)) in scene.paths.iter().zip(ROBOTS).enumerate() {
        canvas.line(&[(left, y), (left + 26.0, y)], 4.0, colour.alpha(1.0));
        label(canvas, left, y, &format!("robot {robot}"));
        y += line;
    }
    let mid = left + 13.0;
    layers::ring(canvas, (mid, y), 6.0);
    label(canvas, left, y, "start");
    y += line;
    layers::head(canvas, (mid, y), 0.0, 9.0);
    label(canvas, left, y, "end");
    if !scene.residual.is_empty() {
        y += line;
        layers::diamond(canvas, (mid, y));
        label(canvas, left, y, "frontier left");
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::grid_map::MapCell;

    #[test]
    fn each_robot_has_its_colour_on_the_picture() {
        let mut map = GridMap::unknown(0, 0, 60, 40);
        for (x, y) in (0..60).flat_map(|x| (0..40).map(move |y| (x, y))) {
            map.set(x, y, MapCell::Free);
        }
        let along = |y_m: f64| {
            let place = |k: i32| Stamped {
                x_m: f64::from(k) * 0.1,
                y_m,
                ..Stamped::default()
            };
            (5..55).map(place).collect::<Vec<_>>()
        };
        let paths: Vec<Vec<Stamped>> = (1..=8).map(|k| along(0.4 * f64::from(k))).collect();
        let scene = TeamScene {
            title: "a",
            subtitle: "b",
            map: &map,
            paths: &paths,
            residual: &[(1.0, 1.0)],
        };
        let page = tiny_skia::Pixmap::decode_png(&team_png(&scene)).expect("a PNG");
        for (robot, Rgb(r, g, b)) in ROBOTS.into_iter().enumerate() {
            let is_its = |it: &&tiny_skia::PremultipliedColorU8| {
                (it.red(), it.green(), it.blue()) == (r, g, b)
            };
            let found = page.pixels().iter().filter(is_its).count();
            assert!(found > 100, "robot {robot}: {found}");
        }
    }
}
