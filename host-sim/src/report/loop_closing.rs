//! Loops that the device reported: closed, given up, and the time wasted on loops not closed.
//!
//! All of it is the device's own report. `loops` beside it is judged on the true path. A *closing*
//! begins with the first step that says `closing` and ends with the first that does not. Its time
//! is wasted if it closed no loop. A loop that is lost and begun again has two closings. A closing
//! that lasts to the end of the run is wasted.

use serde::{Deserialize, Serialize};

/// Loops that the device reported.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct LoopClosing {
    /// Tractor points reached by the way ahead.
    pub closed: u32,
    /// Loops given up, because they do not exist or are too long.
    pub given_up: Vec<GivenUp>,
    /// Time with a shield behind the robot, seconds.
    pub closing_s: f64,
    /// The part of `closing_s` that closed no loop.
    pub wasted_s: f64,
}

/// A loop that was given up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GivenUp {
    /// Simulated seconds.
    pub time_s: f64,
    /// Position of the robot, odometry frame.
    pub x_m: f64,
    /// Position of the robot.
    pub y_m: f64,
}

/// Report of one step on loops.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct LoopStatus {
    /// Simulated seconds.
    pub time_s: f64,
    /// Position of the robot, metres.
    pub at_m: [f64; 2],
    /// True while a loop is being closed.
    pub closing: bool,
    /// Loops closed so far.
    pub closed: u16,
    /// Loops given up so far.
    pub given_up: u16,
}

impl LoopClosing {
    /// Sums up all steps of a run, in order.
    #[must_use]
    pub fn of(steps: impl Iterator<Item = LoopStatus>) -> Self {
        let mut out = Self::default();
        let mut last = LoopStatus::default();
        let mut began: Option<LoopStatus> = None;
        for step in steps {
            out.closed = step.closed.into();
            for _ in last.given_up..step.given_up {
                let [x_m, y_m] = step.at_m;
                let time_s = step.time_s;
                out.given_up.push(GivenUp { time_s, x_m, y_m });
            }
            began = match began {
                None => step.closing.then_some(step),
                Some(began) if step.closing && step.closed == began.closed => Some(began),
                Some(began) => {
                    out.end(began, step);
                    step.closing.then_some(step)
                }
            };
            last = step;
        }
        if let Some(began) = began {
            out.end(began, last);
        }
        out
    }

    /// Adds a closing that is over.
    fn end(&mut self, began: LoopStatus, last: LoopStatus) {
        let took_s = last.time_s - began.time_s;
        self.closing_s += took_s;
        if last.closed == began.closed {
            self.wasted_s += took_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{GivenUp, LoopClosing, LoopStatus};

    /// Makes one step a second: closing or not, loops closed, loops given up.
    fn summed(steps: &[(bool, u16, u16)]) -> LoopClosing {
        let step = |(second, &(closing, closed, given_up))| LoopStatus {
            time_s: f64::from(second),
            at_m: [f64::from(second), -1.0],
            closing,
            closed,
            given_up,
        };
        LoopClosing::of((0_u32..).zip(steps).map(step))
    }

    #[test]
    fn only_closings_without_a_closed_loop_are_wasted() {
        let (no, yes) = (false, true);
        let closed = [(no, 0, 0), (yes, 0, 0), (yes, 0, 0), (no, 1, 0), (no, 1, 0)];
        let out = summed(&closed);
        assert_eq!((out.closed, out.closing_s, out.wasted_s), (1, 2.0, 0.0));
        let given_up = [
            (no, 0, 0),
            (yes, 0, 0),
            (yes, 0, 0),
            (yes, 0, 0),
            (no, 0, 1),
        ];
        let out = summed(&given_up);
        assert_eq!((out.closed, out.closing_s, out.wasted_s), (0, 3.0, 3.0));
        let place = GivenUp {
            time_s: 4.0,
            x_m: 4.0,
            y_m: -1.0,
        };
        assert_eq!(out.given_up, [place]);
    }

    #[test]
    fn the_next_loop_may_begin_where_one_was_closed() {
        let steps = [(true, 0, 0), (true, 0, 0), (true, 1, 0), (true, 1, 0)];
        let out = summed(&steps);
        assert_eq!((out.closed, out.closing_s, out.wasted_s), (1, 3.0, 1.0));
        assert_eq!(summed(&[]), LoopClosing::default());
    }
}
