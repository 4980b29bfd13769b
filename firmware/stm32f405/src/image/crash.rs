//! Panics and faults: say so on the line, keep it for the next boot, reboot. A robot whose planner crashed gets no further command, and its
//! host stops it at the report or at the latest when the command is stale.
//!
//! The fault handlers are assembly because they cannot trust the stack: where it ran out there is none. They note where the exception's
//! frame is, start a new stack from the top, and never return; but for one load, whose fault means "no memory here".

use core::arch::global_asm;
use core::panic::PanicInfo;
use core::ptr;

use cortex_m_rt::{ExceptionFrame, exception};
use fieldline_protocol::frame::{MAX_REPLY_FRAME, encode_reply};
use fieldline_protocol::message::{CRASH_FILE_BYTES, Cause, Crash, Reply};

use super::{board, kept, uart};

/// What cortex-m-rt paints the stack with.
const PAINT: u32 = 0xcccc_cccc;

unsafe extern "C" {
    /// Top of the stack (the linker's symbol: its address counts).
    static _stack_start: u32;
    /// Bottom of the stack.
    static _stack_end: u32;
    /// 1 if the word at `place` can be read, 0 if reading it is a bus fault.
    fn fieldline_answers(place: usize) -> u32;
}

global_asm!(
    ".section .text.fieldline_faults,\"ax\",%progbits",
    ".syntax unified",
    ".thumb",
    // u32 fieldline_answers(usize place)
    ".global fieldline_answers",
    ".type fieldline_answers,%function",
    ".thumb_func",
    "fieldline_answers:",
    "  ldr r1, [r0]",
    "  movs r0, #1",
    "  bx lr",
    ".type fieldline_silence,%function",
    ".thumb_func",
    "fieldline_silence:",
    "  movs r0, #0",
    "  bx lr",
    // Did the load above fault? Then go on at fieldline_silence.
    ".global BusFault",
    ".type BusFault,%function",
    ".thumb_func",
    "BusFault:",
    "  ldr r1, [sp, #24]",
    "  ldr r2, =fieldline_answers",
    "  bic r2, r2, #1",
    "  cmp r1, r2",
    "  bne HardFault",
    "  ldr r2, =fieldline_silence",
    "  bic r2, r2, #1",
    "  str r2, [sp, #24]",
    // Clear the fault's status by writing it back.
    "  ldr r2, =0xE000ED28",
    "  ldr r1, [r2]",
    "  str r1, [r2]",
    "  bx lr",
    // Any other fault: report with the frame's address, on a new stack.
    ".global HardFault",
    ".type HardFault,%function",
    ".thumb_func",
    "HardFault:",
    "  mov r0, sp",
    "  ldr r1, =_stack_start",
    "  mov sp, r1",
    "  b {report}",
    ".ltorg",
    report = sym report_fault,
);

/// Whether there is memory at `place`.
pub(crate) fn answers(place: usize) -> bool {
    // SAFETY: a load without effect; where it faults, the handler above returns 0 in its place.
    unsafe { fieldline_answers(place) == 1 }
}

/// Bytes of stack that were ever used.
pub(crate) fn deepest_stack_bytes() -> u32 {
    let (bottom, top) = (ptr::addr_of!(_stack_end), ptr::addr_of!(_stack_start));
    let words = (top as usize - bottom as usize) / 4;
    let painted = (0..words)
        // SAFETY: within the stack's memory; what is in use lies above what is painted, and a word is read whole.
        .take_while(|word| unsafe { bottom.add(*word).read_volatile() } == PAINT)
        .count();
    ((words - painted) * 4) as u32
}

extern "C" fn report_fault(frame: usize) -> ! {
    let (bottom, top) = (
        ptr::addr_of!(_stack_end) as usize,
        ptr::addr_of!(_stack_start) as usize,
    );
    let crash = if (bottom..=top - size_of::<ExceptionFrame>()).contains(&frame) {
        let frame = ptr::with_exposed_provenance::<ExceptionFrame>(frame);
        Crash {
            cause: Cause::Fault,
            // SAFETY: the processor put the frame there, within the stack.
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

/// An interrupt that nobody asked for.
#[exception]
unsafe fn DefaultHandler(number: i16) {
    panic!("interrupt {}", number);
}

#[panic_handler]
fn panic(info: &PanicInfo<'_>) -> ! {
    let mut crash = Crash::default();
    if let Some(place) = info.location() {
        crash.at = place.line();
        // The end of the path tells more than its beginning.
        let path = place.file();
        let tail = path.len().saturating_sub(CRASH_FILE_BYTES);
        for letter in path.chars().skip(tail) {
            let _ = crash.file.push(letter);
        }
    }
    end(&crash)
}

/// Last words.
fn end(crash: &Crash) -> ! {
    cortex_m::interrupt::disable();
    kept::keep(crash);
    let mut frame = [0; 1 + MAX_REPLY_FRAME];
    // The zero before it ends whatever frame the crash cut off.
    if let Some(room) = frame.get_mut(1..)
        && let Ok(length) = encode_reply(0, &Reply::Crash(crash.clone()), room)
    {
        uart::send_last_words(frame.get(..=length).unwrap_or(&[]));
    }
    reboot()
}

/// Starts over, at the host's word or after a crash.
pub(crate) fn reboot() -> ! {
    board::reset()
}

/// The rehearsal of the test image: the third step panics, faults or overflows the stack, by the number of the boot.
#[cfg(feature = "crash-test")]
pub(crate) fn rehearse(boots: u32) {
    use core::sync::atomic::{AtomicU32, Ordering};
    static STEPS: AtomicU32 = AtomicU32::new(0);

    #[allow(unconditional_recursion, reason = "that is the point")]
    fn deeper(frame: [u32; 16]) -> u32 {
        let mut next = frame;
        next[0] = core::hint::black_box(frame[1]) + 1;
        deeper(core::hint::black_box(next)) + next[2]
    }

    let step = STEPS.load(Ordering::Relaxed) + 1;
    STEPS.store(step, Ordering::Relaxed);
    match (step, boots % 3) {
        (3, 1) => panic!("rehearsal"),
        // Nothing answers there, and no probe is under way.
        (3, 2) => {
            // SAFETY: the load faults and the program ends.
            unsafe { ptr::with_exposed_provenance::<u32>(0x6000_0000).read_volatile() };
        }
        (3, _) => {
            core::hint::black_box(deeper([0; 16]));
        }
        _ => {}
    }
}
