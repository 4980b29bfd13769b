//! Share of the path that was driven twice.
//!
//! `overlap` is the share of the path's length within 0.5 m of a point that the robot passed at
//! least 3 m of path earlier. 0 is a path that never comes back; 1 would be a path on its own
//! tracks from the first metre. The path is sampled every 5 cm. The samples are stored in buckets
//! of 0.5 m, so a test needs only nine of them.

use std::collections::BTreeMap;

use crate::robot::distance_m;

/// Greatest distance from an earlier point that counts as driven again, metres.
pub const NEAR_M: f64 = 0.5;
/// Least distance along the path to an earlier point, metres.
pub const EARLIER_M: f64 = 3.0;
/// Length of path between two samples, metres.
const SAMPLE_M: f64 = 0.05;

/// The path so far.
#[derive(Clone, Debug, Default)]
pub struct Overlap {
    /// (x, y, metres of path) by bucket.
    buckets: BTreeMap<[i32; 2], Vec<[f64; 3]>>,
    last: Option<[f64; 2]>,
    length_m: f64,
    again_m: f64,
    pending_m: f64,
}

impl Overlap {
    /// Adds the robot's position, metres.
    pub fn add(&mut self, x_m: f64, y_m: f64) {
        let last = *self.last.get_or_insert([x_m, y_m]);
        self.pending_m += distance_m(last, [x_m, y_m]);
        self.last = Some([x_m, y_m]);
        if self.pending_m < SAMPLE_M {
            return;
        }
        self.length_m += self.pending_m;
        if self.was_near(x_m, y_m) {
            self.again_m += self.pending_m;
        }
        self.pending_m = 0.0;
        self.buckets
            .entry(bucket(x_m, y_m))
            .or_default()
            .push([x_m, y_m, self.length_m]);
    }

    /// Share of the path that was driven again, 0 to 1; 0 before the first sample.
    #[must_use]
    pub fn fraction(&self) -> f64 {
        if self.length_m > 0.0 {
            self.again_m / self.length_m
        } else {
            0.0
        }
    }

    fn was_near(&self, x_m: f64, y_m: f64) -> bool {
        let [column, row] = bucket(x_m, y_m);
        (row - 1..=row + 1)
            .flat_map(|row| (column - 1..=column + 1).map(move |column| [column, row]))
            .filter_map(|bucket| self.buckets.get(&bucket))
            .flatten()
            .any(|[x, y, at_m]| {
                let (dx, dy) = (x_m - x, y_m - y);
                self.length_m - at_m >= EARLIER_M && dx * dx + dy * dy <= NEAR_M * NEAR_M
            })
    }
}

fn bucket(x_m: f64, y_m: f64) -> [i32; 2] {
    [x_m, y_m].map(|m| (m / NEAR_M).floor() as i32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn drive(points: &[[f64; 2]]) -> f64 {
        let mut overlap = Overlap::default();
        for pair in points.windows(2) {
            let ([x0, y0], [x1, y1]) = (pair[0], pair[1]);
            let steps = ((x1 - x0).hypot(y1 - y0) / 0.01).ceil();
            for step in 0..=steps as u32 {
                let t = f64::from(step) / steps;
                overlap.add(x0 + t * (x1 - x0), y0 + t * (y1 - y0));
            }
        }
        overlap.fraction()
    }

    #[test]
    fn a_straight_path_has_none_and_the_way_back_counts() {
        assert_eq!(drive(&[[0.0, 0.0], [20.0, 0.0]]), 0.0);
        // 20 m and back: the first 1.25 m back are near points less than 3 m of path earlier
        // (2 s − 0.5 < 3, ± one sample), the rest is driven again.
        let back = drive(&[[0.0, 0.0], [20.0, 0.0], [0.0, 0.0]]);
        assert!((back - 18.75 / 40.0).abs() < 0.003, "{back}");
        // Parallel tracks 0.6 m apart never meet.
        let lanes = drive(&[[0.0, 0.0], [9.0, 0.0], [9.0, 0.6], [0.0, 0.6]]);
        assert_eq!(lanes, 0.0);
    }
}
