//! USART1 as a byte stream: an interrupt receives into a ring, and sending polls.
//!
//! Sending polls for two reasons: QEMU 7.2 raises no interrupt for an empty transmitter, and a
//! reply is short. 300 bytes take 7 ms, and nothing else is due meanwhile because the host waits
//! for them. The ring holds two of the longest requests. More than one is under way only if the
//! host repeats one too early.

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
/// Number of overruns and framing errors, visible in a debugger. The receiver counts the damaged
/// frame.
static ERRORS: AtomicU32 = AtomicU32::new(0);

/// The serial line.
pub(crate) struct Uart(USART1);

impl Uart {
    /// Starts the line at [`BAUD`], 8N1, on a bus of `bus_hz`.
    pub(crate) fn new(usart: USART1, bus_hz: u32) -> Self {
        let divider = ((bus_hz + BAUD / 2) / BAUD) as u16;
        // SAFETY: any divider of at least 16 is valid (RM0090, 30.3.4). 16 MHz / 460 800 is 35.
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

    /// Returns true if every received byte was read.
    pub(crate) fn is_idle(&self) -> bool {
        RECEIVED.is_empty()
    }

    /// Waits until the last byte is sent.
    pub(crate) fn drain(&self) {
        // Bounded: a byte takes 22 µs, and a dead transmitter must not prevent the reboot.
        (0..1_000_000).any(|_| self.0.sr().read().tc().bit_is_set());
    }

    fn send(&self, byte: u8) {
        while self.0.sr().read().txe().bit_is_clear() {}
        self.0.dr().write(|w| w.dr().set(u16::from(byte)));
    }
}

/// Enables the interrupt for received bytes.
pub(crate) fn listen() {
    // SAFETY: the interrupt shares only the ring, and is its only producer.
    unsafe { NVIC::unmask(Interrupt::USART1) };
}

/// Sends bytes from a crashed program: without interrupts, and for a limited time even if the
/// transmitter is dead.
pub(crate) fn send_after_crash(bytes: &[u8]) {
    // SAFETY: interrupts are off and nothing else runs after a crash, so nothing else uses the
    // port.
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
    // SAFETY: only this interrupt reads the data register. Reading status and data clears the
    // interrupt.
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
    /// Sleeps until a byte arrives.
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
