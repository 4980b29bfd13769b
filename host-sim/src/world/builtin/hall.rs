//! Two halls: one mostly open, one empty and larger than the range of the lasers.

use super::super::canvas::Canvas;
use super::super::occupancy::{Class, Occupancy};

/// 24 × 24 m with four round pillars and a kiosk.
pub(super) fn plan() -> Occupancy {
    let mut plan = Canvas::new(24.4, 24.4, Class::Wall);
    plan.floor([0.2, 0.2, 24.2, 24.2]);
    for centre in [[6.5, 7.0], [17.5, 6.0], [7.5, 18.0], [18.0, 17.0]] {
        plan.disc(Class::Wall, centre, 0.35);
    }
    plan.block([11.6, 11.0, 12.6, 12.0]);
    plan.finish()
}

/// 30 × 30 m without any obstacle.
pub(super) fn empty() -> Occupancy {
    let mut plan = Canvas::new(30.4, 30.4, Class::Wall);
    plan.floor([0.2, 0.2, 30.2, 30.2]);
    plan.finish()
}
