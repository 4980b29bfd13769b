//! Text as outlines: glyphs of a free font, Ubuntu Light, side by side.
//!
//! Units: pixels; the baseline is y = 0, y grows downwards.

use epaint_default_fonts::UBUNTU_LIGHT;
use tiny_skia::{Path, PathBuilder};
use ttf_parser::{Face as Font, OutlineBuilder};

/// Returns the outline of `words` with an em of `size` pixels; `None` for blanks.
pub(super) fn outline(words: &str, size: f32) -> Option<Path> {
    let font = Font::parse(UBUNTU_LIGHT, 0).ok()?;
    let mut pen = Pen {
        builder: PathBuilder::new(),
        scale: size / f32::from(font.units_per_em()),
        x: 0.0,
    };
    for glyph in words.chars().map(|letter| font.glyph_index(letter)) {
        // Glyph 0 is the box for a missing character.
        let glyph = glyph.unwrap_or_default();
        font.outline_glyph(glyph, &mut pen);
        pen.x += f32::from(font.glyph_hor_advance(glyph).unwrap_or(0)) * pen.scale;
    }
    pen.builder.finish()
}

/// Draws glyphs at `x`; y of the font points up and is reversed.
struct Pen {
    builder: PathBuilder,
    scale: f32,
    x: f32,
}

impl Pen {
    fn at(&self, x: f32, y: f32) -> (f32, f32) {
        (self.x + x * self.scale, -y * self.scale)
    }
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.move_to(x, y);
    }
    fn line_to(&mut self, x: f32, y: f32) {
        let (x, y) = self.at(x, y);
        self.builder.line_to(x, y);
    }
    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        let ((x1, y1), (x, y)) = (self.at(x1, y1), self.at(x, y));
        self.builder.quad_to(x1, y1, x, y);
    }
    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        let ((x1, y1), (x2, y2), (x, y)) = (self.at(x1, y1), self.at(x2, y2), self.at(x, y));
        self.builder.cubic_to(x1, y1, x2, y2, x, y);
    }
    fn close(&mut self) {
        self.builder.close();
    }
}

#[cfg(test)]
mod tests {
    use super::outline;

    #[test]
    fn letters_stand_on_the_baseline() {
        let bounds = outline("Hx", 20.0).unwrap().bounds();
        assert!(bounds.bottom().abs() < 0.5, "{bounds:?}");
        assert!((-18.0..-12.0).contains(&bounds.top()), "{bounds:?}");
        assert!(bounds.left() >= 0.0 && bounds.right() <= 30.0, "{bounds:?}");
    }

    #[test]
    fn the_font_has_every_sign_of_the_legend() {
        let box_of = |sign: char| outline(&sign.to_string(), 20.0).map(|path| path.bounds());
        let missing = box_of('\u{10fffd}');
        for sign in "AZaz09.,:()%²·–°×-_".chars() {
            assert!(box_of(sign).is_some() && box_of(sign) != missing, "{sign}");
        }
        assert!(outline("   ", 20.0).is_none());
    }
}
