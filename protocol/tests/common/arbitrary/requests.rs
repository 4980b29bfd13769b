//! What a host asks and tells.

use fieldline_protocol::message::{
    self, Budget, Control, Correct, CorrectedTile, CorrectedTiles, Fence, FencePolygon, Hull,
    Laser, LoopLimits, Motion, Observation, Order, Preference, Recall, RecalledPoint, Request,
    Scan, Start, UnevenGround,
};
use proptest::prelude::*;

use super::team::{packet, team};
use super::{list, long, pose, short, twist};
use crate::common::hello;

fn laser() -> impl Strategy<Value = Laser> {
    (
        short(),
        short(),
        short(),
        short(),
        long(),
        long(),
        any::<(u16, u16)>(),
        any::<(u16, bool)>(),
    )
        .prop_map(
            |(x, y, z, pitch, first_bearing, bearing_step, sweep, turn)| Laser {
                x,
                y,
                z,
                pitch,
                first_bearing,
                bearing_step,
                beams: sweep.0,
                range_limit_mm: sweep.1,
                turn_time_ms: turn.0,
                newest_first: turn.1,
            },
        )
}

fn uneven_ground() -> impl Strategy<Value = UnevenGround> {
    let preference = prop_oneof![
        Just(Preference::Off),
        Just(Preference::Height),
        Just(Preference::Global),
        Just(Preference::Both),
    ];
    let heights = [short(), short(), short(), short()];
    let preferences = [short(), short(), short(), short(), short()];
    (preference, any::<bool>(), heights, preferences, long()).prop_map(
        |(preference, levels, [obstacle, near, hole, step], preferences, global_scale)| {
            let [least, most, height_scale, climb, roll] = preferences;
            UnevenGround {
                preference,
                levels,
                obstacle,
                near,
                hole,
                least,
                most,
                height_scale,
                global_scale,
                climb,
                roll,
                step,
            }
        },
    )
}

fn space_field() -> impl Strategy<Value = message::SpaceField> {
    let rest = any::<(u16, Option<u16>)>();
    ([long(), long(), long(), long()], rest).prop_map(
        |([x, y, across, up], (until_permille, impatience_s))| message::SpaceField {
            origin: (x, y),
            size: (across, up),
            until_permille,
            impatience_s,
        },
    )
}

fn fence() -> impl Strategy<Value = Fence> {
    let polygon = any::<(u8, bool)>();
    let polygon = polygon.prop_map(|(corners, bounds)| FencePolygon { corners, bounds });
    (list((long(), long())), list(polygon))
        .prop_map(|(corners, polygons)| Fence { corners, polygons })
}

fn budget() -> impl Strategy<Value = Budget> {
    any::<(Option<u16>, Option<u16>)>().prop_map(|(range_m, time_s)| Budget { range_m, time_s })
}

fn strategy() -> impl Strategy<Value = message::Strategy> {
    prop_oneof![
        Just(message::Strategy::Frontier),
        Just(message::Strategy::Ouroboros),
        any::<(u16, Option<u16>)>().prop_map(|(patrol_s, impatience_s)| message::Strategy::Tdbvp {
            patrol_s,
            impatience_s,
        }),
        space_field().prop_map(message::Strategy::Sbpf),
        space_field().prop_map(message::Strategy::Esbpf),
    ]
}

fn start() -> impl Strategy<Value = Start> {
    (
        (
            strategy(),
            any::<(bool, bool)>(),
            prop::option::of(uneven_ground()),
            prop::option::of(team()),
            (order(), fence(), budget()),
        ),
        list(laser()),
        (any::<[u16; 4]>(), [long(), long(), long(), long(), long()]),
        any::<u16>(),
        [short(), short(), short(), short()],
    )
        .prop_map(
            |(
                (strategy, (localise, survey), uneven_ground, team, (order, fence, budget)),
                lasers,
                (sizes, loops),
                period_ms,
                limits,
            )| {
                let [length_mm, width_mm, height_mm, robot_radius_mm] = sizes;
                let [least, most, most_per_frontier, detour, slack] = loops;
                let [max_linear, max_angular, linear_accel, angular_accel] = limits;
                Start {
                    strategy,
                    lasers,
                    hull: Hull {
                        length_mm,
                        width_mm,
                        height_mm,
                    },
                    robot_radius_mm,
                    max_linear,
                    max_angular,
                    linear_accel,
                    angular_accel,
                    period_ms,
                    uneven_ground,
                    loops: LoopLimits {
                        least,
                        most,
                        most_per_frontier,
                        detour,
                        slack,
                    },
                    order,
                    team,
                    localise,
                    survey,
                    fence,
                    budget,
                }
            },
        )
}

fn order() -> impl Strategy<Value = Order> {
    prop_oneof![
        short().prop_map(|worth| Order::Gain { worth }),
        short().prop_map(|worth| Order::Nearest { worth }),
    ]
}

fn control() -> impl Strategy<Value = Control> {
    prop_oneof![
        start().prop_map(Control::Start),
        Just(Control::Pause),
        Just(Control::Resume),
        Just(Control::Stop),
        Just(Control::Reset),
        Just(Control::Home),
        Just(Control::Explore),
        (long(), long(), long()).prop_map(|(x, y, yaw)| Control::SetHome { x, y, yaw }),
        (long(), long()).prop_map(|(x, y)| Control::GoTo { x, y }),
    ]
}

fn observation() -> impl Strategy<Value = Observation> {
    let scan = list(any::<u16>()).prop_map(|ranges_mm| Scan { ranges_mm });
    (any::<u32>(), pose(), twist(), list(scan)).prop_map(|(time_ms, pose, velocity, scans)| {
        Observation {
            time_ms,
            pose,
            velocity,
            scans,
        }
    })
}

fn correct() -> impl Strategy<Value = Correct> {
    (any::<(u16, u16)>(), [long(), long(), long()]).prop_map(|((epoch, tiles), [x, y, yaw])| {
        Correct {
            epoch,
            motion: Motion { x, y, yaw },
            tiles,
        }
    })
}

fn corrected_tiles() -> impl Strategy<Value = CorrectedTiles> {
    let tile = any::<(i16, i16, (i8, i8), u16, bool)>();
    let tile = tile.prop_map(|(x, y, shift, bytes, trail)| CorrectedTile {
        x,
        y,
        shift,
        bytes,
        trail,
    });
    let head = any::<(u16, u16, bool)>();
    (head, list(tile), list(any::<u8>())).prop_map(|((epoch, first, last), tiles, cells)| {
        CorrectedTiles {
            epoch,
            first,
            last,
            tiles,
            cells,
        }
    })
}

fn recall() -> impl Strategy<Value = Recall> {
    let point = any::<(i16, i16, u8)>().prop_map(|(x_mm, y_mm, returns)| RecalledPoint {
        x_mm,
        y_mm,
        returns,
    });
    let ends = [long(), long(), long()].prop_map(|[x, y, yaw]| Motion { x, y, yaw });
    let head = (any::<u16>(), long(), long(), proptest::option::of(ends));
    (head, list(point), list(any::<[i8; 3]>())).prop_map(
        |((epoch, x, y, track_end), points, track)| Recall {
            epoch,
            origin: (x, y),
            points,
            track_end,
            track,
        },
    )
}

/// Any request except a hello of another version.
pub(crate) fn request() -> impl Strategy<Value = Request> {
    prop_oneof![
        any::<u32>().prop_map(hello),
        control().prop_map(Request::Control),
        observation().prop_map(Request::Observation),
        any::<(i16, i16)>().prop_map(|(x, y)| Request::Tile { x, y }),
        any::<u8>().prop_map(|row| Request::FieldRow { row }),
        Just(Request::Frontiers),
        any::<u8>().prop_map(|from| Request::Path { from }),
        packet().prop_map(Request::Hear),
        Just(Request::Say),
        correct().prop_map(Request::Correct),
        corrected_tiles().prop_map(Request::Tiles),
        recall().prop_map(Request::Recall),
    ]
}
