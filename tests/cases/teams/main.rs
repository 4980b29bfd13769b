//! Whole explorations by teams: the radio, leaving and joining, and how much faster a team is.

mod claims;
mod drift;
mod dropout;
mod fences;
mod full;
mod meetings;
mod slam;
mod small;
