//! Bytes from one producer (an interrupt, a logger) to one consumer (the main loop), without locks.
//!
//! Invariant: all three places are below N; going round, `tail` is never passed by `staged`, so one byte of the N stays unused. The
//! producer alone writes `head` and `staged`, the consumer alone `tail`. Two producers or two consumers at once lose bytes but nothing
//! worse.

use core::sync::atomic::{AtomicU8, AtomicU32, AtomicUsize, Ordering};

/// A ring with room for `N` − 1 bytes.
#[derive(Debug)]
pub struct Ring<const N: usize> {
    bytes: [AtomicU8; N],
    /// Written up to here and not yet given to the consumer.
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

const fn after(place: usize, size: usize) -> usize {
    if place + 1 < size { place + 1 } else { 0 }
}

impl<const N: usize> Ring<N> {
    /// An empty ring.
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

    /// Producer: adds a byte; it is lost, and counted, if the ring is full.
    pub fn push(&self, byte: u8) {
        if self.stage(byte) {
            self.publish();
        }
    }

    /// Producer: writes a byte that the consumer does not see yet; false, and the byte is lost and counted, if the ring is full.
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

    /// Producer: gives what is staged to the consumer.
    pub fn publish(&self) {
        self.head
            .store(self.staged.load(Ordering::Relaxed), Ordering::Release);
    }

    /// Producer: forgets what is staged.
    pub fn discard(&self) {
        self.staged
            .store(self.head.load(Ordering::Relaxed), Ordering::Relaxed);
    }

    /// Consumer: the oldest byte.
    pub fn pop(&self) -> Option<u8> {
        let tail = self.tail.load(Ordering::Relaxed);
        if tail == self.head.load(Ordering::Acquire) {
            return None;
        }
        let byte = self.bytes.get(tail)?.load(Ordering::Relaxed);
        self.tail.store(after(tail, N), Ordering::Release);
        Some(byte)
    }

    /// Consumer: moves bytes to `out` and gives how many.
    pub fn take(&self, out: &mut [u8]) -> usize {
        let mut count = 0;
        for place in out {
            let Some(byte) = self.pop() else { break };
            *place = byte;
            count += 1;
        }
        count
    }

    /// Whether the consumer has nothing to take.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tail.load(Ordering::Relaxed) == self.head.load(Ordering::Acquire)
    }

    /// Bytes lost for lack of room.
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
    fn first_in_first_out_and_full_loses_the_newest() {
        let ring = Ring::<5>::new();
        (1..=6).for_each(|byte| ring.push(byte));
        assert_eq!((all(&ring), ring.lost()), ([1, 2, 3, 4].into(), 2));
        ring.push(7);
        let mut out = [0; 3];
        assert_eq!((ring.take(&mut out), out), (1, [7, 0, 0]));
        assert!(ring.is_empty());
    }

    #[test]
    fn staged_bytes_come_all_or_not_at_all() {
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
    fn two_threads_lose_nothing_while_there_is_room() {
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
