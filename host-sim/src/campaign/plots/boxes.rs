//! Box plots by world and strategy: box from quartile to quartile, line at the median, whiskers to
//! the least and the greatest, a dot for each trial.

use plotters::backend::SVGBackend;
use plotters::chart::{ChartBuilder, ChartContext};
use plotters::coord::types::RangedCoordf64;
use plotters::element::{Circle, PathElement, Rectangle, Text};
use plotters::prelude::Cartesian2d;
use plotters::style::text_anchor::{HPos, VPos};
use plotters::style::{Color as _, IntoFont as _};

use super::{
    Canvas, Failure, Group, LABEL, LEGEND_LINE, TITLE, colour, drawing, head, label_style, plain,
    square, text_width,
};
use crate::campaign::statistics::Summary;
use crate::campaign::table::numbers;

/// Width of a box with the gap beside it.
const SLOT: u32 = 34;
/// Height of the field with the boxes.
const HEIGHT: u32 = 320;
/// Width of the labels of the axis.
const AXIS: u32 = 72;

/// The field with the boxes.
type Field<'a, 'b> = ChartContext<'a, SVGBackend<'b>, Cartesian2d<RangedCoordf64, RangedCoordf64>>;

/// The greatest value by the least above which the axis is logarithmic.
const WIDE: f64 = 30.0;

/// The axis: from 0, or logarithmic.
#[derive(Clone, Copy)]
struct Scale {
    is_log: bool,
    from: f64,
    to: f64,
}

impl Scale {
    /// Chooses the axis for these values; `None` if there are none.
    fn of(values: impl Iterator<Item = f64> + Clone, may_be_log: bool) -> Option<Self> {
        let most = values.clone().reduce(f64::max)?;
        let least = values.reduce(f64::min)?;
        if may_be_log && least > 0.0 && most > WIDE * least {
            let (from, to) = (least.log10() - 0.1, most.log10() + 0.1);
            let is_log = true;
            return Some(Self { is_log, from, to });
        }
        Some(Self {
            is_log: false,
            from: 0.0,
            // An axis needs a length.
            to: if most > 0.0 { 1.05 * most } else { 1.0 },
        })
    }

    /// Returns the place of a value.
    fn at(self, value: f64) -> f64 {
        if self.is_log { value.log10() } else { value }
    }

    /// Returns the text at a place.
    fn label(self, at: f64) -> String {
        if !self.is_log {
            return plain(at);
        }
        let value = 10.0_f64.powf(at);
        // Two digits: places are halves or fifths of a decade.
        let decimals = (1.0 - value.log10().floor()).clamp(0.0, 6.0) as usize;
        plain(format!("{value:.decimals$}").parse().unwrap_or(value))
    }

    const fn remark(self) -> &'static str {
        if self.is_log { " (logarithmic)" } else { "" }
    }
}

/// A box plot.
pub(super) struct Chart<'a> {
    pub(super) title: String,
    /// What the axis shows, with the unit.
    pub(super) axis: &'a str,
    /// Path of the column.
    pub(super) column: &'a str,
    /// The axis is logarithmic if the values differ by much.
    pub(super) may_be_log: bool,
    /// Names of the strategies.
    pub(super) labels: &'a [String],
    pub(super) groups: &'a [Group<'a>],
}

impl Chart<'_> {
    /// Draws the plot; `None` if no trial has a value.
    pub(super) fn draw(&self) -> Result<Option<String>, Failure> {
        let samples: Vec<Vec<Vec<f64>>> = self.groups.iter().map(|it| self.samples(it)).collect();
        let values = samples.iter().flatten().flatten().copied();
        let Some(scale) = Scale::of(values, self.may_be_log) else {
            return Ok(None);
        };
        let slots = self.labels.len() as u32 + 1;
        let names = self
            .groups
            .iter()
            .map(|group| text_width(&group.label) + 16);
        let group_width = names.max().unwrap_or(0).max(slots * SLOT);
        let width = AXIS + 30 + group_width * self.groups.len() as u32;
        let width = width.max(text_width(&self.title) * 3 / 2 + 32).max(420);
        let legend_lines = 1 + self
            .labels
            .iter()
            .map(|it| text_width(it) + 44)
            .sum::<u32>()
            / width;
        let height = TITLE + legend_lines * LEGEND_LINE + HEIGHT + 40;
        drawing((width, height), |canvas| {
            let top = head(canvas, &self.title, self.labels, square)?;
            self.field(canvas, top, scale, &samples)
        })
        .map(Some)
    }

    /// Returns the values of a group by strategy.
    fn samples(&self, group: &Group<'_>) -> Vec<Vec<f64>> {
        let of_arm = |rows: &Vec<_>| numbers(rows, self.column).into_values().collect();
        group.arms.iter().map(of_arm).collect()
    }

    fn field(
        &self,
        canvas: &Canvas<'_>,
        top: u32,
        scale: Scale,
        samples: &[Vec<Vec<f64>>],
    ) -> Result<(), Failure> {
        let (_, below) = canvas.split_vertically(top);
        let slots = (self.labels.len() + 1) as f64;
        let mut chart = ChartBuilder::on(&below)
            .margin_left(14)
            .margin_right(16)
            .x_label_area_size(32)
            .y_label_area_size(AXIS)
            .build_cartesian_2d(0.0..slots * samples.len() as f64, scale.from..scale.to)?;
        chart
            .configure_mesh()
            .disable_x_mesh()
            .x_labels(0)
            .light_line_style(plotters::style::TRANSPARENT)
            .y_desc(format!("{}{}", self.axis, scale.remark()))
            .y_label_formatter(&|at| scale.label(*at))
            .label_style(("sans-serif", LABEL).into_font())
            .draw()?;
        for (number, (group, samples)) in self.groups.iter().zip(samples).enumerate() {
            let left = slots * number as f64;
            for (index, sample) in samples.iter().enumerate() {
                draw_box(
                    &mut chart,
                    scale,
                    (left + index as f64 + 1.0, index),
                    sample,
                )?;
            }
            let (x, y) = chart.backend_coord(&(left + slots / 2.0, scale.from));
            let style = label_style(HPos::Center, VPos::Top);
            canvas.draw(&Text::new(group.label.clone(), (x, y + 10), style))?;
        }
        Ok(())
    }
}

/// Draws the box of a strategy at a place of the axis.
fn draw_box(
    chart: &mut Field<'_, '_>,
    scale: Scale,
    (at, index): (f64, usize),
    sample: &[f64],
) -> Result<(), Failure> {
    let Some(summary) = Summary::of(sample) else {
        return Ok(());
    };
    let colour = colour(index);
    let marks = summary.quartiles.map(|value| scale.at(value));
    let [least, lower, median, upper, greatest] = marks;
    let across = |half: f64, y: f64| vec![(at - half, y), (at + half, y)];
    let corners = [(at - 0.36, lower), (at + 0.36, upper)];
    chart.draw_series([Rectangle::new(corners, colour.mix(0.25).filled())])?;
    let thin = colour.stroke_width(2);
    let (left, right) = (at - 0.36, at + 0.36);
    let frame = [
        (left, lower),
        (left, upper),
        (right, upper),
        (right, lower),
        (left, lower),
    ];
    let whiskers = [
        vec![(at, least), (at, lower)],
        vec![(at, upper), (at, greatest)],
    ];
    let caps = [across(0.18, least), across(0.18, greatest)];
    let lines = whiskers.into_iter().chain(caps).chain([frame.to_vec()]);
    chart.draw_series(lines.map(|line| PathElement::new(line, thin)))?;
    let middle = PathElement::new(across(0.36, median), colour.stroke_width(4));
    chart.draw_series([middle])?;
    let dot = |value: &f64| Circle::new((at, scale.at(*value)), 2, colour.mix(0.7).filled());
    chart.draw_series(sample.iter().map(dot))?;
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::Scale;

    #[test]
    fn an_axis_is_logarithmic_where_values_differ_by_much_and_may_be() {
        let scale = |values: &[f64], may_be_log| Scale::of(values.iter().copied(), may_be_log);
        let log = scale(&[0.1, 1.0, 10.0], true).unwrap();
        assert!(log.is_log && log.from < log.at(0.1) && log.at(10.0) < log.to);
        let labels = [-1.0, -0.5, 0.0, 0.5, 1.0, 2.2].map(|at| log.label(at));
        assert_eq!(labels, ["0.1", "0.32", "1", "3.2", "10", "158"]);
        for (values, may_be_log) in [(vec![0.1, 10.0], false), (vec![0.0, 10.0], true)] {
            let linear = scale(&values, may_be_log).unwrap();
            assert!(!linear.is_log && linear.from == 0.0 && linear.to > 10.0);
            assert_eq!(linear.label(2.5), "2.5");
        }
        assert_eq!(scale(&[0.0], true).unwrap().to, 1.0);
        assert!(scale(&[], true).is_none());
    }
}
