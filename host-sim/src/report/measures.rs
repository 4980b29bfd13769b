//! What was measured of a run in the true world: ground known, loops, patrol, contacts, map.

use serde::{Deserialize, Serialize};

/// Ground known, as a share of the ground that a disc of the robot's radius can see from where it
/// can go.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Coverage {
    /// `known_m2 / explorable_m2`, at most 1.
    pub fraction: f64,
    /// Area known at the end, of the explorable.
    pub known_m2: f64,
    /// Area that can be seen; in an uneven world the area that the robot can cover.
    pub explorable_m2: f64,
    /// First time at which the fraction was 0.90.
    pub t90_s: Option<f64>,
    /// First time at which the fraction was 0.95.
    pub t95_s: Option<f64>,
    /// First time at which the fraction was 0.99.
    pub t99_s: Option<f64>,
}

/// Loops of the world that the robot drove, judged on its true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Loops {
    /// Islands of the world with a way round them of at least 10 m.
    pub islands: u32,
    /// Islands that the robot drove round completely.
    pub circled: u32,
}

/// Ages of the rails on a patrol, judged on the true path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Patrol {
    /// Longest time for which a rail was not visited, seconds.
    pub max_rail_age_s: f64,
    /// Mean over all rails and steps, seconds.
    pub mean_rail_age_s: f64,
}

/// Contacts of the true footprint with the true world.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Safety {
    /// Number of times that the footprint began to touch an obstacle.
    pub collisions: u32,
    /// Number of times that a wheel lost the ground.
    pub falls: u32,
    /// Number of times that the robot tipped over.
    pub tips: u32,
    /// Least distance from the footprint to an obstacle.
    pub min_clearance_m: Option<f64>,
    /// Number of times that two robots of a team began to touch; the key is missing for a robot
    /// alone.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot_contacts: Option<u32>,
    /// Number of times that the robot began to touch a person; the key is missing without people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub person_contacts: Option<u32>,
    /// Least distance from the footprint to a person, at most 1 m; the key is missing without
    /// people.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub min_person_gap_m: Option<f64>,
}

/// The map's obstacle cells against the true surfaces, after the best rigid alignment of the map.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MapErrors {
    /// Distance of an obstacle cell to a true surface; `null` for a map without obstacles.
    pub wall_error_m: Option<WallError>,
    /// Share of the obstacle cells farther than 0.3 m from every true surface.
    pub ghost_share: f64,
    /// Share of the true walls around the floor that have an obstacle cell within 0.3 m.
    #[serde(default)]
    pub walls_share: Option<f64>,
    /// Known area, in per cent of what a whole exploration at the true poses makes of the same
    /// scans. A map that is folded over itself has less, and one that has a place twice has more.
    #[serde(default)]
    pub area_percent: Option<f64>,
}

/// Percentiles of the distance of an obstacle cell to a true surface.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct WallError {
    /// The median.
    pub p50: f64,
    /// 95 of 100 cells are at or below it.
    pub p95: f64,
}
