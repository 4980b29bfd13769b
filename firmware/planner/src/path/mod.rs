//! Paths along the skeleton: how to search for one, which goal is worth its cost, whether the robot
//! makes progress, and what it cannot drive to.
//!
//! | file | what it holds |
//! | --- | --- |
//! | [`context`] | the inputs of a planning round, its scratch memory, and its outcome |
//! | [`cell_path`] | the path to the present goal, and the cells on it that may be the local goal |
//! | [`open_stretch`] | how far the local grid leads along the path: its last cell is the goal |
//! | [`nearest`], [`centres`] | centre cells: the nearest to a place, by place, by map class |
//! | [`search`] | a wave over centre cells and the path down it |
//! | [`robot_wave`] | a wave from the robot over centre cells, and the paths back to it |
//! | [`ways_back`] | the first cell near the robot on the ways back from its goals |
//! | [`candidates`] | frontier cells near each other, in lent memory |
//! | [`goal_choice`] | the frontier of the greatest utility, and if it is worth the trip |
//! | [`shared_trip`] | goals that are worth a trip together only |
//! | [`claims`] | goals that another robot is nearer to |
//! | [`gain`], [`rays`] | what a robot at a goal would see |
//! | [`utility`] | what a trip gains for what it costs |
//! | [`goal_level`] | the level of a goal, which counts as way |
//! | [`level_path`] | the path to a goal that stays on its level |
//! | [`height_levels`] | the height of the ground, and the level of goals |
//! | [`progress`] | the progress checker: when to give up a goal or block a passage |
//! | [`blocked_passages`] | passages that the robot could not drive through |
//! | [`residual_frontiers`] | goals that were given up, and frontiers never reached |
//! | [`second_look`] | whether what no path led to is tried again at the end |
//! | [`viewpoint`] | places from which the robot can see through gaps |
//! | [`map_exits`] | reachable places beyond which the map has no room |
//! | [`breadcrumbs`] | the last metres of the robot's way |
//!
//! Units: map cells of 10 cm, coarse steps of 20 cm.

pub(crate) mod blocked_passages;
pub(crate) mod breadcrumbs;
pub(crate) mod candidates;
pub(crate) mod cell_path;
pub(crate) mod centres;
pub(crate) mod claims;
pub(crate) mod context;
pub(crate) mod gain;
pub(crate) mod goal_choice;
pub(crate) mod goal_level;
pub(crate) mod height_levels;
pub(crate) mod level_path;
pub(crate) mod map_exits;
pub(crate) mod nearest;
pub(crate) mod open_stretch;
pub(crate) mod progress;
pub(crate) mod rays;
pub(crate) mod residual_frontiers;
pub(crate) mod robot_wave;
pub(crate) mod search;
pub(crate) mod second_look;
pub(crate) mod shared_trip;
pub(crate) mod utility;
pub(crate) mod viewpoint;
pub(crate) mod ways_back;

pub use cell_path::Path;
pub(crate) use context::{PlanningContext, PlanningScratch, RoundOutcome};
