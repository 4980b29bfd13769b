//! The bit-parallel thinning against the conditions of \[GuoHall89\], cell by cell, and against
//! `OpenCV`.

use fieldline_planner::grid::{PAGE_WORDS, PlaneMut, TileKey, Tiling, TooSmall};
use fieldline_planner::roadmap::{Progress, Thinning};
use fieldline_tests::bitmap::{Map, any_anchors, any_map, discs, noise, rooms};
use fieldline_tests::random::Random;

type AnyThinning = Thinning<64>;

/// A plane with the cells of a map.
struct Sheet {
    keys: Vec<TileKey>,
    words: Vec<u32>,
}

impl Sheet {
    fn of(map: &Map) -> Self {
        let keys = map.keys();
        let words = map.words(&keys);
        Self { keys, words }
    }

    fn tiling(&self) -> Tiling<'_> {
        Tiling::new(&self.keys)
    }

    /// Returns the words that a map of anchors has over the same tiles.
    fn anchors(&self, map: &Map, anchors: &Map) -> Vec<u32> {
        let mut held = anchors.clone();
        for (held, cell) in held.cells.iter_mut().zip(&map.cells) {
            *held &= cell;
        }
        held.words(&self.keys)
    }

    fn advance<const PAGES: usize>(
        &mut self,
        thinning: &mut Thinning<PAGES>,
        anchors: &[u32],
        budget: u32,
    ) -> Progress {
        let mut plane = PlaneMut::new(Tiling::new(&self.keys), &mut self.words).unwrap();
        let mut losses = vec![0xdead_beef; self.keys.len() * PAGE_WORDS];
        thinning.advance(&mut plane, anchors, &mut losses, budget)
    }

    fn map(&self, like: &Map) -> Map {
        like.with_words(&self.keys, &self.words)
    }
}

/// Thins in one go; returns the skeleton and the work.
fn thin(map: &Map) -> (Map, u32) {
    thin_around(map, &Map::new(map.columns, map.rows, false))
}

/// Thins in one go around anchors; returns the skeleton and the work.
fn thin_around(map: &Map, anchors: &Map) -> (Map, u32) {
    let mut sheet = Sheet::of(map);
    let anchors = sheet.anchors(map, anchors);
    let mut thinning = AnyThinning::new();
    thinning.start(sheet.tiling()).unwrap();
    let Progress::Done { left } = sheet.advance(&mut thinning, &anchors, u32::MAX) else {
        panic!("an endless budget was spent");
    };
    (sheet.map(map), u32::MAX - left)
}

#[test]
fn equals_the_cell_by_cell_thinning_on_a_thousand_maps() {
    let mut random = Random::new(1);
    for round in 0..1000 {
        let map = any_map(&mut random);
        let (skeleton, _) = thin(&map);
        let expected = map.thinned();
        assert!(
            skeleton == expected,
            "map {round}\n{}\nours\n{}\nexpected\n{}",
            map.print(),
            skeleton.print(),
            expected.print()
        );
    }
}

#[test]
fn keeps_every_piece_and_every_hole() {
    let mut random = Random::new(2);
    let mut most = (0, 0);
    for _ in 0..300 {
        let map = any_map(&mut random);
        let (skeleton, _) = thin(&map);
        let pieces = map.pieces(true, true);
        let outsides = map.pieces(false, false);
        assert_eq!(skeleton.pieces(true, true), pieces, "{}", map.print());
        assert_eq!(skeleton.pieces(false, false), outsides, "{}", map.print());
        most = (most.0.max(pieces), most.1.max(outsides));
    }
    assert!(
        most.0 > 50 && most.1 > 50,
        "the maps were too tame: {most:?}"
    );
}

#[test]
fn anchors_stay_and_the_rest_is_thinned_around_them() {
    let mut random = Random::new(8);
    let mut held = 0;
    for round in 0..1000 {
        let map = any_map(&mut random);
        let anchors = any_anchors(&mut random, &map);
        let (skeleton, _) = thin_around(&map, &anchors);
        let expected = map.thinned_around(&anchors);
        assert!(
            skeleton == expected,
            "map {round}\n{}\nanchors\n{}\nours\n{}\nexpected\n{}",
            map.print(),
            anchors.print(),
            skeleton.print(),
            expected.print()
        );
        let bare = map.thinned();
        for (i, cell) in map.cells.iter().enumerate() {
            let anchor = *cell && anchors.cells[i];
            assert!(!anchor || skeleton.cells[i], "map {round}, cell {i}");
            held += usize::from(anchor && !bare.cells[i]);
        }
    }
    assert!(held > 100_000, "the anchors held too little: {held}");
}

#[test]
fn anchors_change_no_count_of_pieces_and_holes() {
    let mut random = Random::new(9);
    for _ in 0..300 {
        let map = any_map(&mut random);
        let anchors = any_anchors(&mut random, &map);
        let (skeleton, _) = thin_around(&map, &anchors);
        let count = |map: &Map| (map.pieces(true, true), map.pieces(false, false));
        assert_eq!(
            count(&skeleton),
            count(&map),
            "{}\nanchors\n{}",
            map.print(),
            anchors.print()
        );
    }
}

#[test]
fn instalments_change_nothing() {
    let mut random = Random::new(3);
    for _ in 0..300 {
        let map = any_map(&mut random);
        let anchors = any_anchors(&mut random, &map);
        let (expected, _) = thin_around(&map, &anchors);
        let mut sheet = Sheet::of(&map);
        let anchors = sheet.anchors(&map, &anchors);
        let mut thinning = AnyThinning::new();
        thinning.start(sheet.tiling()).unwrap();
        let largest = 1 + random.index(200);
        let mut budget = || random.index(largest + 1) as u32;
        while sheet.advance(&mut thinning, &anchors, budget()) == Progress::Pending {}
        assert_eq!(sheet.map(&map), expected);
    }
}

#[test]
fn a_new_start_forgets_a_half_done_thinning() {
    let mut random = Random::new(7);
    let mut thinning = AnyThinning::new();
    for round in 0..300 {
        let map = any_map(&mut random);
        let mut sheet = Sheet::of(&map);
        thinning.start(sheet.tiling()).unwrap();
        if round % 3 == 0 {
            while sheet.advance(&mut thinning, &[], 50) == Progress::Pending {}
            assert_eq!(sheet.map(&map), map.thinned(), "map {round}");
        } else {
            let _ = sheet.advance(&mut thinning, &[], random.index(400) as u32);
        }
    }
}

/// In this map, found by search, a cell of the last word can be deleted only after its neighbour in
/// the word before; no other change marks the word. It is tried at all places of a tile.
#[test]
fn a_change_marks_the_words_beside() {
    let picture = Map::parse(
        "\
..####..
.#......
.....#..
####.#..
#.###...
#..###..
.###....
",
    );
    for (left, above) in (0..16).flat_map(|x| (0..16).map(move |y| (x, y))) {
        let mut map = Map::new(48, 48, false);
        for y in 0..picture.rows {
            for x in 0..picture.columns {
                let cell = picture.get(x as isize, y as isize);
                map.set(left + x, above + y, cell);
            }
        }
        let (skeleton, _) = thin(&map);
        assert_eq!(skeleton.print(), map.thinned().print());
    }
}

#[test]
fn wide_planes_do_not_wrap() {
    let mut random = Random::new(5);
    for round in 0..60 {
        let columns = [992, 961, 400, 160][round % 4];
        let mut map = match round % 3 {
            0 => rooms(&mut random, columns, 24),
            1 => noise(&mut random, columns, 24),
            _ => discs(&mut random, columns, 24),
        };
        map.rect(0, 0, 3, 24, true);
        map.rect(columns - 3, 0, 3, 24, true);
        let mut sheet = Sheet::of(&map);
        let mut thinning = Thinning::<{ 62 * 2 }>::new();
        thinning.start(sheet.tiling()).unwrap();
        while sheet.advance(&mut thinning, &[], 1000) == Progress::Pending {}
        assert_eq!(sheet.map(&map), map.thinned(), "map {round}");
    }
}

#[test]
fn the_work_follows_the_outline_of_the_map() {
    let mut map = Map::new(320, 320, false);
    map.rect(100, 100, 120, 120, true);
    let mut sheet = Sheet::of(&map);
    let mut thinning = Thinning::<100>::new();
    thinning.start(sheet.tiling()).unwrap();
    let Progress::Done { left } = sheet.advance(&mut thinning, &[], u32::MAX) else {
        panic!("an endless budget was spent");
    };
    let (work, passes) = (u32::MAX - left, u32::from(thinning.passes()));
    assert_eq!(
        passes, 121,
        "one side a pass, and one pass to see that nothing changes"
    );
    // A pass looks up at most the tiles and does the words on the hall's outline: 120 rows at two
    // sides and 8 words at the two others; then it deletes in these tiles. The first two passes do
    // all words of the 8 × 8 tiles.
    assert!(
        work < passes * (2 * 64 + 2 * 120 + 2 * 8) + 2 * 64 * 9,
        "{work} units"
    );
}

#[test]
fn more_tiles_than_pages_are_refused() {
    let sheet = Sheet::of(&Map::new(16 * 65, 1, true));
    let error = AnyThinning::new().start(sheet.tiling()).unwrap_err();
    let expected = TooSmall {
        needs: 65 * 8,
        has: 64 * 8,
    };
    assert_eq!(error, expected);
}

#[test]
fn a_thinning_that_was_not_started_changes_nothing() {
    let map = Map::new(32, 1, true);
    let mut sheet = Sheet::of(&map);
    let progress = sheet.advance(&mut AnyThinning::new(), &[], 5);
    assert_eq!(progress, Progress::Done { left: 5 });
    assert_eq!(sheet.map(&map), map);
}

/// Reads `fixtures/skeleton.txt`, which its script makes: name, map, and `OpenCV`'s skeleton of it.
fn fixtures() -> Vec<(String, Map, Map)> {
    let text = include_str!("../../fixtures/skeleton.txt");
    let mut lines = text.lines();
    let mut maps = Vec::new();
    while let Some(head) = lines.next() {
        let words: Vec<&str> = head.split(' ').collect();
        let ["map", name, columns, rows] = words[..] else {
            panic!("not the head of a map: {head}");
        };
        let (columns, rows) = (columns.parse().unwrap(), rows.parse().unwrap());
        let mut map = Map::new(columns, rows, false);
        let mut skeleton = map.clone();
        for y in 0..rows {
            let line = lines.next().unwrap();
            assert_eq!(line.len(), columns, "{name}, row {y}");
            for (x, cell) in line.bytes().enumerate() {
                map.set(x, y, cell != b'.');
                skeleton.set(x, y, cell == b'#');
            }
        }
        maps.push((name.to_owned(), map, skeleton));
    }
    maps
}

#[test]
fn skeletons_are_opencvs_bit_for_bit() {
    let fixtures = fixtures();
    assert_eq!(fixtures.len(), 9);
    for (name, map, expected) in fixtures {
        let (skeleton, _) = thin(&map);
        assert!(
            skeleton == expected,
            "{name}: ours\n{}\nexpected\n{}",
            skeleton.print(),
            expected.print()
        );
        assert!(map.cells.iter().filter(|c| **c).count() > 600);
    }
}
