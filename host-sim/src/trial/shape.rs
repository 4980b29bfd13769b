//! The shape of the map's box in tiles: an even number across, at least 4 across and up, at most
//! the device's slots in all.
//!
//! The box is toroidal: the known extent must fit its size, at any position. An extent that is not
//! aligned with the tiles touches one tile more than its length says.

/// Side of a tile, metres.
pub const TILE_M: f64 = 3.2;
/// Least number of tiles across and up.
const LEAST: u32 = 4;

/// Returns the box for a world of this size: square if that holds the world, else as long as the
/// world. If neither fits, the box is square, and the run ends with a fault.
///
/// The first choice has a tile to spare for a world that is not aligned with the tiles. A box
/// without it is the second choice, because walls at both ends are rarely touched.
#[must_use]
pub fn for_world(size_m: [f64; 2], slots: u16) -> (u8, u8) {
    let slots = u32::from(slots);
    let side = even_down(slots.isqrt());
    let square = (side, side);
    let (across, up) = [1, 0]
        .into_iter()
        .find_map(|spare| {
            let least = size_m.map(|m| tiles(m).saturating_add(spare));
            let [across, up] = least;
            let wide = even_up(across);
            let long = if across > up {
                (wide, slots / wide)
            } else {
                (even_down(slots / up), up)
            };
            [square, long]
                .into_iter()
                .find(|&(across, up)| across >= least[0] && up >= least[1] && up >= LEAST)
        })
        .unwrap_or(square);
    (narrow(across), narrow(up))
}

/// Returns the box of a size in metres, rounded up to whole tiles; `None` if no device can have it.
#[must_use]
pub fn of_metres(across_m: f64, up_m: f64) -> Option<(u8, u8)> {
    let possible = |metres: f64| metres > 0.0 && metres <= f64::from(u8::MAX - 1) * TILE_M;
    (possible(across_m) && possible(up_m)).then(|| {
        let [across, up] = [across_m, up_m].map(|m| tiles(m - 1e-9).max(LEAST));
        (narrow(even_up(across)), narrow(up))
    })
}

/// Returns the number of tiles along a length.
fn tiles(metres: f64) -> u32 {
    (metres / TILE_M).ceil().max(1.0) as u32
}

const fn even_up(tiles: u32) -> u32 {
    tiles.saturating_add(tiles % 2)
}

const fn even_down(tiles: u32) -> u32 {
    tiles - tiles % 2
}

fn narrow(tiles: u32) -> u8 {
    u8::try_from(tiles).unwrap_or(u8::MAX - 1)
}

#[cfg(test)]
mod tests {
    use super::{for_world, of_metres};

    #[test]
    fn small_worlds_get_the_square() {
        assert_eq!(for_world([24.0, 14.0], 400), (20, 20));
        assert_eq!(for_world([60.8, 60.8], 400), (20, 20));
    }

    #[test]
    fn long_worlds_get_a_long_box_that_holds_them() {
        for (size, expected) in [
            ([114.0, 30.0], (36, 11)),
            ([114.0, 28.0], (38, 10)),
            ([30.0, 96.0], (12, 31)),
            ([30.0, 112.0], (10, 35)),
            ([72.0, 13.0], (24, 16)),
        ] {
            let (across, up) = for_world(size, 400);
            assert_eq!((across, up), expected);
            assert!(u32::from(across) * u32::from(up) <= 400);
            assert!(f64::from(across) * 3.2 >= size[0] && f64::from(up) * 3.2 >= size[1]);
        }
    }

    #[test]
    fn a_world_that_does_not_fit_gets_the_square() {
        assert_eq!(for_world([200.0, 200.0], 400), (20, 20));
    }

    #[test]
    fn metres_are_rounded_up_to_whole_tiles() {
        assert_eq!(of_metres(64.0, 64.0), Some((20, 20)));
        assert_eq!(of_metres(64.1, 3.0), Some((22, 4)));
        assert_eq!(of_metres(3.2, 812.8), Some((4, 254)));
        for bad in [0.0, -3.0, 813.0, 1e9, f64::INFINITY, f64::NAN] {
            assert_eq!(of_metres(bad, 5.0), None, "{bad}");
            assert_eq!(of_metres(5.0, bad), None, "{bad}");
        }
    }

    /// A device with the default image takes the box of any world.
    #[test]
    fn every_world_gets_a_box_that_the_device_takes() {
        for across in (1..2000).step_by(7) {
            for up in (1..2000).step_by(11) {
                let size = [f64::from(across) / 10.0, f64::from(up) / 10.0];
                let (width, height) = for_world(size, 400);
                assert!(
                    fieldline_planner::map::Tiles::<1, 400>::fits(width, height),
                    "{size:?}: {width} x {height}"
                );
            }
        }
    }
}
