//! PathSearch along the skeleton: how to search one, which goal is worth its cost, whether the robot gets on with it, and what cannot
//! be driven to.
//!
//! | file | what it holds |
//! | --- | --- |
//! | [`cell_path`] | the path to the present goal, and the local goal on it |
//! | [`centres`] | queries about centre cells |
//! | [`nearest`] | the centre cell nearest to a place [Jorge15, `moveToVoronoi`] |
//! | [`search`] | a wave over centre cells and the path down it [Jorge15, `propagatePotential`] |
//! | [`frontier_path`] | the path to the frontier of the least cost |
//! | [`goal_cost`] | the delay after which a frontier cell's wave starts |
//! | [`blocked_passages`] | passages that the robot could not drive through |
//! | [`residual_frontiers`] | goals that were given up, and frontiers never reached |
//! | [`progress`] | the progress checker: a goal that comes no nearer is dropped |
//! | [`height_levels`] | how high the ground lies everywhere, and which goals are preferred for it |
//! | [`viewpoint`] | places from which the robot can look through gaps |
//! | [`map_exits`] | ways on for which the map has no room |
//! | [`breadcrumbs`] | the last metres of the robot's way |
//!
//! Units: map cells of 10 cm, coarse steps of 20 cm.

pub(crate) mod blocked_passages;
pub mod breadcrumbs;
pub mod cell_path;
pub(crate) mod centres;
pub mod context;
pub(crate) mod frontier_path;
pub(crate) mod goal_cost;
pub mod height_levels;
pub mod map_exits;
pub(crate) mod nearest;
pub(crate) mod progress;
pub(crate) mod residual_frontiers;
pub(crate) mod search;
pub mod viewpoint;

pub use cell_path::Path;
pub use context::{PlanningContext, PlanningScratch, RoundOutcome};
