//! The image for the chip, built by cargo, and QEMU, which runs it.
//!
//! Cases that call these functions are `#[ignore]`d: not every machine has the chip's target and
//! QEMU.

use std::path::{Path, PathBuf};

use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::qemu::{self, QemuLine};
use host_sim::link::{LinkError, image};

/// Builds the image.
///
/// # Panics
/// If this machine cannot build it. The message says what to install.
#[must_use]
pub fn image() -> PathBuf {
    expect(image::image())
}

/// Starts the image in QEMU; returns the link to it.
///
/// # Panics
/// If QEMU cannot be started. The message says what to install.
#[must_use]
pub fn chip(image: &Path) -> Endpoint<QemuLine> {
    Endpoint::new(expect(qemu::open_line(image)), RetryPolicy::LOCKSTEP, 1)
}

fn expect<T>(found: Result<T, LinkError>) -> T {
    match found {
        Ok(found) => found,
        Err(error) => panic!("{error}"),
    }
}
