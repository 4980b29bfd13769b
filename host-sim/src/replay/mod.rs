//! Recorded logs: what a CARMEN log holds, and how far poses are from known relations.

pub mod carmen;
pub mod relations;
