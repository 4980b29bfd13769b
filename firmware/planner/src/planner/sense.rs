//! The first stage of a step: scans and odometry into pose, map and ground model, and what the
//! strategy and the errands learn of them.
//!
//! The input of this stage has the odometry's pose, and its output the pose in the map.
//!
//! Units: metres; millimetres of range; milliseconds.

use crate::config::Config;
use crate::doing::Event;
use crate::geometry::{CELL_M, Cell, MapPose, OdomPose, Point, Pose};
use crate::input::{INVALID_MM, Input};
use crate::math;
use crate::planner::state::State;
use crate::profiling::{Stage, StageTimer};
use crate::robot::LaserMount;
use crate::status::{Fault, Status};

/// A range below this is inside the robot's own hull, metres.
const BLOCKED_M: f32 = 0.12;
/// Steps in a row in which no beam tells anything, from which on the robot stands until one does.
/// One scan may be lost on the line.
const DARK_STEPS: u8 = 2;

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Takes what the robot sensed. Returns its pose in the map; `None` if the robot stands in this
    /// step.
    pub(super) fn sense(
        &mut self,
        config: &Config,
        input: Input<'_>,
        timer: &mut impl StageTimer,
    ) -> Option<MapPose> {
        let MapPose(expected) = self.localiser.to_map(&OdomPose(input.pose));
        let peers = self.team.peers();
        let MapPose(pose) = if peers.may_be_seen(input.time_ms, &expected, &config.lasers) {
            self.enter_without_peers(config, &input, &expected)
        } else {
            self.enter(config, &input)
        };
        let input = Input { pose, ..input };
        if self.team.has_own_frame() {
            self.team.sight(config, self.map.tiles(), &input);
        }
        self.note_surroundings(config, &input);
        self.drive.note_pose(&MapPose(pose));
        if self.localiser.has_given_up() {
            self.status = Status::Fault(Fault::PoseLost);
        }
        let plans = !self.localiser.is_lost() && !config.survey;
        if plans && !self.errands.is_going() {
            self.tell_strategy(config, &input);
        }
        self.errands.note_driven(self.localiser.odom().0.point());
        if plans {
            self.mind_budget(config, input.time_ms);
        }
        timer.mark(Stage::Sense);
        (plans && self.status.drives() && !self.is_dark(config, &input)).then_some(MapPose(pose))
    }

    /// Returns true if no beam has told anything for some steps. Then the robot is not blamed for
    /// standing.
    fn is_dark(&mut self, config: &Config, input: &Input<'_>) -> bool {
        self.dark_steps = if tells(input) {
            0
        } else {
            self.dark_steps.saturating_add(1)
        };
        let is_dark = self.dark_steps >= DARK_STEPS;
        if is_dark {
            self.strategy.frontier.hold(config.period_ms());
        }
        is_dark
    }

    /// Locates the robot and enters scans and odometry into the map. It is large and called from
    /// two places, so it is not inlined.
    #[inline(never)]
    pub(super) fn enter(&mut self, config: &Config, input: &Input<'_>) -> MapPose {
        let MapPose(pose) = self.localiser.locate(config, &self.map, input);
        let input = &Input { pose, ..*input };
        if !self.started {
            self.begin(config, input);
        }
        if self.localiser.may_enter() {
            self.map.observe(config, input);
        }
        let level = level_scans(config, input).find(|(_, ranges_mm)| !ranges_mm.is_empty());
        self.strategy
            .note(&pose, input.time_ms, level, config.tuning);
        MapPose(pose)
    }

    /// Begins the session if a beam tells anything, or says why it cannot begin.
    fn begin(&mut self, config: &Config, input: &Input<'_>) {
        self.started = config.survey || tells(input);
        self.errands
            .begin_at(input.pose, self.localiser.odom().0.point());
        self.status = match self.started {
            false => Status::NoScan,
            true if config.survey => Status::Exploring,
            // A session that was given a map goes on where another one was: it is no start.
            true if self.map_epoch() != 0 => Status::Exploring,
            true if starts_blocked(config, input) => Status::Fault(Fault::StartBlocked),
            true if !may_stand(config, &input.pose) => Status::Fault(Fault::StartForbidden),
            true => Status::Exploring,
        };
        if self.started && !self.is_recalled {
            let odom = self.localiser.odom();
            self.ground.surround(&odom, &config.robot);
        }
    }

    /// Enters scans and odometry into the ground model. What protects the hull takes every beam,
    /// also one that seems to end in a peer: a wall may stand there instead, beside a peer that has
    /// moved.
    #[inline(never)]
    pub(super) fn note_surroundings(&mut self, config: &Config, input: &Input<'_>) {
        let odom = self.localiser.odom();
        self.ground.observe(
            config,
            (input, &odom),
            self.team.peers(),
            &mut self.map,
            &mut self.preferences,
        );
        // Wheels that slip on a slope are no contact.
        if !self.ground.is_uneven()
            && let Some(contact) = self.drive.feel(config, input.velocity)
        {
            self.ground.feel(&odom, &config.robot, contact);
            self.events.add(Event::Touched);
        }
    }

    /// Tells the strategy what the map and the peers know. The strategy may end the exploration.
    #[inline(never)]
    fn tell_strategy(&mut self, config: &Config, input: &Input<'_>) {
        let peers = self.team.peers().iter();
        for peer in peers.filter(|peer| peer.has_claims(input.time_ms)) {
            let place = peer.pose(input.time_ms).point();
            self.strategy.note_peer(place);
        }
        let rivals = self.team.rivals(input.time_ms);
        let rivals = rivals.map(|peer| peer.pose(input.time_ms).point());
        let (places, tiles) = ((input.pose.point(), rivals), self.map.tiles());
        if let Some(end) = self.strategy.note_map(tiles, places, input.time_ms, config) {
            self.status = end;
        }
    }
}

/// Returns the level lasers, each with its scan.
pub(super) fn level_scans<'a>(
    config: &'a Config,
    input: &Input<'a>,
) -> impl Iterator<Item = (&'a LaserMount, &'a [u16])> {
    let scans = config.lasers.iter().zip(input.scans);
    scans.filter(|(laser, _)| laser.is_level())
}

/// Returns true if the fence allows every cell under the hull of a robot at `pose`.
#[must_use]
pub fn may_stand(config: &Config, pose: &Pose) -> bool {
    config.fence.is_empty() || fence_allows_hull(config, pose)
}

/// Returns true as [`may_stand`]. It is not inlined: its rows must not be on the stack of a step.
#[inline(never)]
fn fence_allows_hull(config: &Config, pose: &Pose) -> bool {
    // A row of the fence costs as much as a cell of it.
    let (corner, rows) = under_hull(config, pose);
    let mut rows = (corner.y..).zip(rows).filter(|(_, row)| *row != 0);
    rows.all(|(y, row)| config.fence.row(corner.x, y) & row == 0)
}

/// Returns the cells under the hull of a robot, in a square of 64 cells, and the square's corner.
/// The longest hull has a diagonal of 57 cells.
fn under_hull(config: &Config, pose: &Pose) -> (Cell, [u64; 64]) {
    let (length_m, width_m) = (config.robot.half_length_m, config.robot.half_width_m);
    // Places across a hull, at most half a cell apart, its edges included.
    let parts = |half_m: f32| math::floor(4.0 * half_m / CELL_M) + 1;
    let at = |k: i32, half_m: f32| half_m * (2.0 * k as f32 / parts(half_m) as f32 - 1.0);
    let corner = pose.point().cell().offset(-32, -32);
    let mut rows = [0; 64];
    for i in 0..=parts(length_m) {
        for j in 0..=parts(width_m) {
            let place = Point {
                x_m: at(i, length_m),
                y_m: at(j, width_m),
            };
            let cell = pose.to_map(place).cell();
            if let Some(row) = rows.get_mut((cell.y - corner.y) as usize) {
                *row |= 1 << ((cell.x - corner.x) & 63);
            }
        }
    }
    (corner, rows)
}

/// Returns true if a beam tells anything.
#[must_use]
pub fn tells(input: &Input<'_>) -> bool {
    let mut ranges = input.scans.iter().copied().flatten();
    ranges.any(|&range_mm| range_mm != INVALID_MM)
}

/// Returns true if nine of ten beams of the level laser that tell anything end inside the robot's
/// own hull.
#[must_use]
pub fn starts_blocked(config: &Config, input: &Input<'_>) -> bool {
    let level = level_scans(config, input).next();
    level.is_some_and(|(_, ranges_mm)| {
        let told = || ranges_mm.iter().filter(|&&range_mm| range_mm != INVALID_MM);
        let blocked = |&&range: &&u16| f32::from(range) * 1e-3 < BLOCKED_M;
        let count = told().count();
        count > 0 && told().filter(blocked).count() * 10 >= count * 9
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fence::Fence;
    use crate::grid::bits::tests::Rng;
    use crate::robot::RobotShape;

    /// [`may_stand`], place by place.
    fn slowly(config: &Config, pose: &Pose) -> bool {
        let (length_m, width_m) = (config.robot.half_length_m, config.robot.half_width_m);
        let parts = |half_m: f32| math::floor(4.0 * half_m / CELL_M) + 1;
        let at = |k: i32, half_m: f32| half_m * (2.0 * k as f32 / parts(half_m) as f32 - 1.0);
        let is_free = |i: i32, j: i32| {
            let place = Point {
                x_m: at(i, length_m),
                y_m: at(j, width_m),
            };
            config.fence.allows(pose.to_map(place).cell())
        };
        (0..=parts(length_m)).all(|i| (0..=parts(width_m)).all(|j| is_free(i, j)))
    }

    #[test]
    fn a_robot_may_stand_where_no_place_under_its_hull_is_forbidden() {
        let mut rng = Rng(3);
        let mut between = |low: f32, high: f32| {
            let part = (rng.next() >> 40) as f32 / (1_u64 << 24) as f32;
            low + (high - low) * part
        };
        let mut allowed = 0;
        for round in 0..600 {
            // The longest hull that a session may have, and short ones.
            let most_m = if round % 2 == 0 { 4.0 } else { 0.6 };
            let robot = RobotShape::rectangle(between(0.1, most_m), between(0.1, most_m), 0.5);
            let (x_m, y_m) = (between(-3.0, 3.0), between(-3.0, 3.0));
            let corner = |dx, dy| Point {
                x_m: x_m + dx,
                y_m: y_m + dy,
            };
            let pose = Pose {
                x_m: between(-3.0, 3.0),
                y_m: between(-3.0, 3.0),
                yaw_rad: between(-3.1, 3.1),
                ..Pose::default()
            };
            let (east, north) = (between(0.2, 2.0), between(0.2, 2.0));
            let triangle = [corner(0.0, 0.0), corner(east, 0.1), corner(0.1, north)];
            let config = Config {
                robot,
                fence: Fence::new().no_go(&triangle),
                ..Config::pioneer_3at(heapless::Vec::new())
            };
            let may = may_stand(&config, &pose);
            assert_eq!(may, slowly(&config, &pose), "round {round}");
            allowed += u32::from(may);
        }
        assert!((300..560).contains(&allowed), "{allowed}");
    }
}
