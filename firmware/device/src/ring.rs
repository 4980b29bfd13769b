//! A ring of bytes from one producer (an interrupt or a logger) to one consumer (the main loop),
//! without locks.
//!
//! Invariants: `head`, `staged` and `tail` are less than N. Around the ring, `staged` never reaches
//! `tail` from behind, so one of the N bytes stays unused. Only the producer writes `head` and
//! `staged`; only the consumer writes `tail`. Two producers or two consumers at once lose bytes;
//! nothing worse happens.

use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

/// A ring with room for `N` − 1 bytes.
///
/// ```
/// use fieldline_device::ring::Ring;
///
/// static RECEIVED: Ring<64> = Ring::new();
/// RECEIVED.push(7); // in the interrupt
/// assert_eq!(RECEIVED.pop(), Some(7)); // in the main loop
/// assert!(RECEIVED.is_empty());
/// ```
#[derive(Debug)]
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    /// End of the bytes that the producer wrote. The consumer sees only the bytes before `head`.
    staged: AtomicUsize,
    head: AtomicUsize,
    tail: AtomicUsize,
    lost: AtomicU32,
}

impl<const N: usize> Default for Ring<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// Returns the index after `place` in a ring of `size` bytes.
const fn after(place: usize, size: usize) -> usize {
    if place + 1 < size { place + 1 } else { 0 }
}

impl<const N: usize> Ring<N> {
    /// Returns an empty ring.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            bytes: [const { AtomicU8::new(0) }; N],
            staged: AtomicUsize::new(0),
            head: AtomicUsize::new(0),
            tail: AtomicUsize::new(0),
            lost: AtomicU32::new(0),
        }
    }

    /// Producer: adds a byte. If the ring is full, the byte is lost and counted.
    pub fn push(&self, byte: u8) {
        if self.stage(byte) {
            self.publish();
        }
    }

    /// Producer: writes a byte that the consumer does not see yet. If the ring is full, the byte is
    /// lost and counted, and the result is false.
    pub fn stage(&self, byte: u8) -> bool {
        let at = self.staged.load(Ordering::Relaxed);
        let next = after(at, N);
        match self.bytes.get(at) {
            Some(place) if next != self.tail.load(Ordering::Acquire) => {
                place.store(byte, Ordering::Relaxed);
                self.staged.store(next, Ordering::Relaxed);
                true
            }
            _ => {
                let lost = self.lost.load(Ordering::Relaxed);
                self.lost.store(lost.wrapping_add(1), Ordering::Relaxed);
                false
            }
        }
    }

    /// Producer: shows all staged bytes to the consumer.
    pub fn publish(&self) {
        self.head
            .store(self.staged.load(Ordering::Relaxed), Ordering::Release);
    }

    /// Producer: discards all staged bytes.
    pub fn discard(&self) {
        self.staged
            .store(self.head.load(Ordering::Relaxed), Ordering::Relaxed);
    }

    /// Consumer: removes and returns the oldest byte.
    pub fn pop(&self) -> Option<u8> {
        let tail = self.tail.load(Ordering::Relaxed);
        if tail == self.head.load(Ordering::Acquire) {
            return None;
        }
        let byte = self.bytes.get(tail)?.load(Ordering::Relaxed);
        self.tail.store(after(tail, N), Ordering::Release);
        Some(byte)
    }

    /// Consumer: moves bytes to `out` and returns how many.
    pub fn take(&self, out: &mut [u8]) -> usize {
        let mut count = 0;
        for place in out {
            let Some(byte) = self.pop() else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    /// Returns true if the consumer has no byte to take.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tail.load(Ordering::Relaxed) == self.head.load(Ordering::Acquire)
    }

    /// Returns the number of bytes lost because the ring was full.
    #[must_use]
    pub fn lost(&self) -> u32 {
        self.lost.load(Ordering::Relaxed)
    }
}

#[cfg(test)]
mod tests {
    use std::vec::Vec;

    use super::Ring;

    fn all<const N: usize>(ring: &Ring<N>) -> Vec<u8> {
        core::iter::from_fn(|| ring.pop()).collect()
    }

    #[test]
    fn a_full_ring_loses_the_newest_byte() {
        let ring = Ring::<5>::new();
        (1..=6).for_each(|byte| ring.push(byte));
        assert_eq!((all(&ring), ring.lost()), ([1, 2, 3, 4].into(), 2));
        ring.push(7);
        let mut out = [0; 3];
        assert_eq!((ring.take(&mut out), out), (1, [7, 0, 0]));
        assert!(ring.is_empty());
    }

    #[test]
    fn staged_bytes_appear_together_or_never() {
        let ring = Ring::<5>::new();
        ring.push(1);
        assert!(ring.stage(2) && ring.stage(3));
        assert_eq!(all(&ring), [1]);
        ring.discard();
        assert!(ring.stage(4) && ring.stage(5) && ring.stage(6) && ring.stage(7));
        assert!(!ring.stage(8));
        ring.publish();
        assert_eq!(all(&ring), [4, 5, 6, 7]);
    }

    #[test]
    fn two_threads_exchange_every_byte() {
        static RING: Ring<64> = Ring::new();
        const COUNT: u32 = 100_000;
        let producer = std::thread::spawn(|| {
            for number in 0..COUNT {
                while !RING.stage(number as u8) {
                    std::thread::yield_now();
                }
                RING.publish();
            }
        });
        for number in 0..COUNT {
            let byte = loop {
                match RING.pop() {
                    Some(byte) => break byte,
                    None => std::thread::yield_now(),
                }
            };
            assert_eq!(byte, number as u8);
        }
        producer.join().unwrap();
    }
}
