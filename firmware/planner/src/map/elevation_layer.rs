//! The map on uneven ground: the memory of the elevation window, and its classes into the tiles.
//!
//! Counts of hits and passes mean nothing there, because beams pass over holes and end on slopes.
//! So the elevation window uses their memory: 8 KB for 4,096 heights of two bytes. Its 4,096 marks
//! of one byte use 16 pages of the pool. On flat ground the map has all pages.
//!
//! Units: map cells.

use crate::config::{Config, GroundTuning, UnevenGround};
use crate::geometry::Cell;
use crate::grid::bits::ones64;
use crate::ground::classify::{self, RiseLimits};
use crate::ground::doorway_view::{DoorwayView, Part};
use crate::ground::elevation::{WINDOW_CELLS, WINDOW_SIDE};
use crate::ground::heights::WindowRows;
use crate::ground::survey::Survey;
use crate::ground::{Elevation, Heights};
use crate::input::Input;
use crate::map::{Class, Map, SideTable, Tiles, landmarks};

/// Pages that hold the marks.
pub(super) const MARK_TILES: usize = WINDOW_CELLS / size_of::<super::tiles::Cells>();

/// Phases of the beams through a doorway to a known wall. A step evaluates one phase, to save time.
/// Each beam comes within a second.
const BEAM_PHASES: usize = 5;

/// Returns the phase of a step: which of the doorway's beams are due.
const fn beam_phase(time_ms: u32, period_ms: u32) -> usize {
    (time_ms / period_ms) as usize % BEAM_PHASES
}

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Lends the pages that hold the marks to the elevation window, and those of the landmarks to a
    /// session that corrects its odometry.
    pub(super) fn lend_memory_to_elevation(&mut self, localise: bool) {
        let with_landmarks = MARK_TILES + landmarks::PAGES;
        // A small pool has no room for landmarks.
        let has_landmarks = localise && TILES >= 2 * with_landmarks;
        self.tiles.lend(if has_landmarks {
            with_landmarks
        } else {
            MARK_TILES
        });
    }

    /// Returns the elevation window; on flat ground it has no heights.
    #[must_use]
    pub fn heights(&self) -> Heights<'_> {
        Heights::new(self.evidence.bytes(), self.tiles.mark_bytes(), self.window)
    }

    /// Enters scans and pose into the window, and the window's classes into the tiles.
    pub(super) fn update_elevation(
        &mut self,
        config: &Config,
        ground: &UnevenGround,
        input: &Input<'_>,
    ) {
        let tuning = &config.tuning.ground;
        let input = &Input {
            pose: self.attitude.update(&input.pose, tuning),
            ..*input
        };
        let window = self.window;
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.mark_bytes_mut(),
            &mut self.window,
            tuning,
        );
        Survey::new(&mut elevation, ground, input)
            .with_attitude(&self.attitude)
            .run(config, input, !self.has_surveyed);
        self.has_surveyed = true;
        self.mark_landmarks(config, input, window);
        if self.attitude.is_exact(tuning) {
            self.view_doorways(config, ground, input);
        }
        self.odd_rows = !self.odd_rows;
        self.classify_all(
            &RiseLimits::new(ground, tuning),
            config.tuning.map.near_rows,
        );
    }

    /// Classifies the rows of the elevation window that are due. It is not inlined: its rows of
    /// marks would lie on the stack under the match of a scan.
    #[inline(never)]
    fn classify_all(&mut self, limits: &RiseLimits<'_>, near_rows: i32) {
        let rows = self.heights().all_rows();
        let middle = self.window.y + WINDOW_SIDE / 2;
        for y in self.window.y..self.window.y + WINDOW_SIDE {
            // All rows would take too long for a step, and a far row can wait for one step.
            if (y - middle).abs() <= near_rows || (y & 1 == 1) == self.odd_rows {
                self.classify(&rows, limits, y);
            }
        }
    }

    /// Moves the elevation window with its heights by whole cells. Landmarks are forgotten: the
    /// next scans mark them anew.
    pub(super) fn move_heights(&mut self, by: [i32; 2]) {
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.mark_bytes_mut(),
            &mut self.window,
            &GroundTuning::DEFAULT,
        );
        elevation.move_by(by);
        self.tiles.landmark_bytes_mut().fill(0);
    }

    /// Enters what beams see through doorways into cells that are unknown.
    fn view_doorways(&mut self, config: &Config, ground: &UnevenGround, input: &Input<'_>) {
        let phase = beam_phase(input.time_ms, config.period_ms());
        let mut written = 0;
        for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
            let tuning = &config.tuning.ground;
            let view = DoorwayView::new(&input.pose, ground, tuning, laser, ranges_mm);
            let Some(mut view) = view.filter(|_| laser.is_level()) else {
                continue;
            };
            let mut from = 0;
            while let Some(beams) = view.next_doorway(&self.heights(), from) {
                from = beams.end;
                // The cells before a known wall are mostly known, so a few beams per step suffice.
                let is_due = |tiles: &Tiles<TILES, SLOTS>, number: usize| {
                    let is_new = |end: Cell| tiles.class(end) == Class::Unknown;
                    number % BEAM_PHASES == phase || view.end_cell(number).is_some_and(is_new)
                };
                for number in beams {
                    if written < config.tuning.map.max_doorway_cells && is_due(&self.tiles, number)
                    {
                        view.for_each_cell(number, |cell, part| {
                            written += 1;
                            self.set_if_unknown(cell, part);
                        });
                    }
                }
            }
        }
    }

    /// Stores a cell that a beam saw through a doorway, if it is unknown.
    fn set_if_unknown(&mut self, cell: Cell, part: Part) {
        if self.tiles.class(cell) == Class::Unknown {
            let class = match part {
                Part::Floor => Class::Free,
                Part::Wall => Class::Obstacle,
            };
            // Without room the cell stays unknown.
            let _ = self.tiles.set(cell, class);
        }
    }

    /// Makes room in the pool if it runs short (`compaction`). Call it after every survey.
    pub fn compact(&mut self, side_table: &mut impl SideTable) {
        self.tiles.compact(self.window, WINDOW_SIDE, side_table);
    }

    /// Resolves the unknown cells around a goal that the robot reached without measuring them.
    ///
    /// Ground behind a brow stays out of view. Such a cell becomes free if the measured ground on
    /// both sides spans the gap, otherwise negative.
    pub fn resolve_gaps(&mut self, config: &Config, goal: Cell) {
        let reach = config.tuning.map.resolve_cells;
        self.fill_gaps(config, (goal, reach), Some(Class::Negative));
    }

    /// Frees the unknown cells around the place before a blocked robot, if measured ground spans
    /// them. Returns true if there were any.
    pub(crate) fn free_gaps(&mut self, config: &Config, ahead: Cell) -> bool {
        let reach = config.tuning.map.free_gap_cells;
        self.fill_gaps(config, (ahead, reach), None)
    }

    /// Makes the unknown cells in a square free if measured ground spans them, otherwise `gone`.
    /// Returns true if any became free.
    fn fill_gaps(
        &mut self,
        config: &Config,
        (middle, reach): (Cell, i32),
        gone: Option<Class>,
    ) -> bool {
        let Some(ground) = &config.ground else {
            return false;
        };
        let tuning = &config.tuning.ground;
        let limits = RiseLimits::new(ground, tuning);
        let mut any = false;
        // If the attitude is not exact, a rim beside the cell may be unnoticed. With trust in such
        // ground the robot fell at two holes.
        let is_sure = self.attitude.is_exact(tuning);
        for y in middle.y - reach..=middle.y + reach + 1 {
            for x in middle.x - reach..=middle.x + reach + 1 {
                let cell = Cell { x, y };
                if self.tiles.class(cell) != Class::Unknown {
                    continue;
                }
                let spans_gap = is_sure && classify::spans_gap(&self.heights(), &limits, cell, 0.0);
                // Ground with a height of low confidence exists.
                let gone = gone.filter(|_| self.heights().low_confidence_m(cell).is_none());
                let class = if spans_gap { Some(Class::Free) } else { gone };
                if let Some(class) = class {
                    // Without room the cell stays unknown.
                    any |= self.tiles.set(cell, class).is_ok() && spans_gap;
                }
            }
        }
        any
    }

    /// Classifies a row of the elevation window, whose rows are `rows`.
    fn classify(&mut self, rows: &WindowRows, limits: &RiseLimits<'_>, y: i32) {
        let x = self.window.x;
        let known = self.tiles.row(x, y);
        let classes = classify::row((&self.heights(), rows), limits, y, known);
        let changed = [
            (
                Class::Obstacle,
                classes.obstacle & !(known.obstacle() & !known.negative()),
            ),
            (Class::Negative, classes.negative & !known.negative()),
            (Class::Free, classes.free & !known.free()),
        ];
        for (class, cells) in changed {
            for k in ones64(cells) {
                let cell = Cell { x: x + k as i32, y };
                self.store(cell, class);
            }
        }
    }
}

#[cfg(test)]
impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Measure the ground around a cell, where it has a height, metres.
    pub(crate) fn set_ground_heights(
        &mut self,
        middle: Cell,
        height_m: impl Fn(Cell) -> Option<f32>,
    ) {
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.mark_bytes_mut(),
            &mut self.window,
            &GroundTuning::DEFAULT,
        );
        elevation.follow(middle);
        let half = WINDOW_SIDE / 2;
        for y in middle.y - half..middle.y + half {
            for x in middle.x - half..middle.x + half {
                let cell = Cell { x, y };
                if let Some(height_m) = height_m(cell) {
                    elevation.measure(cell, height_m);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::boxed::Box;
    use std::vec::Vec;

    use super::{BEAM_PHASES, Class, Config, RiseLimits, UnevenGround, beam_phase};
    use crate::config::{GroundTuning, MapTuning};
    use crate::geometry::Cell;
    use crate::map::Map;

    /// Columns of a ditch that no beam met.
    const DITCH: core::ops::RangeInclusive<i32> = 30..=33;

    fn config() -> Config {
        Config {
            ground: Some(UnevenGround::TABLE_I),
            ..Config::pioneer_3at(heapless::Vec::new())
        }
    }

    /// A map of level ground with the ditch in it.
    fn with_a_ditch(far_side_m: f32) -> Box<Map<152, 400>> {
        let mut map = Box::new(Map::new());
        map.begin(&config());
        map.set_ground_heights(Cell { x: 32, y: 32 }, |cell| {
            (!DITCH.contains(&cell.x)).then_some(if cell.x > 33 { far_side_m } else { 0.0 })
        });
        let limits = RiseLimits::new(&UnevenGround::TABLE_I, &GroundTuning::DEFAULT);
        let rows = map.heights().all_rows();
        (0..64).for_each(|y| map.classify(&rows, &limits, y));
        map
    }

    /// Rows of the ditch that are free.
    fn free_rows(map: &Map<152, 400>) -> Vec<i32> {
        let is_free = |y: &i32| {
            DITCH
                .map(|x| map.tiles().class(Cell { x, y: *y }))
                .all(|class| class == Class::Free)
        };
        (0..64).filter(is_free).collect()
    }

    #[test]
    fn beams_of_a_doorway_are_due_in_turn_at_every_period() {
        for period_s in [0.1, 0.2, 0.4] {
            let config = Config {
                period_s,
                ..config()
            };
            let period_ms = config.period_ms();
            assert_eq!(period_ms, [100, 200, 400][(10.0 * period_s) as usize / 2]);
            for step in 0..20 {
                let phase = beam_phase(step * period_ms, period_ms);
                assert_eq!(phase, step as usize % BEAM_PHASES, "{period_ms} ms");
            }
        }
    }

    #[test]
    fn ground_is_trusted_half_a_metre_around_the_place_that_stops_the_robot_and_no_farther() {
        let mut map = with_a_ditch(0.0);
        let ahead = Cell { x: 31, y: 30 };
        assert!(map.free_gaps(&config(), ahead));
        let reach = MapTuning::DEFAULT.free_gap_cells;
        let rows: Vec<i32> = (30 - reach..=31 + reach).collect();
        assert_eq!(free_rows(&map), rows);
        assert!(!map.free_gaps(&config(), ahead), "there was any");
    }

    #[test]
    fn ground_that_lies_higher_behind_a_gap_is_not_trusted_but_given_up() {
        let mut map = with_a_ditch(0.2);
        let ahead = Cell { x: 31, y: 30 };
        assert!(!map.free_gaps(&config(), ahead));
        assert_eq!(map.tiles().class(ahead), Class::Unknown);
        map.resolve_gaps(&config(), ahead);
        assert_eq!(map.tiles().class(ahead), Class::Negative);
    }
}
