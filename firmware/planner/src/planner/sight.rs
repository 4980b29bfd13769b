//! Scans in a team: a beam that ends in a peer is no measurement of the map.
//!
//! Such a beam becomes invalid for everything that enters scans. It still says that nothing stands
//! before the peer, so on flat ground it frees the cells up to there. Otherwise two robots that
//! drive towards each other would always have a frontier between them.
//!
//! Units: millimetres of range, metres.

use heapless::Vec;

use crate::config::Config;
use crate::input::{INVALID_MM, Input, informative_range_mm};
use crate::planner::sense;
use crate::planner::state::State;
use crate::robot::MAX_BEAMS;

/// A beam that ends in a peer frees the cells up to this distance before it, millimetres: two
/// cells.
const BEFORE_PEER_MM: u16 = 200;

/// The ranges of a scan.
type Ranges = Vec<u16, { MAX_BEAMS as usize }>;

/// Enters scans and odometry, without the beams that end in a peer. Not inlined: its scans lie on
/// the stack only while the planner senses.
#[inline(never)]
pub(super) fn sense_without_peers<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
) {
    let mut seen = [const { Ranges::new() }; 2];
    for ((laser, scan), seen) in config.lasers.iter().zip(input.scans).zip(&mut seen) {
        // A dropout is known by its neighbours, which may be hidden.
        let range = |i| informative_range_mm(scan, i, laser.range_limit_mm);
        let ranges = (0..scan.len()).map(|i| range(i).unwrap_or(INVALID_MM));
        seen.extend(ranges.take(MAX_BEAMS.into()));
        let peers = state.team.peers();
        peers.hide(input.time_ms, &input.pose, laser, seen);
    }
    let [first, second] = &seen;
    let without_peers = Input {
        scans: [first, second],
        ..*input
    };
    sense(config, state, &without_peers);
    if !state.ground.is_uneven() && state.localiser.may_enter() {
        free_before_peers(config, state, input, &seen);
    }
}

/// Frees the cells before the peers, along the beams of the level lasers that were hidden.
fn free_before_peers<const TILES: usize, const SLOTS: usize>(
    config: &Config,
    state: &mut State<TILES, SLOTS>,
    input: &Input<'_>,
    seen: &[Ranges; 2],
) {
    let scans = config.lasers.iter().zip(input.scans.iter().zip(seen));
    for (laser, (scan, seen)) in scans.filter(|(laser, _)| laser.is_level()) {
        for (number, (&range_mm, &seen_mm)) in scan.iter().zip(seen).enumerate() {
            let was_hidden = seen_mm == INVALID_MM && range_mm < laser.range_limit_mm;
            let Some(free_mm) = range_mm.checked_sub(BEFORE_PEER_MM).filter(|_| was_hidden) else {
                continue;
            };
            let beam = (number, f32::from(free_mm) * 1e-3);
            let tuning = &config.tuning.map;
            state.map.free_view(tuning, &input.pose, laser, beam);
        }
    }
}
