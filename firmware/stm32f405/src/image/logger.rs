//! defmt's bytes into a ring, which the session drains into log frames.
//!
//! A message that does not fit is lost as a whole, so the stream stays decodable. Interrupts are off while a message is written.

use core::cell::UnsafeCell;

use critical_section::RestoreState;
use fieldline_device::ring::Ring;

static LOG: Ring<512> = Ring::new();

#[defmt::global_logger]
struct Logger;

/// What a message needs while it is written.
struct Writing {
    encoder: defmt::Encoder,
    restore: RestoreState,
    whole: bool,
}

struct Shared(UnsafeCell<Writing>);

// SAFETY: used only between acquire and release, in a critical section of a single core.
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

// SAFETY: acquire enters a critical section and release leaves it, so messages are written one at a time; defmt calls them
// in that order, and a log statement within a log statement does not occur.
unsafe impl defmt::Logger for Logger {
    fn acquire() {
        // SAFETY: released in `release`, in reverse order.
        let restore = unsafe { critical_section::acquire() };
        // SAFETY: in the critical section, see above.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.restore = restore;
        writing.whole = true;
        writing.with_ring(|encoder, put| encoder.start_frame(put));
    }

    unsafe fn flush() {}

    unsafe fn release() {
        // SAFETY: still in the critical section.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.with_ring(|encoder, put| encoder.end_frame(put));
        if writing.whole {
            LOG.publish();
        } else {
            LOG.discard();
        }
        let restore = writing.restore;
        // SAFETY: the state that `acquire` got.
        unsafe { critical_section::release(restore) };
    }

    unsafe fn write(bytes: &[u8]) {
        // SAFETY: still in the critical section.
        let writing = unsafe { &mut *WRITING.0.get() };
        writing.with_ring(|encoder, put| encoder.write(bytes, put));
    }
}

/// Moves log bytes to `out` and gives how many.
pub(crate) fn take(out: &mut [u8]) -> usize {
    LOG.take(out)
}
