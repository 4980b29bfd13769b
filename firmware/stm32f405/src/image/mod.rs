//! The program: the planner and its conversation on a chip, the same bytes on silicon and in QEMU.
//!
//! | file | what |
//! | --- | --- |
//! | `board.rs` | clocks, pins, timers, watchdog: set up once |
//! | `uart.rs` | USART1 as a byte stream |
//! | `logger.rs` | defmt into a ring, drained into the link |
//! | `workspace.rs` | where the planner's scratch lies |
//! | `kept.rs` | what survives a reboot |
//! | `crash.rs` | panics and faults: report, reboot |
//!
//! This is the only code of the project that is unsafe; each block says why it is sound.

mod board;
mod crash;
mod kept;
mod logger;
mod uart;
mod workspace;

use cortex_m_rt::entry;
use fieldline_device::port::{Port, Turn};
use fieldline_device::{Memory, SLOTS, Session, State, TILES};

use board::Board;

#[entry]
fn main() -> ! {
    static mut STATE: State = State::new();
    static mut SESSION: Session = Session::new();

    let (mut board, serial, emergency_stop, led) = Board::take();
    let workspace = workspace::place();
    let boot = kept::boot(board.reset_by_watchdog());
    #[cfg(feature = "crash-test")]
    {
        board.boots = boot.boots;
    }
    SESSION.boot(boot, TILES, SLOTS);
    let mut port = Port {
        serial,
        emergency_stop,
        led,
    };
    let mut memory = Memory {
        state: STATE,
        workspace,
    };
    loop {
        board.feed_watchdog();
        match port.turn(SESSION, &mut memory, &mut board) {
            Ok(Turn::Busy) => {}
            Ok(Turn::Idle) => board.sleep_unless(|| !port.serial.is_idle()),
            Ok(Turn::Reset) => {
                port.serial.drain();
                crash::reboot();
            }
            // The line counts its errors itself; a frame is lost and the host asks again.
            Err(_) => {}
        }
    }
}
