//! The boot record: number of boots and last crash, in memory that the start-up code does not
//! clear.
//!
//! After power-on the memory holds arbitrary words. A checksum over the words detects this. Access
//! is volatile, because the compiler never sees the words initialised and could otherwise remove
//! it.

use core::mem::MaybeUninit;
use core::ptr;

use fieldline_device::Boot;
use fieldline_protocol::message::{CRASH_FILE_BYTES, Cause, Crash};

const FILE_WORDS: usize = CRASH_FILE_BYTES / 4;
const WORDS: usize = 5 + FILE_WORDS;
/// Seed of the checksum.
const SEED: u32 = 0xf1e1_d11e;

/// The record: checksum, boots, cause + 1 or 0, line or address, length of the name, the name.
#[unsafe(link_section = ".uninit.BOOT_RECORD")]
static mut BOOT_RECORD: MaybeUninit<[u32; WORDS]> = MaybeUninit::uninit();

/// Returns the record, or `None` if its checksum is wrong.
fn read() -> Option<[u32; WORDS]> {
    let record = ptr::addr_of!(BOOT_RECORD).cast::<[u32; WORDS]>();
    // SAFETY: only the main program before its loop, and a crash after which nothing else runs,
    // access the record, so no two accesses overlap. The memory exists, and every bit pattern is a
    // valid number.
    let words = unsafe { record.read_volatile() };
    (words[0] == checksum(&words)).then_some(words)
}

fn write(mut words: [u32; WORDS]) {
    words[0] = checksum(&words);
    let record = ptr::addr_of_mut!(BOOT_RECORD).cast::<[u32; WORDS]>();
    // SAFETY: as in `read`.
    unsafe { record.write_volatile(words) };
}

fn checksum(words: &[u32; WORDS]) -> u32 {
    words[1..]
        .iter()
        .fold(SEED, |sum, word| (sum ^ word).wrapping_mul(0x0100_0193))
}

/// Counts this boot, and returns the count with the crash that ended the last one.
pub(crate) fn boot(by_watchdog: bool) -> Boot {
    let words = read().unwrap_or([0; WORDS]);
    let mut next = [0; WORDS];
    next[1] = words[1].wrapping_add(1);
    write(next);
    let crash = match words[2] {
        0 if by_watchdog => Some(Crash {
            cause: Cause::Watchdog,
            ..Crash::default()
        }),
        0 => None,
        number => Some(Crash {
            cause: cause(number),
            at: words[3],
            file: file(&words),
        }),
    };
    Boot {
        boots: next[1],
        crash,
    }
}

/// Stores a crash for the next boot.
pub(crate) fn store(crash: &Crash) {
    let mut words = read().unwrap_or([0; WORDS]);
    words[2] = match crash.cause {
        Cause::Panic => 1,
        Cause::Fault => 2,
        Cause::StackOverflow => 3,
        Cause::Watchdog => 4,
    };
    words[3] = crash.at;
    words[4] = crash.file.len() as u32;
    let mut bytes = [0; CRASH_FILE_BYTES];
    for (slot, byte) in bytes.iter_mut().zip(crash.file.bytes()) {
        *slot = byte;
    }
    for (word, four) in words[5..].iter_mut().zip(bytes.chunks_exact(4)) {
        *word = u32::from_le_bytes([four[0], four[1], four[2], four[3]]);
    }
    write(words);
}

fn cause(number: u32) -> Cause {
    match number {
        1 => Cause::Panic,
        2 => Cause::Fault,
        3 => Cause::StackOverflow,
        _ => Cause::Watchdog,
    }
}

fn file(words: &[u32; WORDS]) -> heapless::String<CRASH_FILE_BYTES> {
    let mut file = heapless::String::new();
    let bytes = words[5..].iter().flat_map(|word| word.to_le_bytes());
    for byte in bytes.take(words[4] as usize) {
        // File names are ASCII. Any other byte becomes a question mark.
        let letter = if byte.is_ascii_graphic() {
            char::from(byte)
        } else {
            '?'
        };
        let _ = file.push(letter);
    }
    file
}
