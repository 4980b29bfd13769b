//! What the device said of loops: closed, given up, and the time that went into those that were not closed.
//!
//! It is the device's word, `loops_closed` beside it is judged on the true world. A *closing* lasts from the step that first says
//! `closing` to the first one that says it no more; it was in vain if no loop was closed by it. A loop that is lost and begun again
//! has two closings. One that lasts to the end of the run was in vain.

use serde::{Deserialize, Serialize};

/// What the device said of loops.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Closures {
    /// Tractor points reached by the way ahead.
    pub closed: u32,
    /// Loops given up: they do not exist, or are too long.
    pub given_up: Vec<GivenUp>,
    /// Time with a shield behind the robot.
    pub closing_s: f64,
    /// The part of it by which no loop was closed.
    pub in_vain_s: f64,
}

/// A loop that was given up.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct GivenUp {
    /// When.
    pub time_s: f64,
    /// Where the robot was, odometry frame.
    pub x_m: f64,
    /// Where the robot was.
    pub y_m: f64,
}

/// What one step says.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Word {
    /// Simulated seconds.
    pub time_s: f64,
    /// Where the robot was, metres.
    pub at_m: [f64; 2],
    /// A loop is being closed.
    pub closing: bool,
    /// Loops closed so far.
    pub closed: u16,
    /// Loops given up so far.
    pub given_up: u16,
}

impl Closures {
    /// Of all steps of a run, in order.
    #[must_use]
    pub fn of(words: impl Iterator<Item = Word>) -> Self {
        let mut out = Self::default();
        let mut last = Word::default();
        let mut began: Option<Word> = None;
        for word in words {
            out.closed = word.closed.into();
            for _ in last.given_up..word.given_up {
                let [x_m, y_m] = word.at_m;
                let time_s = word.time_s;
                out.given_up.push(GivenUp { time_s, x_m, y_m });
            }
            began = match began {
                None => word.closing.then_some(word),
                Some(began) if word.closing && word.closed == began.closed => Some(began),
                Some(began) => {
                    out.end(began, word);
                    word.closing.then_some(word)
                }
            };
            last = word;
        }
        if let Some(began) = began {
            out.end(began, last);
        }
        out
    }

    /// A closing is over.
    fn end(&mut self, began: Word, word: Word) {
        let took_s = word.time_s - began.time_s;
        self.closing_s += took_s;
        if word.closed == began.closed {
            self.in_vain_s += took_s;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Closures, GivenUp, Word};

    /// One step a second: whether it closes a loop, how many were closed and how many given up by then.
    fn told(words: &[(bool, u16, u16)]) -> Closures {
        let word = |(second, &(closing, closed, given_up))| Word {
            time_s: f64::from(second),
            at_m: [f64::from(second), -1.0],
            closing,
            closed,
            given_up,
        };
        Closures::of((0_u32..).zip(words).map(word))
    }

    #[test]
    fn only_closings_without_a_closed_loop_are_in_vain() {
        let (no, yes) = (false, true);
        let closed = [(no, 0, 0), (yes, 0, 0), (yes, 0, 0), (no, 1, 0), (no, 1, 0)];
        let out = told(&closed);
        assert_eq!((out.closed, out.closing_s, out.in_vain_s), (1, 2.0, 0.0));
        let given_up = [
            (no, 0, 0),
            (yes, 0, 0),
            (yes, 0, 0),
            (yes, 0, 0),
            (no, 0, 1),
        ];
        let out = told(&given_up);
        assert_eq!((out.closed, out.closing_s, out.in_vain_s), (0, 3.0, 3.0));
        let place = GivenUp {
            time_s: 4.0,
            x_m: 4.0,
            y_m: -1.0,
        };
        assert_eq!(out.given_up, [place]);
    }

    #[test]
    fn the_next_loop_may_begin_where_one_was_closed() {
        let words = [(true, 0, 0), (true, 0, 0), (true, 1, 0), (true, 1, 0)];
        let out = told(&words);
        assert_eq!((out.closed, out.closing_s, out.in_vain_s), (1, 3.0, 1.0));
        assert_eq!(told(&[]), Closures::default());
    }
}
