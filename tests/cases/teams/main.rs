//! Whole explorations by teams: the radio, leaving and joining, and how much faster a team is.

mod full;
mod meetings;
mod small;
