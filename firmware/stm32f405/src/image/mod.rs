//! The program: a planner and its session on a chip. The same bytes run on silicon and in QEMU.
//!
//! | file | contents |
//! | --- | --- |
//! | `board.rs` | clocks, pins, timers, watchdog |
//! | `uart.rs` | USART1 as a byte stream |
//! | `logger.rs` | defmt's bytes into a ring |
//! | `workspace.rs` | the memory of the planner's workspace |
//! | `boot_record.rs` | boots and last crash, kept over a reboot |
//! | `crash.rs` | panics and faults: report, reboot |
//!
//! This is the only unsafe code of the project. Each block says why it is sound.

mod board;
mod boot_record;
mod crash;
mod logger;
mod uart;
mod workspace;

use cortex_m_rt::entry;
use fieldline_device::port::{Port, Turn};
use fieldline_device::{Memory, SLOTS, Session, State, TILES};
use fieldline_planner::Tuning;

use board::Board;

#[entry]
fn main() -> ! {
    static mut STATE: State = State::new();
    static mut SESSION: Session = Session::new();

    let (mut board, serial, emergency_stop, led) = Board::take();
    let workspace = workspace::init();
    let boot = boot_record::boot(board.reset_by_watchdog());
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
        tuning: &Tuning::DEFAULT,
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
            // The line counts its errors. A frame is lost, and the host repeats its request.
            Err(_) => {}
        }
    }
}
