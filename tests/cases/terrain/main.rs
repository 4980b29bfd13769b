//! Whole explorations of uneven ground.

mod data;
mod drift;
mod full;
mod roll;
mod scenarios;
mod shared;
mod whole;
