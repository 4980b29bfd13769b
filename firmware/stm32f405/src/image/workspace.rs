//! Memory of the planner's workspace: the chip's core-coupled memory, or the extra SRAM of QEMU
//! 7.2.
//!
//! The chip has 64 KB at `0x1000_0000`. The model in QEMU 7.2 has no such memory; it has 192 KB of
//! SRAM where the chip has 128 KB. Newer models are like the chip. One image runs on all of them:
//! it reads a word at each address and uses the first that has memory. Reading an address without
//! memory is a bus fault, which `crash.rs` turns into "no".

use core::mem::{MaybeUninit, align_of, size_of};
use core::ptr;

use fieldline_planner::Workspace;

use super::crash;

/// Start of the core-coupled memory.
const CCM: usize = 0x1000_0000;
/// Start of the memory behind the chip's SRAM in QEMU 7.2.
const EXTRA_SRAM: usize = 0x2002_0000;
/// Size of the memory at either address, bytes.
const SIZE: usize = 64 * 1024;
const _: () = assert!(size_of::<Workspace>() <= SIZE && align_of::<Workspace>() <= 8);

/// Returns the cleared workspace. Called once.
///
/// # Panics
/// If neither address has memory: the chip is then no STM32F405.
pub(crate) fn init() -> &'static mut Workspace {
    let has_memory = |start: &usize| crash::can_read(*start) && crash::can_read(*start + SIZE - 4);
    let Some(start) = [CCM, EXTRA_SRAM].into_iter().find(has_memory) else {
        panic!("no memory for the workspace");
    };
    let workspace = ptr::without_provenance_mut::<MaybeUninit<Workspace>>(start);
    // SAFETY: there are 64 KB at `start` (both ends can be read), enough and aligned for a
    // workspace (asserted above). The linker puts nothing there (memory.x), and this is called
    // once, so the reference is unique. `clear` writes a valid workspace.
    let memory = unsafe { &mut *workspace };
    clear(memory)
}

/// Writes an empty workspace. Not inlined: the value must not stay on the stack of `main`.
#[inline(never)]
fn clear(memory: &mut MaybeUninit<Workspace>) -> &mut Workspace {
    memory.write(Workspace::new())
}
