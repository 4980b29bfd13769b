//! The shape of the map's box: so many tiles across and up, at most the device's slots in all.
//!
//! The box is toroidal: the known extent must fit it, wherever it lies. An extent that is not aligned with the tiles
//! touches one tile more than its length says.

/// Side of a tile, metres.
pub const TILE_M: f64 = 3.2;

/// The box for a world of this size: square where that holds the world, else as long as the world. Where not even that fits,
/// square, and the run will say so.
///
/// A world that is not aligned with the tiles touches one tile more than its length says; a box that has no slots
/// for that is taken all the same, since walls at both ends are rarely touched.
#[must_use]
pub fn for_world(size_m: [f64; 2], slots: u16) -> (u8, u8) {
    let slots = u32::from(slots).max(1);
    let side = slots.isqrt();
    [1, 0]
        .into_iter()
        .find_map(|spare| {
            let [across, up] = size_m.map(|m| (m / TILE_M).ceil().max(1.0) as u32 + spare);
            match (across.max(up) <= side, across * up <= slots) {
                (true, _) => Some((side, side)),
                (false, true) if across > up => Some((across, slots / across)),
                (false, true) => Some((slots / up, up)),
                _ => None,
            }
        })
        .map_or((narrow(side), narrow(side)), |(across, up)| {
            (narrow(across), narrow(up))
        })
}

/// The box of so many metres, rounded up to tiles.
#[must_use]
pub fn of_metres(across_m: f64, up_m: f64) -> (u8, u8) {
    let tiles = |metres: f64| narrow((metres / TILE_M - 1e-9).ceil().max(1.0) as u32);
    (tiles(across_m), tiles(up_m))
}

fn narrow(tiles: u32) -> u8 {
    u8::try_from(tiles).unwrap_or(u8::MAX)
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
            ([114.0, 28.0], (37, 10)),
            ([30.0, 96.0], (12, 31)),
            ([72.0, 13.0], (24, 16)),
        ] {
            let (across, up) = for_world(size, 400);
            assert_eq!((across, up), expected);
            assert!(u32::from(across) * u32::from(up) <= 400);
            assert!(f64::from(across) * 3.2 >= size[0] && f64::from(up) * 3.2 >= size[1]);
        }
    }

    #[test]
    fn what_does_not_fit_gets_the_square() {
        assert_eq!(for_world([200.0, 200.0], 400), (20, 20));
    }

    #[test]
    fn metres_round_up_to_tiles() {
        assert_eq!(of_metres(64.0, 64.0), (20, 20));
        assert_eq!(of_metres(64.1, 3.0), (21, 1));
        assert_eq!(of_metres(1e9, 0.0), (255, 1));
    }
}
