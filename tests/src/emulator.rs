//! The image and the emulator, where they can be had.

use std::path::PathBuf;

use host_sim::link::{LinkError, image, qemu};

/// The image, if this machine can build and emulate it; else `None`, with a word on standard output.
///
/// # Panics
/// Instead of `None` where `FIELDLINE_HIL=1` says that the emulator must be there.
#[must_use]
pub fn image() -> Option<PathBuf> {
    let tried = image::image().and_then(|image| qemu::open_line(&image).map(|_| image));
    required(tried)
}

/// The image, if this machine can build it; else as [`image()`].
///
/// # Panics
/// As [`image()`].
#[must_use]
pub fn image_alone() -> Option<PathBuf> {
    required(image::image())
}

fn required(tried: Result<PathBuf, LinkError>) -> Option<PathBuf> {
    match tried {
        Ok(image) => Some(image),
        Err(error) if crate::is_set("FIELDLINE_HIL") => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}
