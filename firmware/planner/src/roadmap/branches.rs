//! The branches of a skeleton: the kind of each cell, and the way along a branch.
//!
//! In circular order, the set ones of a cell's eight neighbours form *runs*. The number of runs,
//! Rutovitz's crossing number, gives the cell's kind:
//!
//! ```text
//! runs   0             1      2           3, 4
//!        alone, or     end    passage     junction
//!        deep inside
//! ```
//!
//! A branch is a chain of passages; it ends at an end or at a junction. Nothing is stored.
//!
//! The corner of a spot two cells thick has one run as well, and counts as an end. Thinning leaves
//! such spots only beside anchors.
//!
//! Units: sites of the plane, 8-connected.
//!
//! D. Rutovitz, "Pattern recognition", Journal of the Royal Statistical Society A 129(4), 1966.

use crate::grid::{Plane, RING, Site};

/// The kind of a set cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    /// No neighbour is set, or all are.
    Alone,
    /// The last cell of a branch.
    End,
    /// It lies between two others.
    Passage,
    /// Three or four ways meet in it.
    Junction,
}

/// Returns the kind of a cell; `None` if it is not set.
pub(crate) fn kind(plane: Plane<'_>, site: Site) -> Option<Kind> {
    if !plane.get(site) {
        return None;
    }
    let mut is_set = plane.query();
    let mut around = 0_u8;
    for (k, (dx, dy)) in RING.into_iter().enumerate() {
        let near = site.offset(dx, dy);
        around |= u8::from(near.is_some_and(&mut is_set)) << k;
    }
    // A run of set neighbours begins where the one before is clear.
    let runs = (around & !around.rotate_left(1)).count_ones();
    Some(match runs {
        0 => Kind::Alone,
        1 => Kind::End,
        2 => Kind::Passage,
        _ => Kind::Junction,
    })
}

/// The cells of a branch, from the one after its first cell to the end or junction that it leads
/// to; see [`Branch::new`].
#[derive(Clone, Debug)]
pub(crate) struct Branch<'a> {
    plane: Plane<'a>,
    first: Site,
    before: Site,
    next: Option<Site>,
    /// Maximum number of cells to come: in a thick spot the way may go round for ever.
    left: usize,
}

impl<'a> Branch<'a> {
    /// Returns the branch that leaves `first` by its neighbour `next`.
    pub(crate) fn new(plane: Plane<'a>, first: Site, next: Site) -> Self {
        Self {
            plane,
            first,
            before: first,
            next: plane.get(next).then_some(next),
            left: plane.count(),
        }
    }

    /// Returns the neighbour of a passage across from `before`: in its other run, a side before a
    /// corner.
    fn across(&self, here: Site, before: Site) -> Option<Site> {
        let ring = |k: usize| RING.get(k % 8).and_then(|&(dx, dy)| here.offset(dx, dy));
        let is_set = |k: usize| ring(k).is_some_and(|near| self.plane.get(near));
        let from = (0..8).find(|&k| ring(k) == Some(before))?;
        // Leave the run that `before` is in, then find the next run.
        let gap = (from..from + 8).find(|&k| !is_set(k))?;
        let run = (gap..gap + 8).find(|&k| is_set(k))?;
        let end = (run..run + 8).find(|&k| !is_set(k))?;
        (run..end).find(|k| k % 2 == 0).or(Some(run)).and_then(ring)
    }
}

impl Iterator for Branch<'_> {
    type Item = Site;

    fn next(&mut self) -> Option<Site> {
        let here = self.next.take()?;
        let before = core::mem::replace(&mut self.before, here);
        self.left = self.left.saturating_sub(1);
        let goes_on = here != self.first && self.left != 0;
        if goes_on && kind(self.plane, here) == Some(Kind::Passage) {
            self.next = self.across(here, before);
        }
        Some(here)
    }
}

/// Maximum number of ways that leave a cell.
pub(crate) const MOST_WAYS: usize = 8;

/// Returns the cells two steps from a cell through which the skeleton leaves its surroundings, one
/// for each way.
///
/// A wave passes by a single blocked cell where the skeleton is a staircase or two cells thick. So
/// a blocker takes the 3 × 3 cells around it out, its *surroundings*; that blocks all ways, and
/// what remains of each begins at one of these cells. Cells that touch each other belong to one
/// way.
pub(crate) fn ways(plane: Plane<'_>, site: Site) -> heapless::Vec<Site, MOST_WAYS> {
    let ring = |k: usize| {
        FAR_RING
            .get(k % 16)
            .and_then(|&(dx, dy)| site.offset(dx, dy))
    };
    let leads_out =
        |k: usize| ring(k).is_some_and(|far| plane.get(far) && touches_inside(plane, site, far));
    let mut ways = heapless::Vec::new();
    let mut last: Option<usize> = None;
    // Begin after a gap, so that no way is counted at both ends of the round.
    let Some(gap) = (0..16).find(|&k| !leads_out(k) && !leads_out(k + 15)) else {
        // The ring is set all round: no way is apart from another.
        return ways;
    };
    for k in gap + 1..gap + 16 {
        if !leads_out(k) {
            continue;
        }
        // Across a corner of the ring, cells two places apart touch.
        let joined =
            last.is_some_and(|last| k - last == 1 || (k - last == 2 && (last + 1) % 4 == CORNER));
        if !joined && let Some(far) = ring(k) {
            // At most eight of sixteen cells are apart.
            let _ = ways.push(far);
        }
        last = Some(k);
    }
    ways
}

/// Returns the nine cells of a cell's surroundings, the cell itself first; see [`ways`].
pub(crate) fn surroundings(site: Site) -> impl Iterator<Item = Site> {
    core::iter::once(site).chain(site.neighbours())
}

/// Returns true if a cell two steps away touches a set neighbour of the cell.
fn touches_inside(plane: Plane<'_>, site: Site, far: Site) -> bool {
    let near = |a: Site, b: Site| a.x.abs_diff(b.x) <= 1 && a.y.abs_diff(b.y) <= 1;
    plane.neighbours(far).any(|inside| near(inside, site))
}

/// Steps to the cells at distance two, round from the north on.
const FAR_RING: [(i8, i8); 16] = [
    (0, -2),
    (1, -2),
    (2, -2),
    (2, -1),
    (2, 0),
    (2, 1),
    (2, 2),
    (1, 2),
    (0, 2),
    (-1, 2),
    (-2, 2),
    (-2, 1),
    (-2, 0),
    (-2, -1),
    (-2, -2),
    (-1, -2),
];
/// The places of the corners in [`FAR_RING`], modulo 4.
const CORNER: usize = 2;

#[cfg(test)]
mod tests {
    use std::string::String;
    use std::vec::Vec;

    use super::{Branch, Kind, Plane, RING, Site, kind, ways};
    use crate::grid::{PlaneMut, TileKey, Tiling, draw};

    /// A plane of two tiles side by side.
    struct Sheet {
        keys: [TileKey; 2],
        words: [u32; 16],
    }

    impl Sheet {
        fn drawn(picture: &str) -> Self {
            let keys = [0, 1].map(|column| TileKey::of(column, 0).unwrap());
            let mut words = [0; 16];
            let mut plane = PlaneMut::new(Tiling::new(&keys), &mut words).unwrap();
            let rows: Vec<&str> = picture.split_whitespace().collect();
            draw(&mut plane, keys[0], &rows.join("\n"));
            Self { keys, words }
        }

        fn plane(&self) -> Plane<'_> {
            Plane::new(Tiling::new(&self.keys), &self.words).unwrap()
        }
    }

    /// Draws the kind of each cell: `e`nd, `-` passage, `x` junction, `o` alone.
    fn kinds_of(picture: &str) -> Vec<String> {
        let sheet = Sheet::drawn(picture);
        let plane = sheet.plane();
        let rows = picture.split_whitespace().enumerate();
        rows.map(|(y, row)| {
            let cell = |x: usize| match kind(plane, site(x, y)) {
                None => '.',
                Some(Kind::Alone) => 'o',
                Some(Kind::End) => 'e',
                Some(Kind::Passage) => '-',
                Some(Kind::Junction) => 'x',
            };
            (0..row.len()).map(cell).collect()
        })
        .collect()
    }

    /// The site so many columns and rows from the picture's corner.
    fn site(x: usize, y: usize) -> Site {
        let least = TileKey::of(0, 0).unwrap().least();
        Site {
            x: least.x + x as u16,
            y: least.y + y as u16,
        }
    }

    #[test]
    fn ends_passages_and_junctions_are_told_apart() {
        let picture = "
            #####..#...#
            ..#.....#.#.
            ..#......#..
            ..#......#.#
            ..#####..#..
            ...........#";
        let expected = [
            "e-x-e..e...e",
            "..-.....-.-.",
            "..-......x..",
            "..-......-.o",
            "..----e..e..",
            "...........o",
        ];
        assert_eq!(kinds_of(picture), expected);
    }

    #[test]
    fn the_kind_is_the_number_of_runs_of_set_neighbours() {
        let mut seed = 1_u64;
        let mut random = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (seed >> 32) as u32
        };
        for _ in 0..200 {
            let mut sheet = Sheet::drawn("#");
            sheet.words = core::array::from_fn(|_| random() & random() | random() & 0x1111);
            let plane = sheet.plane();
            for (y, x) in (0..16).flat_map(|y| (0..32).map(move |x| (y, x))) {
                let around = RING.map(|(dx, dy)| {
                    let near = site(x, y).offset(dx, dy);
                    near.is_some_and(|near| plane.get(near))
                });
                let begins = |&k: &usize| around[k] && !around[(k + 7) % 8];
                let expected = match (0..8).filter(begins).count() {
                    0 => Kind::Alone,
                    1 => Kind::End,
                    2 => Kind::Passage,
                    _ => Kind::Junction,
                };
                let expected = plane.get(site(x, y)).then_some(expected);
                assert_eq!(kind(plane, site(x, y)), expected);
            }
        }
    }

    #[test]
    fn a_branch_is_walked_to_its_junction_and_to_its_end() {
        let sheet = Sheet::drawn(
            "
            ..###...#
            .#...#.#.
            #.....#..
            .#...#...
            ..#.#....
            ...#.....",
        );
        let plane = sheet.plane();
        let junction = site(6, 2);
        let to = |x, y| -> Vec<Site> { Branch::new(plane, junction, site(x, y)).collect() };
        assert_eq!(to(7, 1), [site(7, 1), site(8, 0)], "to the end");
        let round = to(5, 1);
        assert_eq!(round.len(), 12, "round and back to where it began");
        assert_eq!(round.last(), Some(&junction));
        let mut back = to(5, 3);
        back.pop();
        back.reverse();
        assert_eq!(round[..11], back[..], "the same cells the other way round");
        assert_eq!(to(6, 3), [], "no cell, no branch");
    }

    #[test]
    fn ways_that_touch_are_one_and_a_thing_beside_is_none() {
        let ways_of = |picture: &str| {
            let sheet = Sheet::drawn(picture);
            let corner = site(0, 0);
            let ways = ways(sheet.plane(), site(3, 3));
            let from_corner = |s: &Site| (s.x - corner.x, s.y - corner.y);
            ways.iter().map(from_corner).collect::<Vec<_>>()
        };
        let corridor = "....... ....... ....... ####### ....... ....... .......";
        assert_eq!(ways_of(corridor), [(5, 3), (1, 3)]);
        let stairs = "....... .....## ....##. ..###.. ###.... ....... .......";
        assert_eq!(ways_of(stairs), [(5, 1), (1, 4)]);
        let three = "....... ...#... ...#... ####### ....... ....... .......";
        assert_eq!(ways_of(three), [(5, 3), (1, 3), (3, 1)]);
        let spur = "....... ....... ....... .###### ....... ....... .......";
        assert_eq!(ways_of(spur), [(5, 3), (1, 3)]);
        let end = "....... ....... ....... ..##### ....... ....... .......";
        assert_eq!(ways_of(end), [(5, 3)]);
        let beside = ".#..... .#..... .#..... .#.#... .#.#... .#.#... ...#...";
        assert_eq!(ways_of(beside), [(3, 5)]);
        let thick = "....... ....... ....... ####### ####### ....... .......";
        assert_eq!(ways_of(thick), [(5, 3), (1, 4)]);
    }
}
