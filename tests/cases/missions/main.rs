//! Whole explorations of flat worlds by the usual strategy, and the links that carry them.

mod buildings;
mod corrections;
mod data;
mod disturbed;
mod endings;
mod fences;
mod full;
mod generated;
mod known_maps;
mod larger;
mod links;
mod localise;
mod localise_parts;
mod lost_device;
mod orders;
mod people;
mod periods;
mod random_missions;
mod replay;
mod robots;
mod space;
mod starts;
mod turning;
mod whole;
mod wiring;
