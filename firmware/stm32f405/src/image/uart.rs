//! USART1 as a byte stream: received by interrupt into a ring, sent by polling.
//!
//! Polling, because QEMU 7.2 raises no interrupt for an empty transmitter, and because a reply is short: 300 bytes take 7 ms, in
//! which nothing else is due (the host waits for it). The ring holds two of the longest requests, and only one is ever
//! under way unless the host lost patience.

use core::convert::Infallible;
use core::sync::atomic::{AtomicU32, Ordering};

use cortex_m::peripheral::NVIC;
use embedded_io::{ErrorType, Read, ReadReady, Write};
use fieldline_device::ring::Ring;
use fieldline_protocol::BAUD;
use fieldline_protocol::frame::MAX_REQUEST_FRAME;
use stm32f4::stm32f405::{Interrupt, USART1, interrupt};

const RING_BYTES: usize = 2 * MAX_REQUEST_FRAME + 16;

static RECEIVED: Ring<RING_BYTES> = Ring::new();
/// Overruns and framing errors, for whoever looks with a debugger; the frame is then wrong and counted as such.
static ERRORS: AtomicU32 = AtomicU32::new(0);

/// The serial line.
pub(crate) struct Uart(USART1);

impl Uart {
    /// Starts listening at [`BAUD`], 8N1, on a bus of `bus_hz`.
    pub(crate) fn new(usart: USART1, bus_hz: u32) -> Self {
        let divider = ((bus_hz + BAUD / 2) / BAUD) as u16;
        // SAFETY: any divider from 16 on is valid (RM0090, 30.3.4); 16 MHz / 460 800 is 35.
        usart.brr().write(|w| unsafe { w.bits(divider) });
        usart.cr1().write(|w| {
            w.ue()
                .set_bit()
                .te()
                .set_bit()
                .re()
                .set_bit()
                .rxneie()
                .set_bit()
        });
        listen();
        Self(usart)
    }

    /// Whether nothing was received that was not read.
    pub(crate) fn is_idle(&self) -> bool {
        RECEIVED.is_empty()
    }

    /// Waits until the last byte is on the line.
    pub(crate) fn drain(&self) {
        // Bounded: a byte takes 22 µs, and a transmitter that never ends must not keep us from rebooting.
        (0..1_000_000).any(|_| self.0.sr().read().tc().bit_is_set());
    }

    fn send(&self, byte: u8) {
        while self.0.sr().read().txe().bit_is_clear() {}
        self.0.dr().write(|w| w.dr().set(u16::from(byte)));
    }
}

/// Lets received bytes interrupt.
pub(crate) fn listen() {
    // SAFETY: the interrupt shares only the ring, whose one producer it is.
    unsafe { NVIC::unmask(Interrupt::USART1) };
}

/// Sends from a crashed program: no interrupt, no owner, and an end even if the transmitter is dead.
pub(crate) fn send_last_words(bytes: &[u8]) {
    // SAFETY: interrupts are off and nothing runs after a crash, so nobody else uses the port.
    let uart = Uart(unsafe { USART1::steal() });
    for byte in bytes {
        if !(0..100_000).any(|_| uart.0.sr().read().txe().bit_is_set()) {
            return;
        }
        uart.0.dr().write(|w| w.dr().set(u16::from(*byte)));
    }
    uart.drain();
}

#[interrupt]
fn USART1() {
    // SAFETY: this interrupt alone reads the data register; reading status and data is what clears the interrupt.
    let usart = unsafe { USART1::steal() };
    let status = usart.sr().read();
    if status.ore().bit_is_set() || status.fe().bit_is_set() {
        ERRORS.store(
            ERRORS.load(Ordering::Relaxed).wrapping_add(1),
            Ordering::Relaxed,
        );
    }
    if status.rxne().bit_is_set() || status.ore().bit_is_set() {
        RECEIVED.push(usart.dr().read().dr().bits() as u8);
    }
}

impl ErrorType for Uart {
    type Error = Infallible;
}

impl ReadReady for Uart {
    fn read_ready(&mut self) -> Result<bool, Infallible> {
        Ok(!RECEIVED.is_empty())
    }
}

impl Read for Uart {
    /// Sleeps until there is a byte.
    fn read(&mut self, out: &mut [u8]) -> Result<usize, Infallible> {
        while !out.is_empty() && RECEIVED.is_empty() {
            cortex_m::interrupt::free(|_| {
                if RECEIVED.is_empty() {
                    cortex_m::asm::wfi();
                }
            });
        }
        Ok(RECEIVED.take(out))
    }
}

impl Write for Uart {
    fn write(&mut self, bytes: &[u8]) -> Result<usize, Infallible> {
        bytes.iter().for_each(|byte| self.send(*byte));
        Ok(bytes.len())
    }

    fn flush(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
