//! The judge of a motion: which of its witnesses is wrong.
//!
//! Command, odometry and scan are three witnesses of a motion. Where two agree, the third is wrong,
//! and the remedy is that of the device's own check. Units: metres, radians.

use fieldline_protocol::message::Mistake;

use crate::trial::wiring_advice::wiring_advice;

/// The quarter turn, radians, and the way, metres.
pub(super) const QUARTER_RAD: f64 = core::f64::consts::FRAC_PI_2;
pub(super) const WAY_M: f64 = 0.5;
/// Witnesses agree if one tells between this and its inverse of the other.
const AGREES: f64 = 0.67;

/// Returns true if a witness tells the same as another.
fn agrees(one: f64, other: f64) -> bool {
    let ratio = one / other;
    (AGREES..=1.0 / AGREES).contains(&ratio)
}

/// What to do where the scan tells nothing.
const UNDECIDED: &str = "the scan does not tell how the robot moved: put it in a room, with a \
                         corner in view, and begin again";

/// Judges a quarter turn to the left.
pub(super) fn judge_turn(odometry: f64, scan: Option<f64>) -> Option<String> {
    let nothing = 0.1 * QUARTER_RAD;
    let mistake = match scan {
        None => return Some(UNDECIDED.into()),
        Some(scan) if odometry.abs() < nothing && scan.abs() < nothing => {
            return Some(
                "the robot does not turn: are the motors powered, does it hear its commands?"
                    .into(),
            );
        }
        Some(scan) if odometry.abs() < nothing && scan.abs() >= nothing => Mistake::TurnTooSmall,
        Some(scan) if scan.abs() < nothing => Mistake::ScanStands,
        Some(scan) if odometry < 0.0 && scan > 0.0 => Mistake::YawReversed,
        Some(scan) if odometry > 0.0 && scan < 0.0 => Mistake::ScanMirrored,
        _ if odometry < 0.0 => Mistake::TurnsReversed,
        Some(scan) if odometry * AGREES > scan => Mistake::TurnTooGreat,
        Some(scan) if odometry < AGREES * scan => Mistake::TurnTooSmall,
        _ if agrees(odometry, QUARTER_RAD) => return None,
        _ => {
            return Some(format!(
                "the robot turns by {:.0} degrees and not by 90: correct the track of its drive",
                odometry.to_degrees()
            ));
        }
    };
    Some(wiring_advice(mistake).into())
}

/// Judges half a metre ahead.
pub(super) fn judge_way([ahead, left]: [f64; 2], scan: Option<[f64; 2]>) -> Option<String> {
    let (nothing, odometry) = (0.1 * WAY_M, ahead.hypot(left));
    let length = |[x, y]: [f64; 2]| x.hypot(y);
    let mistake = match scan {
        None => return Some(UNDECIDED.into()),
        Some(scan) if odometry < nothing && length(scan) < nothing => {
            return Some(
                "the robot does not drive: are the motors powered, does it hear its commands?"
                    .into(),
            );
        }
        Some(_) if odometry < nothing => Mistake::WayTooShort,
        _ if odometry > 4.0 * WAY_M => Mistake::WayTooLong,
        Some(scan) if length(scan) < nothing => Mistake::ScanStands,
        Some([x, y]) if y.abs() > x.abs() => {
            if (y > 0.0) == (ahead > 0.0) {
                Mistake::LaserTurnedRight
            } else {
                Mistake::LaserTurnedLeft
            }
        }
        Some([x, _]) if ahead < 0.0 && x > 0.0 => Mistake::WayReversed,
        Some([x, _]) if ahead > 0.0 && x < 0.0 => Mistake::LaserTurnedBack,
        _ if ahead < 0.0 => Mistake::DriveReversed,
        Some(scan) if odometry * AGREES > length(scan) => Mistake::WayTooLong,
        Some(scan) if odometry < AGREES * length(scan) => Mistake::WayTooShort,
        _ if agrees(odometry, WAY_M) => return None,
        _ => {
            return Some(format!(
                "the robot drives {odometry:.2} m and not 0.50 m: correct the scale of its drive"
            ));
        }
    };
    Some(wiring_advice(mistake).into())
}

#[cfg(test)]
mod tests {
    use super::{QUARTER_RAD, WAY_M, judge_turn, judge_way};

    fn word(remedy: Option<String>, word: &str) -> bool {
        remedy.is_some_and(|text| text.contains(word))
    }

    #[test]
    fn two_witnesses_of_a_turn_name_the_third() {
        let quarter = QUARTER_RAD;
        assert_eq!(judge_turn(quarter, Some(0.95 * quarter)), None);
        assert!(word(judge_turn(quarter, None), "corner"));
        assert!(word(judge_turn(quarter, Some(-quarter)), "mirrored"));
        assert!(word(judge_turn(-quarter, Some(quarter)), "change its sign"));
        assert!(word(judge_turn(-quarter, Some(-quarter)), "swapped"));
        assert!(word(judge_turn(0.0, Some(0.0)), "powered"));
        assert!(word(judge_turn(0.0, Some(quarter)), "smaller turn"));
        assert!(word(judge_turn(quarter, Some(0.0)), "repeat"));
        assert!(word(
            judge_turn(2.0 * quarter, Some(quarter)),
            "greater turn"
        ));
        assert!(word(
            judge_turn(0.5 * quarter, Some(0.5 * quarter)),
            "track"
        ));
    }

    #[test]
    fn two_witnesses_of_a_way_name_the_third() {
        let way = [WAY_M, 0.0];
        assert_eq!(judge_way(way, Some([0.45, 0.05])), None);
        assert!(word(judge_way(way, None), "corner"));
        assert!(word(judge_way(way, Some([0.0, 0.5])), "right"));
        assert!(word(judge_way(way, Some([0.0, -0.5])), "to the left"));
        assert!(word(judge_way(way, Some([-0.5, 0.0])), "backwards"));
        assert!(word(
            judge_way([-0.5, 0.0], Some([0.5, 0.0])),
            "sign of its distance"
        ));
        assert!(word(
            judge_way([-0.5, 0.0], Some([-0.5, 0.0])),
            "motors reversed"
        ));
        assert!(word(judge_way([500.0, 0.0], Some(way)), "millimetres"));
        assert!(word(judge_way([0.0, 0.0], Some([0.5, 0.0])), "shorter way"));
        assert!(word(judge_way(way, Some([0.0, 0.0])), "repeat"));
    }
}
