//! The wavefront, with a small queue and two bits a cell, against a plain breadth-first search.

use fieldline_planner::grid::{Plane, PlaneMut, Site, TileKey, Tiling};
use fieldline_planner::roadmap::{Barrier, Residues, WaveSpace, Wavefront};
use fieldline_tests::bitmap::{Map, any_map, column_and_row, site};
use fieldline_tests::random::Random;

/// Memory of a wave.
struct Memory {
    keys: Vec<TileKey>,
    way: Vec<u32>,
    pairs: Vec<[u32; 2]>,
    ring: Vec<u32>,
}

impl Memory {
    fn new(map: &Map, ring: usize) -> Self {
        let keys = map.keys();
        let way = map.words(&keys);
        let pairs = vec![[0x1234_5678; 2]; way.len()];
        Self {
            keys,
            way,
            pairs,
            ring: vec![0; ring],
        }
    }

    fn space(&mut self) -> WaveSpace<'_> {
        let tiling = Tiling::new(&self.keys);
        WaveSpace {
            cells: Plane::new(tiling, &self.way).unwrap(),
            residues: Residues::new(tiling, &mut self.pairs).unwrap(),
            ring: &mut self.ring,
        }
    }
}

/// Asserts every cell's residue, and the descent from every reached cell.
fn check(map: &Map, residues: &Residues<'_>, steps: &[Option<u32>]) {
    for y in 0..map.rows {
        for x in 0..map.columns {
            let (at, expected) = (site(x, y), steps[y * map.columns + x]);
            assert_eq!(residues.get(at), expected.map(|s| (s % 3) as u8), "{at:?}");
        }
    }
    let index = |s: Site| {
        let (x, y) = column_and_row(s);
        y * map.columns + x
    };
    for (i, steps_from) in steps.iter().enumerate() {
        let from = site(i % map.columns, i / map.columns);
        match steps_from {
            None => assert_eq!(residues.descend(from), None),
            Some(0) => assert_eq!(residues.descend(from), None, "a seed is the end"),
            Some(s) => {
                let next = residues.descend(from).unwrap();
                assert_eq!(steps[index(next)], Some(s - 1), "from {from:?}");
                let side = next.x == from.x || next.y == from.y;
                let sides = [(1, 0), (0, -1), (-1, 0), (0, 1)];
                let nearer_side = sides.into_iter().any(|(dx, dy)| {
                    let (x, y) = (i % map.columns, i / map.columns);
                    let near = (x as isize + dx, y as isize + dy);
                    map.get(near.0, near.1)
                        && steps[near.1 as usize * map.columns + near.0 as usize] == Some(s - 1)
                });
                assert_eq!(side, nearer_side, "sides come before corners");
            }
        }
    }
}

fn some_seeds(random: &mut Random, map: &Map) -> Vec<Site> {
    let count = [1, 3, 40, 400][random.index(4)];
    (0..count)
        .map(|_| site(random.index(map.columns), random.index(map.rows)))
        .collect()
}

#[test]
fn equals_a_plain_search_with_rings_of_all_sizes() {
    let mut random = Random::new(11);
    for round in 0..600 {
        let map = any_map(&mut random);
        let map = if round % 2 == 0 { map.thinned() } else { map };
        let seeds = some_seeds(&mut random, &map);
        let steps = map.distances(&seeds);
        let ring = [0, 1, 2, 7, 31, 1024][round % 6];
        let mut memory = Memory::new(&map, ring);
        let mut space = memory.space();
        let mut wave = Wavefront::new();
        wave.start(&mut space);
        for seed in &seeds {
            wave.seed(&mut space, *seed);
        }
        wave.run(&mut space, None);
        check(&map, &space.residues, &steps);
    }
}

#[test]
fn a_stop_at_a_cell_leaves_its_descent_complete() {
    let mut random = Random::new(14);
    let mut stopped_early = 0;
    for _ in 0..300 {
        let map = any_map(&mut random).thinned();
        let seeds = some_seeds(&mut random, &map);
        let until = site(random.index(map.columns), random.index(map.rows));
        let steps = map.distances(&seeds);
        let mut memory = Memory::new(&map, 128);
        let mut space = memory.space();
        let mut wave = Wavefront::new();
        wave.start(&mut space);
        for seed in &seeds {
            wave.seed(&mut space, *seed);
        }
        wave.run(&mut space, Some(until));
        let (x, y) = column_and_row(until);
        let expected = steps[y * map.columns + x];
        assert_eq!(space.residues.get(until).is_some(), expected.is_some());
        let walked = space.residues.descent(until).count();
        assert_eq!(walked, expected.unwrap_or(0) as usize);
        let last = space.residues.descent(until).last();
        assert!(last.is_none_or(|end| seeds.contains(&end)));
        let reached = |s: &Residues<'_>| {
            let sites = (0..map.cells.len()).map(|i| site(i % map.columns, i / map.columns));
            sites.filter(|at| s.get(*at).is_some()).count()
        };
        let early = reached(&space.residues);
        wave.run(&mut space, None);
        check(&map, &space.residues, &steps);
        stopped_early += usize::from(early < reached(&space.residues));
    }
    assert!(
        stopped_early > 20,
        "only {stopped_early} waves stopped early"
    );
}

#[test]
fn a_barrier_sends_the_wave_the_other_way_round() {
    let ring = Map::parse(
        "\
.######.
#......#
#......#
.######.
",
    );
    let mut memory = Memory::new(&ring, 16);
    let from = site(0, 1);
    let walk = |memory: &mut Memory| {
        let mut space = memory.space();
        let mut wave = Wavefront::new();
        wave.start(&mut space);
        assert!(wave.seed(&mut space, site(7, 1)));
        wave.run(&mut space, None);
        let sites: Vec<Site> = space.residues.descent(from).collect();
        sites
    };
    let free = walk(&mut memory);
    assert_eq!(free.len(), 7);
    assert!(
        free.iter().all(|s| column_and_row(*s).1 < 2),
        "along the north: {free:?}"
    );
    let mut way = memory.way.clone();
    let keys = ring.keys();
    let mut plane = PlaneMut::new(Tiling::new(&keys), &mut way).unwrap();
    let barrier = Barrier::<4>::raise(&mut plane, [site(3, 0), site(3, 1)]).unwrap();
    memory.way.copy_from_slice(plane.words_mut());
    let blocked = walk(&mut memory);
    assert_eq!(blocked.len(), 9);
    assert!(
        blocked.iter().any(|s| column_and_row(*s).1 == 3),
        "round the south"
    );
    barrier.lower(&mut plane);
    memory.way.copy_from_slice(plane.words_mut());
    assert_eq!(walk(&mut memory), free);
}
