//! The map in the ROS `map_server` convention: a grey PGM, greatest y first, and its YAML file.
//!
//! Trinary: 254 free, 0 occupied (obstacles of both kinds), 205 unknown. `origin` is the outer
//! corner of the cell with least x and y.

use core::fmt::Write as _;

use super::grid_map::{CELL_M, GridMap, MapCell};

/// Returns the bytes of `map.pgm`: binary PGM (P5), 8 bits.
#[must_use]
pub fn pgm(map: &GridMap) -> Vec<u8> {
    // A picture has at least one pixel, so an empty map is one unknown cell.
    let (width, height) = (map.width.max(1), map.height.max(1));
    let mut out = format!("P5\n{width} {height}\n255\n").into_bytes();
    for row in (0..height as i32).rev() {
        let of_column = |column: i32| grey(map.get(map.origin_x + column, map.origin_y + row));
        out.extend((0..width as i32).map(of_column));
    }
    out
}

/// Returns the text of `map.yaml`; `image` is the name of the picture.
#[must_use]
pub fn yaml(map: &GridMap, image: &str) -> String {
    let corner = |cell: i32| f64::from(cell) * CELL_M;
    let mut out = String::new();
    // Writing into a string does not fail.
    let _ = write!(
        out,
        "image: {image}\nmode: trinary\nresolution: {CELL_M}\norigin: [{:.1}, {:.1}, 0.0]\n\
         negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n",
        corner(map.origin_x),
        corner(map.origin_y),
    );
    out
}

fn grey(cell: MapCell) -> u8 {
    match cell {
        MapCell::Free => 254,
        MapCell::Unknown => 205,
        MapCell::Obstacle | MapCell::NegativeObstacle => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::{pgm, yaml};
    use crate::report::grid_map::{GridMap, MapCell};

    fn small() -> GridMap {
        let mut map = GridMap::unknown(-12, 7, 3, 2);
        map.set(-12, 7, MapCell::Free);
        map.set(-11, 7, MapCell::Obstacle);
        map.set(-10, 8, MapCell::NegativeObstacle);
        map
    }

    #[test]
    fn the_picture_has_the_greatest_y_first() {
        let expected = [b"P5\n3 2\n255\n".as_slice(), &[205, 205, 0], &[254, 0, 205]];
        assert_eq!(pgm(&small()), expected.concat());
    }

    #[test]
    fn the_yaml_places_the_corner_of_the_least_cell() {
        assert_eq!(
            yaml(&small(), "map.pgm"),
            "image: map.pgm\nmode: trinary\nresolution: 0.1\norigin: [-1.2, 0.7, 0.0]\n\
             negate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n"
        );
    }

    #[test]
    fn an_empty_map_is_still_a_picture() {
        assert_eq!(pgm(&GridMap::default()), b"P5\n1 1\n255\n\xcd");
    }

    /// A reader with these thresholds gets the classes back.
    #[test]
    fn greys_fall_on_the_right_side_of_the_thresholds() {
        let occupancy = |grey: u8| (255.0 - f64::from(grey)) / 255.0;
        assert!(occupancy(254) < 0.196 && occupancy(0) > 0.65);
        assert!((0.196..0.65).contains(&occupancy(205)));
    }
}
