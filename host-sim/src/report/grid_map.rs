//! The robot's map as a rectangle of cells, put together from its tiles.
//!
//! Cells of 10 cm, row by row from the least y; `origin` is the map coordinate of the first cell,
//! in the odometry frame. Each tile also has the strategy's data: closed regions (one bit for 8 × 8
//! cells) and visit stamps (one for 16 × 16 cells).

use std::collections::BTreeMap;

use fieldline_protocol::message::{TILE_STAMPS, Tile};

/// Cells along a tile.
pub const TILE_SIDE: i32 = 32;
/// Side of a cell, metres.
pub const CELL_M: f64 = 0.1;

/// Class of a cell.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum MapCell {
    /// Never measured.
    #[default]
    Unknown,
    /// A beam passed.
    Free,
    /// A beam ended.
    Obstacle,
    /// A hole or cliff.
    NegativeObstacle,
}

/// The strategy's data of a tile, as sent.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct StrategyData {
    /// Regions in which no new loop starts because a loop was closed near them, one bit each.
    pub closed_regions: u16,
    /// Regions in which no new loop starts because a loop was given up near them, or a revisit
    /// ended there, one bit each.
    pub given_up_regions: u16,
    /// Stamps of the last visits; 0 never.
    pub visit_stamps: [u8; TILE_STAMPS],
}

/// A rectangle of cells and the skeleton over it.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct GridMap {
    /// Column of the first cell.
    pub origin_x: i32,
    /// Row of the first cell.
    pub origin_y: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
    cells: Vec<MapCell>,
    skeleton: Vec<bool>,
    /// The strategy's data of tiles that have any.
    strategy_data: BTreeMap<(i16, i16), StrategyData>,
}

impl GridMap {
    /// Makes an unknown rectangle.
    #[must_use]
    pub fn unknown(origin_x: i32, origin_y: i32, width: usize, height: usize) -> Self {
        Self {
            origin_x,
            origin_y,
            width,
            height,
            cells: vec![MapCell::Unknown; width * height],
            skeleton: vec![false; width * height],
            strategy_data: BTreeMap::new(),
        }
    }

    /// Puts tiles side by side, cut to the known cells and a rim of one unknown cell; empty if
    /// nothing is known.
    #[must_use]
    pub fn from_tiles(tiles: &BTreeMap<(i16, i16), Tile>) -> Self {
        let span = |of: fn(&(i16, i16)) -> i16| {
            let least = tiles.keys().map(of).min().unwrap_or(0);
            let most = tiles.keys().map(of).max().unwrap_or(-1);
            (i32::from(least), i32::from(most) + 1)
        };
        let ((x0, x1), (y0, y1)) = (span(|key| key.0), span(|key| key.1));
        let side = |from: i32, to: i32| usize::try_from((to - from) * TILE_SIDE).unwrap_or(0);
        let mut map = Self::unknown(x0 * TILE_SIDE, y0 * TILE_SIDE, side(x0, x1), side(y0, y1));
        for tile in tiles.values() {
            map.lay(tile);
        }
        map.cropped(1)
    }

    /// Returns the cell at map coordinates; outside it is unknown.
    #[must_use]
    pub fn get(&self, x: i32, y: i32) -> MapCell {
        self.index(x, y)
            .and_then(|i| self.cells.get(i).copied())
            .unwrap_or_default()
    }

    /// Returns true if the cell at map coordinates is on the skeleton.
    #[must_use]
    pub fn on_skeleton(&self, x: i32, y: i32) -> bool {
        self.index(x, y)
            .and_then(|i| self.skeleton.get(i).copied())
            .unwrap_or(false)
    }

    /// Returns true if a loop was closed near the cell at map coordinates.
    #[must_use]
    pub fn is_in_closed_region(&self, x: i32, y: i32) -> bool {
        self.strategy_data(x, y)
            .is_some_and(|data| data.closed_regions >> square(x, y, 8) & 1 == 1)
    }

    /// Returns true if a loop was given up near the cell at map coordinates, or a revisit ended
    /// there.
    #[must_use]
    pub fn is_in_given_up_region(&self, x: i32, y: i32) -> bool {
        self.strategy_data(x, y)
            .is_some_and(|data| data.given_up_regions >> square(x, y, 8) & 1 == 1)
    }

    /// Returns the stamp of the last visit near a cell, later ones are greater; `None` if there was
    /// none.
    #[must_use]
    pub fn visit_stamp(&self, x: i32, y: i32) -> Option<u8> {
        let data = self.strategy_data(x, y)?;
        let stamp = data.visit_stamps.get(square(x, y, 16)).copied();
        stamp.filter(|stamp| *stamp > 0)
    }

    /// Returns the oldest and the newest visit stamp; `None` if there are none.
    #[must_use]
    pub fn visit_stamp_span(&self) -> Option<(u8, u8)> {
        let tiles = self.strategy_data.values();
        let stamps = tiles.flat_map(|data| data.visit_stamps);
        let visited = stamps.filter(|stamp| *stamp > 0);
        visited.fold(None, |span: Option<(u8, u8)>, stamp| {
            let (oldest, newest) = span.unwrap_or((stamp, stamp));
            Some((oldest.min(stamp), newest.max(stamp)))
        })
    }

    /// Returns true if there is a closed region.
    #[must_use]
    pub fn has_closed_regions(&self) -> bool {
        let mut tiles = self.strategy_data.values();
        tiles.any(|data| data.closed_regions != 0)
    }

    /// Returns true if there is a given up region.
    #[must_use]
    pub fn has_given_up_regions(&self) -> bool {
        let mut tiles = self.strategy_data.values();
        tiles.any(|data| data.given_up_regions != 0)
    }

    /// Sets the strategy's data of a tile.
    pub fn set_strategy_data(&mut self, tile: (i16, i16), data: StrategyData) {
        if data != StrategyData::default() {
            self.strategy_data.insert(tile, data);
        }
    }

    fn strategy_data(&self, x: i32, y: i32) -> Option<StrategyData> {
        let tile = [x, y].map(|at| i16::try_from(at.div_euclid(TILE_SIDE)));
        let [Ok(x), Ok(y)] = tile else {
            return None;
        };
        self.strategy_data.get(&(x, y)).copied()
    }

    /// Sets a cell; ignores cells outside.
    pub fn set(&mut self, x: i32, y: i32, cell: MapCell) {
        if let Some(slot) = self.index(x, y).and_then(|i| self.cells.get_mut(i)) {
            *slot = cell;
        }
    }

    /// Puts a cell on the skeleton; ignores cells outside.
    pub fn set_skeleton(&mut self, x: i32, y: i32) {
        if let Some(slot) = self.index(x, y).and_then(|i| self.skeleton.get_mut(i)) {
            *slot = true;
        }
    }

    /// Returns the middles of the skeleton's free roadmap cells of 20 cm, metres.
    pub fn rails(&self) -> impl Iterator<Item = [f64; 2]> + '_ {
        let even = |least: i32, length: usize| {
            let end = least + i32::try_from(length).unwrap_or(i32::MAX - least);
            (least.div_euclid(2)..=end.div_euclid(2)).map(|at| 2 * at)
        };
        even(self.origin_y, self.height)
            .flat_map(move |y| even(self.origin_x, self.width).map(move |x| (x, y)))
            .filter(|&(x, y)| self.on_skeleton(x, y) && self.get(x, y) == MapCell::Free)
            .map(|(x, y)| [x, y].map(|at| f64::from(at + 1) * CELL_M))
    }

    /// Counts the cells that are not unknown.
    #[must_use]
    pub fn known(&self) -> usize {
        let is_known = |cell: &&MapCell| **cell != MapCell::Unknown;
        self.cells.iter().filter(is_known).count()
    }

    /// Returns the cells that are not unknown, with their map coordinates, row by row.
    pub fn known_cells(&self) -> impl Iterator<Item = (i32, i32, MapCell)> + '_ {
        let cells = self.places().zip(&self.cells);
        cells
            .filter(|(_, cell)| **cell != MapCell::Unknown)
            .map(|((x, y), cell)| (x, y, *cell))
    }

    /// Returns what several maps know together, with the skeletons of all. Of two classes of a cell
    /// the later one in [`MapCell`] counts, as when the robots merge their maps.
    #[must_use]
    pub fn united<'a>(maps: impl Iterator<Item = &'a Self>) -> Self {
        let maps: Vec<&Self> = maps.filter(|map| !map.cells.is_empty()).collect();
        let least = |of: fn(&Self) -> i32| maps.iter().map(|map| of(map)).min().unwrap_or(0);
        let most = |of: fn(&Self) -> i32| maps.iter().map(|map| of(map)).max().unwrap_or(0);
        let (x0, y0) = (least(|map| map.origin_x), least(|map| map.origin_y));
        let east = most(|map| map.origin_x + map.width as i32);
        let north = most(|map| map.origin_y + map.height as i32);
        let side = |from: i32, to: i32| usize::try_from(to - from).unwrap_or(0);
        let mut out = Self::unknown(x0, y0, side(x0, east), side(y0, north));
        for map in maps {
            for (x, y, cell) in map.known_cells() {
                out.set(x, y, out.get(x, y).max(cell));
                if map.on_skeleton(x, y) {
                    out.set_skeleton(x, y);
                }
            }
        }
        out
    }

    fn index(&self, x: i32, y: i32) -> Option<usize> {
        let column = usize::try_from(x - self.origin_x).ok()?;
        let row = usize::try_from(y - self.origin_y).ok()?;
        (column < self.width && row < self.height).then_some(row * self.width + column)
    }

    fn lay(&mut self, tile: &Tile) {
        let data = StrategyData {
            closed_regions: tile.closed_regions,
            given_up_regions: tile.given_up_regions,
            visit_stamps: tile.visit_stamps,
        };
        self.set_strategy_data((tile.x, tile.y), data);
        let (left, bottom) = (i32::from(tile.x) * TILE_SIDE, i32::from(tile.y) * TILE_SIDE);
        for row in 0..TILE_SIDE {
            for column in 0..TILE_SIDE {
                let (x, y) = (left + column, bottom + row);
                self.set(x, y, cell_of(tile, column, row));
                if skeleton_of(tile, column, row) {
                    self.set_skeleton(x, y);
                }
            }
        }
    }

    fn cropped(&self, rim: i32) -> Self {
        let (mut x0, mut y0, mut x1, mut y1) = (i32::MAX, i32::MAX, i32::MIN, i32::MIN);
        for (x, y) in self.places() {
            if self.get(x, y) != MapCell::Unknown {
                (x0, y0) = (x0.min(x), y0.min(y));
                (x1, y1) = (x1.max(x), y1.max(y));
            }
        }
        if x0 > x1 {
            return Self::default();
        }
        let side = |from: i32, to: i32| usize::try_from(to - from + 1 + 2 * rim).unwrap_or(0);
        let mut out = Self::unknown(x0 - rim, y0 - rim, side(x0, x1), side(y0, y1));
        for (x, y) in out.places().collect::<Vec<_>>() {
            out.set(x, y, self.get(x, y));
            if self.on_skeleton(x, y) {
                out.set_skeleton(x, y);
            }
        }
        out.strategy_data.clone_from(&self.strategy_data);
        out
    }

    fn places(&self) -> impl Iterator<Item = (i32, i32)> + use<> {
        let (x0, y0, width) = (self.origin_x, self.origin_y, self.width.max(1));
        let place = move |i: usize| (x0 + (i % width) as i32, y0 + (i / width) as i32);
        (0..self.cells.len()).map(place)
    }
}

/// Returns the class of a tile's cell: two bits a cell, row by row, least x in the low bits.
fn cell_of(tile: &Tile, column: i32, row: i32) -> MapCell {
    let bit = 2 * (row * TILE_SIDE + column);
    let byte = tile.cells.get((bit / 8) as usize).copied().unwrap_or(0);
    match (byte >> (bit % 8)) & 3 {
        0 => MapCell::Unknown,
        1 => MapCell::Free,
        2 => MapCell::Obstacle,
        _ => MapCell::NegativeObstacle,
    }
}

/// Returns the number of a cell's square in its tile; squares of `side` cells, row by row.
fn square(x: i32, y: i32, side: i32) -> usize {
    let [column, row] = [x, y].map(|at| at.rem_euclid(TILE_SIDE) / side);
    (row * (TILE_SIDE / side) + column) as usize
}

/// Returns true if a tile's cell is on the skeleton: one bit for 2 × 2 cells, row by row, least x
/// in the low bits.
fn skeleton_of(tile: &Tile, column: i32, row: i32) -> bool {
    let bit = (row / 2) * (TILE_SIDE / 2) + column / 2;
    let byte = tile.skeleton.get((bit / 8) as usize).copied().unwrap_or(0);
    (byte >> (bit % 8)) & 1 == 1
}

#[cfg(test)]
mod tests {
    use super::{GridMap, MapCell};
    use fieldline_protocol::message::Tile;
    use std::collections::BTreeMap;

    fn tile(x: i16, y: i16, set: &[(usize, usize, u8)]) -> ((i16, i16), Tile) {
        let mut cells = [0_u8; 256];
        for &(column, row, code) in set {
            let bit = 2 * (row * 32 + column);
            cells[bit / 8] |= code << (bit % 8);
        }
        let mut skeleton = [0_u8; 32];
        skeleton[2 * 3] = 0b10; // coarse (1, 3): cells 2..4 × 6..8
        let tile = Tile {
            x,
            y,
            cells: heapless::Vec::from_slice(&cells).unwrap(),
            skeleton: heapless::Vec::from_slice(&skeleton).unwrap(),
            closed_regions: 0,
            given_up_regions: 0,
            visit_stamps: [0; 4],
        };
        ((x, y), tile)
    }

    #[test]
    fn tiles_are_placed_by_their_coordinates() {
        let tiles: BTreeMap<_, _> = [
            tile(-1, 0, &[(31, 6, 1), (30, 6, 2)]),
            tile(0, 0, &[(0, 6, 1), (3, 7, 3)]),
        ]
        .into();
        let map = GridMap::from_tiles(&tiles);
        assert_eq!((map.origin_x, map.origin_y), (-3, 5));
        assert_eq!((map.width, map.height), (8, 4));
        assert_eq!(map.get(-2, 6), MapCell::Obstacle);
        assert_eq!(map.get(-1, 6), MapCell::Free);
        assert_eq!(map.get(0, 6), MapCell::Free);
        assert_eq!(map.get(3, 7), MapCell::NegativeObstacle);
        assert_eq!(map.get(0, 7), MapCell::Unknown);
        assert_eq!(map.known(), 4);
        let skeleton: Vec<_> = (0..5).map(|x| map.on_skeleton(x, 6)).collect();
        assert_eq!(skeleton, [false, false, true, true, false]);
        assert!(map.on_skeleton(2, 7) && !map.on_skeleton(2, 5));
    }

    #[test]
    fn closed_regions_and_visit_stamps_are_placed_by_their_tile() {
        let (_, mut known) = tile(-1, 2, &[(0, 0, 1)]);
        (known.closed_regions, known.given_up_regions) = (1 << 6, 1 << 7);
        known.visit_stamps = [0, 3, 9, 0];
        let map = GridMap::from_tiles(&[((-1, 2), known)].into());
        // Region 6 is the third of the second row: 8 × 8 cells from (16, 8) on.
        let around = [
            (-16, 72),
            (-9, 79),
            (-17, 72),
            (-16, 71),
            (-8, 72),
            (-16, 80),
        ];
        let is_in = around.map(|(x, y)| map.is_in_closed_region(x, y));
        assert_eq!(is_in, [true, true, false, false, false, false]);
        let is_in = around.map(|(x, y)| map.is_in_given_up_region(x, y));
        assert_eq!(is_in, [false, false, false, false, true, false]);
        let places = [(-32, 64), (-16, 64), (-1, 79), (-32, 80), (-1, 95), (0, 64)];
        let stamps = places.map(|(x, y)| map.visit_stamp(x, y));
        assert_eq!(stamps, [None, Some(3), Some(3), Some(9), None, None]);
        assert_eq!(map.visit_stamp_span(), Some((3, 9)));
        assert!(map.has_closed_regions() && !GridMap::default().has_closed_regions());
        assert!(map.has_given_up_regions() && !GridMap::default().has_given_up_regions());
        assert_eq!(GridMap::default().visit_stamp_span(), None);
    }

    #[test]
    fn tiles_without_known_cells_are_an_empty_map() {
        let map = GridMap::from_tiles(&[tile(4, 4, &[])].into());
        assert_eq!((map.width, map.height, map.known()), (0, 0, 0));
        assert_eq!(GridMap::from_tiles(&BTreeMap::new()), map);
    }
}
