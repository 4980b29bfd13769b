//! The image and the emulator, where they can be had.

use std::path::PathBuf;

use host_sim::link::{LinkError, image, qemu};

/// The image, if this machine can build and emulate it; else `None`, with a word on standard output.
///
/// # Panics
/// Instead of `None` where `FIELDLINE_HIL=1` says that the emulator must be there.
#[must_use]
pub fn image() -> Option<PathBuf> {
    available(|| {
        let image = image::image()?;
        qemu::open_line(&image).map(|_| image)
    })
}

/// The image, if this machine can build it; else as [`image()`].
///
/// # Panics
/// As [`image()`].
#[must_use]
pub fn image_alone() -> Option<PathBuf> {
    available(image::image)
}

fn available(find: impl FnOnce() -> Result<PathBuf, LinkError>) -> Option<PathBuf> {
    let wanted = std::env::var("FIELDLINE_HIL").unwrap_or_default();
    if wanted == "0" {
        println!("skipped: FIELDLINE_HIL=0");
        return None;
    }
    match find() {
        Ok(image) => Some(image),
        Err(error) if wanted == "1" => panic!("{error}"),
        Err(error) => {
            println!("skipped: {error}");
            None
        }
    }
}
