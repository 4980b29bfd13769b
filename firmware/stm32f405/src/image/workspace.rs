//! Where the planner's scratch lies: in the chip's core-coupled memory, or in QEMU 7.2's extra SRAM.
//!
//! The chip has 64 KB at `0x1000_0000`. QEMU 7.2's model has no such memory but 192 KB of SRAM where the chip has 128; newer models
//! have what the chip has. One image serves all: it reads a word at each place and takes the first that answers. A read of nothing
//! is a bus fault, which `crash.rs` turns into "no".

use core::mem::{MaybeUninit, align_of, size_of};
use core::ptr;

use fieldline_planner::Workspace;

use super::crash;

/// Core-coupled memory.
const CCM: usize = 0x1000_0000;
/// What follows the chip's SRAM in QEMU 7.2.
const EXTRA_SRAM: usize = 0x2002_0000;
/// Bytes at either place.
const ROOM: usize = 64 * 1024;
const _: () = assert!(size_of::<Workspace>() <= ROOM && align_of::<Workspace>() <= 8);

/// The workspace, cleared. Called once.
///
/// # Panics
/// Where neither place has memory: that is no STM32F405.
pub(crate) fn place() -> &'static mut Workspace {
    let answers = |place: &usize| crash::answers(*place) && crash::answers(*place + ROOM - 4);
    let Some(place) = [CCM, EXTRA_SRAM].into_iter().find(answers) else {
        panic!("no memory for the workspace");
    };
    let workspace = ptr::without_provenance_mut::<MaybeUninit<Workspace>>(place);
    // SAFETY: there are 64 KB at `place` (both ends answered), enough and aligned for a workspace (asserted above); the linker puts nothing
    // there (memory.x), and this is called once, so the reference is unique. What is written is a valid workspace.
    let place = unsafe { &mut *workspace };
    clear(place)
}

#[inline(never)]
fn clear(place: &mut MaybeUninit<Workspace>) -> &mut Workspace {
    place.write(Workspace::new())
}
