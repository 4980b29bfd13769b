//! A QEMU plugin: it tells the model of `fieldline-cycles` what QEMU executes.
//!
//! ```text
//! qemu-system-arm … -plugin file=libfieldline_qemu_cycles.so,steps=FILE[,profile=FILE]
//! ```
//!
//! The plugin appends to `FILE` what each step of the image took, by stage, before the image sends
//! its reply ([`StepCost::to_bytes`](fieldline_cycles::steps::StepCost::to_bytes)). The file of the
//! profile is up to date then, too ([`fieldline_cycles::profile`]). The plugin changes nothing in
//! the emulated chip: it only looks at instructions and addresses.
//!
//! QEMU calls [`api::qemu_plugin_install`] once. Then the thread of the only core, which owns the
//! model, calls three functions of `callbacks`: for each block that QEMU translates, for each block
//! that runs, and for each access to memory.
//!
//! All unsafe code is in [`api`], which has QEMU's functions, each behind one safe function.

pub mod api;
mod callbacks;
