//! What a step costs, measured by the board.

/// A counter of instructions and a mark of the deepest stack.
pub trait Meter {
    /// A step begins.
    fn start(&mut self);
    /// The step ended: instructions since [`Meter::start`], or whatever the board counts and documents; 0 where it counts nothing.
    fn stop(&mut self) -> u32;
    /// Deepest stack since boot, bytes; 0 where it is not known.
    fn stack_bytes(&self) -> u32;
}

/// Measures nothing.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoMeter;

impl Meter for NoMeter {
    fn start(&mut self) {}

    fn stop(&mut self) -> u32 {
        0
    }

    fn stack_bytes(&self) -> u32 {
        0
    }
}
