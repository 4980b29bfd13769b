//! The colours of the picture. They are distinct to colour-blind eyes and in grey print.

use tiny_skia::Color;

/// The page.
pub(super) const PAGE: Rgb = Rgb(0xff, 0xff, 0xff);
/// Text and outlines.
pub(super) const INK: Rgb = Rgb(0x1d, 0x23, 0x2b);
/// Secondary text, ticks, the frame.
pub(super) const FAINT: Rgb = Rgb(0x6b, 0x75, 0x82);
/// Hairlines.
pub(super) const HAIR: Rgb = Rgb(0xd5, 0xda, 0xe0);
/// Unknown cells.
pub(super) const UNKNOWN: Rgb = Rgb(0xe8, 0xeb, 0xef);
/// Free cells.
pub(super) const FREE: Rgb = Rgb(0xff, 0xff, 0xff);
/// Obstacle cells.
pub(super) const OBSTACLE: Rgb = Rgb(0x2b, 0x33, 0x3d);
/// Negative obstacles: holes and cliffs.
pub(super) const NEGATIVE: Rgb = Rgb(0x8a, 0x5a, 0x3b);
/// Ground that rises too steeply.
pub(super) const STEEP_UP: Rgb = Rgb(0x56, 0x60, 0x6c);
/// Ground that rises too steeply from one side and falls too steeply from the other.
pub(super) const STEEP_BOTH: Rgb = Rgb(0x70, 0x5d, 0x54);
/// Grid lines, 5 m apart.
pub(super) const GRID: Rgb = Rgb(0xec, 0xef, 0xf2);
/// The skeleton.
pub(super) const SKELETON: Rgb = Rgb(0x7f, 0xb2, 0xc4);
/// The window and its arrows.
pub(super) const WINDOW: Rgb = Rgb(0x1f, 0x6f, 0xb2);
/// Start of the path.
pub(super) const START: Rgb = Rgb(0x1a, 0x93, 0x6f);
/// The path as the device believed it.
pub(super) const BELIEVED: Rgb = Rgb(0x8b, 0x93, 0x9e);
/// The path as closed loops corrected it.
pub(super) const CORRECTED: Rgb = START;
/// Residual frontiers.
pub(super) const RESIDUE: Rgb = Rgb(0xe0, 0x8e, 0x0b);

/// Tractor point and shield of the loop that is being closed; loops given up.
pub(super) const LOOP: Rgb = Rgb(0xc0, 0x1f, 0x2e);
/// Free cells of regions near which a loop was closed.
pub(super) const CLOSED: Rgb = Rgb(0xe6, 0xf3, 0xe4);
/// Free cells of regions near which a loop was given up, or a revisit ended.
pub(super) const GIVEN_UP: Rgb = Rgb(0xfb, 0xea, 0xdc);

/// An opaque colour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Rgb(pub(super) u8, pub(super) u8, pub(super) u8);

impl Rgb {
    /// Returns the colour with an opacity of `alpha`, 0 to 1.
    pub(super) fn alpha(self, alpha: f32) -> Color {
        let opacity = (alpha.clamp(0.0, 1.0) * 255.0) as u8;
        Color::from_rgba8(self.0, self.1, self.2, opacity)
    }

    /// Returns the colour, brighter or darker by a factor.
    pub(super) fn lit(self, light: f32) -> Self {
        let channel = |v: u8| (f32::from(v) * light).clamp(0.0, 255.0) as u8;
        Self(channel(self.0), channel(self.1), channel(self.2))
    }

    /// Returns the mixture with a share of another colour, 0 to 1.
    pub(super) fn mix(self, other: Self, share: f32) -> Self {
        let channel = |a: u8, b: u8| (f32::from(a) + (f32::from(b) - f32::from(a)) * share) as u8;
        Self(
            channel(self.0, other.0),
            channel(self.1, other.1),
            channel(self.2, other.2),
        )
    }
}

/// Colours of the path from first to last: dark violet over magenta to amber, ever lighter.
pub(super) fn time(share: f32) -> Rgb {
    const STOPS: [Rgb; 5] = [
        Rgb(0x2d, 0x11, 0x60),
        Rgb(0x72, 0x1f, 0x81),
        Rgb(0xb7, 0x37, 0x79),
        Rgb(0xee, 0x5b, 0x5e),
        Rgb(0xfc, 0xa5, 0x54),
    ];
    along(&STOPS, share)
}

/// Colours of the field on the map, from far from a goal to near: light to deeper blue.
pub(super) fn field(share: f32) -> Rgb {
    const STOPS: [Rgb; 3] = [
        Rgb(0xf3, 0xf8, 0xfc),
        Rgb(0xd6, 0xe8, 0xf5),
        Rgb(0xa6, 0xcd, 0xea),
    ];
    along(&STOPS, share)
}

/// Colours of rails from the newest visit to the oldest: dark to light green.
pub(super) fn age(share: f32) -> Rgb {
    const STOPS: [Rgb; 3] = [
        Rgb(0x0b, 0x55, 0x3c),
        Rgb(0x4f, 0xa3, 0x6b),
        Rgb(0xbf, 0xe5, 0xbb),
    ];
    along(&STOPS, share)
}

/// Colours of ground from the lowest to the highest: teal over green to sand, ever lighter.
pub(super) fn height(share: f32) -> Rgb {
    const STOPS: [Rgb; 4] = [
        Rgb(0x5f, 0x93, 0x9c),
        Rgb(0x93, 0xb8, 0x96),
        Rgb(0xcf, 0xd0, 0x9c),
        Rgb(0xf6, 0xe6, 0xc8),
    ];
    along(&STOPS, share)
}

/// Colours of preferences from repelling to attracting: orange over white to violet.
pub(super) fn preference(share: f32) -> Rgb {
    const STOPS: [Rgb; 5] = [
        Rgb(0xb3, 0x58, 0x06),
        Rgb(0xf1, 0xa3, 0x40),
        Rgb(0xf7, 0xf7, 0xf7),
        Rgb(0x99, 0x8e, 0xc3),
        Rgb(0x54, 0x27, 0x88),
    ];
    along(&STOPS, share)
}

/// Colours of the field in a panel, from far from a goal to near: dark blue to pale yellow.
pub(super) fn potential(share: f32) -> Rgb {
    const STOPS: [Rgb; 5] = [
        Rgb(0x18, 0x2b, 0x4d),
        Rgb(0x1f, 0x5f, 0x8b),
        Rgb(0x3d, 0x9c, 0xa3),
        Rgb(0x9b, 0xd0, 0xa5),
        Rgb(0xfb, 0xf6, 0xcf),
    ];
    along(&STOPS, share)
}

/// Returns the colour at a share of a scale, 0 to 1.
fn along(stops: &[Rgb], share: f32) -> Rgb {
    let place = share.clamp(0.0, 1.0) * (stops.len() - 1) as f32;
    let i = (place as usize).min(stops.len() - 2);
    stops[i].mix(stops[i + 1], place - i as f32)
}

#[cfg(test)]
mod tests {
    use super::{Rgb, age, height, time};

    #[test]
    fn scales_of_time_height_and_age_grow_lighter() {
        let light = |Rgb(r, g, b): Rgb| {
            0.2126 * f32::from(r) + 0.7152 * f32::from(g) + 0.0722 * f32::from(b)
        };
        let spread = |scale: fn(f32) -> Rgb| {
            let scale: Vec<f32> = (0..=100).map(|i| light(scale(i as f32 / 100.0))).collect();
            assert!(scale.windows(2).all(|pair| pair[0] <= pair[1] + 0.8));
            scale[100] - scale[0]
        };
        assert!(spread(time) > 120.0 && spread(height) > 80.0 && spread(age) > 120.0);
    }

    #[test]
    fn light_keeps_within_white() {
        assert_eq!(Rgb(100, 200, 240).lit(1.2), Rgb(120, 240, 255));
        assert_eq!(Rgb(100, 200, 240).lit(0.0), Rgb(0, 0, 0));
    }

    #[test]
    fn the_ends_are_the_stops_and_outside_is_clamped() {
        assert_eq!(time(-1.0), Rgb(0x2d, 0x11, 0x60));
        assert_eq!(time(2.0), Rgb(0xfc, 0xa5, 0x54));
    }
}
