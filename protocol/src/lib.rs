//! What is said between a Fieldline planner and its robot, and nothing else.
#![no_std]
#![forbid(unsafe_code)]

pub mod message;
