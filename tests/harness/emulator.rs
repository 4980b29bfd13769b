//! The image for the chip, built by cargo, and QEMU, which runs it.
//!
//! Cases that call these functions are `#[ignore]`d: not every machine has the chip's target and
//! QEMU.

use std::path::{Path, PathBuf};

use host_sim::link::endpoint::{Endpoint, RetryPolicy};
use host_sim::link::qemu::{self, QemuLine};
use host_sim::link::{LinkError, cycles, image};

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

/// As [`chip`], with the plugin that counts cycles.
///
/// # Panics
/// If QEMU cannot be started, or the plugin cannot be built or loaded.
#[must_use]
pub fn watched_chip(image: &Path) -> Endpoint<QemuLine> {
    profiled_chip(image, None)
}

/// As [`watched_chip`], with a file for a profile.
///
/// # Panics
/// As [`watched_chip`].
#[must_use]
pub fn profiled_chip(image: &Path, profile: Option<&Path>) -> Endpoint<QemuLine> {
    let plugin = expect(cycles::plugin());
    let line = qemu::open_watched(image, plugin, profile);
    Endpoint::new(expect(line), RetryPolicy::LOCKSTEP, 1)
}

fn expect<T>(found: Result<T, LinkError>) -> T {
    match found {
        Ok(found) => found,
        Err(error) => panic!("{error}"),
    }
}
