//! The image for an STM32F405. On a host the program prints how to build it.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image;

/// Prints how to build the image.
#[cfg(not(target_os = "none"))]
fn main() {
    println!("This is firmware. Build it with:");
    println!("    rustup target add thumbv7em-none-eabihf");
    println!("    cargo image");
    println!("firmware/README.md says how to flash it.");
}
