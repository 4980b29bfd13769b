//! Tests of the simulator's library, in one program: a program for each file would be linked on
//! its own, which takes longer than its tests.

mod baselines;
#[path = "../drive/mod.rs"]
mod drive;
mod links;
mod particles;
mod rays;
mod robots;
mod team;
mod world_files;
