//! What survives a reboot, in memory that the start-up code leaves alone: how often we booted, and what we crashed of.
//!
//! After power-on the memory holds anything; a checksum over the words tells. Access is volatile: to the compiler the
//! words are never initialised, and it would be right to forget them.

use core::mem::MaybeUninit;
use core::ptr;

use fieldline_device::Boot;
use fieldline_protocol::message::{CRASH_FILE_BYTES, Cause, Crash};

const FILE_WORDS: usize = CRASH_FILE_BYTES / 4;
const WORDS: usize = 5 + FILE_WORDS;
/// Seed of the checksum.
const SEED: u32 = 0xf1e1_d11e;

/// checksum, boots, cause + 1 or 0, line or address, length of the name, the name.
#[unsafe(link_section = ".uninit.KEPT")]
static mut KEPT: MaybeUninit<[u32; WORDS]> = MaybeUninit::uninit();

fn read() -> Option<[u32; WORDS]> {
    let kept = ptr::addr_of!(KEPT).cast::<[u32; WORDS]>();
    // SAFETY: only the main program before its loop, and a crash after which nothing else runs, come here: no two at once. The memory
    // exists, and every pattern of bits is a number.
    let words = unsafe { kept.read_volatile() };
    (words[0] == checksum(&words)).then_some(words)
}

fn write(mut words: [u32; WORDS]) {
    words[0] = checksum(&words);
    let kept = ptr::addr_of_mut!(KEPT).cast::<[u32; WORDS]>();
    // SAFETY: as in `read`.
    unsafe { kept.write_volatile(words) };
}

fn checksum(words: &[u32; WORDS]) -> u32 {
    words[1..]
        .iter()
        .fold(SEED, |sum, word| (sum ^ word).wrapping_mul(0x0100_0193))
}

/// Counts this boot, and tells what ended the last one.
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

/// Keeps a crash for the next boot to tell.
pub(crate) fn keep(crash: &Crash) {
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
    for (place, byte) in bytes.iter_mut().zip(crash.file.bytes()) {
        *place = byte;
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
        // File names are ASCII; anything else shows as a question mark.
        let letter = if byte.is_ascii_graphic() {
            char::from(byte)
        } else {
            '?'
        };
        let _ = file.push(letter);
    }
    file
}
