//! The exchange of map tiles: what is said when.
//!
//! | packet | when |
//! | --- | --- |
//! | tile | it is due ([`crate::map`]'s versions), or a member asked for it |
//! | digest | once a second, of the next tiles in turn, while a peer's map differs |
//! | wanted | after a digest in which a tile differs |
//!
//! Digests repair what was lost, and let a newcomer catch up. While no peer is in reach nothing is
//! said, and what is due stays due.
//!
//! Invariant: at most [`STEP_PACKETS`] packets in a step.
//! Units: milliseconds, tiles.

use heapless::Vec;

use crate::clock::since;
use crate::map::Map;
use crate::map::exchange::TileView;
use crate::team::packet::{Body, Digest, TeamTile, TileVersion, WANTED_TILES, Wanted};

/// Greatest number of packets in a step beside the beacon.
pub(crate) const STEP_PACKETS: u8 = 3;
/// Time from one digest to the next, and from one sweep of the news to the next, milliseconds.
const DIGEST_MS: u32 = 1_000;
/// Greatest number of tiles that were asked for and not yet said.
const MOST_ASKED: usize = 2 * WANTED_TILES;

/// The state of the exchange.
#[derive(Debug)]
pub(crate) struct Exchange {
    /// Packets that may still be said in this step.
    left: u8,
    /// Time of the last digest.
    digest_ms: u32,
    owes_digest: bool,
    salt: u8,
    /// The place of the next tile in a digest.
    digest_place: usize,
    /// The place of the tile that was said last, plus one.
    due_place: usize,
    /// Tiles that others asked for.
    asked: Vec<(i8, i8), MOST_ASKED>,
    /// Tiles to ask for.
    wanted: Wanted,
    /// The map's number of changes when `mark` was made, and the mark.
    mark: (u32, u32),
}

impl Exchange {
    /// Returns the state at the start.
    pub(crate) const fn new() -> Self {
        Self {
            left: 0,
            digest_ms: 0,
            owes_digest: false,
            salt: 0,
            digest_place: 0,
            due_place: 0,
            asked: Vec::new(),
            wanted: Wanted {
                of: 0,
                tiles: Vec::new(),
            },
            mark: (0, 0),
        }
    }

    /// Begins a step.
    pub(crate) fn begin_step<const TILES: usize, const SLOTS: usize>(
        &mut self,
        now_ms: u32,
        map: &mut Map<TILES, SLOTS>,
    ) {
        self.left = STEP_PACKETS;
        if since(now_ms, self.digest_ms) >= DIGEST_MS {
            self.digest_ms = now_ms;
            self.owes_digest = true;
            map.sweep_news();
        }
    }

    /// Returns a number that is equal for equal maps.
    pub(crate) fn mark<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &Map<TILES, SLOTS>,
    ) -> u32 {
        let edits = map.tiles().edits();
        if self.mark.0 != edits || self.mark.1 == 0 {
            let of = |(_, view): (usize, TileView<'_>)| {
                let (x, y) = view.tile;
                let place = (x as u32 & 0xff) << 8 | y as u32 & 0xff;
                view.hash(place << 16 | u32::from(view.raises()))
            };
            let sum = map.views_from(0).map(of).fold(0, u32::wrapping_add);
            self.mark = (edits, sum);
        }
        self.mark.1
    }

    /// Takes the versions of another robot's tiles: notes which of them to ask for. The tiles of an
    /// earlier digest that were not asked for yet come again.
    pub(crate) fn hear_digest(
        &mut self,
        of: u8,
        digest: &Digest,
        is_wanted: impl Fn(&TileVersion) -> bool,
    ) {
        if self.wanted.tiles.is_empty() {
            let tiles = digest.tiles.iter().filter(|version| is_wanted(version));
            let tiles = tiles.take(WANTED_TILES).map(|version| version.tile);
            self.wanted = Wanted {
                of,
                tiles: tiles.collect(),
            };
        }
    }

    /// Takes a request for tiles. What there is no room for is asked for again.
    pub(crate) fn hear_wanted(&mut self, tiles: &[(i8, i8)]) {
        for tile in tiles {
            if !self.asked.contains(tile) {
                let _ = self.asked.push(*tile);
            }
        }
    }

    /// Returns the next packet's body. `differs` is true if the map of a peer in reach does.
    pub(crate) fn say<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
        differs: bool,
    ) -> Option<Body> {
        if self.left == 0 {
            return None;
        }
        let body = self
            .say_wanted()
            .map(Body::Wanted)
            .or_else(|| self.say_digest(map, differs))
            .or_else(|| self.say_asked(map))
            .or_else(|| self.say_due(map))?;
        self.left -= 1;
        Some(body)
    }

    /// Returns the next request for tiles.
    pub(crate) fn say_wanted(&mut self) -> Option<Wanted> {
        if self.wanted.tiles.is_empty() {
            return None;
        }
        Some(core::mem::take(&mut self.wanted))
    }

    fn say_digest<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &Map<TILES, SLOTS>,
        differs: bool,
    ) -> Option<Body> {
        if !core::mem::replace(&mut self.owes_digest, false) || !differs {
            return None;
        }
        let mut tiles = Vec::new();
        let mut next = 0;
        for (place, view) in map.views_from(self.digest_place) {
            let Some(tile) = told(view.tile) else {
                continue;
            };
            let version = TileVersion {
                tile,
                epoch: view.epoch,
                hash: short_hash(&view, self.salt),
            };
            if tiles.push(version).is_err() {
                next = place;
                break;
            }
        }
        let digest = Digest {
            salt: self.salt,
            tiles,
        };
        if next == 0 {
            self.salt = self.salt.wrapping_add(1);
        }
        self.digest_place = next;
        (!digest.tiles.is_empty()).then_some(Body::Digest(digest))
    }

    fn say_asked<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
    ) -> Option<Body> {
        while !self.asked.is_empty() {
            let (x, y) = self.asked.remove(0);
            let place = map.place((x.into(), y.into()));
            if let Some(body) = place.and_then(|place| say_tile(map, place)) {
                return Some(body);
            }
        }
        None
    }

    fn say_due<const TILES: usize, const SLOTS: usize>(
        &mut self,
        map: &mut Map<TILES, SLOTS>,
    ) -> Option<Body> {
        let place = map.due_place(self.due_place)?;
        self.due_place = place + 1;
        say_tile(map, place)
    }
}

/// Returns true if a map's own tile differs from a version of a digest.
pub(crate) fn differs<const TILES: usize, const SLOTS: usize>(
    map: &Map<TILES, SLOTS>,
    version: &TileVersion,
    salt: u8,
) -> bool {
    let (x, y) = version.tile;
    let own = map.view((x.into(), y.into()));
    let same =
        |view: TileView<'_>| view.epoch == version.epoch && short_hash(&view, salt) == version.hash;
    !own.is_some_and(same)
}

/// Returns the hash of a tile in a digest.
fn short_hash(view: &TileView<'_>, salt: u8) -> u16 {
    view.hash(salt.into()) as u16
}

/// Returns a tile's column and row on the air; `None` beyond 400 m.
fn told((x, y): (i32, i32)) -> Option<(i8, i8)> {
    Some((x.try_into().ok()?, y.try_into().ok()?))
}

/// Says the tile at a place of the map's directory.
fn say_tile<const TILES: usize, const SLOTS: usize>(
    map: &mut Map<TILES, SLOTS>,
    place: usize,
) -> Option<Body> {
    let view = map.say_at(place)?;
    Some(Body::Tile(TeamTile {
        tile: told(view.tile)?,
        epoch: view.epoch,
        planes: view.cells(),
    }))
}
