//! The map on uneven ground: the elevation window's memory, and its classes into the tiles.
//!
//! Counts of hits and passes say nothing there, because beams pass over holes and end on slopes; so the window of heights takes their place,
//! in their memory: 8 KB for 4,096 heights of two bytes, and 16 tiles of the pool for a byte of marks each. On flat ground all tiles are the
//! map's.

use crate::config::Config;
use crate::config::UnevenGround;
use crate::geometry::Cell;
use crate::grid::bits::ones64;
use crate::ground::classify::{self, Steps};
use crate::ground::doorway_view::{Look, Part};
use crate::ground::elevation::{WINDOW_CELLS, WINDOW_SIDE};
use crate::ground::survey::Survey;
use crate::ground::{Elevation, Heights};
use crate::input::Input;
use crate::map::tiles::NoRoom;
use crate::map::{Class, Map, SideTable, Tiles};
use crate::robot::is_level;

/// Tiles that hold the marks.
const MARK_TILES: usize = WINDOW_CELLS / size_of::<super::tiles::Cells>();

/// Rows this near to the robot are classified in every step, others in every second one: farther off than it drives until it has stopped.
const AT_ONCE: i32 = 12;
/// Of the beams into a room whose walls are known, every so many-th is looked at in a step.
const TURNS: usize = 5;
/// Cells told of in a step before what else is seen through doorways waits for the next one: a whole room at once is too much for a step.
const MOST_TOLD: u32 = 5_000;
/// About a step, milliseconds.
const STEP_MS: u32 = 200;
/// Cells around a goal that are given up with it.
const GIVEN_UP: i32 = 3;
/// Cells around the place before a robot that cannot go on where it trusts the ground: behind a brow no less is out of its view.
const TRUSTED: i32 = 5;

impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// From here on the window of heights lies where the counts were.
    pub(super) fn make_room_for_heights(&mut self) {
        self.tiles.lend(MARK_TILES);
    }

    /// The elevation window; without a single height on flat ground.
    #[must_use]
    pub fn heights(&self) -> Heights<'_> {
        Heights::new(self.evidence.bytes(), self.tiles.lent_bytes(), self.window)
    }

    /// Scans and pose into the window, and the window into the map.
    pub(super) fn survey(&mut self, config: &Config, terrain: &UnevenGround, input: &Input<'_>) {
        let input = &Input {
            pose: self.tilt.note(&input.pose),
            ..*input
        };
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.lent_bytes_mut(),
            &mut self.window,
        );
        Survey::new(&mut elevation, terrain, input)
            .believing(&self.tilt)
            .run(config, input, !self.surveyed);
        self.surveyed = true;
        if self.tilt.is_calm() {
            self.look_into_rooms(config, terrain, input);
        }
        let steps = Steps::new(terrain);
        self.odd = !self.odd;
        let middle = self.window.y + WINDOW_SIDE / 2;
        for y in self.window.y..self.window.y + WINDOW_SIDE {
            // Twice the work would be too much for a step, and what is far can wait for one.
            if (y - middle).abs() <= AT_ONCE || (y & 1 == 1) == self.odd {
                self.classify(&steps, y);
            }
        }
    }

    /// What is seen through doorways, where nothing is known yet.
    fn look_into_rooms(&mut self, config: &Config, terrain: &UnevenGround, input: &Input<'_>) {
        let turn = (input.time_ms / STEP_MS) as usize % TURNS;
        let mut told = 0;
        for (laser, ranges_mm) in config.lasers.iter().zip(input.scans) {
            let look = Look::new(&input.pose, terrain, laser, ranges_mm);
            let Some(look) = look.filter(|_| is_level(laser)) else {
                continue;
            };
            let mut from = 0;
            while let Some(beams) = look.doorway(&self.heights(), from) {
                from = beams.end;
                // Where a wall is known already, what lies before it mostly is: then a few beams a step will do.
                let is_due = |tiles: &Tiles<TILES, SLOTS>, number: usize| {
                    let is_new = |end: Cell| tiles.class(end) == Class::Unknown;
                    number % TURNS == turn || look.end(number).is_some_and(is_new)
                };
                for number in beams {
                    if told < MOST_TOLD && is_due(&self.tiles, number) {
                        look.tell(number, |cell, part| {
                            told += 1;
                            self.suppose(cell, part);
                        });
                    }
                }
            }
        }
    }

    /// What is seen through a doorway counts where nothing else is known.
    fn suppose(&mut self, cell: Cell, part: Part) {
        if self.tiles.class(cell) == Class::Unknown {
            let class = match part {
                Part::Floor => Class::Free,
                Part::Wall => Class::Obstacle,
            };
            // Where there is no room nothing is known in any case.
            let _ = self.tiles.set(cell, class);
        }
    }

    /// Make room in the pool if it runs short ([`super::folding`]), after every survey.
    pub fn fold(&mut self, lodger: &mut impl SideTable) {
        self.tiles.fold(self.window, WINDOW_SIDE, lodger);
    }

    /// The robot stood by a cell, and neither it nor what is around it was measured. Behind a brow ground stays out of view: where what is
    /// measured on both sides leads over it, it is taken for free, and else for gone.
    pub fn give_up_ground(&mut self, terrain: &UnevenGround, goal: Cell) {
        self.lead_over(terrain, (goal, GIVEN_UP), Some(Class::Negative));
    }

    /// The robot cannot go on for ground around a cell that was never measured: what leads over it is taken for free. Whether
    /// there was any.
    pub fn trust_ground(&mut self, terrain: &UnevenGround, ahead: Cell) -> bool {
        self.lead_over(terrain, (ahead, TRUSTED), None)
    }

    /// Take ground around a cell that was never measured for free where it is led over, and else for `gone`; whether any is free now.
    fn lead_over(
        &mut self,
        terrain: &UnevenGround,
        (middle, reach): (Cell, i32),
        gone: Option<Class>,
    ) -> bool {
        let mut any = false;
        // With an attitude that is not sure a rim beside it may have gone unnoticed: trusted, ground at two holes let the robot fall.
        let is_sure = self.tilt.is_calm();
        for y in middle.y - reach..=middle.y + reach + 1 {
            for x in middle.x - reach..=middle.x + reach + 1 {
                let cell = Cell { x, y };
                if self.tiles.class(cell) != Class::Unknown {
                    continue;
                }
                let leads_over =
                    is_sure && classify::leads_over(&self.heights(), terrain, cell, 0.0);
                // What was glimpsed is there.
                let gone = gone.filter(|_| self.heights().glimpse_m(cell).is_none());
                let class = if leads_over { Some(Class::Free) } else { gone };
                if let Some(class) = class {
                    // Where there is no room nothing is known in any case.
                    any |= self.tiles.set(cell, class).is_ok() && leads_over;
                }
            }
        }
        any
    }

    fn classify(&mut self, steps: &Steps, y: i32) {
        let x = self.window.x;
        let known = self.tiles.row(x, y);
        let classes = classify::row(&self.heights(), steps, y, known);
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
                match self.tiles.set(cell, class) {
                    Ok(()) => {}
                    Err(NoRoom::Box) => self.out_of_box = true,
                    Err(NoRoom::Pool) => self.pool_full = true,
                }
            }
        }
    }
}

#[cfg(test)]
impl<const TILES: usize, const SLOTS: usize> Map<TILES, SLOTS> {
    /// Measure the ground around a cell, where it has a height, metres.
    pub(crate) fn lay_ground(&mut self, middle: Cell, height_m: impl Fn(Cell) -> Option<f32>) {
        let mut elevation = Elevation::new(
            self.evidence.bytes_mut(),
            self.tiles.lent_bytes_mut(),
            &mut self.window,
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

    use super::{Class, Config, Steps, TRUSTED, UnevenGround};
    use crate::geometry::Cell;
    use crate::map::Map;

    /// Columns of a ditch that no beam met.
    const DITCH: core::ops::RangeInclusive<i32> = 30..=33;

    /// A map of level ground with the ditch in it.
    fn with_a_ditch(far_side_m: f32) -> Box<Map<152, 400>> {
        let config = Config {
            ground: Some(UnevenGround::TABLE_I),
            ..Config::pioneer_3at(heapless::Vec::new())
        };
        let mut map = Box::new(Map::new());
        map.begin(&config);
        map.lay_ground(Cell { x: 32, y: 32 }, |cell| {
            (!DITCH.contains(&cell.x)).then_some(if cell.x > 33 { far_side_m } else { 0.0 })
        });
        (0..64).for_each(|y| map.classify(&Steps::new(&UnevenGround::TABLE_I), y));
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
    fn ground_is_trusted_half_a_metre_around_the_place_that_stops_the_robot_and_no_farther() {
        let mut map = with_a_ditch(0.0);
        let ahead = Cell { x: 31, y: 30 };
        assert!(map.trust_ground(&UnevenGround::TABLE_I, ahead));
        let rows: Vec<i32> = (30 - TRUSTED..=31 + TRUSTED).collect();
        assert_eq!(free_rows(&map), rows);
        assert!(
            !map.trust_ground(&UnevenGround::TABLE_I, ahead),
            "there was any"
        );
    }

    #[test]
    fn ground_that_lies_higher_behind_a_gap_is_not_trusted_but_given_up() {
        let mut map = with_a_ditch(0.2);
        let ahead = Cell { x: 31, y: 30 };
        assert!(!map.trust_ground(&UnevenGround::TABLE_I, ahead));
        assert_eq!(map.tiles().class(ahead), Class::Unknown);
        map.give_up_ground(&UnevenGround::TABLE_I, ahead);
        assert_eq!(map.tiles().class(ahead), Class::Negative);
    }
}
