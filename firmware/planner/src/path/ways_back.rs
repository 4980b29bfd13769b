//! The ways back from goals to the robot: the first cell near the robot on each.
//!
//! A wave from the robot leaves them ([`crate::path::robot_wave`]). Each alone may be as long as
//! the map is large. But they join, and from there on they are one. So what is known of the last
//! ways shortens the next ones: all ways of a round together are hardly longer than the skeleton.
//!
//! Invariant: what is noted is true of its cell, whichever way it was noted on.
//!
//! Units: coarse steps of 20 cm; sites of the skeleton's plane.

use crate::grid::Site;
use crate::roadmap::Residues;

/// Steps between the cells of a way that are noted.
const APART: usize = 32;
/// Capacity, cells: they note a way of 400 m. A longer one notes its end over its begin.
const MOST: usize = 64;
/// No cell.
const NOWHERE: Site = Site {
    x: u16::MAX,
    y: u16::MAX,
};

/// What is known of the ways back to a robot.
#[derive(Debug)]
pub(crate) struct WaysBack {
    /// Cells, by their steps to the robot, each with the first cell near the robot.
    noted: [(Site, Site); MOST],
}

impl WaysBack {
    /// Nothing is known.
    pub(crate) const NONE: Self = Self {
        noted: [(NOWHERE, NOWHERE); MOST],
    };

    /// Returns the first cell that `is_near` holds for on the way back from a goal that is so many
    /// steps away; the last one if it holds for none. Residues and `is_near` must be the same in
    /// all calls.
    pub(crate) fn first_near(
        &mut self,
        residues: &Residues<'_>,
        (goal, steps): (Site, u32),
        is_near: impl Fn(Site) -> bool,
    ) -> Site {
        let (mut site, mut left) = (goal, steps);
        for next in residues.descent(goal) {
            if is_near(site) {
                break;
            }
            if let Some(first) = self.known(site, left) {
                site = first;
                break;
            }
            (site, left) = (next, left.saturating_sub(1));
        }
        self.note(site);
        site
    }

    /// Returns the first cell near the robot on the way back from a cell that is so many steps
    /// away. If it is not known, the next [`Self::note`] tells it.
    fn known(&mut self, site: Site, steps: u32) -> Option<Site> {
        let steps = steps as usize;
        let place = (steps / APART) % MOST;
        let noted = self
            .noted
            .get_mut(place)
            .filter(|_| steps.is_multiple_of(APART))?;
        if noted.0 == site {
            return Some(noted.1);
        }
        *noted = (site, NOWHERE);
        None
    }

    /// Notes the first cell near the robot for the cells of the last way that did not know it.
    fn note(&mut self, first: Site) {
        for (_, known) in &mut self.noted {
            if *known == NOWHERE {
                *known = first;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use core::cell::Cell as Counter;
    use std::vec;
    use std::vec::Vec;

    use super::*;
    use crate::grid::bits::tests::Rng;
    use crate::grid::{Plane, TileKey, Tiling};
    use crate::roadmap::{WaveSpace, Wavefront};

    /// Tiles along a side of the map: the longest ways note more than there is room for.
    const TILES: i32 = 6;
    /// Sites along a side.
    const SIDE: u64 = 16 * TILES as u64;

    fn keys() -> Vec<TileKey> {
        let keys = (0..TILES).flat_map(|y| (0..TILES).map(move |x| TileKey::of(x, y).unwrap()));
        keys.collect()
    }

    /// Draws corridors along every fourth row. Each is joined with the next one at a random place;
    /// if it `winds`, at its ends in turn.
    fn corridors(rng: &mut Rng, winds: bool, mut set: impl FnMut(u64, u64)) {
        for y in (0..SIDE).step_by(4) {
            (0..SIDE).for_each(|x| set(x, y));
            let joint = match (winds, y % 8) {
                (false, _) => rng.next() % SIDE,
                (true, 0) => SIDE - 1,
                (true, _) => 0,
            };
            (y + 1..(y + 4).min(SIDE)).for_each(|y| set(joint, y));
        }
    }

    /// The way back cell by cell: its end, and the cells that were asked for.
    fn slowly(residues: &Residues<'_>, goal: Site, is_near: impl Fn(Site) -> bool) -> (Site, u32) {
        let (mut site, mut asked) = (goal, 1);
        while !is_near(site)
            && let Some(next) = residues.descend(site)
        {
            (site, asked) = (next, asked + 1);
        }
        (site, asked)
    }

    #[test]
    fn equals_a_walk_cell_by_cell_and_is_much_shorter() {
        let keys = keys();
        let tiling = Tiling::new(&keys);
        let least = keys[0].least();
        let site = |x: u64, y: u64| Site {
            x: least.x + x as u16,
            y: least.y + y as u16,
        };
        let mut rng = Rng(5);
        for round in 0..40 {
            let mut words = vec![0; tiling.words()];
            corridors(&mut rng, round % 2 == 1, |x, y| {
                words[tiling.index(site(x, y)).unwrap()] |= site(x, y).bit();
            });
            let mut pairs = vec![[0; 2]; words.len()];
            let mut space = WaveSpace {
                cells: Plane::new(tiling, &words).unwrap(),
                residues: Residues::new(tiling, &mut pairs).unwrap(),
                ring: &mut [0; 200],
            };
            let mut place = || site(rng.next() % SIDE, rng.next() % SIDE / 4 * 4);
            let (robot, mut wave) = (place(), Wavefront::new());
            wave.start(&mut space);
            wave.seed(&mut space, robot);
            wave.run(&mut space, None);

            let apart = |site: Site| site.x.abs_diff(robot.x).max(site.y.abs_diff(robot.y));
            let (mut ways, asked) = (WaysBack::NONE, Counter::new(0));
            let is_near = |site| {
                asked.set(asked.get() + 1);
                apart(site) <= 5
            };
            let mut all = 0;
            for _ in 0..24 {
                let goal = place();
                let steps = space.residues.descent(goal).count() as u32;
                let (expected, alone) = slowly(&space.residues, goal, |site| apart(site) <= 5);
                all += alone;
                let first = ways.first_near(&space.residues, (goal, steps), is_near);
                assert_eq!(first, expected, "round {round}");
            }
            assert!(2 * asked.get() < all, "{} of {all}", asked.get());
        }
    }
}
