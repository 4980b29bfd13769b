//! The history of a run: every record so far, in memory of a bounded size.
//!
//! ```text
//! run thread ── push ──► │ chunk │ chunk │ chunk │ ◄── read(cursor) ── one thread for each viewer
//!                        └ oldest half: folded into a key frame when the bound is reached
//! ```
//!
//! The log is the queue of every viewer. A viewer keeps a cursor, so one that lags costs no memory
//! of its own, and the run never waits for it. A viewer whose place was folded begins anew.
//!
//! Invariants: a record lies in one chunk; chunk numbers only grow. Beside the log lies the newest
//! scan, which a viewer may miss.
//!
//! Units: bytes. A step takes about 80, a scan 370. An hour at 5 steps a second takes about 5 MB.

use std::collections::{BTreeMap, VecDeque};
use std::sync::Arc;

use super::frame::{self, Kind};
use crate::link::inside::Key;

/// Bytes of a chunk; also the most that a viewer is sent at once.
const CHUNK: usize = 256 * 1024;

/// A place in the log.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Cursor {
    run: u64,
    folds: u64,
    chunk: u64,
    byte: usize,
}

/// What a viewer is sent next.
#[derive(Debug, PartialEq, Eq)]
pub(super) struct Part {
    /// True if the viewer must forget what it has.
    pub(super) is_anew: bool,
    /// Whole records.
    pub(super) bytes: Vec<u8>,
}

/// The records of one run.
#[derive(Debug)]
pub(super) struct Log {
    run: u64,
    /// Number of the first chunk.
    first: u64,
    folds: u64,
    chunks: VecDeque<Vec<u8>>,
    bytes: usize,
    limit: usize,
    chunk: usize,
    newest: (u64, Arc<[u8]>),
}

impl Log {
    /// Makes an empty log of at most about `limit` bytes.
    pub(super) fn new(limit: usize) -> Self {
        Self {
            run: 0,
            first: 0,
            folds: 0,
            chunks: VecDeque::new(),
            bytes: 0,
            limit,
            chunk: CHUNK.min(limit / 8).max(1),
            newest: (0, Arc::default()),
        }
    }

    /// Begins another run: every viewer forgets the last one.
    pub(super) fn begin(&mut self) {
        self.run += 1;
        self.chunks.clear();
        self.bytes = 0;
        self.set_newest(&[]);
    }

    /// Appends whole records.
    pub(super) fn push(&mut self, mut records: &[u8]) {
        while let Some((_, payload, rest)) = frame::split(records) {
            let length = frame::HEAD + payload.len();
            let (record, _) = records.split_at(length);
            let is_full = |last: &Vec<u8>| last.len() + length > self.chunk;
            if self.chunks.back().is_none_or(is_full) {
                self.chunks
                    .push_back(Vec::with_capacity(self.chunk.max(length)));
            }
            if let Some(last) = self.chunks.back_mut() {
                last.extend_from_slice(record);
            }
            self.bytes += length;
            records = rest;
        }
        if self.bytes > self.limit {
            self.fold();
        }
    }

    /// Replaces the newest scan.
    pub(super) fn set_newest(&mut self, records: &[u8]) {
        self.newest = (self.newest.0 + 1, records.into());
    }

    /// Returns the newest scan, if it is another than the one of this number.
    pub(super) fn newest(&self, seen: &mut u64) -> Option<Arc<[u8]>> {
        let (number, records) = &self.newest;
        let is_new = core::mem::replace(seen, *number) != *number;
        (is_new && !records.is_empty()).then(|| Arc::clone(records))
    }

    /// Returns what follows a cursor, and moves it; `None` if nothing does.
    pub(super) fn read(&self, cursor: &mut Cursor) -> Option<Part> {
        let is_folded =
            cursor.chunk < self.first || (cursor.chunk == self.first && cursor.folds != self.folds);
        let is_anew = cursor.run != self.run || is_folded;
        if is_anew {
            (cursor.run, cursor.chunk, cursor.byte) = (self.run, self.first, 0);
        }
        cursor.folds = self.folds;
        let mut bytes = Vec::new();
        let place = usize::try_from(cursor.chunk - self.first).ok()?;
        for chunk in self.chunks.range(place.min(self.chunks.len())..) {
            bytes.extend_from_slice(chunk.get(cursor.byte..).unwrap_or_default());
            if !bytes.is_empty() {
                cursor.byte = chunk.len();
                break;
            }
            // A chunk that has a successor does not grow; the last one may.
            if cursor.chunk + 1 < self.first + self.chunks.len() as u64 {
                (cursor.chunk, cursor.byte) = (cursor.chunk + 1, 0);
            }
        }
        (is_anew || !bytes.is_empty()).then_some(Part { is_anew, bytes })
    }

    /// Folds the oldest half into a key frame, which gets the number of the last folded chunk.
    fn fold(&mut self) {
        let count = self.chunks.len() / 2;
        if count < 2 {
            return;
        }
        let mut key = KeyFrame::default();
        for chunk in self.chunks.drain(..count) {
            key.enter(&chunk);
        }
        self.chunks.push_front(key.records());
        self.first += count as u64 - 1;
        self.folds += 1;
        self.bytes = self.chunks.iter().map(Vec::len).sum();
    }
}

/// The sum of the oldest records: what must be known to go on after them.
#[derive(Debug, Default)]
struct KeyFrame {
    tiles: BTreeMap<Key, Box<[u8; 256]>>,
    skeletons: BTreeMap<Key, Vec<u8>>,
    /// The last record of each other kind, in the order in which they are told.
    run: Vec<u8>,
    status: Vec<u8>,
    step: Vec<u8>,
    path: Vec<u8>,
    doing: Vec<u8>,
}

impl KeyFrame {
    fn enter(&mut self, mut bytes: &[u8]) {
        while let Some((kind, payload, rest)) = frame::split(bytes) {
            self.enter_one(kind, payload);
            bytes = rest;
        }
    }

    fn enter_one(&mut self, kind: u8, payload: &[u8]) {
        let keep = |kind: Kind, into: &mut Vec<u8>| {
            into.clear();
            frame::record(into, kind, payload);
        };
        match kind {
            it if it == Kind::Run as u8 => keep(Kind::Run, &mut self.run),
            it if it == Kind::Status as u8 => keep(Kind::Status, &mut self.status),
            it if it == Kind::Step as u8 => keep(Kind::Step, &mut self.step),
            it if it == Kind::Path as u8 => keep(Kind::Path, &mut self.path),
            it if it == Kind::Doing as u8 => keep(Kind::Doing, &mut self.doing),
            it if it == Kind::Rows as u8 => {
                if let Some((key, rest)) = frame::key(payload) {
                    let tile = self.tiles.entry(key).or_insert_with(|| Box::new([0; 256]));
                    frame::enter_rows(rest, tile);
                }
            }
            it if it == Kind::Skeleton as u8 => {
                if let Some((key, _)) = frame::key(payload) {
                    keep(Kind::Skeleton, self.skeletons.entry(key).or_default());
                }
            }
            // Scans, notes: gone with the moments that they belong to.
            _ => {}
        }
    }

    fn records(&self) -> Vec<u8> {
        let mut out = self.run.clone();
        for (key, tile) in &self.tiles {
            frame::rows(&mut out, *key, &[0; 256], tile);
        }
        out.extend(self.skeletons.values().flatten());
        for part in [&self.status, &self.doing, &self.step, &self.path] {
            out.extend(part);
        }
        out
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn scan(number: u16) -> Vec<u8> {
        let mut out = Vec::new();
        frame::scan(&mut out, &[number; 20]);
        out
    }

    fn all(log: &Log, cursor: &mut Cursor) -> (bool, Vec<u8>) {
        let mut out = (false, Vec::new());
        while let Some(part) = log.read(cursor) {
            if part.is_anew {
                out = (true, Vec::new());
            }
            out.1.extend(part.bytes);
        }
        out
    }

    #[test]
    fn every_viewer_gets_every_record_once() {
        let mut log = Log::new(1 << 20);
        log.begin();
        let (mut early, mut told) = (Cursor::default(), Vec::new());
        for number in 0..5_000 {
            log.push(&scan(number));
            if number % 7 == 0 {
                told.extend(all(&log, &mut early).1);
            }
        }
        told.extend(all(&log, &mut early).1);
        let whole: Vec<u8> = (0..5_000).flat_map(scan).collect();
        assert!(told == whole);
        assert!(all(&log, &mut Cursor::default()) == (true, whole));
        assert_eq!(log.read(&mut early), None);
    }

    #[test]
    fn a_new_run_is_told_anew() {
        let mut log = Log::new(1 << 20);
        log.begin();
        log.push(&scan(1));
        let mut cursor = Cursor::default();
        assert!(all(&log, &mut cursor).0);
        log.begin();
        assert_eq!(all(&log, &mut cursor), (true, Vec::new()));
        log.push(&scan(2));
        assert_eq!(all(&log, &mut cursor), (false, scan(2)));
    }

    #[test]
    fn the_oldest_half_becomes_a_key_frame_and_the_map_stays() {
        let mut log = Log::new(64 * 1024);
        log.begin();
        let (mut tile, mut close) = ([0u8; 256], Cursor::default());
        let mut told = Vec::new();
        for number in 0..20_000u32 {
            let before = tile;
            tile[(number % 256) as usize] = number.to_le_bytes()[0] ^ number.to_le_bytes()[1];
            let mut out = scan(number as u16);
            frame::rows(&mut out, (3, 4), &before, &tile);
            log.push(&out);
            let (is_anew, part) = all(&log, &mut close);
            assert!(!is_anew || number == 0, "who keeps up is never told anew");
            told.extend(part);
            assert!(log.bytes <= 65 * 1024);
        }
        let map = |bytes: &[u8]| {
            let mut key = KeyFrame::default();
            key.enter(bytes);
            key.tiles.get(&(3, 4)).map(|tile| **tile)
        };
        let (_, late) = all(&log, &mut Cursor::default());
        assert!(late.len() < told.len() / 4);
        assert_eq!(map(&told), Some(tile));
        assert_eq!(map(&late), Some(tile));
    }

    #[test]
    fn the_newest_scan_is_told_once() {
        let mut log = Log::new(1 << 20);
        let mut seen = 0;
        assert_eq!(log.newest(&mut seen), None);
        log.set_newest(&scan(1));
        log.set_newest(&scan(2));
        assert_eq!(log.newest(&mut seen).as_deref(), Some(scan(2).as_slice()));
        assert_eq!(log.newest(&mut seen), None);
    }
}
