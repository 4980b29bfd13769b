//! A page of pixels, with crisp cells, antialiased lines, discs and polygons, and text.
//!
//! Units: pixels, x to the right, y down; the centre of a pixel is at (0.5, 0.5). Drawing is
//! clipped to the page.

use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Paint, Path, PathBuilder, Pixmap, Stroke, Transform,
};

use super::palette::Rgb;
use super::text::outline;

/// A point of the page.
pub(super) type Spot = (f32, f32);

/// The pixels of a page, row by row from the top.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Pixels {
    /// Pixels of a row.
    pub width: usize,
    /// Number of rows.
    pub height: usize,
    /// Red, green, blue and 255 of each.
    pub rgba: Vec<u8>,
}

/// A page.
pub(super) struct Canvas {
    pixmap: Pixmap,
}

impl Canvas {
    /// Makes a page of one colour, at least one pixel wide and high.
    pub(super) fn new(width: u32, height: u32, page: Rgb) -> Option<Self> {
        let mut pixmap = Pixmap::new(width.max(1), height.max(1))?;
        pixmap.fill(page.alpha(1.0));
        Some(Self { pixmap })
    }

    /// Encodes the page as a PNG file.
    pub(super) fn png(&self) -> Option<Vec<u8>> {
        self.pixmap.encode_png().ok()
    }

    /// Returns the page's width, height and pixels.
    pub(super) fn into_pixels(self) -> Pixels {
        Pixels {
            width: self.pixmap.width() as usize,
            height: self.pixmap.height() as usize,
            // The page is opaque, so the colours are not premultiplied.
            rgba: self.pixmap.take(),
        }
    }

    /// Fills a square without antialiasing, so that cells are crisp.
    pub(super) fn cell(&mut self, (x, y): (i32, i32), side: i32, colour: Rgb) {
        let (width, height) = (self.pixmap.width() as i32, self.pixmap.height() as i32);
        let colour = colour.alpha(1.0).premultiply().to_color_u8();
        let pixels = self.pixmap.pixels_mut();
        for row in y.max(0)..(y + side).min(height) {
            for column in x.max(0)..(x + side).min(width) {
                pixels[(row * width + column) as usize] = colour;
            }
        }
    }

    /// Fills a rectangle.
    pub(super) fn rect(&mut self, (x, y): Spot, width: f32, height: f32, colour: Color) {
        let corners = [
            (x, y),
            (x + width, y),
            (x + width, y + height),
            (x, y + height),
        ];
        self.polygon(&corners, colour);
    }

    /// Fills a polygon.
    pub(super) fn polygon(&mut self, corners: &[Spot], colour: Color) {
        if let Some(path) = path(corners, true) {
            self.fill(&path, colour);
        }
    }

    /// Fills a disc.
    pub(super) fn disc(&mut self, (x, y): Spot, radius: f32, colour: Color) {
        if let Some(path) = PathBuilder::from_circle(x, y, radius) {
            self.fill(&path, colour);
        }
    }

    /// Draws a line through spots, with round ends.
    pub(super) fn line(&mut self, spots: &[Spot], width: f32, colour: Color) {
        if let Some(path) = path(spots, false) {
            self.stroke(&path, width, colour);
        }
    }

    /// Draws the outline of a polygon.
    pub(super) fn outline(&mut self, corners: &[Spot], width: f32, colour: Color) {
        if let Some(path) = path(corners, true) {
            self.stroke(&path, width, colour);
        }
    }

    /// Draws a text; its baseline begins at `(x, y)`, and `size` is the height of an em.
    pub(super) fn text(&mut self, (x, y): Spot, size: f32, words: &str, colour: Rgb) {
        let glyphs = outline(words, size);
        let place = Transform::from_translate(x, y);
        if let Some(path) = glyphs.and_then(|glyphs| glyphs.transform(place)) {
            self.fill(&path, colour.alpha(1.0));
        }
    }

    fn fill(&mut self, path: &Path, colour: Color) {
        let paint = paint(colour);
        let all = Transform::identity();
        self.pixmap
            .fill_path(path, &paint, FillRule::Winding, all, None);
    }

    fn stroke(&mut self, path: &Path, width: f32, colour: Color) {
        let stroke = Stroke {
            width,
            line_cap: LineCap::Round,
            line_join: LineJoin::Round,
            ..Stroke::default()
        };
        let all = Transform::identity();
        self.pixmap
            .stroke_path(path, &paint(colour), &stroke, all, None);
    }
}

fn paint(colour: Color) -> Paint<'static> {
    let mut paint = Paint::default();
    paint.set_color(colour);
    paint.anti_alias = true;
    paint
}

fn path(spots: &[Spot], closed: bool) -> Option<Path> {
    let mut builder = PathBuilder::new();
    let (&(x, y), rest) = spots.split_first()?;
    builder.move_to(x, y);
    for &(x, y) in rest {
        builder.line_to(x, y);
    }
    if closed {
        builder.close();
    }
    builder.finish()
}

#[cfg(test)]
mod tests {
    use super::Canvas;
    use crate::picture::palette::Rgb;

    const RED: Rgb = Rgb(255, 0, 0);
    const WHITE: Rgb = Rgb(255, 255, 255);

    fn red_pixels(canvas: &Canvas) -> Vec<(usize, usize)> {
        let width = canvas.pixmap.width() as usize;
        let red = |(i, pixel): (usize, &tiny_skia::PremultipliedColorU8)| {
            (pixel.green() == 0).then_some((i % width, i / width))
        };
        let pixels = canvas.pixmap.pixels().iter().enumerate();
        pixels.filter_map(red).collect()
    }

    #[test]
    fn a_cell_is_exactly_its_pixels_and_is_cut_at_the_page() {
        let mut canvas = Canvas::new(5, 4, WHITE).unwrap();
        canvas.cell((1, 2), 2, RED);
        assert_eq!(red_pixels(&canvas), [(1, 2), (2, 2), (1, 3), (2, 3)]);
        let mut canvas = Canvas::new(5, 4, WHITE).unwrap();
        canvas.cell((-2, -2), 3, RED);
        canvas.cell((4, 3), 3, RED);
        assert_eq!(red_pixels(&canvas), [(0, 0), (4, 3)]);
    }

    #[test]
    fn a_page_is_a_png() {
        let png = Canvas::new(3, 2, WHITE).unwrap().png().unwrap();
        assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
        assert_eq!(&png[16..24], [0, 0, 0, 3, 0, 0, 0, 2]);
    }
}
