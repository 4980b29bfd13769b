//! The records of a run as bytes: what the page draws.
//!
//! ```text
//! record    kind u8, length u32, payload of that length; all numbers little endian
//!
//! RUN       JSON: world, strategy, link, hull, laser, what is shown
//! STEP      time ms u32; believed x, y, yaw f32; true x, y, yaw f32; speed, turn rate f32;
//!           known share, path m f32; round trip µs, instructions u32;
//!           quality u8 (0 odometry, 1 tracking, 2 degenerate, 3 lost, 4 stands); flags u8;
//!           loops closed, given up u16; covariance xx, xy, yy in m² f32
//! STATUS    the planner's status in words, when it changes
//! ROWS      tile x, y i16; mask u32 of the rows that changed; for each of them 8 bytes, 2 bits a
//!           cell: 0 unknown, 1 free, 2 obstacle, 3 negative obstacle
//! SKELETON  tile x, y i16; 16 rows u16, one bit a roadmap cell
//! SCAN      ranges of the level laser u16, mm
//! PATH      flags u8 (1 tractor point, 2 shield); those places i16; number of path cells u16;
//!           cells i16; local goals f32
//! NOTE      JSON: what a viewer asked for, and the answer
//! END       JSON: the end of the run, its reason and the report's lines
//! DOING     JSON: what the robot does and what happened, when it changes, as in `mission.log`
//! ```
//!
//! Invariant: a tile or a skeleton is the sum of its records so far, so a record may be left out
//! only with all before it, for a key frame (`log.rs`).
//!
//! Units: metres and radians in the device's map; places in map cells of 10 cm.

use serde::Serialize;

use crate::link::inside::Key;
use crate::trial::Step;
use crate::trial::planned_path::PlannedPath;
use fieldline_protocol::message::Quality;

/// Bytes of a record before its payload.
pub(super) const HEAD: usize = 5;
/// Bytes of a row of a tile.
pub(super) const ROW_BYTES: usize = 8;

/// Kind of a record.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Kind {
    /// The run's settings.
    Run = 1,
    /// A step.
    Step = 2,
    /// The planner's status.
    Status = 3,
    /// Rows of a tile.
    Rows = 4,
    /// The skeleton of a tile.
    Skeleton = 5,
    /// A scan.
    Scan = 6,
    /// Path, local goal, tractor point, shield.
    Path = 7,
    /// A viewer's request and its answer.
    Note = 8,
    /// The end.
    End = 9,
    /// What the robot does, and why.
    Doing = 10,
}

/// Appends a record.
pub(super) fn record(out: &mut Vec<u8>, kind: Kind, payload: &[u8]) {
    out.push(kind as u8);
    out.extend((payload.len() as u32).to_le_bytes());
    out.extend(payload);
}

/// Appends a record of JSON. Everything that is sent here can be written.
pub(super) fn json(out: &mut Vec<u8>, kind: Kind, value: &impl Serialize) {
    record(out, kind, &serde_json::to_vec(value).unwrap_or_default());
}

/// Appends a step, with the share of the world that is known and the metres driven. A session that
/// `localises` and says no pose stands.
pub(super) fn step(out: &mut Vec<u8>, step: &Step, localises: bool, known: f64, path_m: f64) {
    let command = &step.command;
    let mut payload = Vec::with_capacity(72);
    payload.extend(step.truth.time_ms.to_le_bytes());
    for pose in [&step.estimate, &step.truth] {
        floats(&mut payload, &[pose.x_m, pose.y_m, pose.yaw_rad]);
    }
    let velocity = command.velocity;
    floats(
        &mut payload,
        &[
            velocity.linear.to_num(),
            velocity.angular.to_num(),
            known,
            path_m,
        ],
    );
    payload.extend((step.round_trip_us as u32).to_le_bytes());
    payload.extend(command.cost.instructions.to_le_bytes());
    payload.push(match command.location.map(|at| at.quality) {
        None if !localises => 0,
        Some(Quality::Tracking) => 1,
        Some(Quality::Degenerate { .. }) => 2,
        Some(Quality::Lost) => 3,
        None => 4,
    });
    let loops = command.loops;
    let flags = [loops.closing, command.cost.budget_exhausted];
    payload.push((0..).zip(flags).map(|(bit, is)| u8::from(is) << bit).sum());
    payload.extend(loops.closed.to_le_bytes());
    payload.extend(loops.given_up.to_le_bytes());
    let covariance = command.location.unwrap_or_default().covariance;
    let [xx, xy, yy, ..] = covariance.map(|it| it.to_num::<f64>() * 1e-4);
    floats(&mut payload, &[xx, xy, yy]);
    record(out, Kind::Step, &payload);
}

/// Appends those rows of a tile in which it differs from what was told before.
pub(super) fn rows(out: &mut Vec<u8>, (x, y): Key, before: &[u8; 256], now: &[u8; 256]) {
    let pairs = before
        .chunks_exact(ROW_BYTES)
        .zip(now.chunks_exact(ROW_BYTES));
    let changed = (0u32..)
        .zip(pairs)
        .filter(|(_, (before, now))| before != now);
    let mut mask = 0;
    let mut cells: Vec<u8> = Vec::new();
    for (row, (_, now)) in changed {
        mask |= 1 << row;
        cells.extend(now);
    }
    if mask == 0 {
        return;
    }
    let mut payload = Vec::with_capacity(8 + cells.len());
    payload.extend(x.to_le_bytes());
    payload.extend(y.to_le_bytes());
    payload.extend(u32::to_le_bytes(mask));
    payload.extend(cells);
    record(out, Kind::Rows, &payload);
}

/// Returns the key of a record of rows or of a skeleton, and what follows it.
pub(super) fn key(payload: &[u8]) -> Option<(Key, &[u8])> {
    let (head, rest) = payload.split_at_checked(4)?;
    let [a, b, c, d] = *head else {
        return None;
    };
    Some((
        (i16::from_le_bytes([a, b]), i16::from_le_bytes([c, d])),
        rest,
    ))
}

/// Enters the rows of a record, without its key, in a tile.
pub(super) fn enter_rows(rest: &[u8], tile: &mut [u8; 256]) {
    let Some((mask, cells)) = rest.split_at_checked(4) else {
        return;
    };
    let mask = mask
        .iter()
        .rev()
        .fold(0u32, |sum, byte| sum << 8 | u32::from(*byte));
    let changed = tile.chunks_exact_mut(ROW_BYTES).enumerate();
    let changed = changed.filter(|(row, _)| mask >> row & 1 == 1);
    for ((_, into), from) in changed.zip(cells.chunks_exact(ROW_BYTES)) {
        into.copy_from_slice(from);
    }
}

/// Appends the skeleton of a tile.
pub(super) fn skeleton(out: &mut Vec<u8>, (x, y): Key, rows: &[u16; 16]) {
    let mut payload = Vec::with_capacity(36);
    payload.extend(x.to_le_bytes());
    payload.extend(y.to_le_bytes());
    payload.extend(rows.iter().flat_map(|row| row.to_le_bytes()));
    record(out, Kind::Skeleton, &payload);
}

/// Appends a scan.
pub(super) fn scan(out: &mut Vec<u8>, ranges_mm: &[u16]) {
    let payload: Vec<u8> = ranges_mm.iter().flat_map(|mm| mm.to_le_bytes()).collect();
    record(out, Kind::Scan, &payload);
}

/// Appends path, tractor point, shield and local goal.
pub(super) fn path(out: &mut Vec<u8>, path: &PlannedPath, goals: &[[f64; 2]]) {
    let shield = path.shield.iter().flatten();
    let marks = path.tractor.iter().chain(shield);
    let mut payload = Vec::with_capacity(16 + 4 * path.cells.len() + 8 * goals.len());
    payload.push(u8::from(path.tractor.is_some()) | u8::from(path.shield.is_some()) << 1);
    payload.extend(marks.flat_map(|&(x, y)| place(x, y)));
    payload.extend((path.cells.len() as u16).to_le_bytes());
    payload.extend(path.cells.iter().flat_map(|&(x, y)| place(x, y)));
    for goal in goals {
        floats(&mut payload, goal);
    }
    record(out, Kind::Path, &payload);
}

fn place(x: i16, y: i16) -> [u8; 4] {
    let ([a, b], [c, d]) = (x.to_le_bytes(), y.to_le_bytes());
    [a, b, c, d]
}

fn floats(out: &mut Vec<u8>, values: &[f64]) {
    out.extend(
        values
            .iter()
            .flat_map(|value| (*value as f32).to_le_bytes()),
    );
}

/// Splits the first record off; `None` if there is no whole one.
pub(super) fn split(bytes: &[u8]) -> Option<(u8, &[u8], &[u8])> {
    let (head, rest) = bytes.split_at_checked(HEAD)?;
    let [kind, a, b, c, d] = *head else {
        return None;
    };
    let length = usize::try_from(u32::from_le_bytes([a, b, c, d])).ok()?;
    let (payload, rest) = rest.split_at_checked(length)?;
    Some((kind, payload, rest))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_changed_rows_are_told() {
        let (before, mut now) = ([0; 256], [0; 256]);
        let mut out = Vec::new();
        rows(&mut out, (1, -2), &before, &now);
        assert!(out.is_empty());
        now[8] = 0b01;
        now[255] = 0b10;
        rows(&mut out, (1, -2), &before, &now);
        let (kind, payload, rest) = split(&out).expect("a record");
        assert_eq!((kind, rest.len()), (Kind::Rows as u8, 0));
        assert_eq!(payload.len(), 8 + 2 * ROW_BYTES);
        assert_eq!(payload[..4], [1, 0, 0xfe, 0xff]);
        assert_eq!(payload[4..8], (1u32 << 1 | 1 << 31).to_le_bytes());
        let (told, rest) = key(payload).expect("a key");
        let mut tile = before;
        enter_rows(rest, &mut tile);
        assert_eq!((told, tile), ((1, -2), now));
    }

    #[test]
    fn a_record_that_is_cut_is_none() {
        let mut out = Vec::new();
        scan(&mut out, &[1_000, 2_000]);
        assert!((0..out.len()).all(|length| split(&out[..length]).is_none()));
        let (kind, payload, rest) = split(&out).expect("a record");
        assert_eq!((kind, payload.len(), rest.len()), (Kind::Scan as u8, 4, 0));
    }

    #[test]
    fn a_path_has_its_marks_before_its_cells() {
        let told = PlannedPath {
            tractor: Some((4, 6)),
            shield: None,
            cells: vec![(2, 2), (4, 4)],
        };
        let mut out = Vec::new();
        path(&mut out, &told, &[[1.0, 2.0]]);
        let (_, payload, _) = split(&out).expect("a record");
        assert_eq!(payload.len(), 1 + 4 + 2 + 8 + 8);
        assert_eq!(payload[..7], [1, 4, 0, 6, 0, 2, 0]);
    }
}
