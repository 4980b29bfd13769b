//! defmt's bytes into a ring. The session takes them out and sends them in log frames.
//!
//! A message that does not fit is lost as a whole, so the stream stays decodable. Interrupts are
//! off while a message is written.

use core::cell::UnsafeCell;

use critical_section::RestoreState;
use fieldline_device::ring::Ring;

static LOG: Ring<448> = Ring::new();

#[defmt::global_logger]
struct Logger;

/// State of the message that is being written.
struct Writing {
    encoder: defmt::Encoder,
    restore: RestoreState,
    /// True if all bytes of the message fit into the ring so far.
    whole: bool,
}

struct Shared(UnsafeCell<Writing>);

// SAFETY: it is used only between acquire and release, in a critical section of a single core.
unsafe impl Sync for Shared {}

static WRITING: Shared = Shared(UnsafeCell::new(Writing {
    encoder: defmt::Encoder::new(),
    restore: RestoreState::invalid(),
    whole: true,
}));

impl Writing {
    fn with_ring(&mut self, act: impl FnOnce(&mut defmt::Encoder, &mut dyn FnMut(&[u8]))) {
        let Self { encoder, whole, .. } = self;
        act(encoder, &mut |bytes: &[u8]| {
            for byte in bytes {
                *whole &= LOG.stage(*byte);
            }
        });
    }
}

// SAFETY: acquire enters a critical section and release leaves it, so messages are written one at a
// time. defmt calls them in this order, and no log statement contains another.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: `release` releases it, in reverse order.
        let restore = unsafe { critical_section::acquire() };
        // SAFETY: inside the critical section, see above.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.restore = restore;
        writing.whole = true;
        writing.with_ring(|encoder, put| encoder.start_frame(put));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: still inside the critical section.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.with_ring(|encoder, put| encoder.end_frame(put));
        if writing.whole {
            LOG.publish();
        } else {
            LOG.discard();
        }
        let restore = writing.restore;
        // SAFETY: this is the state that `acquire` returned.
        unsafe { critical_section::release(restore) };
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: still inside the critical section.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.with_ring(|encoder, put| encoder.write(bytes, put));
    }
}

/// Moves log bytes to `out` and returns how many.
pub(crate) fn take(out: &mut [u8]) -> usize {
    LOG.take(out)
}
