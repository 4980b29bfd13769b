//! Panics and faults: report them on the line, store them for the next boot, reboot.
//!
//! A robot whose planner crashed gets no further command. Its host stops it at the report, or at
//! the latest when the command is stale.
//!
//! A crashed program does not return, so its report starts a new stack from the top: a crash takes
//! a few bytes of the old one, wherever it happens. The fault handlers are assembly because they
//! cannot trust the stack: it may have overflowed. They pass the address of the exception's frame
//! to `report_fault`. The one fault that returns is that of the load of `can_read`: it means "no
//! memory here".

use core::arch::global_asm;
use core::panic::PanicInfo;
use core::ptr;

use cortex_m_rt::{ExceptionFrame, exception};
use fieldline_protocol::frame::{MAX_REPLY_FRAME, encode_reply};
use fieldline_protocol::message::{CRASH_FILE_BYTES, Cause, Crash, Reply};

use super::{board, boot_record, uart};

/// Word with which cortex-m-rt paints the stack.
const PAINT: u32 = 0xcccc_cccc;

unsafe extern "C" {
    /// Top of the stack: a linker symbol, of which only the address has a meaning.
    static _stack_start: u32;
    /// Bottom of the stack, likewise.
    static _stack_end: u32;
    /// Returns 1 if the word at `address` can be read, 0 if reading it is a bus fault.
    fn fieldline_can_read(address: usize) -> u32;
    /// Goes on in `report_panic`, with these arguments, at the top of the stack.
    fn fieldline_restart(line: u32, file: *const u8, length: usize) -> !;
}

global_asm!(
    ".section .text.fieldline_faults,\"ax\",%progbits",
    ".syntax unified",
    ".thumb",
    // u32 fieldline_can_read(usize address)
    ".global fieldline_can_read",
    ".type fieldline_can_read,%function",
    ".thumb_func",
    "fieldline_can_read:",
    "  ldr r1, [r0]",
    "  movs r0, #1",
    "  bx lr",
    ".type fieldline_cannot_read,%function",
    ".thumb_func",
    "fieldline_cannot_read:",
    "  movs r0, #0",
    "  bx lr",
    // If the load above faulted, continue at fieldline_cannot_read.
    ".global BusFault",
    ".type BusFault,%function",
    ".thumb_func",
    "BusFault:",
    "  ldr r1, [sp, #24]",
    "  ldr r2, =fieldline_can_read",
    "  bic r2, r2, #1",
    "  cmp r1, r2",
    "  bne HardFault",
    "  ldr r2, =fieldline_cannot_read",
    "  bic r2, r2, #1",
    "  str r2, [sp, #24]",
    // Clear the fault's status: write it back.
    "  ldr r2, =0xE000ED28",
    "  ldr r1, [r2]",
    "  str r1, [r2]",
    "  bx lr",
    // Any other fault: report it with the frame's address, on a new stack.
    ".global HardFault",
    ".type HardFault,%function",
    ".thumb_func",
    "HardFault:",
    "  mov r0, sp",
    "  ldr r1, =_stack_start",
    "  mov sp, r1",
    "  b {report}",
    ".global fieldline_restart",
    ".type fieldline_restart,%function",
    ".thumb_func",
    "fieldline_restart:",
    "  ldr r3, =_stack_start",
    "  mov sp, r3",
    "  b {panicked}",
    ".ltorg",
    report = sym report_fault,
    panicked = sym report_panic,
);

/// Returns true if there is memory at `address`.
pub(crate) fn can_read(address: usize) -> bool {
    // SAFETY: the load has no effect. If it faults, the handler above makes the function return 0.
    unsafe { fieldline_can_read(address) == 1 }
}

/// Returns the deepest stack since the boot, bytes.
pub(crate) fn deepest_stack_bytes() -> u32 {
    let (bottom, top) = (ptr::addr_of!(_stack_end), ptr::addr_of!(_stack_start));
    let words = (top as usize - bottom as usize) / 4;
    let painted = (0..words)
        // SAFETY: the word lies in the stack's memory and is read whole. The part in use lies above
        // the painted part.
        .take_while(|word| unsafe { bottom.add(*word).read_volatile() } == PAINT)
        .count();
    ((words - painted) * 4) as u32
}

/// Reports a processor fault whose exception frame is at the address `frame`, and reboots.
extern "C" fn report_fault(frame: usize) -> ! {
    let (bottom, top) = (
        ptr::addr_of!(_stack_end) as usize,
        ptr::addr_of!(_stack_start) as usize,
    );
    let crash = if (bottom..=top - size_of::<ExceptionFrame>()).contains(&frame) {
        let frame = ptr::with_exposed_provenance::<ExceptionFrame>(frame);
        Crash {
            cause: Cause::Fault,
            // SAFETY: the processor wrote the frame there, within the stack.
            at: unsafe { frame.read() }.pc(),
            file: heapless::String::new(),
        }
    } else {
        Crash {
            cause: Cause::StackOverflow,
            ..Crash::default()
        }
    };
    end(&crash)
}

/// An unexpected interrupt.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    panic!("unexpected interrupt {}", number);
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    cortex_m::interrupt::disable();
    let place = info.location().map(|it| (it.line(), it.file()));
    let (line, file) = place.unwrap_or_default();
    // SAFETY: nothing of the old stack is used again: this never returns, interrupts are off, and
    // the compiler keeps the text of a location in flash.
    unsafe { fieldline_restart(line, file.as_ptr(), file.len()) }
}

/// Reports a panic at a place in the source, and reboots.
extern "C" fn report_panic(line: u32, file: *const u8, length: usize) -> ! {
    // SAFETY: `panic` passes the parts of a text in flash.
    let bytes = unsafe { core::slice::from_raw_parts(file, length) };
    let path = core::str::from_utf8(bytes).unwrap_or_default();
    let mut crash = Crash {
        at: line,
        ..Crash::default()
    };
    // The end of the path says more than its start.
    let tail = path.len().saturating_sub(CRASH_FILE_BYTES);
    for letter in path.chars().skip(tail) {
        let _ = crash.file.push(letter);
    }
    end(&crash)
}

/// Stores and sends the crash report, and reboots.
fn end(crash: &Crash) -> ! {
    cortex_m::interrupt::disable();
    boot_record::store(crash);
    let mut frame = [0; 1 + MAX_REPLY_FRAME];
    // The zero before the report ends a frame that the crash cut off.
    if let Some(room) = frame.get_mut(1..)
        && let Ok(length) = encode_reply(0, &Reply::Crash(crash.clone()), room)
    {
        uart::send_after_crash(frame.get(..=length).unwrap_or(&[]));
    }
    reboot()
}

/// Reboots, at the request of the host or after a crash.
pub(crate) fn reboot() -> ! {
    board::reset()
}

/// Crashes the test image in its third step. The number of boots selects a panic, a fault or a
/// stack overflow.
#[cfg(feature = "crash-test")]
pub(crate) fn crash_on_third_step(boots: u32) {
    use core::sync::atomic::{AtomicU32, Ordering};
    static STEPS: AtomicU32 = AtomicU32::new(0);

    #[allow(unconditional_recursion, reason = "it overflows the stack on purpose")]
    fn deeper(frame: [u32; 16]) -> u32 {
        let mut next = frame;
        next[0] = core::hint::black_box(frame[1]) + 1;
        deeper(core::hint::black_box(next)) + next[2]
    }

    let step = STEPS.load(Ordering::Relaxed) + 1;
    STEPS.store(step, Ordering::Relaxed);
    match (step, boots % 3) {
        (3, 1) => panic!("crash test"),
        // There is no memory at this address, and no probe is running.
        (3, 2) => {
            // SAFETY: the load faults and ends the program.
            unsafe { ptr::with_exposed_provenance::<u32>(0x6000_0000).read_volatile() };
        }
        (3, _) => {
            core::hint::black_box(deeper([0; 16]));
        }
        _ => {}
    }
}
