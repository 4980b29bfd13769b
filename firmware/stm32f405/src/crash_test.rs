//! The image for the crash tests: it crashes in its third step, in a different way after each boot.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
#[path = "image/mod.rs"]
mod image;

/// Prints how to build the image.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This is firmware. Build it with:");
    println!("    rustup target add thumbv7em-none-eabihf");
    println!("    cargo image --bin fieldline-crash-test --features crash-test");
}
