//! Starts of a team: side by side around one start of the world, or far apart.
//!
//! *Side by side*: the first robot stands at the world's start. Each other one stands at the place
//! nearest to it where it fits, has [`WALL_M`] to every wall, and can turn on the spot beside the
//! others. All face the same way. *Apart*: the next robot takes the start of the world that is
//! farthest from all robots so far; if the world has too few starts, the farthest place of a
//! lattice where it can turn on the spot. Only places that the first robot can reach count, and
//! only those where bounds and no-go polygons let a robot stand. Metres.

use crate::metrics::CellSet;
use crate::robot::Pose;
use crate::sim::{SimConfig, Simulator};
use crate::world::{Start, World, WorldError};

/// Distance between two robots that turn on the spot side by side, metres.
const BETWEEN_M: f64 = 0.10;
/// Distance to walls, metres.
const WALL_M: f64 = 0.10;
/// Step of the lattice of places side by side, metres.
const NEAR_STEP_M: f64 = 0.1;
/// Greatest distance of a robot from the first one along x and y, metres.
const NEAR_M: f64 = 6.0;
/// Step of the lattice of places apart, metres.
const FAR_STEP_M: f64 = 0.5;

/// Places for robots in a world.
pub(super) struct Places<'w> {
    world: &'w World,
    config: SimConfig,
    first: Start,
    reach: CellSet,
    taken: Vec<Start>,
}

impl<'w> Places<'w> {
    /// Puts the first robot at the configured start.
    ///
    /// # Errors
    /// As [`WorldError::Start`].
    pub(super) fn new(world: &'w World, config: SimConfig) -> Result<Self, WorldError> {
        let first = Simulator::new(world, config.clone())?.start();
        Ok(Self {
            world,
            first,
            reach: CellSet::reach(world, first, config.radius_m),
            taken: vec![first],
            config,
        })
    }

    /// Returns the starts of `robots` side by side; fewer if no more fit.
    pub(super) fn side_by_side(mut self, robots: usize) -> Vec<Start> {
        let steps = (NEAR_M / NEAR_STEP_M) as i32;
        let lattice = (-steps..=steps).flat_map(|j| (-steps..=steps).map(move |i| [i, j]));
        let mut places: Vec<[i32; 2]> = lattice.collect();
        // Stable: of places as near as each other the order is that of the lattice.
        places.sort_by_key(|[i, j]| i * i + j * j);
        for [i, j] in places {
            if self.taken.len() >= robots {
                break;
            }
            let start = Start {
                x_m: self.first.x_m + f64::from(i) * NEAR_STEP_M,
                y_m: self.first.y_m + f64::from(j) * NEAR_STEP_M,
                ..self.first
            };
            if self.has_room(start) {
                self.taken.push(start);
            }
        }
        self.taken.truncate(robots);
        self.taken
    }

    /// Returns the starts of `robots` far apart; fewer if no more fit.
    pub(super) fn apart(mut self, robots: usize) -> Vec<Start> {
        let of_world = self.world.starts().to_vec();
        let of_lattice: Vec<Start> = self.lattice();
        for candidates in [of_world, of_lattice] {
            while self.taken.len() < robots {
                let fitting = candidates.iter().filter(|start| self.has_room(**start));
                let farthest = fitting.max_by(|a, b| self.off_m(a).total_cmp(&self.off_m(b)));
                let Some(start) = farthest else { break };
                self.taken.push(*start);
            }
        }
        self.taken.truncate(robots);
        self.taken
    }

    /// Reachable places, [`FAR_STEP_M`] from each other.
    fn lattice(&self) -> Vec<Start> {
        let [across_m, up_m] = self.world.size_m();
        let [x0, y0] = self.world.occupancy().origin_m();
        let steps = |size_m: f64| 1..(size_m / FAR_STEP_M) as u32;
        let place = |[i, j]: [u32; 2]| Start {
            x_m: x0 + f64::from(i) * FAR_STEP_M,
            y_m: y0 + f64::from(j) * FAR_STEP_M,
            ..self.first
        };
        let cells = steps(up_m).flat_map(|j| steps(across_m).map(move |i| [i, j]));
        // A robot does not see what is behind it, so it must be able to turn.
        let fits = |start: &Start| {
            let footprint = &self.config.footprint;
            self.reaches(start) && footprint.can_turn(self.world, &start.pose())
        };
        cells.map(place).filter(fits).collect()
    }

    fn reaches(&self, start: &Start) -> bool {
        let cell = self.world.occupancy().cell_at(start.x_m, start.y_m);
        self.reach.contains(cell)
    }

    /// Distance to the nearest robot so far, metres.
    fn off_m(&self, start: &Start) -> f64 {
        let pose: Pose = start.pose();
        let taken = self
            .taken
            .iter()
            .map(|taken| pose.distance_m(&taken.pose()));
        taken.fold(f64::INFINITY, f64::min)
    }

    fn has_room(&self, start: Start) -> bool {
        let footprint = &self.config.footprint;
        let config = SimConfig {
            place: Some(start),
            ..self.config.clone()
        };
        self.off_m(&start) >= 2.0 * footprint.circumradius_m() + BETWEEN_M
            && self.reaches(&start)
            && self.world.clearance_m(footprint, start) >= WALL_M
            && self
                .config
                .fence
                .check_start(footprint, &start.pose())
                .is_ok()
            && Simulator::new(self.world, config).is_ok()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::distance_m;

    fn places<'w>(world: &'w World, start: usize) -> Places<'w> {
        let config = SimConfig {
            start,
            ..SimConfig::default()
        };
        Places::new(world, config).expect("fits")
    }

    fn least_m(starts: &[Start]) -> f64 {
        let at = |start: &Start| [start.x_m, start.y_m];
        let pairs = (0..starts.len()).flat_map(|a| (0..a).map(move |b| [a, b]));
        let gaps = pairs.map(|[a, b]| distance_m(at(&starts[a]), at(&starts[b])));
        gaps.fold(f64::INFINITY, f64::min)
    }

    #[test]
    fn eight_robots_fit_side_by_side_in_every_flat_world() {
        for name in ["office", "hall", "cave", "loop"] {
            let world = World::builtin(name).expect("built in");
            let starts = places(&world, 0).side_by_side(8);
            assert_eq!((starts.len(), starts[0]), (8, world.starts()[0]), "{name}");
            let least = least_m(&starts);
            assert!((0.81..1.0).contains(&least), "{name}: {least}");
            let first = [starts[0].x_m, starts[0].y_m];
            let far = starts.iter().map(|s| distance_m(first, [s.x_m, s.y_m]));
            assert!(far.fold(0.0, f64::max) < 5.0, "{name}");
        }
    }

    #[test]
    fn robots_apart_take_the_worlds_starts_and_then_far_places() {
        let world = World::builtin("office").expect("built in");
        let (near, far) = (
            places(&world, 0).side_by_side(4),
            places(&world, 0).apart(4),
        );
        assert_eq!((far.len(), far[0]), (4, world.starts()[0]));
        assert!(least_m(&far) > 4.0 * least_m(&near), "{}", least_m(&far));
        assert_eq!(places(&world, 0).apart(8).len(), 8);
    }

    #[test]
    fn far_places_have_room_for_a_turn() {
        let world = World::builtin("cluttered").expect("built in");
        let places = places(&world, 0);
        let lattice = places.lattice();
        assert!(lattice.len() > 50, "{}", lattice.len());
        for place in lattice {
            let turned = (0..360).map(|degrees| Start {
                yaw_rad: f64::from(degrees).to_radians(),
                ..place
            });
            let clearances = turned.map(|it| world.clearance_m(&places.config.footprint, it));
            let least = clearances.fold(f64::INFINITY, f64::min);
            assert!(least > 0.0, "{place:?}");
        }
    }

    #[test]
    fn a_world_without_room_has_fewer_starts() {
        let world = World::builtin("boxed-in").expect("built in");
        assert!(places(&world, 0).side_by_side(8).len() < 8);
    }
}
