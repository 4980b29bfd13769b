//! Meetings with other robots: peers as obstacles of the window, and making way.
//!
//! A peer is a place in the window that the robot's centre keeps clear of. If the local goal can
//! then not be reached, although it could without peers, the robot is *blocked*. If a peer's road
//! leads over the robot as well, they meet, and one of them yields (`team/right_of_way.rs`).
//!
//! To yield, the window is charged with every cell that is off the peer's road, so the field leads
//! to the nearest of them by itself: beside the road, or along a corridor and out of it. The map
//! near the robot is known, because the robot came from there.
//!
//! Units: metres, milliseconds; window cells.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows};
use crate::geometry::{CELL_M, Cell, Point};
use crate::grid::bits::ones64;
use crate::math;
use crate::planner::state::State;
use crate::planner::step::Step;
use crate::roadmap::configuration_space::Footprint;
use crate::team::peers::Peer;
use crate::team::right_of_way::{Road, Stance, distance2, road_of, waits_for};

/// Room between two hulls that pass, metres: a map cell.
const ROOM_M: f32 = CELL_M;
/// A yielding robot goes this much farther off the road than it must, metres: then it stands.
const BEYOND_M: f32 = 0.1;
/// Distance between two places at which a road is cut out of the window, metres.
const EVERY_M: f32 = 0.2;
/// Length of a peer's road beyond the robot that the robot leaves, metres.
const BEHIND_M: f32 = 1.0;
/// Length of the robot's own road that counts, metres.
const OWN_ROAD_M: f32 = 3.2;

/// What the robot does in this step.
#[derive(Clone, Copy, Debug)]
pub(super) enum Way {
    /// It drives to its goal.
    Free,
    /// It stands.
    Hold,
    /// It drives to cells that the window is charged with.
    Retreat,
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Takes the places of peers that stand out of the published skeleton. Returns true if one of
    /// them may drive away: then what lies behind it is not given up.
    pub(super) fn cut_peers(&mut self, footprint: &Footprint, now_ms: u32) -> bool {
        let mut waits = false;
        for peer in self.team.peers().iter() {
            if self.team.way.may_move(peer, now_ms) {
                continue;
            }
            waits |= peer.beacon.activity.moves();
            let radius_m = peer.radius_m() + footprint.reach() as f32 * CELL_M;
            self.skeleton.cut(peer.beacon.point().cell(), radius_m);
        }
        waits
    }
}

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Makes the places of the peers, or only of one, impassable in a window at scale 1.
    #[inline(never)]
    pub(super) fn block_peers(&mut self, only: Option<u8>) {
        let (robot, time_ms) = (self.input.pose.point(), self.input.time_ms);
        let grid = &mut self.workspace.local_grid;
        for (id, hull) in self.state.team.peers().turning(time_ms, robot) {
            if only.is_none_or(|only| only == id) {
                grid.keep_off(robot.cell(), hull.area(), &self.footprint);
            }
        }
    }

    /// Decides whether the robot drives on, stands, or makes way.
    #[inline(never)]
    pub(super) fn make_way(&mut self) -> Way {
        let (now_ms, robot, off_m) = (self.input.time_ms, self.robot(), self.off_road_m());
        let team = &mut self.state.team;
        let has_lost_patience = team.way.loses_patience(now_ms);
        let meets = team.meets(now_ms, robot, |_| true).is_some();
        if !meets || has_lost_patience {
            team.way.go_on();
            return Way::Free;
        }
        let other = team.way.other(team.peers(), now_ms).cloned();
        if let Some(other) = other.filter(|other| team.still_yields_to(other)) {
            if distance2(&road_near(&other, now_ms, robot), robot) < off_m * off_m {
                return self.yield_to(&other);
            }
            if self.crosses(&road_of(&other, now_ms)) {
                let team = &mut self.state.team;
                team.way.take(Stance::Yielding, &other, now_ms);
                team.way.go_to(None);
                return Way::Hold;
            }
        }
        if !self.state.team.way.is_shut() && !self.is_blocked() {
            self.state.team.way.go_on();
            return Way::Free;
        }
        let is_in_its_way = |peer: &Peer| {
            waits_for(peer, now_ms, robot)
                || distance2(&road_of(peer, now_ms), robot) < off_m * off_m
        };
        let team = &mut self.state.team;
        if let Some(peer) = team.meets(now_ms, robot, is_in_its_way).cloned()
            && team.is_before_me(&peer)
        {
            return self.yield_to(&peer);
        }
        if let Some(peer) = team.meets(now_ms, robot, |_| true).cloned() {
            team.way.take(Stance::Holding, &peer, now_ms);
        }
        Way::Hold
    }

    /// Returns the distance from a road at which the robot is out of the way, metres: then a peer's
    /// planning disc, whose radius is as this robot's, passes the hull.
    fn off_road_m(&self) -> f32 {
        self.config.robot.half_diagonal_m + self.config.robot_radius_m + ROOM_M
    }

    /// Returns true if the robot's own road comes near the road of a peer.
    fn crosses(&self, road: &Road) -> bool {
        let (robot, off_m) = (self.robot(), self.off_road_m());
        let cells = self.state.strategy.frontier.path().cells().iter();
        let ahead = cells.map(|cell| cell.offset(1, 1).corner());
        ahead
            .take_while(|place| place.distance2(robot) <= OWN_ROAD_M * OWN_ROAD_M)
            .any(|place| distance2(road, place) < off_m * off_m)
    }

    /// Returns true if the local goal that can be reached without the peers cannot with them.
    fn is_blocked(&mut self) -> bool {
        let robot = self.robot();
        self.read_window(1, false);
        let leads = |grid: &LocalGrid, cell: Cell| {
            let mut goal: Rows = [0; SIDE];
            grid.mark(&mut goal, cell) && has_any(&common(&goal, &reached(grid, robot)))
        };
        let path = self.state.strategy.frontier.path();
        let mut ahead = path.ahead_of(robot).iter().rev().copied();
        let goal = ahead.find(|&cell| leads(&self.workspace.local_grid, cell));
        self.block_peers(None);
        goal.is_some_and(|cell| !leads(&self.workspace.local_grid, cell))
    }

    /// Leads the robot off the road of a peer. It is cornered if no cell off the road can be
    /// reached; where others stand in its way, its own road tells them so.
    fn yield_to(&mut self, peer: &Peer) -> Way {
        let (now_ms, robot) = (self.input.time_ms, self.robot());
        self.state.team.way.take(Stance::Yielding, peer, now_ms);
        self.read_window(1, false);
        self.block_peers(Some(peer.member.id));
        let mut off_road = reached(&self.workspace.local_grid, robot);
        let road = road_near(peer, now_ms, robot);
        let radius_m = self.off_road_m() + BEYOND_M;
        clear_road(&self.workspace.local_grid, &mut off_road, &road, radius_m);
        self.block_peers(None);
        let grid = &self.workspace.local_grid;
        let goal = common(&off_road, &reached(grid, robot));
        let can_leave = has_any(&goal);
        let aim = if can_leave { &goal } else { &off_road };
        self.state.team.way.go_to(nearest(grid, aim, robot));
        if can_leave {
            self.workspace.charge(&goal);
            return Way::Retreat;
        }
        self.state.team.way.corner();
        Way::Hold
    }
}

/// Returns the cells that the robot can reach.
fn reached(grid: &LocalGrid, robot: Point) -> Rows {
    grid.reachable(robot.cell()).unwrap_or([0; SIDE])
}

fn common(one: &Rows, other: &Rows) -> Rows {
    let mut rows = *one;
    rows.iter_mut()
        .zip(other)
        .for_each(|(row, other)| *row &= other);
    rows
}

fn has_any(rows: &Rows) -> bool {
    rows.iter().any(|row| *row != 0)
}

/// Returns the road of a peer as far as the robot, and [`BEHIND_M`] more: the window ends soon
/// after.
fn road_near(peer: &Peer, now_ms: u32, robot: Point) -> Road {
    let mut road = road_of(peer, now_ms);
    if waits_for(peer, now_ms, robot) {
        // It would drive here, and on.
        let from = peer.pose(now_ms).point();
        road.truncate(1);
        let beyond = |from: f32, to: f32| to + (to - from);
        // There is room behind the first place.
        let _ = road.push(Point {
            x_m: beyond(from.x_m, robot.x_m),
            y_m: beyond(from.y_m, robot.y_m),
        });
    }
    let mut left_m = BEHIND_M + peer.pose(now_ms).point().distance_m(robot);
    let mut near = Road::new();
    for place in road {
        let Some(&last) = near.last() else {
            let _ = near.push(place);
            continue;
        };
        let step_m = last.distance_m(place);
        let part = (left_m / step_m.max(left_m)).min(1.0);
        // A road has room for all its places.
        let _ = near.push(Point {
            x_m: last.x_m + part * (place.x_m - last.x_m),
            y_m: last.y_m + part * (place.y_m - last.y_m),
        });
        left_m -= step_m;
        if left_m <= 0.0 {
            break;
        }
    }
    near
}

/// Clears the cells within `radius_m` of a road.
fn clear_road(grid: &LocalGrid, rows: &mut Rows, road: &Road, radius_m: f32) {
    if let [only] = road.as_slice() {
        clear_disc(grid, rows, *only, radius_m);
    }
    for ends in road.windows(2) {
        let [from, to] = ends else { continue };
        let parts = math::floor(from.distance_m(*to) / EVERY_M) + 1;
        for k in 0..=parts {
            let part = k as f32 / parts as f32;
            let place = Point {
                x_m: from.x_m + part * (to.x_m - from.x_m),
                y_m: from.y_m + part * (to.y_m - from.y_m),
            };
            clear_disc(grid, rows, place, radius_m);
        }
    }
}

/// Clears the cells within `radius_m` of a place, in a grid at scale 1.
fn clear_disc(grid: &LocalGrid, rows: &mut Rows, centre: Point, radius_m: f32) {
    let cell = centre.cell();
    let (x, y) = (cell.x - grid.origin.x, cell.y - grid.origin.y);
    let radius = radius_m / CELL_M;
    let reach = math::floor(radius);
    for dy in -reach..=reach {
        let row = usize::try_from(y + dy)
            .ok()
            .and_then(|row| rows.get_mut(row));
        let Some(row) = row else { continue };
        let half = math::floor(math::sqrt(radius * radius - (dy * dy) as f32));
        let (from, to) = ((x - half).max(0), (x + half).min(SIDE as i32 - 1));
        if from <= to {
            *row &= !((u64::MAX >> (63 - (to - from))) << from);
        }
    }
}

/// Returns the place of the cell of `rows` nearest to the robot.
fn nearest(grid: &LocalGrid, rows: &Rows, robot: Point) -> Option<Point> {
    let mut nearest = None;
    let mut least2 = f32::MAX;
    for (y, row) in rows.iter().enumerate() {
        for x in ones64(*row) {
            let place = grid.cell(x as usize, y).centre();
            let far2 = place.distance2(robot);
            if far2 < least2 {
                (nearest, least2) = (Some(place), far2);
            }
        }
    }
    nearest
}
