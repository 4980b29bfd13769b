//! The bit-parallel thinning against the conditions of \[GuoHall89\], cell by cell, and against
//! `OpenCV`.

use fieldline_planner::grid::{PlaneMut, ShapeError};
use fieldline_planner::roadmap::{Progress, Thinning, marks_for};
use fieldline_tests::bitmap::{Map, any_anchors, any_map, discs, noise, rooms};
use fieldline_tests::random::Random;

type AnyThinning = Thinning<16>;

/// Thins in one go; returns the skeleton and the work.
fn thin(map: &Map) -> (Map, u32) {
    thin_around(map, &[])
}

/// Thins in one go around anchors; returns the skeleton and the work.
fn thin_around(map: &Map, anchors: &[u32]) -> (Map, u32) {
    let mut words = map.words();
    let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
    let mut thinning = AnyThinning::new();
    thinning.start(map.shape()).unwrap();
    let Progress::Done { left } = thinning.advance(&mut plane, anchors, u32::MAX) else {
        panic!("an endless budget was spent");
    };
    (map.with_words(&words), u32::MAX - left)
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
        let (skeleton, _) = thin_around(&map, &anchors.words());
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
        let (skeleton, _) = thin_around(&map, &anchors.words());
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
        let anchors = any_anchors(&mut random, &map).words();
        let (expected, work) = thin_around(&map, &anchors);
        let mut words = map.words();
        let mut thinning = AnyThinning::new();
        thinning.start(map.shape()).unwrap();
        let largest = 1 + random.index(200);
        let mut spent = 0;
        loop {
            let budget = random.index(largest + 1) as u32;
            let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
            match thinning.advance(&mut plane, &anchors, budget) {
                Progress::Pending => spent += budget,
                Progress::Done { left } => {
                    spent += budget - left;
                    break;
                }
            }
        }
        assert_eq!(spent, work, "the work must not depend on its division");
        assert_eq!(map.with_words(&words), expected);
    }
}

#[test]
fn a_new_start_forgets_a_half_done_thinning() {
    let mut random = Random::new(7);
    let mut thinning = AnyThinning::new();
    for round in 0..300 {
        let map = any_map(&mut random);
        let mut words = map.words();
        let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
        thinning.start(map.shape()).unwrap();
        if round % 3 == 0 {
            while thinning.advance(&mut plane, &[], 50) == Progress::Pending {}
            assert_eq!(map.with_words(&words), map.thinned(), "map {round}");
        } else {
            let _ = thinning.advance(&mut plane, &[], random.index(400) as u32);
        }
    }
}

/// The marks of words come in groups of 32. In a plane of 3 × 11 words the last word, from column
/// 64 of row 10 on, is alone in its group. In this map, found by search, a cell of the last word
/// can be deleted only after its neighbour in the word before; no other change marks the word.
#[test]
fn a_change_marks_words_of_the_next_group() {
    let mut map = Map::new(96, 11, false);
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
    for y in 0..picture.rows {
        for x in 0..picture.columns {
            map.set(60 + x, 4 + y, picture.get(x as isize, y as isize));
        }
    }
    let (skeleton, _) = thin(&map);
    assert_eq!(skeleton.print(), map.thinned().print());
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
        let mut words = map.words();
        let mut thinning = Thinning::<{ marks_for(31 * 24) }>::new();
        thinning.start(map.shape()).unwrap();
        let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
        while thinning.advance(&mut plane, &[], 1000) == Progress::Pending {}
        assert_eq!(map.with_words(&words), map.thinned(), "map {round}");
    }
}

#[test]
fn the_work_follows_the_outline_of_the_map() {
    let mut map = Map::new(320, 320, false);
    map.rect(100, 100, 120, 120, true);
    let mut words = map.words();
    let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
    let mut thinning = Thinning::<100>::new();
    thinning.start(map.shape()).unwrap();
    let Progress::Done { left } = thinning.advance(&mut plane, &[], u32::MAX) else {
        panic!("an endless budget was spent");
    };
    let (work, passes) = (u32::MAX - left, u32::from(thinning.passes()));
    assert_eq!(
        passes, 121,
        "one side a pass, and one pass to see that nothing changes"
    );
    // A pass does at most the hall's outline, two rows and 240 words, and 100 groups; the first two
    // passes do all words.
    assert!(
        work < passes * (2 * 5 + 240 + 100) + 2 * 3200,
        "{work} units"
    );
}

#[test]
fn a_plane_beyond_the_marks_is_refused() {
    let map = Map::new(64, 257, true);
    let error = AnyThinning::new().start(map.shape()).unwrap_err();
    let expected = ShapeError::TooLarge {
        needs: 514,
        has: 512,
    };
    assert_eq!(error, expected);
}

#[test]
fn a_thinning_that_was_not_started_changes_nothing() {
    let map = Map::new(32, 1, true);
    let mut words = map.words();
    let mut plane = PlaneMut::new(map.shape(), &mut words).unwrap();
    let progress = AnyThinning::new().advance(&mut plane, &[], 5);
    assert_eq!(progress, Progress::Done { left: 5 });
    assert_eq!(words, [u32::MAX]);
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
