//! The host's copy of the planner's map, made from the same observations.
//!
//! The planner is deterministic, so the copy equals the device's map at every step and nothing need
//! be read over the wire. At the end of a run it is compared with the device's tiles, cell for
//! cell.

use std::collections::BTreeMap;

use fieldline_device::{SLOTS, TILES, convert};
use fieldline_planner::Input;
use fieldline_planner::config::{Config, Tuning};
use fieldline_planner::geometry::{Cell, MapFromOdom, MapPose, OdomPose, Pose};
use fieldline_planner::localise::Localiser;
use fieldline_planner::map::{Class, Map};
use fieldline_planner::math;
use fieldline_planner::planner::recall::Surroundings;
use fieldline_protocol::message::{Finish, Observation, Recall, Start, Status, Tile};

use super::at_once::AtOnce;
use super::relief::Relief;
use super::snapshot::Window;
use crate::link::correction::{Classes, CorrectedTile, MapCorrection, Motion};

/// Cells along a tile's side, and the side of a cell in metres.
const TILE_CELLS: i32 = 32;
const CELL_M: f32 = 0.1;

/// The copy of a device's map.
#[derive(Debug)]
pub struct Mirror {
    /// `None` if the device refuses the session's parameters. The map then stays empty.
    config: Option<Config>,
    localiser: Localiser,
    at_once: AtOnce,
    map: Box<Map<TILES, SLOTS>>,
    surroundings: Surroundings,
    pose: Pose,
    /// Where the session began, in the map.
    home: Option<Pose>,
    epoch: u16,
}

impl Mirror {
    /// Makes the empty map of a session.
    #[must_use]
    pub fn new(start: &Start) -> Self {
        Self::tuned(start, &Tuning::DEFAULT)
    }

    /// Makes the empty map of a session with other constants.
    #[must_use]
    pub fn tuned(start: &Start, tuning: &'static Tuning) -> Self {
        let config = convert::config(start, tuning).ok();
        let mut map = Box::new(Map::new());
        if let Some(config) = &config {
            map.begin(config);
        }
        let pose = Pose::default();
        Self {
            config,
            localiser: Localiser::new(),
            at_once: AtOnce::default(),
            map,
            surroundings: Surroundings::new(),
            pose,
            home: None,
            epoch: 0,
        }
    }

    /// Enters an observation that the device answered with `status`. A device that is idle, paused
    /// or was stopped enters none.
    pub fn observe(&mut self, observation: &Observation, status: Status) {
        let held = matches!(
            status,
            Status::Idle
                | Status::Paused
                | Status::EmergencyStop
                | Status::Finished(Finish::Stopped)
        );
        let Some(config) = &self.config else {
            return;
        };
        let observation = &*self.at_once.take(config, observation);
        let input = convert::input(observation, config.lasers());
        let Some(input) = input.filter(|_| !held) else {
            return;
        };
        let MapPose(pose) = self.localiser.locate(config, &self.map, &input);
        self.pose = pose;
        if status != Status::NoScan {
            self.home.get_or_insert(pose);
        }
        let input = Input { pose, ..input };
        if self.localiser.may_enter() {
            self.map.observe(config, &input);
        }
        let (odom, started) = (self.localiser.odom(), status != Status::NoScan);
        self.surroundings.observe(config, (&input, &odom), started);
        if config.ground().is_some() {
            self.map.compact(&mut ());
        }
    }

    /// Returns where a device that stands takes its robot to be: by the odometry since its last
    /// step.
    #[must_use]
    pub fn carried(&self, observation: &Observation) -> Option<Pose> {
        let input = convert::input(observation, self.config.as_ref()?.lasers())?;
        let MapPose(pose) = self.localiser.to_map(&OdomPose(input.pose));
        Some(pose)
    }

    /// Takes what came for gone, as the device did in this step.
    pub fn forget_arrivals(&mut self) {
        if let Some(config) = &self.config {
            self.map.forget_arrivals(config, self.pose.point().cell());
            let tuning = &config.tuning().localise;
            self.localiser.expect_contradiction(tuning);
        }
    }

    /// Returns the map.
    #[must_use]
    pub fn map(&self) -> &Map<TILES, SLOTS> {
        &self.map
    }

    /// Returns the robot's pose in the map after the last step or correction.
    #[must_use]
    pub const fn pose(&self) -> Pose {
        self.pose
    }

    /// Returns the robot's last pose by odometry, in its own frame.
    #[must_use]
    pub fn odometry(&self) -> Pose {
        self.localiser.odom().0
    }

    /// Returns home: the pose of the session's first scan, in the map; `None` before it.
    #[must_use]
    pub const fn home(&self) -> Option<Pose> {
        self.home
    }

    /// Returns the last correction; 0 if there was none.
    #[must_use]
    pub const fn epoch(&self) -> u16 {
        self.epoch
    }

    /// Returns the last step's observation, with scans of one instant.
    #[must_use]
    pub fn measured(&self, observation: &Observation) -> Observation {
        self.at_once.again(observation)
    }

    /// Returns the last step's observation, on uneven ground with the beams of the first laser
    /// alone that end at what stands.
    #[must_use]
    pub fn standing(&self, observation: &Observation) -> Observation {
        let measured = self.measured(observation);
        let mut seen = measured.clone();
        let uneven = self.config.as_ref().filter(|it| it.ground().is_some());
        if let Some(config) = uneven
            && let Some(input) = convert::input(&measured, config.lasers())
            && let Some(scan) = seen.scans.first_mut()
        {
            let pose = self.pose;
            let standing = self.map.standing(config, &Input { pose, ..input });
            scan.ranges_mm = standing.into_iter().collect();
        }
        seen
    }

    /// Returns the tiles in which something was measured.
    pub fn tiles(&self) -> impl Iterator<Item = ((i16, i16), Classes)> {
        let tiles = self.map.tiles().touched();
        tiles.filter_map(|(x, y)| Some(((x as i16, y as i16), self.map.planes((x, y))?)))
    }

    /// Corrects the map, as the device does.
    pub fn correct(&mut self, correction: &MapCorrection) {
        for tile in correction.in_order() {
            let at = (tile.key.0.into(), tile.key.1.into());
            self.map.expand(at, &mut ());
            self.map.replace(at, &tile.classes, false);
            self.map.add_trail(at, &tile.trail);
        }
        self.home = self.home.map(|home| moved(home, correction));
        let motion = convert::correction(&correction.opening());
        let motion = MapFromOdom {
            x_m: motion.x_m,
            y_m: motion.y_m,
            yaw_rad: math::wrap(motion.yaw_rad),
        };
        let MapPose(before) = self.localiser.to_map(&self.localiser.odom());
        self.localiser.correct_pose(&motion);
        self.surroundings.correct(&motion);
        let MapPose(pose) = self.localiser.to_map(&self.localiser.odom());
        self.map.end_correction(before.point(), pose.point());
        self.pose = pose;
        self.epoch = correction.epoch;
    }

    /// Returns the correction that gives a device with an empty map this one, and the pose.
    #[must_use]
    pub fn whole(&self) -> MapCorrection {
        let odom = self.localiser.odom();
        let MapPose(pose) = self.localiser.to_map(&odom);
        let tile = |(key, classes)| CorrectedTile {
            key,
            shift: (0, 0),
            classes,
            trail: self.map.trail_rows((key.0.into(), key.1.into())),
        };
        MapCorrection {
            epoch: self.epoch.saturating_add(1),
            motion: Motion::between(&odom.0, &pose),
            tiles: self.tiles().map(tile).collect(),
        }
    }

    /// Returns what a device that has taken [`Self::whole`] is told of the space around the robot.
    #[must_use]
    pub fn recall(&self) -> Recall {
        let (epoch, odom) = (self.epoch.saturating_add(1), self.localiser.odom());
        convert::wire_recall(&self.surroundings.recall(epoch, &odom))
    }

    /// Begins anew with what a device that was reset was given.
    pub fn resume(&mut self, correction: &MapCorrection, recall: &Recall) {
        self.localiser = Localiser::new();
        if let Some(config) = &self.config {
            self.map.begin(config);
        }
        self.correct(correction);
        self.surroundings.take_over(&convert::recall(recall));
    }

    /// Returns true if a cell has been measured.
    #[must_use]
    pub fn is_known(&self, cell: Cell) -> bool {
        self.map.class(cell) != Class::Unknown
    }

    /// Returns the number of cells that have been measured.
    #[must_use]
    pub fn known(&self) -> usize {
        let rows = self.tiles().flat_map(|(_, [low, high])| {
            let rows = low.into_iter().zip(high);
            rows.map(|(low, high)| (low | high).count_ones() as usize)
        });
        rows.sum()
    }

    /// Returns true if the pool had no page for something that a beam met.
    #[must_use]
    pub const fn is_full(&self) -> bool {
        self.map.pool_full()
    }

    /// Returns heights and preferences in a window; `None` on flat ground.
    #[must_use]
    pub fn relief(&self, window: &Window) -> Option<Relief> {
        let terrain = self.config.as_ref()?.ground()?;
        Some(Relief::of(&self.map.heights(), terrain, &self.pose, window))
    }

    /// Returns true if these tiles are this map, complete and with nothing else.
    ///
    /// On uneven ground the planner also classifies cells that it never sees, and the observations
    /// alone do not determine when. So three kinds of cells are not compared: negative obstacles of
    /// the device, cells unknown here, and cells free on the device and negative here.
    #[must_use]
    pub fn equals(&self, tiles: &BTreeMap<(i16, i16), Tile>) -> bool {
        let reach = |of: fn(&(i16, i16)) -> i16| {
            let least = tiles.keys().map(of).min().unwrap_or(0);
            let most = tiles.keys().map(of).max().unwrap_or(0);
            least.saturating_sub(1)..=most.saturating_add(1)
        };
        let config = self.config.as_ref();
        let is_uneven = config.is_some_and(|config| config.ground().is_some());
        reach(|key| key.1).all(|y| {
            reach(|key| key.0).all(|x| {
                let ours = self.map.shown(i32::from(x), i32::from(y));
                let theirs = tiles.get(&(x, y)).map(|tile| tile.cells.as_slice());
                match (&ours, theirs) {
                    (Some(ours), Some(theirs)) if is_uneven => ours
                        .iter()
                        .zip(theirs)
                        .all(|(&ours, &theirs)| may_be(ours, theirs)),
                    (ours, theirs) => ours.as_ref().map(<[u8; 256]>::as_slice) == theirs,
                }
            })
        })
    }
}

/// Returns a place that goes with its tile.
fn moved(place: Pose, by: &MapCorrection) -> Pose {
    let cell = place.point().cell();
    let key = [cell.x, cell.y].map(|at| at.div_euclid(TILE_CELLS));
    let tile = |tile: &&CorrectedTile| [tile.key.0, tile.key.1].map(i32::from) == key;
    let shift = by.tiles.iter().find(tile).map_or((0, 0), |it| it.shift);
    Pose {
        x_m: place.x_m + f32::from(shift.0) * CELL_M,
        y_m: place.y_m + f32::from(shift.1) * CELL_M,
        ..place
    }
}

/// Returns true if four cells of a device on uneven ground, `theirs`, are allowed by the copy's,
/// `ours`.
const fn may_be(ours: u8, theirs: u8) -> bool {
    const LOW: u8 = 0x55;
    let known = (ours | ours >> 1) & LOW;
    let given_up = theirs & theirs >> 1 & LOW;
    let trusted = ours & ours >> 1 & theirs & !(theirs >> 1) & LOW;
    let either = !known & LOW | given_up | trusted;
    (ours ^ theirs) & !(either | either << 1) == 0
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::{Mirror, may_be};
    use crate::sim::{SimConfig, Simulator};
    use crate::world::World;
    use fieldline_planner::geometry::Cell;
    use fieldline_planner::map::Class;
    use fieldline_protocol::message::{Status, Strategy, Tile};

    fn seen_from_the_start() -> (Mirror, BTreeMap<(i16, i16), Tile>) {
        let world = World::builtin("office").unwrap();
        let mut sim = Simulator::new(&world, SimConfig::default()).unwrap();
        let mut mirror = Mirror::new(&sim.start_message(Strategy::Frontier));
        for _ in 0..5 {
            mirror.observe(&sim.observe(), Status::Exploring);
        }
        let mut tiles = BTreeMap::new();
        for (x, y) in (-2..12).flat_map(|x| (-2..12).map(move |y| (x, y))) {
            if let Some(cells) = mirror.map.shown(x.into(), y.into()) {
                let cells = heapless::Vec::from_slice(&cells).unwrap();
                let skeleton = heapless::Vec::new();
                let tile = Tile {
                    x,
                    y,
                    cells,
                    skeleton,
                    closed_regions: 0,
                    given_up_regions: 0,
                    visit_stamps: [0; 4],
                };
                tiles.insert((x, y), tile);
            }
        }
        (mirror, tiles)
    }

    #[test]
    fn cells_that_the_lasers_saw_are_known() {
        let (mirror, _) = seen_from_the_start();
        // The office's start is at (12, 7) in the corridor.
        assert!(mirror.is_known(Cell { x: 130, y: 70 }));
        assert!(!mirror.is_known(Cell { x: -50, y: 70 }));
        let cells = (-300..500).flat_map(|x| (-300..500).map(move |y| Cell { x, y }));
        let known = cells.filter(|cell| mirror.is_known(*cell)).count();
        assert_eq!(mirror.known(), known);
    }

    #[test]
    fn one_changed_cell_or_one_lost_tile_is_a_difference() {
        let (mirror, tiles) = seen_from_the_start();
        assert!(tiles.len() > 3 && mirror.equals(&tiles));
        let mut changed = tiles.clone();
        changed.values_mut().next().unwrap().cells[100] ^= 1;
        assert!(!mirror.equals(&changed));
        let mut lost = tiles.clone();
        let middle = *tiles.keys().nth(tiles.len() / 2).unwrap();
        lost.remove(&middle);
        assert!(!mirror.equals(&lost));
    }

    #[test]
    fn on_uneven_ground_a_device_may_add_negative_cells_and_clear_them_and_no_more() {
        let classes = [
            Class::Unknown,
            Class::Free,
            Class::Obstacle,
            Class::Negative,
        ];
        for (place, ours) in (0..4).flat_map(|place| classes.map(|ours| (place, ours))) {
            for theirs in classes {
                let at = |class: Class| (class as u8) << (2 * place);
                let allowed = ours == theirs
                    || ours == Class::Unknown
                    || theirs == Class::Negative
                    || (ours == Class::Negative && theirs == Class::Free);
                // The cells beside it are the same in both.
                let beside = 0b01_10_11_01 & !(0b11 << (2 * place));
                let may = may_be(beside | at(ours), beside | at(theirs));
                assert_eq!(may, allowed, "{ours:?} {theirs:?} {place}");
            }
        }
    }

    #[test]
    fn a_paused_device_enters_nothing() {
        let world = World::builtin("office").unwrap();
        let mut sim = Simulator::new(&world, SimConfig::default()).unwrap();
        let mut mirror = Mirror::new(&sim.start_message(Strategy::Frontier));
        mirror.observe(&sim.observe(), Status::Paused);
        assert!(mirror.equals(&BTreeMap::new()));
    }
}
