//! The version and the schema hash, which tell whether two ends agree on the messages.
//!
//! The hash is FNV-1a over the shape of [`Request`] and [`Reply`]: names of fields, names and order
//! of variants, types. Then it covers what the shape does not show: the version, the capacities of
//! the bounded lists, and the fraction bits of the two fixed-point types. The compiler computes it
//! from the types, so nobody can forget to update it.

use fixed::types::{I4F12, I16F16};
use postcard_schema::key::hash::fnv1a64::hash_ty_path;

use crate::message::{
    BUILD_BYTES, CORRECTED_BYTES, CORRECTED_TILES, CRASH_FILE_BYTES, DIGEST_TILES, FIELD_SIDE,
    MAX_BEAMS, MAX_FRONTIERS, MAX_SCANS, MOST_CORRECTED, NO_RETURN_MM, PATH_PAGE, RECALLED_POINTS,
    RECALLED_TRACK, ROAD_POINTS, Reply, Request, TILE_BYTES, TILE_SKELETON_BYTES, TILE_STAMPS,
    TRAIL_BYTES, WANTED_TILES,
};

/// Version of the protocol.
///
/// Raise it when the meaning of a message or the framing changes. The schema hash covers all other
/// changes.
pub const VERSION: u16 = 1;

/// Hash of everything that both ends must agree on.
pub const SCHEMA: u32 = {
    let shapes = fold(
        u64::from_le_bytes(hash_ty_path::<Request>("fieldline/request")),
        u64::from_le_bytes(hash_ty_path::<Reply>("fieldline/reply")),
    );
    let mut hash = shapes;
    let limits = [
        VERSION as usize,
        MAX_BEAMS,
        MAX_SCANS,
        MAX_FRONTIERS,
        TILE_BYTES,
        TILE_SKELETON_BYTES,
        TILE_STAMPS,
        PATH_PAGE,
        FIELD_SIDE,
        BUILD_BYTES,
        CRASH_FILE_BYTES,
        ROAD_POINTS,
        DIGEST_TILES,
        WANTED_TILES,
        CORRECTED_TILES,
        CORRECTED_BYTES,
        MOST_CORRECTED as usize,
        TRAIL_BYTES,
        RECALLED_POINTS,
        RECALLED_TRACK,
        NO_RETURN_MM as usize,
        I16F16::FRAC_NBITS as usize,
        I4F12::FRAC_NBITS as usize,
    ];
    let mut rest: &[usize] = &limits;
    while let [limit, tail @ ..] = rest {
        hash = fold(hash, *limit as u64);
        rest = tail;
    }
    (hash ^ (hash >> 32)) as u32
};

/// Continues the FNV-1a hash `hash` over the eight bytes of `word`.
pub(crate) const fn fold(hash: u64, word: u64) -> u64 {
    let mut hash = hash;
    let mut shift = 0;
    while shift < 64 {
        hash = (hash ^ ((word >> shift) & 0xff)).wrapping_mul(0x0100_0000_01b3);
        shift += 8;
    }
    hash
}

#[cfg(test)]
mod tests {
    use super::{SCHEMA, VERSION};

    /// A new hash means that the wire changed. Write the new value here. If the meaning of a
    /// message changed as well, raise [`VERSION`].
    #[test]
    fn schema_hash_is_unchanged() {
        assert_eq!((VERSION, SCHEMA), (1, 0x3d0c_6c0a));
    }
}
