//! The poses of a search and its open list: a binary heap by rank, in the caller's scratch memory.
//!
//! A node is five words; the heap holds node numbers.
//!
//! Invariant: the first `waiting` entries of the heap are a heap of open nodes, the least rank
//! first. Ties are resolved by the place in the heap, the same on every machine.

use crate::drive::hull::Place;
use crate::grid::at;

/// Capacity of a search, poses.
pub(super) const MOST_NODES: usize = 1100;
const NODE_WORDS: usize = 5;

/// Words that the nodes and the heap need.
pub(super) const WORDS: usize = MOST_NODES * NODE_WORDS + MOST_NODES;

/// A pose of the search.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) place: Place,
    /// Cost so far.
    pub(super) cost: f32,
    /// Cost so far plus the estimate of the rest.
    pub(super) rank: f32,
    /// The node before it.
    pub(super) parent: u16,
    /// The motion from there, by number.
    pub(super) motion: u8,
    /// The search ends here. No motion leads here: it is the parent's pose with another rank.
    pub(super) is_end: bool,
}

impl Node {
    /// Returns the node of the robot's pose.
    pub(super) fn start() -> Self {
        Self {
            place: Place::default(),
            cost: 0.0,
            rank: 0.0,
            parent: 0,
            motion: 0,
            is_end: false,
        }
    }

    fn words(self) -> [u32; NODE_WORDS] {
        // Costs are sums of tenths; 16 bits of hundredths hold more than the cost of any recovery.
        let hundredths = |cost: f32| (cost * 100.0) as u16;
        [
            self.place.x_m.to_bits(),
            self.place.y_m.to_bits(),
            self.place.yaw_rad.to_bits(),
            u32::from(hundredths(self.cost)) << 16 | u32::from(hundredths(self.rank)),
            u32::from(self.parent) << 16 | u32::from(self.motion) << 1 | u32::from(self.is_end),
        ]
    }

    fn from_words([x, y, yaw, costs, link]: [u32; NODE_WORDS]) -> Self {
        let place = Place {
            x_m: f32::from_bits(x),
            y_m: f32::from_bits(y),
            yaw_rad: f32::from_bits(yaw),
        };
        let cost = |hundredths: u32| (hundredths & 0xffff) as f32 * 0.01;
        Self {
            place,
            cost: cost(costs >> 16),
            rank: cost(costs),
            parent: (link >> 16) as u16,
            motion: (link >> 1 & 0x7f) as u8,
            is_end: link & 1 == 1,
        }
    }
}

/// The open list: the number of nodes, and of those that wait.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct OpenList {
    nodes: usize,
    waiting: usize,
}

/// Returns the rank of a node, in hundredths.
fn rank(words: &[u32], node: u32) -> u32 {
    words
        .get(node as usize * NODE_WORDS + 3)
        .map_or(u32::MAX, |costs| costs & 0xffff)
}

const fn place_of(entry: usize) -> usize {
    MOST_NODES * NODE_WORDS + entry
}

fn entry(words: &[u32], index: usize) -> u32 {
    at(words, place_of(index))
}

fn swap(words: &mut [u32], one: usize, other: usize) {
    let (a, b) = (entry(words, one), entry(words, other));
    for (at, value) in [(one, b), (other, a)] {
        if let Some(place) = words.get_mut(place_of(at)) {
            *place = value;
        }
    }
}

impl OpenList {
    /// Adds a node. Returns false if there is no room.
    pub(super) fn push(&mut self, words: &mut [u32], node: Node) -> bool {
        if self.nodes == MOST_NODES {
            return false;
        }
        let number = self.nodes;
        let Some(place) = words.get_mut(number * NODE_WORDS..(number + 1) * NODE_WORDS) else {
            return false;
        };
        place.copy_from_slice(&node.words());
        let Some(last) = words.get_mut(place_of(self.waiting)) else {
            return false;
        };
        *last = number as u32;
        self.nodes += 1;
        self.sift_up(words, self.waiting);
        self.waiting += 1;
        true
    }

    /// Takes the waiting node of least rank.
    pub(super) fn pop(&mut self, words: &mut [u32]) -> Option<(u16, Node)> {
        self.waiting = self.waiting.checked_sub(1)?;
        let least = entry(words, 0);
        swap(words, 0, self.waiting);
        self.sift_down(words);
        Some((least as u16, self.node(words, least as u16)?))
    }

    /// Returns a node by number.
    pub(super) fn node(&self, words: &[u32], number: u16) -> Option<Node> {
        let from = usize::from(number) * NODE_WORDS;
        words
            .get(from..)?
            .first_chunk()
            .map(|&words| Node::from_words(words))
    }

    fn sift_up(&self, words: &mut [u32], from: usize) {
        let mut at = from;
        while at > 0 {
            let above = (at - 1) / 2;
            if rank(words, entry(words, above)) <= rank(words, entry(words, at)) {
                return;
            }
            swap(words, above, at);
            at = above;
        }
    }

    fn sift_down(&self, words: &mut [u32]) {
        let mut at = 0;
        loop {
            let mut least = at;
            for below in [2 * at + 1, 2 * at + 2] {
                if below < self.waiting
                    && rank(words, entry(words, below)) < rank(words, entry(words, least))
                {
                    least = below;
                }
            }
            if least == at {
                return;
            }
            swap(words, least, at);
            at = least;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nodes_come_out_by_rank_and_as_they_went_in() {
        let mut words = std::vec![0; WORDS];
        let mut open = OpenList::default();
        for k in 0..500_u16 {
            let rank = f32::from(k * 37 % 500) * 0.5;
            let place = Place {
                x_m: rank,
                y_m: -rank,
                yaw_rad: 0.5 * rank,
            };
            let node = Node {
                place,
                rank,
                cost: 0.1 * rank,
                parent: k,
                motion: 5,
                is_end: k % 2 == 0,
            };
            assert!(open.push(&mut words, node));
        }
        for k in 0..500 {
            let (number, node) = open.pop(&mut words).unwrap();
            let rank = k as f32 * 0.5;
            assert!((node.rank - rank).abs() < 0.01 && node.place.x_m == rank);
            assert_eq!(
                (node.parent, node.motion, node.is_end),
                (number, 5, number % 2 == 0)
            );
        }
        assert!(open.pop(&mut words).is_none());
    }

    #[test]
    fn a_full_list_refuses() {
        let mut words = std::vec![0; WORDS];
        let mut open = OpenList::default();
        for _ in 0..MOST_NODES {
            assert!(open.push(&mut words, Node::start()));
        }
        assert!(!open.push(&mut words, Node::start()));
    }
}
