//! People who walk about in a flat world.
//!
//! | file | holds |
//! | --- | --- |
//! | `person` | one person: its cylinder, its walk, its goals |
//!
//! They begin at random places, not near the robot, and walk on the floor that a person reaches
//! from the robot's start. Each chooses goals in sight at random. They stop before they touch the
//! robot. If the two touch, the robot did it.

mod person;

use crate::metrics::CellSet;
use crate::robot::{FARTHEST_M, Footprint, Noise, Pose, Source};
use crate::world::{GridCell, Ray, Start, World, WorldError};
use person::Company;
pub use person::{KEEP_M, Person, RADIUS_M};

/// Most people of a world.
pub const MOST: usize = 50;
/// Least gap between people, and to the robot, at the beginning, metres.
const APART_M: f64 = 0.8;

/// The people of a run.
#[derive(Clone, Debug)]
pub struct People {
    all: Vec<Person>,
    /// Where they walk.
    ground: Option<CellSet>,
    random: Noise,
}

impl People {
    /// Returns nobody.
    #[must_use]
    pub fn none(seed: u64) -> Self {
        Self {
            all: Vec::new(),
            ground: None,
            random: Noise::new(seed, Source::People),
        }
    }

    /// Returns `count` people at random places.
    ///
    /// # Errors
    /// [`WorldError::People`] if there is no room for them, or the world is not flat.
    pub fn new(
        world: &World,
        start: Start,
        robot: (&Footprint, &Pose),
        (count, seed): (usize, u64),
    ) -> Result<Self, WorldError> {
        let mut people = Self::none(seed);
        if count == 0 {
            return Ok(people);
        }
        let refuse = |reason: String| WorldError::People {
            world: world.name().to_owned(),
            reason,
        };
        if world.elevation().is_some() {
            let reason = "people walk on level floors only; leave --people out";
            return Err(refuse(reason.to_owned()));
        }
        let ground = CellSet::reach(world, start, RADIUS_M);
        let mut places = places(world, &ground);
        while people.all.len() < count && !places.is_empty() {
            let pick = (people.random.uniform() * places.len() as f64) as usize;
            let at_m = places.swap_remove(pick);
            let others = people.places();
            let company = Company {
                robot,
                people: &others,
            };
            if company.gap_m(at_m) >= APART_M {
                people.all.push(Person::standing(at_m));
            }
        }
        if people.all.len() < count {
            let room = people.all.len();
            return Err(refuse(format!(
                "there is room for {room} people, and {count} were asked for; lower --people"
            )));
        }
        people.ground = Some(ground);
        Ok(people)
    }

    /// Returns all people.
    #[must_use]
    pub fn all(&self) -> &[Person] {
        &self.all
    }

    fn places(&self) -> Vec<[f64; 2]> {
        self.all.iter().map(Person::at_m).collect()
    }

    /// Lets all people walk for some seconds, one after another.
    pub fn walk(&mut self, world: &World, robot: (&Footprint, &Pose), seconds: f64) {
        let Some(ground) = &self.ground else {
            return;
        };
        let mut places = self.places();
        for (index, person) in self.all.iter_mut().enumerate() {
            if person.wants_goal() {
                person.choose(world, ground, &mut self.random);
            }
            // A person keeps no distance from itself.
            places[index] = [f64::INFINITY; 2];
            let company = Company {
                robot,
                people: &places,
            };
            person.walk(&company, seconds);
            places[index] = person.at_m();
        }
    }

    /// Returns the metres along a ray to the nearest person within `limit_m`.
    #[must_use]
    pub fn cast(&self, world: &World, ray: &Ray, limit_m: f64) -> Option<f64> {
        let hits = self.all.iter();
        let hits = hits.filter_map(|person| person.cast(world, ray, limit_m));
        hits.min_by(f64::total_cmp)
    }

    /// Returns the least gap from a hull at a pose, 0 if it overlaps somebody, at most
    /// [`FARTHEST_M`].
    #[must_use]
    pub fn gap_m(&self, footprint: &Footprint, pose: &Pose) -> f64 {
        let gaps_m = self.all.iter().map(|person| person.gap_m(footprint, pose));
        gaps_m.fold(FARTHEST_M, f64::min)
    }
}

/// Returns the middles of all cells of the ground, row by row.
fn places(world: &World, ground: &CellSet) -> Vec<[f64; 2]> {
    let grid = world.occupancy();
    let rows = 0..grid.height() as i64;
    let cells = rows.flat_map(|j| (0..grid.width() as i64).map(move |i| GridCell { i, j }));
    let within = cells.filter(|cell| ground.contains(*cell));
    within.map(|cell| grid.centre(cell)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const HULL: Footprint = Footprint::PIONEER_3AT;

    fn office(count: usize, seed: u64) -> (World, Pose, People) {
        let world = World::builtin("office").expect("built in");
        let start = world.starts()[0];
        let pose = start.pose();
        let people = People::new(&world, start, (&HULL, &pose), (count, seed));
        let people = people.expect("there is room");
        (world, pose, people)
    }

    #[test]
    fn people_walk_and_touch_neither_walls_nor_each_other_nor_a_robot_that_stands() {
        let (world, pose, mut people) = office(12, 4);
        let before = people.places();
        for _ in 0..6_000 {
            people.walk(&world, (&HULL, &pose), 0.01);
            assert!(people.gap_m(&HULL, &pose) > 0.0);
        }
        for person in people.all() {
            let [x, y] = person.at_m();
            let cell = world.occupancy().cell_at(x, y);
            assert!(world.distance().from_centre_m(cell) >= RADIUS_M - 1e-9);
            let near = people.all().iter().filter(|other| {
                let [dx, dy] = [other.at_m()[0] - x, other.at_m()[1] - y];
                dx.hypot(dy) < 2.0 * RADIUS_M
            });
            assert_eq!(near.count(), 1, "only itself");
        }
        let walked = |k: usize| {
            let [from, to] = [before[k], people.places()[k]];
            (to[0] - from[0]).hypot(to[1] - from[1])
        };
        let movers = (0..12).filter(|k| walked(*k) > 1.0).count();
        assert!(
            movers >= 8,
            "{movers} of 12 are more than 1 m from their start"
        );
    }

    #[test]
    fn the_same_seed_gives_the_same_people() {
        let after = |seed| {
            let (world, pose, mut people) = office(5, seed);
            for _ in 0..2_000 {
                people.walk(&world, (&HULL, &pose), 0.01);
            }
            people.places()
        };
        assert_eq!(after(1), after(1));
        assert_ne!(after(1), after(2));
    }

    #[test]
    fn too_many_people_and_uneven_ground_are_refused() {
        let refused = |world: &str, count| {
            let world = World::builtin(world).expect("built in");
            let start = world.starts()[0];
            let pose = start.pose();
            let people = People::new(&world, start, (&HULL, &pose), (count, 1));
            people.expect_err("refused").to_string()
        };
        let error = refused("boxed-in", 50);
        assert!(error.starts_with("boxed-in: there is room for "), "{error}");
        let error = refused("slope", 1);
        assert!(error.contains("level floors only"), "{error}");
    }
}
