//! The poses of a search and its open list: a binary heap by rank, in the caller's scratch memory.
//!
//! A node is three words; the heap holds node numbers, two a word:
//!
//! | word | bits 31 to 16 | bits 15 to 0 |
//! | --- | --- | --- |
//! | 0 | y, 2⁻¹⁴ m | x, 2⁻¹⁴ m |
//! | 1 | parent, motion, end: 11, 4 and 1 bits | yaw, 2⁻¹³ rad |
//! | 2 | cost, hundredths | rank, hundredths |
//!
//! Invariant: the first `waiting` entries of the heap are a heap of open nodes, the least rank
//! first. Ties are resolved by the place in the heap, the same on every machine.

use crate::drive::hull::Place;
use crate::drive::motion::MOTIONS;
use crate::grid::at;
use crate::math;

/// Capacity of a search, poses. With too few a search gives up in worlds that can be explored
/// (measured: docs/MEASURED.md, "Capacities of a search").
pub(super) const MOST_NODES: usize = 1770;
/// Capacity of the heap: fewer poses than these wait at a time (measured: as above).
const MOST_WAITING: usize = 720;
const NODE_WORDS: usize = 3;

/// Words that the nodes and the heap need.
pub(super) const WORDS: usize = MOST_NODES * NODE_WORDS + MOST_WAITING.div_ceil(2);

/// Units of a stored place: 0.06 mm and 0.007°. Poses lie within 2 m.
const METRE: f32 = (1 << 14) as f32;
const RADIAN: f32 = (1 << 13) as f32;
/// Bits of a motion's number.
const MOTION_BITS: u32 = 4;
const _CHECKS: () = assert!(
    MOST_NODES < 1 << (15 - MOTION_BITS) && MOTIONS.len() <= 1 << MOTION_BITS,
    "a node's link fits into 16 bits"
);

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

    /// Returns the node as it is stored: its place is rounded, its yaw wrapped.
    fn words(self) -> [u32; NODE_WORDS] {
        let rounded = |value: f32, units: f32| math::floor(value * units + 0.5) as u16;
        // Costs are sums of tenths; 16 bits of hundredths hold more than the cost of any recovery.
        let hundredths = |cost: f32| (cost * 100.0) as u16;
        let pair = |high: u16, low: u16| u32::from(high) << 16 | u32::from(low);
        let motion = u16::from(self.motion) << 1;
        let link = self.parent << (MOTION_BITS + 1) | motion | u16::from(self.is_end);
        [
            pair(
                rounded(self.place.y_m, METRE),
                rounded(self.place.x_m, METRE),
            ),
            pair(link, rounded(math::wrap(self.place.yaw_rad), RADIAN)),
            pair(hundredths(self.cost), hundredths(self.rank)),
        ]
    }

    fn from_words([point, pose, costs]: [u32; NODE_WORDS]) -> Self {
        let value = |half: u32, units: f32| f32::from(half as u16 as i16) / units;
        let place = Place {
            x_m: value(point, METRE),
            y_m: value(point >> 16, METRE),
            yaw_rad: value(pose, RADIAN),
        };
        let cost = |hundredths: u32| (hundredths & 0xffff) as f32 * 0.01;
        let link = pose >> 16;
        Self {
            place,
            cost: cost(costs >> 16),
            rank: cost(costs),
            parent: (link >> (MOTION_BITS + 1)) as u16,
            motion: (link >> 1) as u8 & ((1 << MOTION_BITS) - 1),
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
        .get(node as usize * NODE_WORDS + 2)
        .map_or(u32::MAX, |costs| costs & 0xffff)
}

/// Returns the word of a heap's entry, and the bits below the entry.
const fn place_of(entry: usize) -> (usize, usize) {
    (MOST_NODES * NODE_WORDS + entry / 2, entry % 2 * 16)
}

fn entry(words: &[u32], index: usize) -> u32 {
    let (word, below) = place_of(index);
    at(words, word) >> below & 0xffff
}

fn set_entry(words: &mut [u32], index: usize, node: u32) {
    let (word, below) = place_of(index);
    if let Some(word) = words.get_mut(word) {
        *word = *word & !(0xffff << below) | node << below;
    }
}

fn swap(words: &mut [u32], one: usize, other: usize) {
    let (a, b) = (entry(words, one), entry(words, other));
    set_entry(words, one, b);
    set_entry(words, other, a);
}

impl OpenList {
    /// Adds a node. Returns false if there is no room.
    pub(super) fn push(&mut self, words: &mut [u32], node: Node) -> bool {
        if self.nodes == MOST_NODES || self.waiting == MOST_WAITING {
            return false;
        }
        let number = self.nodes;
        let Some(place) = words.get_mut(number * NODE_WORDS..(number + 1) * NODE_WORDS) else {
            return false;
        };
        place.copy_from_slice(&node.words());
        set_entry(words, self.waiting, number as u32);
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
                x_m: 0.005 * rank,
                y_m: -0.005 * rank,
                yaw_rad: 0.05 * rank,
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
            assert!((node.rank - rank).abs() < 0.01);
            assert!((node.place.x_m - 0.005 * rank).abs() < 4e-5);
            assert!((node.place.y_m + 0.005 * rank).abs() < 4e-5);
            assert!(math::wrap(node.place.yaw_rad - 0.05 * rank).abs() < 1e-4);
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
        for _ in 0..MOST_WAITING {
            assert!(open.push(&mut words, Node::start()));
        }
        assert!(!open.push(&mut words, Node::start()), "too many wait");
        for _ in MOST_WAITING..MOST_NODES {
            assert!(open.pop(&mut words).is_some());
            assert!(open.push(&mut words, Node::start()));
        }
        assert!(open.pop(&mut words).is_some());
        assert!(!open.push(&mut words, Node::start()), "there are too many");
    }
}
