//! Whole explorations of uneven ground.

mod data;
mod full;
mod roll;
mod scenarios;
mod shared;
mod whole;
