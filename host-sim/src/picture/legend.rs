//! Text around the map: title, scale bar, the meaning of each colour, and the time scale of the
//! path.

use super::canvas::Canvas;
use super::ground::greyed;
use super::palette::{self, Rgb};
use super::{Frame, Ground, HEADER, MARGIN, Scene, layers, loops};

/// Distance of two lines, pixels.
const LINE: f32 = super::LINE as f32;

/// Height of the time scale, pixels.
const TIME_BAR: f32 = 118.0;
/// Height of the scale of heights, pixels.
const HEIGHT_BAR: f32 = 78.0;

/// Draws the two lines above the map.
pub(super) fn lines(canvas: &mut Canvas, title: &str, subtitle: &str) {
    let left = MARGIN as f32;
    canvas.text((left, 37.0), 23.0, title, palette::INK);
    canvas.text((left, 61.0), 15.5, subtitle, palette::FAINT);
}

/// Draws a bar of a round length, at most a quarter of the width of the map.
pub(super) fn scale_bar(canvas: &mut Canvas, frame: &Frame) {
    let metres = round_length(frame.width() as f32 / frame.metre_px() / 4.0);
    let length = metres * frame.metre_px();
    let (left, top) = (
        frame.left as f32,
        (frame.top + frame.height()) as f32 + 20.0,
    );
    let ink = palette::INK.alpha(1.0);
    canvas.rect((left, top), length, 5.0, ink);
    canvas.rect(
        (left + length / 2.0, top + 1.0),
        length / 2.0 - 1.0,
        3.0,
        palette::PAGE.alpha(1.0),
    );
    let label = format!("{metres} m");
    let at = (left + length + 9.0, top + 8.0);
    canvas.text(at, 14.0, &label, palette::INK);
}

/// Draws a caption below a map.
pub(super) fn caption(canvas: &mut Canvas, frame: &Frame, words: &str) {
    let at = (
        frame.left as f32,
        (frame.top + frame.height()) as f32 + 28.0,
    );
    canvas.text(at, 14.0, words, palette::INK);
}

/// Returns 1, 2 or 5 times a power of ten, at most `metres`, and at least 1.
fn round_length(metres: f32) -> f32 {
    let lengths = [1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
    let fitting = lengths.into_iter().rfind(|length| *length <= metres);
    fitting.unwrap_or(1.0)
}

/// Draws the keys, from `left` on.
pub(super) fn panel(canvas: &mut Canvas, left: i32, scene: &Scene<'_>) {
    let (left, mut y) = (left as f32, HEADER as f32 + 8.0);
    let mid = left + 13.0;
    let cells = [
        (palette::FREE, "free"),
        (palette::OBSTACLE, "obstacle"),
        (palette::NEGATIVE, "negative obstacle"),
        (palette::UNKNOWN, "not measured"),
    ];
    // A flat world has no negative obstacles.
    let level = scene.ground.is_none();
    for (colour, words) in cells {
        if level && colour == palette::NEGATIVE {
            continue;
        }
        swatch(canvas, (left, y), colour);
        label(canvas, left, y, words);
        y += LINE;
    }
    canvas.line(
        &[(left, y), (left + 26.0, y)],
        2.0,
        palette::SKELETON.alpha(1.0),
    );
    label(canvas, left, y, "skeleton");
    y += LINE;
    if scene.window.is_some() {
        swatch(canvas, (left, y), palette::field(0.6));
        layers::arrow(canvas, (mid, y), (1.0, 0.0), 18.0, 1.2);
        label(canvas, left, y, "field, last window");
        y += LINE;
    }
    layers::ring(canvas, (mid, y), 6.0);
    label(canvas, left, y, "start");
    y += LINE;
    layers::head(canvas, (mid, y), 0.0, 9.0);
    label(canvas, left, y, "end");
    y += LINE;
    if !scene.residual.is_empty() {
        layers::diamond(canvas, (mid, y));
        label(canvas, left, y, "frontier left");
        y += LINE;
    }
    if !scene.not_worth_it.is_empty() {
        layers::hollow_diamond(canvas, (mid, y));
        label(canvas, left, y, "not worth the trip");
        y += LINE;
    }
    for (mark, words) in loops::keys(scene) {
        mark(canvas, (mid, y));
        label(canvas, left, y, words);
        y += LINE;
    }
    time_bar(canvas, left, y + 4.0, scene);
    if let Some(ground) = &scene.ground {
        ground_keys(canvas, left, y + TIME_BAR + 38.0, ground);
    }
}

/// Draws the keys of the true ground: its heights above the start, and its classes.
fn ground_keys(canvas: &mut Canvas, left: f32, mut y: f32, ground: &Ground<'_>) {
    let [low_m, high_m] = ground.span_m();
    for i in 0..HEIGHT_BAR as i32 {
        let colour = palette::height(1.0 - i as f32 / HEIGHT_BAR);
        canvas.rect((left + 6.0, y + i as f32), 14.0, 1.5, colour.alpha(1.0));
    }
    label(canvas, left, y + 6.0, &signed(high_m));
    let contour = format!("contours of {} m", ground.contour_m());
    label(canvas, left, y + HEIGHT_BAR / 2.0, &contour);
    label(canvas, left, y + HEIGHT_BAR - 5.0, &signed(low_m));
    y += HEIGHT_BAR + 28.0;
    for (colour, words) in [
        (palette::STEEP_UP, "rises too steeply"),
        (palette::NEGATIVE, "falls too steeply, hole"),
        (palette::STEEP_BOTH, "either, by the side"),
        (greyed(palette::height(0.5)), "out of reach"),
    ] {
        swatch(canvas, (left, y), colour);
        label(canvas, left, y, words);
        y += LINE;
    }
}

/// Formats a height above the start.
fn signed(height_m: f64) -> String {
    format!("{height_m:+.2} m from the start")
}

/// Draws the mark of a colour.
pub(super) fn swatch(canvas: &mut Canvas, (left, y): (f32, f32), colour: Rgb) {
    let corners = |inset: f32| {
        let (x0, y0) = (left + inset, y - 8.0 + inset);
        let (x1, y1) = (left + 26.0 - inset, y + 8.0 - inset);
        [(x0, y0), (x1, y0), (x1, y1), (x0, y1)]
    };
    canvas.polygon(&corners(0.0), colour.alpha(1.0));
    canvas.outline(&corners(0.5), 1.0, palette::HAIR.alpha(1.0));
}

/// Draws the words beside a mark.
pub(super) fn label(canvas: &mut Canvas, left: f32, y: f32, words: &str) {
    canvas.text((left + 40.0, y + 5.0), 15.5, words, palette::INK);
}

/// Draws the colours of the path over simulated time.
fn time_bar(canvas: &mut Canvas, left: f32, top: f32, scene: &Scene<'_>) {
    let total_s = (scene.path.last().map_or(0, |p| p.time_ms) + 500) / 1000;
    let (x, width) = (left + 6.0, 14.0);
    for i in 0..TIME_BAR as i32 {
        let share = i as f32 / TIME_BAR;
        let y = top + i as f32;
        canvas.rect((x, y), width, 1.5, palette::time(share).alpha(1.0));
    }
    label(canvas, left, top + 6.0, "path from 0:00");
    let end = format!("to {}:{:02} min", total_s / 60, total_s % 60);
    label(canvas, left, top + TIME_BAR - 5.0, &end);
}

#[cfg(test)]
mod tests {
    use super::round_length;

    #[test]
    fn scale_bars_are_round() {
        let lengths = [0.3, 1.9, 4.2, 5.0, 23.0, 400.0].map(round_length);
        assert_eq!(lengths, [1.0, 1.0, 2.0, 5.0, 20.0, 100.0]);
    }
}
