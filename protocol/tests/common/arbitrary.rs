//! Proptest strategies for arbitrary messages, by their kind.

pub(crate) mod replies;
pub(crate) mod requests;
mod team;

use fieldline_protocol::message::{Pose, Twist};
use fixed::types::{I4F12, I16F16};
use proptest::prelude::*;

fn long() -> impl Strategy<Value = I16F16> {
    any::<i32>().prop_map(I16F16::from_bits)
}

fn short() -> impl Strategy<Value = I4F12> {
    any::<i16>().prop_map(I4F12::from_bits)
}

fn list<T: core::fmt::Debug, const N: usize>(
    item: impl Strategy<Value = T>,
) -> impl Strategy<Value = heapless::Vec<T, N>> {
    prop::collection::vec(item, 0..=N).prop_map(|items| items.into_iter().collect())
}

fn text<const N: usize>() -> impl Strategy<Value = heapless::String<N>> {
    "[ -~é]{0,12}".prop_map(|text| {
        let mut short = heapless::String::new();
        for letter in text.chars() {
            let _ = short.push(letter);
        }
        short
    })
}

fn twist() -> impl Strategy<Value = Twist> {
    (short(), short()).prop_map(|(linear, angular)| Twist { linear, angular })
}

fn pose() -> impl Strategy<Value = Pose> {
    (long(), long(), long(), long(), long(), long()).prop_map(|(x, y, z, roll, pitch, yaw)| Pose {
        x,
        y,
        z,
        roll,
        pitch,
        yaw,
    })
}
