//! From the scans of a file to the scans of one laser, in the order of time.
//!
//! | of the scans | are kept |
//! | --- | --- |
//! | lasers | those of the laser that most of them are of |
//! | number of beams | the usual one, and up to 2 or a fiftieth more or less |
//! | readings | those with any information |
//! | times | the longest run that never goes back, and what is within [`MOST_BACK_S`] of it |
//!
//! Invariant: the scans that are kept have the same angles, and times never decrease.
//! Units: seconds.

use std::collections::BTreeMap;

use super::left_out::{Lines, Why};
use super::{Form, Log, LogScan};

/// Most by which a time may be before one that was read and still be sorted in, seconds. Drivers
/// that write in threads of their own are late by fractions of a second.
const MOST_BACK_S: f64 = 1.0;

/// Beams that a scan may have more or less than usual.
const FEW_BEAMS: usize = 2;
/// Share of the usual beams that a scan may have more or less: turning lidars keep their speed to
/// about a percent.
const FEW_OF: usize = 50;

/// Puts the scans into order, in a log that has what was left out before.
pub(super) fn tidied(found: Vec<(Form, LogScan)>, log: Log) -> Log {
    let mut log = Log {
        scans: Vec::new(),
        ..log
    };
    let scans = of_one_laser(found, &mut log);
    let scans = of_usual_beams(scans, &mut log);
    let (full, empty): (Vec<_>, Vec<_>) = scans.into_iter().partition(has_information);
    for scan in empty {
        log.left_out.count(Why::Empty, scan.line);
    }
    in_order(full, &mut log);
    log
}

/// Returns true if a reading of the scan is a range or says that there is nothing.
fn has_information(scan: &LogScan) -> bool {
    scan.ranges.iter().any(|&range_m| range_m > 0.0)
}

/// What tells one laser from another: the form, and the angles and the range that a line tells.
fn identity((form, scan): &(Form, LogScan)) -> (Form, [u64; 3]) {
    let told = match form {
        Form::Flaser | Form::Rlaser => [0.0; 3],
        Form::Robotlaser => [scan.beams.first_rad, scan.beams.step_rad, scan.beams.most_m],
    };
    (*form, told.map(f64::to_bits))
}

/// Returns the scans of the laser that most scans are of; of two the one that begins first.
fn of_one_laser(found: Vec<(Form, LogScan)>, log: &mut Log) -> Vec<LogScan> {
    let Some(most) = usual(found.iter().map(identity)) else {
        return Vec::new();
    };
    log.form = most.0;
    let (own, others): (Vec<_>, Vec<_>) = found.into_iter().partition(|it| identity(it) == most);
    for (_, scan) in others {
        log.left_out.count(Why::OtherLaser, scan.line);
    }
    own.into_iter().map(|(_, scan)| scan).collect()
}

/// Returns the scans that have about as many beams as most, with the angles of those.
fn of_usual_beams(scans: Vec<LogScan>, log: &mut Log) -> Vec<LogScan> {
    let Some(count) = usual_beams(&scans) else {
        return scans;
    };
    let beams = scans.iter().find(|scan| scan.ranges.len() == count);
    let beams = beams.map(|scan| scan.beams);
    let mut kept = Vec::with_capacity(scans.len());
    for mut scan in scans {
        if !is_near(scan.ranges.len(), count) {
            log.left_out.count(Why::Beams, scan.line);
            continue;
        }
        if scan.ranges.len() != count {
            Lines::count(&mut log.resampled, scan.line);
        }
        scan.beams = beams.unwrap_or(scan.beams);
        kept.push(scan);
    }
    kept
}

/// Returns true if a scan of this number of beams may be one of a laser that usually has `usual`.
#[must_use]
pub fn is_near(beams: usize, usual: usize) -> bool {
    beams.abs_diff(usual) <= FEW_BEAMS.max(usual / FEW_OF)
}

/// Returns the number of beams that most scans have; of two the one that comes first.
#[must_use]
pub fn usual_beams(scans: &[LogScan]) -> Option<usize> {
    usual(scans.iter().map(|scan| scan.ranges.len()))
}

/// Returns the value that comes most often; of two the one that comes first.
fn usual<T: Ord + Copy>(values: impl Iterator<Item = T>) -> Option<T> {
    let mut counts: BTreeMap<T, (usize, usize)> = BTreeMap::new();
    for (place, value) in values.enumerate() {
        counts.entry(value).or_insert((0, place)).0 += 1;
    }
    let most = counts
        .into_iter()
        .max_by_key(|(_, (count, first))| (*count, core::cmp::Reverse(*first)));
    most.map(|(value, _)| value)
}

/// Sorts scans by time; equal times keep their order. Leaves out what goes back by more.
fn in_order(scans: Vec<LogScan>, log: &mut Log) {
    let times: Vec<f64> = scans.iter().map(|scan| scan.time).collect();
    let fits = near_the_run(&times);
    let mut newest_s = f64::NEG_INFINITY;
    for (scan, fits) in scans.into_iter().zip(fits) {
        if !fits {
            log.left_out.count(Why::TimeBack, scan.line);
            continue;
        }
        if scan.time < newest_s {
            log.late += 1;
            log.late_s = log.late_s.max(newest_s - scan.time);
        }
        newest_s = newest_s.max(scan.time);
        log.scans.push(scan);
    }
    log.scans.sort_by(|a, b| a.time.total_cmp(&b.time));
}

/// Returns which times are in the longest run that never goes back, or within [`MOST_BACK_S`] of
/// their neighbours in it. So one time that is far ahead costs one line and not the rest.
fn near_the_run(times: &[f64]) -> Vec<bool> {
    let run = longest_run(times);
    let mut is_in = vec![false; times.len()];
    for &place in &run {
        is_in[place] = true;
    }
    let mut next = run.into_iter().peekable();
    let mut before_s = f64::NEG_INFINITY;
    for (place, &time) in times.iter().enumerate() {
        if next.next_if_eq(&place).is_some() {
            before_s = time;
            continue;
        }
        let after_s = next.peek().map_or(f64::INFINITY, |&place| times[place]);
        is_in[place] = (before_s - MOST_BACK_S..=after_s + MOST_BACK_S).contains(&time);
    }
    is_in
}

/// Returns the places of the longest sequence that never decreases, by patience sorting: `ends[k]`
/// is the place of the least last number of a sequence of k + 1 numbers [Fredman 1975].
fn longest_run(times: &[f64]) -> Vec<usize> {
    let mut ends: Vec<usize> = Vec::new();
    let mut before: Vec<Option<usize>> = Vec::with_capacity(times.len());
    for (place, &time) in times.iter().enumerate() {
        let length = ends.partition_point(|&end| times[end] <= time);
        before.push(length.checked_sub(1).map(|last| ends[last]));
        ends.truncate(ends.len().max(length));
        match ends.get_mut(length) {
            Some(end) => *end = place,
            None => ends.push(place),
        }
    }
    let mut run = Vec::with_capacity(ends.len());
    let mut at = ends.last().copied();
    while let Some(place) = at {
        run.push(place);
        at = before[place];
    }
    run.reverse();
    run
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_longest_run_leaves_out_what_is_out_of_order() {
        assert_eq!(
            longest_run(&[1.0, 2.0, 9.0, 3.0, 3.0, 0.0, 4.0]),
            [0, 1, 3, 4, 6]
        );
        assert_eq!(longest_run(&[]), [0; 0]);
    }

    #[test]
    fn a_time_far_ahead_costs_one_line_and_small_disorder_none() {
        let fits = near_the_run(&[1.0, 2.0, 900.0, 3.0, 2.5, 4.0, 0.5, 5.0]);
        assert_eq!(fits, [true, true, false, true, true, true, false, true]);
    }

    #[test]
    fn of_two_values_as_often_the_first_is_usual() {
        assert_eq!(usual([3, 1, 1, 3, 2].into_iter()), Some(3));
        assert_eq!(usual([0; 0].into_iter()), None);
    }
}
