//! Conversions of corrections, and of the cells of a tile.
//!
//! Units: map cells.

use fieldline_planner::{
    CorrectedTile, Correction, CorrectionError, CorrectionProgress, Point, Recall, RecalledPoint,
};
use fieldline_protocol::message as wire;

use super::{float, quantity};

/// Returns the low and the high plane of a tile from its runs; `None` if they do not have the cells
/// of a tile.
#[inline(never)]
pub(super) fn planes(bytes: &[u8]) -> Option<[[u32; 32]; 2]> {
    let mut planes = [[0; 32]; 2];
    let mut at = 0;
    for (class, cells) in wire::TeamTile::unpack_cells(bytes)? {
        let end = at + cells;
        while at < end {
            let (row, column) = (at / 32, at % 32);
            let here = (end - at).min(32 - column);
            let bits = u32::MAX >> (32 - here) << column;
            for (number, plane) in planes.iter_mut().enumerate() {
                if let Some(word) = plane.get_mut(row).filter(|_| class >> number & 1 != 0) {
                    *word |= bits;
                }
            }
            at += here;
        }
    }
    Some(planes)
}

/// Converts a correction from the wire.
#[must_use]
pub fn correction(correct: &wire::Correct) -> Correction {
    let wire::Motion { x, y, yaw } = correct.motion;
    Correction {
        epoch: correct.epoch,
        x_m: float(x),
        y_m: float(y),
        yaw_rad: float(yaw),
        tiles: correct.tiles,
    }
}

/// Converts a tile of a correction from the wire. `bytes` are its cells, and its trail if it has
/// one. `None` if they are not those of a tile.
#[must_use]
pub fn corrected_tile(tile: &wire::CorrectedTile, bytes: &[u8]) -> Option<CorrectedTile> {
    let (bytes, told) = bytes.split_at_checked(tile.bytes.into())?;
    let mut trail = [0; 16];
    let (told, _) = told.as_chunks::<2>();
    for (row, &bytes) in trail.iter_mut().zip(told) {
        *row = u16::from_le_bytes(bytes);
    }
    Some(CorrectedTile {
        tile: (tile.x, tile.y),
        shift: tile.shift,
        planes: if bytes.is_empty() {
            [[0; 32]; 2]
        } else {
            planes(bytes)?
        },
        trail,
    })
}

/// Returns the number of bytes that a tile of a correction has: cells and trail.
#[must_use]
pub fn corrected_bytes(tile: &wire::CorrectedTile) -> usize {
    let trail = if tile.trail { wire::TRAIL_BYTES } else { 0 };
    usize::from(tile.bytes) + trail
}

/// Converts a recall from the wire.
#[must_use]
#[inline(never)]
pub fn recall(recall: &wire::Recall) -> Recall {
    let (x, y) = recall.origin;
    let point = |point: &wire::RecalledPoint| RecalledPoint {
        x_mm: point.x_mm,
        y_mm: point.y_mm,
        returns: point.returns,
    };
    Recall {
        epoch: recall.epoch,
        from: Point {
            x_m: float(x),
            y_m: float(y),
        },
        points: recall.points.iter().map(point).collect(),
        track_end: recall
            .track_end
            .map(|end| [end.x, end.y, end.yaw].map(float)),
        track: recall.track.clone(),
    }
}

/// Converts a recall for the wire.
#[must_use]
pub fn wire_recall(recall: &Recall) -> wire::Recall {
    let point = |point: &RecalledPoint| wire::RecalledPoint {
        x_mm: point.x_mm,
        y_mm: point.y_mm,
        returns: point.returns,
    };
    wire::Recall {
        epoch: recall.epoch,
        origin: (quantity(recall.from.x_m), quantity(recall.from.y_m)),
        points: recall.points.iter().map(point).collect(),
        track_end: recall.track_end.map(|[x, y, yaw]| wire::Motion {
            x: quantity(x),
            y: quantity(y),
            yaw: quantity(yaw),
        }),
        track: recall.track.clone(),
    }
}

/// Converts the progress of a correction for the wire.
#[must_use]
pub const fn wire_progress(progress: CorrectionProgress) -> wire::CorrectionProgress {
    wire::CorrectionProgress {
        epoch: progress.epoch,
        next: progress.next,
        closed: progress.closed,
    }
}

/// Converts the reason of a refusal for the wire.
#[must_use]
pub const fn wire_refusal(error: CorrectionError) -> wire::Refusal {
    match error {
        CorrectionError::Unusable => wire::Refusal::BadCorrection,
        CorrectionError::NotOpen => wire::Refusal::NoCorrection,
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::TeamTile;

    use super::planes;

    #[test]
    fn runs_become_planes_cell_by_cell() {
        for change in [1, 3, 31, 33, 70, 1024] {
            let class = |k: u32| (k / change * 7 % 4) as u8;
            let bytes = TeamTile::pack((0..1024).map(class));
            let [low, high] = planes(&bytes).expect("whole");
            for k in 0..1024 {
                let (row, column) = ((k / 32) as usize, k % 32);
                let read = low[row] >> column & 1 | (high[row] >> column & 1) << 1;
                assert_eq!(read as u8, class(k), "{change} {k}");
            }
        }
        assert_eq!(planes(&[0xfc; 15]), None);
        assert_eq!(planes(&[]), None);
    }
}
