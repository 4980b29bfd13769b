//! QEMU's plugin functions (`include/qemu/qemu-plugin.h`), as far as this plugin uses them.
//!
//! | QEMU | versions that it loads | bytes of an instruction |
//! | --- | --- | --- |
//! | 7.2 to 8.2 | 0 to 1 | a pointer |
//! | 9.0 | 2 | a pointer |
//! | 9.1 to 10 | 2 to 3 and later | copied into a buffer |
//!
//! So the plugin says version 1 or, with feature `qemu-9`, version 2. How the bytes come is decided
//! by the version that QEMU reports when it loads the plugin.

use core::ffi::{CStr, c_char, c_int, c_uint, c_void};
use core::marker::PhantomData;
use core::mem;
use core::sync::atomic::{AtomicBool, Ordering};

use crate::callbacks;

/// The version that QEMU compares with its own.
#[unsafe(no_mangle)]
#[allow(non_upper_case_globals, reason = "QEMU's name")]
pub static qemu_plugin_version: c_int = if cfg!(feature = "qemu-9") { 2 } else { 1 };

/// From this version on QEMU copies the bytes of an instruction.
const COPIES: c_int = 3;
static QEMU_COPIES: AtomicBool = AtomicBool::new(false);

/// The start of QEMU's `qemu_info_t`.
#[repr(C)]
#[derive(Debug)]
pub struct Info {
    target_name: *const c_char,
    least_version: c_int,
    version: c_int,
}

/// A block that QEMU translates.
#[repr(C)]
struct RawBlock([u8; 0]);

/// An instruction of it.
#[repr(C)]
struct RawInstruction([u8; 0]);

type OnTranslation = extern "C" fn(u64, *mut RawBlock);
type OnExecution = extern "C" fn(c_uint, *mut c_void);
type OnAccess = extern "C" fn(c_uint, u32, u64, *mut c_void);

/// The callbacks read no registers.
const NO_REGISTERS: c_int = 0;
/// The callback is for loads and stores.
const LOADS_AND_STORES: c_int = 3;

unsafe extern "C" {
    fn qemu_plugin_register_vcpu_tb_trans_cb(id: u64, callback: OnTranslation);
    fn qemu_plugin_register_vcpu_tb_exec_cb(
        block: *mut RawBlock,
        callback: OnExecution,
        flags: c_int,
        data: *mut c_void,
    );
    fn qemu_plugin_register_vcpu_mem_cb(
        instruction: *mut RawInstruction,
        callback: OnAccess,
        flags: c_int,
        which: c_int,
        data: *mut c_void,
    );
    fn qemu_plugin_tb_n_insns(block: *const RawBlock) -> usize;
    fn qemu_plugin_tb_vaddr(block: *const RawBlock) -> u64;
    fn qemu_plugin_tb_get_insn(block: *const RawBlock, index: usize) -> *mut RawInstruction;
    /// With a buffer and its length from version 3 on, and without before.
    fn qemu_plugin_insn_data(instruction: *const RawInstruction) -> *const c_void;
    fn qemu_plugin_insn_size(instruction: *const RawInstruction) -> usize;
    safe fn qemu_plugin_mem_size_shift(info: u32) -> c_uint;
    safe fn qemu_plugin_mem_is_store(info: u32) -> bool;
}

/// [`qemu_plugin_insn_data`] from version 3 on.
type CopyData = unsafe extern "C" fn(*const RawInstruction, *mut u8, usize) -> usize;

/// A block that is being translated.
#[derive(Debug)]
pub(crate) struct Translation<'a> {
    block: *mut RawBlock,
    during: PhantomData<&'a ()>,
}

impl Translation<'_> {
    /// Returns the address of its first instruction.
    pub(crate) fn address(&self) -> u32 {
        // SAFETY: QEMU's handle is valid during the callback, which `self` does not outlive.
        unsafe { qemu_plugin_tb_vaddr(self.block) as u32 }
    }

    /// Returns the number of its instructions.
    pub(crate) fn len(&self) -> usize {
        // SAFETY: as in `address`.
        unsafe { qemu_plugin_tb_n_insns(self.block) }
    }

    fn instruction(&self, index: usize) -> Option<*mut RawInstruction> {
        // SAFETY: as in `address`; the index is one of the block's.
        let found =
            (index < self.len()).then(|| unsafe { qemu_plugin_tb_get_insn(self.block, index) });
        found.filter(|it| !it.is_null())
    }

    /// Returns the first four bytes of an instruction, or zeros behind fewer.
    pub(crate) fn code(&self, index: usize) -> [u8; 4] {
        let mut code = [0; 4];
        let Some(instruction) = self.instruction(index) else {
            return code;
        };
        if QEMU_COPIES.load(Ordering::Relaxed) {
            // SAFETY: from version 3 on the function has this signature.
            let copy = unsafe {
                mem::transmute::<*const c_void, CopyData>(qemu_plugin_insn_data as *const c_void)
            };
            // SAFETY: QEMU writes at most the four bytes of the buffer.
            unsafe { copy(instruction, code.as_mut_ptr(), code.len()) };
            return code;
        }
        // SAFETY: the handle is valid, and QEMU owns the bytes during the callback.
        let bytes = unsafe {
            let data = qemu_plugin_insn_data(instruction).cast::<u8>();
            let size = qemu_plugin_insn_size(instruction).min(code.len());
            core::slice::from_raw_parts(data, size)
        };
        code[..bytes.len()].copy_from_slice(bytes);
        code
    }

    /// Asks for a call of [`callbacks::executed`] whenever the block runs.
    pub(crate) fn on_execution(&self, data: usize) {
        let data = core::ptr::without_provenance_mut(data);
        // SAFETY: as in `address`. The data is a number, which nobody reads as a pointer.
        unsafe { qemu_plugin_register_vcpu_tb_exec_cb(self.block, executed, NO_REGISTERS, data) };
    }

    /// Asks for a call of [`callbacks::accessed`] whenever an instruction accesses memory.
    pub(crate) fn on_access(&self, index: usize, data: usize) {
        let Some(instruction) = self.instruction(index) else {
            return;
        };
        let data = core::ptr::without_provenance_mut(data);
        // SAFETY: as in `on_execution`.
        unsafe {
            let (flags, which) = (NO_REGISTERS, LOADS_AND_STORES);
            qemu_plugin_register_vcpu_mem_cb(instruction, accessed, flags, which, data);
        }
    }
}

extern "C" fn translated(_: u64, block: *mut RawBlock) {
    callbacks::translated(&Translation {
        block,
        during: PhantomData,
    });
}

extern "C" fn executed(_: c_uint, data: *mut c_void) {
    callbacks::executed(data.addr());
}

extern "C" fn accessed(_: c_uint, info: u32, address: u64, data: *mut c_void) {
    let size = qemu_plugin_mem_size_shift(info);
    let store = qemu_plugin_mem_is_store(info);
    callbacks::accessed(data.addr(), address as u32, size, store);
}

/// Loads the plugin. Returns 0, or 1 if an argument is wrong; the message then says which.
///
/// # Safety
/// Only QEMU calls it: `info` is valid, and `arguments` has `count` strings.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn qemu_plugin_install(
    id: u64,
    info: *const Info,
    count: c_int,
    arguments: *const *const c_char,
) -> c_int {
    // SAFETY: as this function demands.
    let (version, arguments) = unsafe {
        let text = |i| {
            CStr::from_ptr(*arguments.add(i))
                .to_string_lossy()
                .into_owned()
        };
        let arguments: Vec<String> = (0..count.max(0) as usize).map(text).collect();
        ((*info).version, arguments)
    };
    QEMU_COPIES.store(version >= COPIES, Ordering::Relaxed);
    if let Err(error) = callbacks::set_up(&arguments) {
        eprintln!("qemu-cycles: {error}");
        return 1;
    }
    // SAFETY: `id` is the one that QEMU gave; the callback is a function of this library.
    unsafe { qemu_plugin_register_vcpu_tb_trans_cb(id, translated) };
    0
}
