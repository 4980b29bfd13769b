//! A drive by order: where to, how it is told to the device, what became of it.
//!
//! Units: metres and radians in the device's map; milliseconds; in reports degrees.

use fieldline_protocol::message::{Control, Errand, Status};
use fixed::types::I16F16;

use crate::link::{Link, LinkError};
use crate::report;
use crate::report::tum::Stamped;
use crate::trial::wording;

/// A place to drive to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Leg {
    Goal([f64; 2]),
    Home,
}

/// A drive by order, as far as it went.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Trip {
    pub(super) leg: Leg,
    /// Status at its end; `None` while it lasts.
    pub(super) end: Option<Status>,
    /// The device's reason if it refused the order.
    pub(super) refused: Option<String>,
    /// It was a viewer's request, or one cut it short: no part of the orders' success.
    pub(super) is_aside: bool,
    pub(super) begun_ms: u32,
    /// `None` while it lasts.
    pub(super) ended_ms: Option<u32>,
    /// Where the robot thought it was at the end, and where it was.
    pub(super) estimate: Stamped,
    pub(super) truth: Stamped,
}

/// Orders a drive. Returns the device's reason if it refuses.
pub(super) fn tell(leg: Leg, link: &mut dyn Link) -> Result<Option<String>, LinkError> {
    match link.control(&leg.control()) {
        Ok(_) => Ok(None),
        Err(LinkError::Refused(reason)) => Ok(Some(reason)),
        Err(error) => Err(error),
    }
}

impl Leg {
    fn control(self) -> Control {
        match self {
            Self::Home => Control::Home,
            Self::Goal(at) => {
                let [x, y] = at.map(I16F16::saturating_from_num);
                Control::GoTo { x, y }
            }
        }
    }

    pub(super) const fn errand(self) -> Errand {
        match self {
            Self::Home => Errand::Home,
            Self::Goal(_) => Errand::Goal,
        }
    }
}

impl Trip {
    pub(super) const fn has_arrived(&self) -> bool {
        matches!(self.end, Some(Status::Arrived(_)))
    }

    /// Returns the trip for the report. `home` is where the session began.
    pub(super) fn report(&self, home: &Stamped) -> report::Trip {
        let to_m = match self.leg {
            Leg::Home => [home.x_m, home.y_m],
            Leg::Goal(at) => at,
        };
        let off_m = |at: &Stamped| (at.x_m - to_m[0]).hypot(at.y_m - to_m[1]);
        let turn = self.estimate.yaw_rad - home.yaw_rad;
        let off_deg = turn.sin().atan2(turn.cos()).abs().to_degrees();
        report::Trip {
            to: wording::errand(self.leg.errand()).into(),
            to_m,
            reached: self.has_arrived(),
            refused: self.refused.clone(),
            error_m: off_m(&self.estimate),
            error_deg: matches!(self.leg, Leg::Home).then_some(off_deg),
            true_error_m: off_m(&self.truth),
            stands_m: [self.estimate.x_m, self.estimate.y_m],
            time_s: f64::from(self.ended_ms.unwrap_or(self.begun_ms) - self.begun_ms) / 1000.0,
        }
    }
}
