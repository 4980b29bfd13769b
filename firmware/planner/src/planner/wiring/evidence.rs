//! What the scans say for and against each hypothesis of a motion, and how the robot obeys.
//!
//! ```text
//! gain(h) += Σ max(0, v(h) − v(1))      loss(h) += Σ max(0, v(1) − v(h))      v: `agreement`
//! told:    gain − loss ≥ DECIDED  and  gain ≥ CLEARLY loss
//! refuted: loss − gain ≥ DECIDED  and  loss ≥ CLEARLY gain
//! ```
//!
//! Units: metres, radians, beams.

use super::agreement::{Scans, Shift, Values, best};

/// Parts of a command that the robot may have driven: it takes time to speed up.
const PARTS: [f32; 3] = [0.5, 0.75, 1.0];
/// Least legs before anything is told.
const LEAST_LEGS: u8 = 2;
/// Beams that must speak for a hypothesis, more than against it.
const DECIDED: f32 = 15.0;
/// The beams that speak for a hypothesis are so many times those against it.
const CLEARLY: f32 = 4.0;
/// A robot obeys if it moves so many times farther with the command than against it.
const OBEYS: f32 = 3.0;

/// What the scan says of a turn, as a multiple of odometry's.
pub(super) const TURNS: [f32; 5] = [1.0, -1.0, 0.0, 0.5, 2.0];
/// What the scan says of a way, as a multiple of odometry's: ahead and to the left.
pub(super) const WAYS: [(f32, f32); 7] = [
    (1.0, 0.0),
    (0.0, 1.0),
    (-1.0, 0.0),
    (0.0, -1.0),
    (0.0, 0.0),
    (0.5, 0.0),
    (2.0, 0.0),
];

/// The beams for and against each hypothesis. The first one is the odometry.
#[derive(Debug)]
pub(super) struct Evidence<const N: usize> {
    gain: [f32; N],
    loss: [f32; N],
    /// Turn or way so far, radians or metres.
    pub(super) seen: f32,
    /// Legs so far.
    pub(super) legs: u8,
}

impl<const N: usize> Evidence<N> {
    pub(super) const fn new() -> Self {
        Self {
            gain: [0.0; N],
            loss: [0.0; N],
            seen: 0.0,
            legs: 0,
        }
    }

    /// Adds what a leg says of a hypothesis.
    fn add(&mut self, hypothesis: usize, odometry: &Values, other: &Values) {
        let (gain, loss) = other.against(odometry);
        if let Some(sum) = self.gain.get_mut(hypothesis) {
            *sum += gain;
        }
        if let Some(sum) = self.loss.get_mut(hypothesis) {
            *sum += loss;
        }
    }

    /// Adds what a leg says, of a turn or way of this size. `other` is the motion of a hypothesis;
    /// `None` if the leg says nothing of it. What is refuted costs nothing more.
    fn add_leg(
        &mut self,
        scans: Scans<'_>,
        motion: &Shift,
        size: f32,
        other: impl Fn(usize) -> Option<Shift>,
    ) {
        self.legs = self.legs.saturating_add(1);
        self.seen += size;
        if self.agrees(0.0) {
            return;
        }
        let odometry = best(scans, motion);
        for number in 1..N {
            if let Some(other) = other(number).filter(|_| !self.refutes(number)) {
                self.add(number, &odometry, &best(scans, &other));
            }
        }
    }

    /// Adds what a leg says on which odometry counted nothing: the robot may have moved as it was
    /// told, or a part of that. The last hypothesis is that odometry counts too little.
    fn add_unseen(&mut self, scans: Scans<'_>, odometry: &Shift, size: f32, told: &[Shift; 3]) {
        self.legs = self.legs.saturating_add(1);
        self.seen += size;
        self.add(N - 1, &best(scans, odometry), &best_of(scans, told));
    }

    /// Returns the hypothesis that is told.
    pub(super) fn told(&self, least: f32) -> Option<usize> {
        if self.legs < LEAST_LEGS || self.seen < least {
            return None;
        }
        let mut best = None;
        let mut most = 0.0;
        for (number, (gain, loss)) in self.gain.iter().zip(&self.loss).enumerate().skip(1) {
            let lead = gain - loss;
            if lead >= DECIDED && *gain >= CLEARLY * loss && lead > most {
                (best, most) = (Some(number), lead);
            }
        }
        best
    }

    /// Returns true if the scans refute a hypothesis.
    pub(super) fn refutes(&self, hypothesis: usize) -> bool {
        let pair = self.gain.get(hypothesis).zip(self.loss.get(hypothesis));
        pair.is_some_and(|(gain, loss)| loss - gain >= DECIDED && *loss >= CLEARLY * gain)
    }

    /// Returns true if the scans refute every hypothesis but the odometry.
    pub(super) fn agrees(&self, least: f32) -> bool {
        self.seen >= least && (1..N).all(|hypothesis| self.refutes(hypothesis))
    }

    /// Returns true if the scans refute a hypothesis, or still say nothing of it after twice the
    /// least way.
    pub(super) fn is_unlikely(&self, hypothesis: usize, least: f32) -> bool {
        self.refutes(hypothesis) || self.seen >= 2.0 * least
    }
}

impl Evidence<{ TURNS.len() }> {
    /// Adds what a leg says of the turn.
    #[inline(never)]
    pub(super) fn add_turn(&mut self, scans: Scans<'_>, motion: &Shift) {
        self.add_leg(scans, motion, motion.turn_rad.abs(), |number| {
            let times = *TURNS.get(number)?;
            Some(Shift {
                // Odometry that turns the wrong way also goes to the wrong side.
                y_m: if times < 0.0 { -motion.y_m } else { motion.y_m },
                turn_rad: times * motion.turn_rad,
                ..*motion
            })
        });
    }

    /// Adds what a leg says on which odometry counted nothing of a turn that was told.
    #[inline(never)]
    pub(super) fn add_unseen_turn(&mut self, scans: Scans<'_>, motion: &Shift, told_rad: f32) {
        let told = PARTS.map(|part| Shift {
            turn_rad: part * told_rad,
            ..*motion
        });
        self.add_unseen(scans, motion, told_rad.abs(), &told);
    }
}

impl Evidence<{ WAYS.len() }> {
    /// Adds what a leg says of the way.
    #[inline(never)]
    pub(super) fn add_way(&mut self, scans: Scans<'_>, motion: &Shift) {
        self.add_leg(scans, motion, motion.length_m(), |number| {
            let (ahead, left) = *WAYS.get(number)?;
            // In a curve the wheels count by centimetres too much or too little.
            let is_scale = left == 0.0 && ahead > 0.0;
            (!is_scale || motion.is_straight()).then_some(Shift {
                x_m: ahead * motion.x_m - left * motion.y_m,
                y_m: left * motion.x_m + ahead * motion.y_m,
                ..*motion
            })
        });
    }

    /// Adds what a leg says on which odometry counted nothing of a way that was told.
    #[inline(never)]
    pub(super) fn add_unseen_way(&mut self, scans: Scans<'_>, motion: &Shift, told_m: f32) {
        let told = PARTS.map(|part| Shift {
            x_m: part * told_m,
            y_m: 0.0,
            ..*motion
        });
        self.add_unseen(scans, motion, told_m.abs(), &told);
    }
}

/// Returns how well the beams agree under the best of some motions.
#[inline(never)]
fn best_of(scans: Scans<'_>, motions: &[Shift]) -> Values {
    let mut found = Values::default();
    for motion in motions {
        found = found.better(best(scans, motion));
    }
    found
}

/// Turn or way with and against the command.
#[derive(Debug)]
pub(super) struct Obedience {
    with: f32,
    against: f32,
}

impl Obedience {
    pub(super) const fn new() -> Self {
        Self {
            with: 0.0,
            against: 0.0,
        }
    }

    /// Adds the motion of a step whose command had held for two periods.
    pub(super) fn add(&mut self, [before, last]: [f32; 2], moved: f32) {
        if before * last <= 0.0 {
            return;
        }
        if last * moved > 0.0 {
            self.with += moved.abs();
        } else {
            self.against += moved.abs();
        }
    }

    /// Returns true if the robot moves with the command, false if against it; `None` before it
    /// moved so much.
    pub(super) fn verdict(&self, least: f32) -> Option<bool> {
        let sum = self.with + self.against;
        if sum < least {
            return None;
        }
        if self.with >= OBEYS * self.against {
            return Some(true);
        }
        (self.against >= OBEYS * self.with).then_some(false)
    }
}
