//! Levels of the grid as a graph: elimination, groups and scales.

use super::{Level, Node};

/// Makes a corridor of `count` cells with a goal beyond the last one.
fn corridor(count: u32) -> Vec<Node> {
    let node = |k: u32| Node {
        beside: [
            k.checked_sub(1),
            Some(k + 1).filter(|&next| next < count),
            None,
            None,
        ],
        goals: u8::from(k + 1 == count),
    };
    (0..count).map(node).collect()
}

fn swept(mut level: Level) -> Vec<f64> {
    (0..400).for_each(|k| level.sweep(k % 2 == 1));
    level.value
}

#[test]
fn elimination_agrees_with_sweeps() {
    let level = Level::finest(&corridor(12), 1.0);
    let mut direct = level.clone();
    direct.eliminate();
    for (a, b) in direct.value.iter().zip(swept(level)) {
        assert!((a / b - 1.0).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn elimination_is_precise_over_hundreds_of_orders() {
    let mut level = Level::finest(&corridor(400), 1.0);
    level.eliminate();
    let ratio = level.value[100] / level.value[101];
    assert!((ratio - (2.0 - 3.0_f64.sqrt())).abs() < 1e-14, "{ratio}");
    assert!(level.value[0] > 0.0 && level.value[0] < 1e-228);
}

#[test]
fn groups_are_connected_parts_of_blocks_and_their_equations_are_sums() {
    // Places (0,0), (1,0) and (1,1) are in one block, but (0,0) is not connected with the
    // others. Place (2,1) is in the next block.
    let mut nodes = corridor(4);
    nodes[0] = Node::default();
    nodes[1].beside[0] = None;
    let places = [(0, 0), (1, 0), (1, 1), (2, 1)];
    let mut level = Level::finest(&nodes, 8.0);
    let (mut coarse, blocks) = level.coarsen(&places);
    assert_eq!(level.group, [0, 1, 1, 2]);
    assert_eq!(blocks, [(0, 0), (0, 0), (1, 0)]);
    level.value = vec![1.0, 2.0, 3.0, 5.0];
    level.restrict(&mut coarse);
    assert_eq!(coarse.source, [0.0, 0.0, 8.0]);
    // Free neighbours: none, one, two, one.
    assert_eq!(coarse.loss, [4.0, 3.0 * 2.0 + 2.0 * 3.0, 3.0 * 5.0]);
    assert_eq!(
        (&coarse.from[..], &coarse.flow[..]),
        (&[2, 1][..], &[5.0, 3.0][..])
    );
    assert_eq!(coarse.outflow, [4.0, 12.0 + 3.0, 15.0 + 5.0]);
    coarse.value = vec![1.0, 2.0, 10.0];
    level.prolong(&coarse);
    assert_eq!(level.value, [1.0, 4.0, 6.0, 50.0]);
}

#[test]
fn a_solution_is_not_scaled() {
    let mut level = Level::finest(&corridor(8), 1.0);
    level.eliminate();
    let places: Vec<(u32, u32)> = (0..8).map(|k| (k, 0)).collect();
    let (mut coarse, _) = level.coarsen(&places);
    level.restrict(&mut coarse);
    coarse.eliminate();
    for factor in coarse.value {
        assert!((factor - 1.0).abs() < 1e-12, "{factor}");
    }
}
