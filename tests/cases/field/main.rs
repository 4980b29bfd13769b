//! The potential field of the window: laws, precision, and cycles against a solution in f64.

mod judge;
mod laws;
mod oracle;
mod precision;
mod shared;
mod window;
