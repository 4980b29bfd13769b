//! Fences, budgets and orders to drive: those of a careful host, and any that the wire can carry.

use fieldline_protocol::message::{Budget, FENCE_CORNERS, Fence, FencePolygon};
use fixed::types::I16F16;

use super::quantities::{wide, wide_within};
use crate::session::ask::Ask;
use crate::session::choices::Choices;

/// Farthest corner and goal of a careful host along an axis, in 2⁻¹⁶ m: 12 m.
const NEAR: i64 = 12 << 16;

/// Draws a fence around the start: none, bounds and no-go rectangles, or, rarely, anything.
pub(super) fn fence(choices: &mut impl Choices) -> Fence {
    match choices.below(6) {
        0..3 => Fence::default(),
        3 | 4 => rectangles(choices),
        _ => anything(choices),
    }
}

/// Draws bounds around the start and a few rectangles, which may lie on it.
fn rectangles(choices: &mut impl Choices) -> Fence {
    let mut fence = Fence::default();
    if choices.once_in(2) {
        let mut side = || wide_within(choices, 1 << 16, NEAR);
        let (left, low, right, top) = (-side(), -side(), side(), side());
        add(&mut fence, [left, low, right, top], true);
    }
    for _ in 0..choices.below(4) {
        let mut at = || wide_within(choices, -NEAR, NEAR);
        let (x, y) = (at(), at());
        let mut side = || wide_within(choices, 1 << 12, 4 << 16);
        let (right, top) = (x + side(), y + side());
        add(&mut fence, [x, y, right, top], false);
    }
    fence
}

fn add(fence: &mut Fence, [x0, y0, x1, y1]: [I16F16; 4], bounds: bool) {
    // At most four polygons of four corners, for which there is room.
    fence
        .corners
        .extend([(x0, y0), (x1, y0), (x1, y1), (x0, y1)]);
    let _ = fence.polygons.push(FencePolygon { corners: 4, bounds });
}

/// Draws polygons with any corners, or with wrong numbers of them.
fn anything(choices: &mut impl Choices) -> Fence {
    let is_near = choices.once_in(2);
    let mut fence = Fence::default();
    for _ in 0..choices.below(FENCE_CORNERS as u64 + 1) {
        let mut at = || match is_near {
            true => wide_within(choices, -NEAR, NEAR),
            false => wide(choices),
        };
        let _ = fence.corners.push((at(), at()));
    }
    let mut left = fence.corners.len() as u64;
    while left > 0 && !fence.polygons.is_full() {
        let corners = 1 + choices.below(left);
        left -= corners;
        let _ = fence.polygons.push(FencePolygon {
            corners: corners as u8,
            bounds: choices.once_in(3),
        });
        if choices.once_in(8) {
            break;
        }
    }
    fence
}

/// Draws a budget: usually none.
pub(super) fn budget(choices: &mut impl Choices) -> Budget {
    let mut part = || match choices.below(6) {
        0..4 => None,
        4 => Some(choices.below(60) as u16),
        _ => Some(choices.bits(16) as u16),
    };
    Budget {
        range_m: part(),
        time_s: part(),
    }
}

/// Draws an order to drive.
pub(super) fn order(choices: &mut impl Choices) -> Ask {
    match choices.below(5) {
        0 => Ask::Home,
        1 | 2 => Ask::GoTo {
            x: wide_within(choices, -NEAR, NEAR),
            y: wide_within(choices, -NEAR, NEAR),
        },
        3 => Ask::GoTo {
            x: wide(choices),
            y: wide(choices),
        },
        _ => Ask::Explore,
    }
}
