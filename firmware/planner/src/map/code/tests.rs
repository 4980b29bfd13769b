//! Tests: a code gives back what was written, in any of the ways to read it.

use super::{Code, HEAD, MOST_WORDS, Writer, fourfold, whole};
use crate::map::tile::{Cells, Visited};
use crate::map::versions::{News, Version};

fn random(seed: &mut u32) -> u32 {
    *seed ^= *seed << 13;
    *seed ^= *seed >> 17;
    *seed ^= *seed << 5;
    *seed
}

/// A tile of uniform blocks, some of which have noise, and a trail.
fn tile(seed: &mut u32, mixed_in_32: u32) -> (Cells, Visited) {
    let mut cells = [[0; 32]; 2];
    for plane in &mut cells {
        for block_row in 0..8 {
            let bits = random(seed);
            for k in 0..4 {
                plane[4 * block_row + k] = fourfold(bits & 0xff);
            }
        }
    }
    for row in 0..32 {
        for column in 0..32 {
            let block = (row / 4 * 8 + column / 4) as u32;
            let is_mixed = block.wrapping_mul(0x9e37_79b1) >> 27 < mixed_in_32;
            if is_mixed {
                for plane in &mut cells {
                    plane[row] ^= (random(seed) >> 9 & 1) << column;
                }
            }
        }
    }
    let trail = core::array::from_fn(|_| match random(seed) >> 20 & 3 {
        0 => random(seed) as u16,
        _ => 0,
    });
    (cells, trail)
}

#[test]
fn a_code_gives_back_what_was_written() {
    let mut seed = 5;
    let (mut lengths, mut refused) = (std::vec::Vec::new(), 0);
    for round in 0..2_000_u32 {
        let (cells, trail) = tile(&mut seed, round % 33);
        let version = Version {
            epoch: random(&mut seed) as u16,
            news: News::of_bits(random(&mut seed) as u8),
        };
        let Some(mut writer) = Writer::of(&cells, &trail, version) else {
            refused += 1;
            continue;
        };
        let kept = random(&mut seed) as i8;
        writer.keep(kept);
        // What follows in the page is not part of it.
        let mut page = writer.words().to_vec();
        page.extend([u32::MAX; 8]);
        let code = Code::new(&page);
        assert_eq!(code.length(), writer.words().len());
        lengths.push(code.length());
        assert_eq!((code.cells(), code.trail()), (cells, trail));
        assert_eq!((code.version(), code.kept()), (version, kept));
        let [low, high] = &cells;
        let known = low
            .iter()
            .zip(high)
            .map(|(low, high)| (low | high).count_ones());
        assert_eq!(code.known(), known.sum::<u32>());
        for row in 0..32 {
            assert_eq!(code.row(row), cells.map(|plane| plane[row]));
            for column in 0..32 {
                let bits = cells.map(|plane| plane[row] >> column & 1);
                assert_eq!(code.class_bits(row, column), bits);
            }
        }
        let version = Version {
            epoch: 7,
            news: News::of_bits(9),
        };
        super::set_version(&mut page, version);
        let code = Code::new(&page);
        assert_eq!((code.version(), code.kept()), (version, kept));
        assert_eq!((code.cells(), code.trail()), (cells, trail));
    }
    assert!(refused > 100 && lengths.len() > 500, "{refused}");
    assert!(lengths.iter().all(|&length| length <= MOST_WORDS));
    assert!(lengths.contains(&MOST_WORDS));
}

#[test]
fn an_empty_tile_is_its_head() {
    let version = Version::MEASURED;
    let writer = Writer::of(&[[0; 32]; 2], &[0; 16], version).unwrap();
    assert_eq!(writer.words().len(), HEAD);
    let floor = Writer::of(&[[u32::MAX; 32], [0; 32]], &[0; 16], version).unwrap();
    assert_eq!(floor.words().len(), HEAD);
    assert_eq!(Code::new(floor.words()).row(17), [u32::MAX, 0]);
}

#[test]
fn a_code_of_any_words_is_read_without_a_panic() {
    let mut seed = 77;
    for length in 0..64 {
        let words: std::vec::Vec<u32> = (0..length).map(|_| random(&mut seed)).collect();
        let code = Code::new(&words);
        let _ = (code.cells(), code.trail(), code.version(), code.length());
        (0..32).for_each(|k| {
            code.class_bits(k, k as u32);
        });
    }
}

#[test]
fn eight_bits_are_blown_up_to_a_row_and_back() {
    for byte in 0..256 {
        let wide = fourfold(byte);
        assert_eq!(whole(wide), byte);
        for k in 0..32 {
            assert_eq!(wide >> k & 1, byte >> (k / 4) & 1);
            assert_eq!(whole(wide & !(1 << k)), byte & !(1 << (k / 4)));
        }
    }
}
