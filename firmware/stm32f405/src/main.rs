//! The image for an STM32F405.
fn main() {}
