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
//! A branch is a chain of passages; it ends at an end or at a junction. Nothing is stored. The 32
//! cells of a word are judged together from three rows; a branch is followed cell by cell.
//!
//! The corner of a spot two cells thick has one run as well, and counts as an end. Thinning leaves
//! such spots only beside anchors.
//!
//! Units: sites of the plane, 8-connected.
//!
//! D. Rutovitz, "Pattern recognition", Journal of the Royal Statistical Society A 129(4), 1966.

use crate::grid::{Plane, Site};

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

/// The kinds of the set cells of a word. Those in none of the three are [`Kind::Alone`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Kinds {
    /// The [`Kind::End`]s.
    pub(crate) ends: u32,
    /// The [`Kind::Passage`]s.
    pub(crate) passages: u32,
    /// The [`Kind::Junction`]s.
    pub(crate) junctions: u32,
}

/// Returns the kinds of the 32 cells of a word.
pub(crate) fn kinds(plane: Plane<'_>, row: usize, word: usize) -> Kinds {
    let here = plane.word(row, word);
    if here == 0 {
        return Kinds::default();
    }
    let (ones, twos, fours) = count(runs_begin(&around(plane, row, word)));
    Kinds {
        ends: here & ones & !twos,
        passages: here & twos & !ones,
        junctions: here & (fours | (twos & ones)),
    }
}

/// Returns the kind of a cell; `None` if it is not set.
pub(crate) fn kind(plane: Plane<'_>, site: Site) -> Option<Kind> {
    if !plane.get(site) {
        return None;
    }
    let kinds = kinds(plane, usize::from(site.y), usize::from(site.x / 32));
    let has = |cells: u32| cells & site.bit() != 0;
    Some(if has(kinds.ends) {
        Kind::End
    } else if has(kinds.passages) {
        Kind::Passage
    } else if has(kinds.junctions) {
        Kind::Junction
    } else {
        Kind::Alone
    })
}

/// Returns the neighbours of a word's cells: north, north-east, and so on round.
fn around(plane: Plane<'_>, row: usize, word: usize) -> [u32; 8] {
    let three = |row: usize| {
        let beside = |word: usize| plane.word(row, word);
        let here = beside(word);
        [
            here << 1 | beside(word.wrapping_sub(1)) >> 31,
            here,
            here >> 1 | beside(word + 1) << 31,
        ]
    };
    let [north_west, north, north_east] = three(row.wrapping_sub(1));
    let [west, _, east] = three(row);
    let [south_west, south, south_east] = three(row + 1);
    [
        north, north_east, east, south_east, south, south_west, west, north_west,
    ]
}

/// Returns for each direction the cells for which a run of set neighbours begins there.
fn runs_begin(around: &[u32; 8]) -> impl Iterator<Item = u32> + '_ {
    let before = around.iter().cycle().skip(7);
    around
        .iter()
        .zip(before)
        .map(|(here, before)| here & !before)
}

/// Counts the words that have each bit, up to four: returns ones, twos and fours.
fn count(words: impl Iterator<Item = u32>) -> (u32, u32, u32) {
    words.fold((0, 0, 0), |(ones, twos, fours), word| {
        let carry = ones & word;
        (ones ^ word, twos ^ carry, fours | (twos & carry))
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

/// Steps to the neighbours round a cell, from the north on. Sides have even places.
const RING: [(i8, i8); 8] = [
    (0, -1),
    (1, -1),
    (1, 0),
    (1, 1),
    (0, 1),
    (-1, 1),
    (-1, 0),
    (-1, -1),
];

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

    use super::{Branch, Kind, Plane, Site, kind, kinds, ways};
    use crate::grid::{PlaneMut, Shape, draw};

    fn plane(picture: &str) -> (Shape, Vec<u32>) {
        let rows: Vec<&str> = picture.split_whitespace().collect();
        let shape = Shape::new(2, rows.len()).unwrap();
        let mut words = std::vec![0; shape.words()];
        let mut plane = PlaneMut::new(shape, &mut words).unwrap();
        draw(&mut plane, &rows.join("\n"));
        (shape, words)
    }

    /// Draws the kind of each cell: `e`nd, `-` passage, `x` junction, `o` alone.
    fn kinds_of(picture: &str) -> Vec<String> {
        let (shape, words) = plane(picture);
        let plane = Plane::new(shape, &words).unwrap();
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

    fn site(x: usize, y: usize) -> Site {
        Site {
            x: x as u16,
            y: y as u16,
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

    fn random(seed: &mut u64) -> u32 {
        *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        (*seed >> 32) as u32
    }

    #[test]
    fn a_word_at_a_time_is_a_cell_at_a_time() {
        let mut seed = 1;
        for round in 0..200 {
            let shape = Shape::new(1 + round % 3, 1 + round % 5).unwrap();
            let words: Vec<u32> = (0..shape.words())
                .map(|_| random(&mut seed) & random(&mut seed) | random(&mut seed) & 0x1111)
                .collect();
            let plane = Plane::new(shape, &words).unwrap();
            for (y, x) in (0..shape.rows()).flat_map(|y| (0..shape.columns()).map(move |x| (y, x)))
            {
                let around = super::RING.map(|(dx, dy)| {
                    site(x, y)
                        .offset(dx, dy)
                        .is_some_and(|near| plane.get(near))
                });
                let runs = (0..8)
                    .filter(|&k| around[k] && !around[(k + 7) % 8])
                    .count();
                let kinds = kinds(plane, y, x / 32);
                let has = |bits: u32| bits >> (x % 32) & 1 == 1;
                let set = plane.get(site(x, y));
                assert_eq!(has(kinds.ends), set && runs == 1);
                assert_eq!(has(kinds.passages), set && runs == 2);
                assert_eq!(has(kinds.junctions), set && runs > 2);
            }
        }
    }

    #[test]
    fn a_branch_is_walked_to_its_junction_and_to_its_end() {
        let (shape, words) = plane(
            "
            ..###...#
            .#...#.#.
            #.....#..
            .#...#...
            ..#.#....
            ...#.....",
        );
        let plane = Plane::new(shape, &words).unwrap();
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
            let (shape, words) = plane(picture);
            let plane = Plane::new(shape, &words).unwrap();
            let ways: Vec<(u16, u16)> =
                ways(plane, site(3, 3)).iter().map(|s| (s.x, s.y)).collect();
            ways
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
