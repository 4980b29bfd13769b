//! Share known over simulated time: the median of a strategy's trials and the band between their
//! quartiles. A trial that has ended keeps its last share.

use plotters::chart::ChartBuilder;
use plotters::element::{PathElement, Polygon};
use plotters::prelude::{DashedLineSeries, LineSeries};
use plotters::style::{Color as _, IntoFont as _};

use super::{Canvas, Failure, Group, LABEL, colour, drawing, head, plain};
use crate::campaign::statistics::quantile;

/// Size of a plot.
const SIZE: (u32, u32) = (720, 460);
/// Number of points of a curve.
const POINTS: usize = 240;
/// Lengths of dash and gap of the strategies, in their order; a gap of 0 is a whole line.
const DASHES: [(u32, u32); 4] = [(1, 0), (9, 4), (3, 3), (14, 6)];

/// Quartiles at a time.
type Quartiles = (f64, [f64; 3]);

/// Draws the plot of a group; `None` if no trial has a curve.
pub(super) fn draw(
    title: &str,
    labels: &[String],
    group: &Group<'_>,
) -> Result<Option<String>, Failure> {
    let curves = |rows: &Vec<&super::Row<'_>>| -> Vec<Vec<[f64; 2]>> {
        let curves = rows.iter().map(|row| row.line.coverage.clone());
        curves.filter(|curve| !curve.is_empty()).collect()
    };
    let arms: Vec<Vec<Vec<[f64; 2]>>> = group.arms.iter().map(curves).collect();
    let ends = arms.iter().flatten().filter_map(|curve| curve.last());
    let Some(end_s) = ends.map(|point| point[0]).reduce(f64::max) else {
        return Ok(None);
    };
    let end_s = end_s.max(1.0);
    drawing(SIZE, |canvas| {
        let top = head(canvas, title, labels, sample)?;
        let (_, below) = canvas.split_vertically(top);
        let mut chart = ChartBuilder::on(&below)
            .margin_left(14)
            .margin_right(24)
            .x_label_area_size(44)
            .y_label_area_size(60)
            .build_cartesian_2d(0.0..end_s, 0.0..102.0)?;
        chart
            .configure_mesh()
            .light_line_style(plotters::style::TRANSPARENT)
            .x_desc("simulated time, s")
            .x_label_formatter(&|at| plain(*at))
            .y_label_formatter(&|at| plain(*at))
            .y_desc("known, % of what can be seen")
            .label_style(("sans-serif", LABEL).into_font())
            .draw()?;
        for (index, curves) in arms.iter().enumerate().filter(|(_, it)| !it.is_empty()) {
            let quartiles = quartiles(curves, end_s);
            let lower = quartiles.iter().map(|(t, q)| (*t, q[0]));
            let upper = quartiles.iter().rev().map(|(t, q)| (*t, q[2]));
            let band: Vec<(f64, f64)> = lower.chain(upper).collect();
            chart.draw_series([Polygon::new(band, colour(index).mix(0.18).filled())])?;
            let median = quartiles.iter().map(|(t, q)| (*t, q[1]));
            let style = colour(index).stroke_width(2);
            match DASHES[index % DASHES.len()] {
                (_, 0) => chart.draw_series(LineSeries::new(median, style))?,
                (dash, gap) => {
                    chart.draw_series(DashedLineSeries::new(median, dash, gap, style))?
                }
            };
        }
        Ok(())
    })
    .map(Some)
}

/// Returns the quartiles of the curves, in per cent, at times from 0 to the end.
fn quartiles(curves: &[Vec<[f64; 2]>], end_s: f64) -> Vec<Quartiles> {
    let at = |point: usize| {
        let time_s = end_s * point as f64 / (POINTS - 1) as f64;
        let shares = curves.iter().filter_map(|curve| share(curve, time_s));
        let shares: Vec<f64> = shares.map(|share| 100.0 * share).collect();
        (
            time_s,
            [0.25, 0.5, 0.75].map(|part| quantile(&shares, part)),
        )
    };
    (0..POINTS).map(at).collect()
}

/// Returns the share known at a time: linear between the moments, and the last one after the end.
fn share(curve: &[[f64; 2]], time_s: f64) -> Option<f64> {
    let next = curve.partition_point(|point| point[0] <= time_s);
    let before = curve.get(next.saturating_sub(1))?;
    let Some(after) = curve.get(next).filter(|_| next > 0) else {
        return Some(before[1]);
    };
    let part = (time_s - before[0]) / (after[0] - before[0]);
    Some(before[1] + part * (after[1] - before[1]))
}

/// Draws a piece of a strategy's line.
fn sample(canvas: &Canvas<'_>, index: usize, (x, y): (i32, i32)) -> Result<(), Failure> {
    let (dash, gap) = DASHES[index % DASHES.len()];
    let (from, to) = (x, x + 26);
    let style = colour(index).stroke_width(3);
    let mut at = from;
    while at < to {
        let end = if gap == 0 {
            to
        } else {
            (at + dash as i32).min(to)
        };
        canvas.draw(&PathElement::new(vec![(at, y), (end, y)], style))?;
        at = end + gap as i32;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::share;

    #[test]
    fn a_curve_is_linear_between_its_moments_and_keeps_its_ends() {
        let curve = [[1.0, 0.2], [3.0, 0.6], [5.0, 0.7]];
        let shares = [0.0, 1.0, 2.0, 3.0, 4.5, 9.0].map(|time_s| share(&curve, time_s).unwrap());
        let wanted = [0.2, 0.2, 0.4, 0.6, 0.675, 0.7];
        for (share, wanted) in shares.iter().zip(wanted) {
            assert!((share - wanted).abs() < 1e-12, "{shares:?}");
        }
        assert_eq!(share(&[], 1.0), None);
    }
}
