//! Plots of a campaign, as SVG.
//!
//! | file | content |
//! | --- | --- |
//! | `time.svg` | box plots of the time to the end, by world and strategy |
//! | `error.svg` | box plots of the mean error of the position |
//! | `particles.svg` | box plots of PFErr, if the trials have a particle filter |
//! | `coverage-WORLD.svg` | share known over simulated time: median and quartiles of a strategy |
//!
//! The colours are those of \[Okabe08\], which the colour-blind can tell apart; lines also differ
//! in their dashes. Sizes are pixels.
//!
//! Okabe08: M. Okabe, K. Ito, "Color universal design", 2008.

mod boxes;
mod coverage;

use std::fs;
use std::path::Path;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::element::{Rectangle, Text};
use plotters::prelude::{DrawingArea, IntoDrawingArea as _};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{BLACK, Color as _, IntoFont as _, RGBColor, TextStyle, WHITE};

use super::CampaignError;
use super::columns::Row;
use super::plan::{Plan, row_name};
use super::store::Finished;

/// Folder of the plots in a campaign's folder.
pub const FOLDER: &str = "plots";
/// Colours of the strategies, in their order; then they begin again.
const COLOURS: [RGBColor; 7] = [
    RGBColor(0, 114, 178),
    RGBColor(213, 94, 0),
    RGBColor(0, 158, 115),
    RGBColor(204, 121, 167),
    RGBColor(230, 159, 0),
    RGBColor(86, 180, 233),
    RGBColor(0, 0, 0),
];
/// Width of a letter of the labels, about.
const LETTER: u32 = 8;
/// Size of the labels' letters.
const LABEL: u32 = 15;
/// Height of the title.
const TITLE: u32 = 34;
/// Height of a line of the legend.
const LEGEND_LINE: u32 = 20;
/// Left end of title and legend.
const LEFT: i32 = 16;

/// A place to draw on.
type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
/// Anything that can go wrong while drawing.
type Failure = Box<dyn core::error::Error>;

/// Draws the sample of a strategy at a place.
type Swatch = fn(&Canvas<'_>, usize, (i32, i32)) -> Result<(), Failure>;

/// A world with an odometry: its label, and its trials of each strategy.
struct Group<'a> {
    label: String,
    arms: Vec<Vec<&'a Row<'a>>>,
}

/// Draws all plots into the folder of a campaign.
///
/// # Errors
/// The system refuses to write a file.
pub fn write(folder: &Path, plan: &Plan, finished: &[Finished]) -> Result<(), CampaignError> {
    let mut ordered: Vec<&Finished> = finished.iter().collect();
    ordered.sort_by_key(|line| line.index);
    let rows: Vec<Row<'_>> = ordered.into_iter().map(Row::new).collect();
    let groups = groups(plan, &rows);
    let labels: Vec<String> = plan.arms().into_iter().map(|arm| arm.label).collect();
    let folder = folder.join(FOLDER);
    fs::create_dir_all(&folder)
        .map_err(|error| CampaignError::io("make this folder", &folder, &error))?;
    for (name, column, axis, may_be_log) in [
        ("time", "sim_time_s", "simulated time to the end, s", false),
        (
            "error",
            "localization.mean_error_m",
            "mean error of the position, m",
            true,
        ),
        (
            "particles",
            "particles.pf_error_m",
            "PFErr, mean error of the particles, m",
            true,
        ),
    ] {
        let chart = boxes::Chart {
            title: format!("{}: {axis}", plan.name),
            axis,
            column,
            may_be_log,
            labels: &labels,
            groups: &groups,
        };
        put(&folder, name, chart.draw())?;
    }
    for group in &groups {
        let title = format!("{}: {}", plan.name, group.label);
        let name = format!("coverage-{}", file_name(&group.label));
        put(&folder, &name, coverage::draw(&title, &labels, group))?;
    }
    Ok(())
}

fn put(
    folder: &Path,
    name: &str,
    drawn: Result<Option<String>, Failure>,
) -> Result<(), CampaignError> {
    let path = folder.join(format!("{name}.svg"));
    let drawn = drawn
        .map_err(|error| CampaignError::new(format!("cannot draw it: {error}")).in_file(&path))?;
    match drawn {
        Some(text) => super::store::put(&path, &text),
        None => Ok(()),
    }
}

fn groups<'a>(plan: &Plan, rows: &'a [Row<'a>]) -> Vec<Group<'a>> {
    let mut groups = Vec::new();
    for world in &plan.worlds {
        for odometry in plan.odometries() {
            let shown = odometry.as_deref().filter(|_| plan.odometry.len() > 1);
            let of = |arm: &str| -> Vec<&Row<'a>> {
                let is_here = |row: &&Row<'a>| {
                    let line = row.line;
                    line.world == *world && line.odometry == odometry && line.strategy == arm
                };
                rows.iter().filter(is_here).collect()
            };
            groups.push(Group {
                label: row_name(world, shown),
                arms: plan.arms().iter().map(|arm| of(&arm.label)).collect(),
            });
        }
    }
    groups
}

/// Returns a label as part of a file's name.
fn file_name(label: &str) -> String {
    let is_good = |it: char| it.is_alphanumeric() || "-_.".contains(it);
    let words = label
        .split(|it| !is_good(it))
        .filter(|word| !word.is_empty());
    words.collect::<Vec<_>>().join("-")
}

/// Returns the colour of a strategy.
fn colour(index: usize) -> RGBColor {
    COLOURS[index % COLOURS.len()]
}

/// Draws on a canvas of this size; returns the file's text.
fn drawing(
    size: (u32, u32),
    draw: impl FnOnce(&Canvas<'_>) -> Result<(), Failure>,
) -> Result<String, Failure> {
    let mut text = String::new();
    {
        let canvas = SVGBackend::with_string(&mut text, size).into_drawing_area();
        canvas.fill(&WHITE)?;
        draw(&canvas)?;
        canvas.present()?;
    }
    Ok(text)
}

/// Returns the style of labels with this anchor.
fn label_style<'a>(horizontal: HPos, vertical: VPos) -> TextStyle<'a> {
    let style = ("sans-serif", LABEL).into_font().color(&BLACK);
    style.pos(Pos::new(horizontal, vertical))
}

/// Returns a number of an axis without needless zeros.
fn plain(value: f64) -> String {
    // The additions of a scale leave rounding errors; adding 0 removes the sign of a zero.
    ((value * 1e6).round() / 1e6 + 0.0).to_string()
}

/// Returns the width of the text, about.
fn text_width(text: &str) -> u32 {
    text.chars().count() as u32 * LETTER
}

/// Draws title and legend at the top; returns the height that they take. `swatch` draws the sample
/// of a strategy at a place.
fn head(
    canvas: &Canvas<'_>,
    title: &str,
    labels: &[String],
    swatch: Swatch,
) -> Result<u32, Failure> {
    let style = ("sans-serif", 20).into_font().color(&BLACK);
    canvas.draw(&Text::new(title.to_owned(), (LEFT, 10), style))?;
    let (width, _) = canvas.dim_in_pixel();
    let (mut x, mut y) = (LEFT, TITLE as i32);
    for (index, label) in labels.iter().enumerate() {
        let step = (30 + text_width(label) + 14) as i32;
        if x > LEFT && x + step > width as i32 {
            x = LEFT;
            y += LEGEND_LINE as i32;
        }
        let middle = y + LEGEND_LINE as i32 / 2;
        swatch(canvas, index, (x, middle))?;
        let style = label_style(HPos::Left, VPos::Center);
        canvas.draw(&Text::new(label.clone(), (x + 30, middle), style))?;
        x += step;
    }
    Ok(y as u32 + LEGEND_LINE + 6)
}

/// Draws a filled square as the sample of a strategy.
fn square(canvas: &Canvas<'_>, index: usize, (x, y): (i32, i32)) -> Result<(), Failure> {
    let corners = [(x + 4, y - 6), (x + 22, y + 6)];
    canvas.draw(&Rectangle::new(corners, colour(index).mix(0.45).filled()))?;
    canvas.draw(&Rectangle::new(corners, colour(index).stroke_width(2)))?;
    Ok(())
}

#[cfg(test)]
mod tests;
