//! A plot as an SVG: lines over one pair of axes that begin at 0, with a legend.
//!
//! Units: the labels name those of the figures; the page is in pixels, y down.

use core::fmt::Write as _;

/// Size of the page, and the space left of, above, right of and below the axes.
const PAGE: [f64; 2] = [760.0, 400.0];
const ROOM: [f64; 4] = [70.0, 46.0, 20.0, 52.0];
/// Most ticks of an axis.
const MOST_TICKS: f64 = 8.0;

/// A line of the plot.
#[derive(Clone, Debug)]
pub struct Series {
    /// Its name in the legend.
    pub name: &'static str,
    /// Its colour, in SVG's words.
    pub colour: &'static str,
    /// True if it is drawn in dashes.
    pub dashed: bool,
    /// x and y, in order of x.
    pub points: Vec<[f64; 2]>,
}

/// Draws a plot with a title and the labels of x and y.
#[must_use]
pub fn svg(title: &str, labels: [&str; 2], series: &[Series]) -> String {
    let most = |axis: usize| {
        let all = series.iter().flat_map(|series| &series.points);
        all.map(|point| point[axis]).fold(0.0, f64::max)
    };
    let (steps, most) = ([most(0), most(1)].map(tick), [most(0), most(1)]);
    let ends = [0, 1].map(|axis| (most[axis] / steps[axis]).ceil().max(1.0) * steps[axis]);
    let [width, height] = PAGE;
    let [left, top, right, bottom] = ROOM;
    let place = |[x, y]: [f64; 2]| {
        let across = x / ends[0] * (width - left - right);
        let up = y / ends[1] * (height - top - bottom);
        [left + across, height - bottom - up]
    };
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"{width}\" height=\"{height}\" fill=\"#ffffff\"/>\n"
    );
    text(&mut out, [left, 24.0], "start", title);
    axes(&mut out, place, steps, ends);
    text(&mut out, [width - right, height - 12.0], "end", labels[0]);
    text(&mut out, [left, top - 6.0], "start", labels[1]);
    for (k, series) in series.iter().enumerate() {
        line(&mut out, series, series.points.iter().map(|p| place(*p)));
        let y = top + 16.0 + 20.0 * k as f64;
        line(
            &mut out,
            series,
            [[left + 16.0, y], [left + 46.0, y]].into_iter(),
        );
        text(&mut out, [left + 54.0, y + 4.0], "start", series.name);
    }
    out + "</svg>\n"
}

/// Returns the distance of ticks on an axis up to `most`: 1, 2 or 5 times a power of ten.
fn tick(most: f64) -> f64 {
    let least = (most / MOST_TICKS).max(f64::MIN_POSITIVE);
    let power = 10_f64.powf(least.log10().floor());
    let fits = [1.0, 2.0, 5.0].into_iter().map(|times| times * power);
    fits.into_iter()
        .find(|step| *step >= least)
        .unwrap_or(10.0 * power)
}

fn axes(out: &mut String, place: impl Fn([f64; 2]) -> [f64; 2], steps: [f64; 2], ends: [f64; 2]) {
    for axis in [0, 1] {
        let count = (ends[axis] / steps[axis]).round() as u32;
        for value in (0..=count).map(|k| f64::from(k) * steps[axis]) {
            let (mut from, mut to) = ([0.0; 2], ends);
            (from[axis], to[axis]) = (value, value);
            let ([x1, y1], [x2, y2]) = (place(from), place(to));
            let _ = writeln!(
                out,
                "<path d=\"M{x1:.1} {y1:.1}L{x2:.1} {y2:.1}\" \
                 stroke=\"#dddddd\" fill=\"none\"/>"
            );
            let words = format!("{value}");
            if axis == 0 {
                text(out, [x1, y1 + 18.0], "middle", &words);
            } else {
                text(out, [x1 - 8.0, y1 + 4.0], "end", &words);
            }
        }
    }
}

fn text(out: &mut String, [x, y]: [f64; 2], anchor: &str, words: &str) {
    let words = words.replace('&', "&amp;").replace('<', "&lt;");
    let _ = writeln!(
        out,
        "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" \
         fill=\"#1d232b\">{words}</text>"
    );
}

fn line(out: &mut String, series: &Series, spots: impl Iterator<Item = [f64; 2]>) {
    let mut path = String::new();
    for (k, [x, y]) in spots.enumerate() {
        let letter = if k == 0 { 'M' } else { 'L' };
        let _ = write!(path, "{letter}{x:.1} {y:.1}");
    }
    let dashes = if series.dashed {
        " stroke-dasharray=\"5 4\""
    } else {
        ""
    };
    let colour = series.colour;
    let _ = writeln!(
        out,
        "<path d=\"{path}\" stroke=\"{colour}\" stroke-width=\"2\"{dashes} \
         fill=\"none\"/>"
    );
}

#[cfg(test)]
mod tests {
    use super::{Series, svg, tick};

    #[test]
    fn ticks_are_round_and_few() {
        assert_eq!(
            [8.0, 9.0, 40.0, 41.0, 0.3].map(tick),
            [1.0, 2.0, 5.0, 10.0, 0.05]
        );
    }

    #[test]
    fn lines_lie_where_the_axes_say() {
        let series = Series {
            name: "a < b",
            colour: "#123456",
            dashed: true,
            points: vec![[0.0, 0.0], [8.0, 4.0], [4.0, 8.0]],
        };
        let text = svg("title", ["x", "y"], &[series]);
        // 670 pixels across and 302 up, from (70, 348) on.
        assert!(
            text.contains("d=\"M70.0 348.0L740.0 197.0L405.0 46.0\" stroke=\"#123456\""),
            "{text}"
        );
        assert!(text.contains("a &lt; b") && text.ends_with("</svg>\n"));
    }
}
