//! Proptest strategies for arbitrary messages.

use fieldline_protocol::message::{
    self, Activity, Beacon, Body, Cause, Command, Control, Cost, Counters, Crash, Digest, Fault,
    FieldRow, Finish, Hull, Identity, Laser, Location, LoopLimits, Loops, Member, Observation,
    Order, Packet, Parameter, Path, Pose, Preference, Quality, Refusal, Reply, Request,
    ResidualFrontier, ResidualReason, Scan, Stages, Start, Status, Team, TeamTile, Tile,
    TileVersion, Twist, UnevenGround, Wanted,
};
use fixed::types::{I4F12, I16F16};
use proptest::prelude::*;

use super::hello;

fn long() -> impl Strategy<Value = I16F16> {
    any::<i32>().prop_map(I16F16::from_bits)
}

fn short() -> impl Strategy<Value = I4F12> {
    any::<i16>().prop_map(I4F12::from_bits)
}

fn list<T: core::fmt::Debug, const N: usize>(
    item: impl Strategy<Value = T>,
) -> impl Strategy<Value = heapless::Vec<T, N>> {
    prop::collection::vec(item, 0..=N).prop_map(|items| items.into_iter().collect())
}

fn text<const N: usize>() -> impl Strategy<Value = heapless::String<N>> {
    "[ -~é]{0,12}".prop_map(|text| {
        let mut short = heapless::String::new();
        for letter in text.chars() {
            let _ = short.push(letter);
        }
        short
    })
}

fn laser() -> impl Strategy<Value = Laser> {
    (
        short(),
        short(),
        short(),
        short(),
        long(),
        long(),
        any::<(u16, u16)>(),
    )
        .prop_map(
            |(x, y, z, pitch, first_bearing, bearing_step, (beams, range_limit_mm))| Laser {
                x,
                y,
                z,
                pitch,
                first_bearing,
                bearing_step,
                beams,
                range_limit_mm,
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

fn start() -> impl Strategy<Value = Start> {
    let strategy = prop_oneof![
        Just(message::Strategy::Frontier),
        Just(message::Strategy::Ouroboros),
        any::<(u16, Option<u16>)>().prop_map(|(patrol_s, impatience_s)| message::Strategy::Tdbvp {
            patrol_s,
            impatience_s,
        }),
        space_field().prop_map(message::Strategy::Sbpf),
        space_field().prop_map(message::Strategy::Esbpf),
    ];
    (
        (
            strategy,
            any::<(bool, bool)>(),
            prop::option::of(uneven_ground()),
            prop::option::of(team()),
            order(),
        ),
        list(laser()),
        (any::<[u16; 4]>(), [long(), long(), long(), long(), long()]),
        any::<u16>(),
        [short(), short(), short(), short()],
    )
        .prop_map(
            |(
                (strategy, (localise, survey), uneven_ground, team, order),
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
                }
            },
        )
}

fn order() -> impl Strategy<Value = Order> {
    prop_oneof![
        short().prop_map(|worth| Order::Gain { worth }),
        Just(Order::Nearest),
    ]
}

fn member() -> impl Strategy<Value = Member> {
    any::<(u8, u16)>().prop_map(|(id, boot)| Member { id, boot })
}

fn team() -> impl Strategy<Value = Team> {
    (member(), long(), long(), long()).prop_map(|(member, x, y, yaw)| Team {
        member,
        origin: (x, y),
        yaw,
    })
}

fn beacon() -> impl Strategy<Value = Beacon> {
    let activity = prop::sample::select(vec![
        Activity::Exploring,
        Activity::Yielding,
        Activity::Cornered,
        Activity::Standing,
        Activity::Finished,
        Activity::Faulted,
        Activity::Gone,
        Activity::Holding,
    ]);
    let motion = (short(), twist());
    let place = any::<(u32, i16, i16, u8, u8, u8)>();
    let road = list(any::<(i8, i8)>());
    (place, motion, activity, any::<Option<(i16, i16)>>(), road).prop_map(
        |((map, x_cm, y_cm, sd_cm, length, width), (yaw, velocity), activity, goal, road)| Beacon {
            map,
            x_cm,
            y_cm,
            yaw,
            sd_cm,
            velocity,
            half_length_cm: length,
            half_width_cm: width,
            activity,
            goal,
            road,
        },
    )
}

/// Any packet of a team.
pub(crate) fn packet() -> impl Strategy<Value = Packet> {
    let version = any::<(i8, i8, u16, u16)>().prop_map(|(x, y, epoch, hash)| TileVersion {
        x,
        y,
        epoch,
        hash,
    });
    let digest = (any::<u8>(), list(version)).prop_map(|(salt, tiles)| Digest { salt, tiles });
    let wanted = (any::<u8>(), list(any::<(i8, i8)>()));
    let tile = (any::<(i8, i8, u16)>(), list(any::<u8>()));
    let body = prop_oneof![
        beacon().prop_map(Body::Beacon),
        digest.prop_map(Body::Digest),
        wanted.prop_map(|(of, tiles)| Body::Wanted(Wanted { of, tiles })),
        tile.prop_map(|((x, y, epoch), cells)| Body::Tile(TeamTile { x, y, epoch, cells })),
    ];
    (member(), any::<u16>(), body).prop_map(|(from, sequence, body)| Packet {
        from,
        sequence,
        body,
    })
}

fn control() -> impl Strategy<Value = Control> {
    prop_oneof![
        start().prop_map(Control::Start),
        Just(Control::Pause),
        Just(Control::Resume),
        Just(Control::Stop),
        Just(Control::Reset),
    ]
}

fn twist() -> impl Strategy<Value = Twist> {
    (short(), short()).prop_map(|(linear, angular)| Twist { linear, angular })
}

fn pose() -> impl Strategy<Value = Pose> {
    (long(), long(), long(), long(), long(), long()).prop_map(|(x, y, z, roll, pitch, yaw)| Pose {
        x,
        y,
        z,
        roll,
        pitch,
        yaw,
    })
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
    ]
}

fn status() -> impl Strategy<Value = Status> {
    let finish = prop::sample::select(vec![
        Finish::Explored,
        Finish::BoxedIn,
        Finish::Stopped,
        Finish::Covered,
        Finish::NothingAttracts,
    ]);
    let fault = prop::sample::select(vec![
        Fault::StartBlocked,
        Fault::MapFull,
        Fault::OutOfBox,
        Fault::BadObservation,
        Fault::Stuck,
        Fault::PoseLost,
        Fault::Trapped,
    ]);
    prop_oneof![
        Just(Status::Idle),
        Just(Status::Exploring),
        Just(Status::Paused),
        Just(Status::EmergencyStop),
        finish.prop_map(Status::Finished),
        fault.prop_map(Status::Fault),
    ]
}

fn crash() -> impl Strategy<Value = Crash> {
    let cause = prop::sample::select(vec![
        Cause::Panic,
        Cause::Fault,
        Cause::StackOverflow,
        Cause::Watchdog,
    ]);
    (cause, any::<u32>(), text()).prop_map(|(cause, at, file)| Crash { cause, at, file })
}

fn identity() -> impl Strategy<Value = Identity> {
    (
        text(),
        any::<(u32, u16, u16, u16, u16)>(),
        prop::option::of(crash()),
        counters(),
    )
        .prop_map(
            |(build, (boots, tile_slots, tile_pool, max_frame, stale_ms), crash, counters)| {
                Identity {
                    version: fieldline_protocol::VERSION,
                    schema: fieldline_protocol::SCHEMA,
                    build,
                    boots,
                    tile_slots,
                    tile_pool,
                    max_frame,
                    stale_ms,
                    crash,
                    counters,
                }
            },
        )
}

fn counters() -> impl Strategy<Value = Counters> {
    any::<(u32, u32, u32, u32, u32)>().prop_map(
        |(received, crc_errors, dropped, duplicates, stale_stops)| Counters {
            received,
            crc_errors,
            dropped,
            duplicates,
            stale_stops,
        },
    )
}

fn stages() -> impl Strategy<Value = Stages> {
    any::<[u32; 7]>().prop_map(
        |[session, sense, topology, plan, window, solve, drive]| Stages {
            session,
            sense,
            topology,
            plan,
            window,
            solve,
            drive,
        },
    )
}

fn loops() -> impl Strategy<Value = Loops> {
    any::<(bool, u16, u16)>().prop_map(|(closing, closed, given_up)| Loops {
        closing,
        closed,
        given_up,
    })
}

fn location() -> impl Strategy<Value = Location> {
    let quality = prop_oneof![
        Just(Quality::Tracking),
        prop::option::of(short()).prop_map(|direction| Quality::Degenerate { direction }),
        Just(Quality::Lost),
    ];
    let six = [long(), long(), long(), long(), long(), long()];
    ([long(), long(), long()], six, quality).prop_map(|([x, y, yaw], covariance, quality)| {
        Location {
            x,
            y,
            yaw,
            covariance,
            quality,
        }
    })
}

fn command() -> impl Strategy<Value = Command> {
    (
        twist(),
        status(),
        (long(), loops(), any::<bool>(), prop::option::of(location())),
        counters(),
        stages(),
        any::<(u32, u32, u16, bool)>(),
    )
        .prop_map(
            |(
                velocity,
                status,
                (heading, loops, forgot_arrivals, location),
                counters,
                stages,
                cost,
            )| Command {
                velocity,
                status,
                heading,
                loops,
                forgot_arrivals,
                location,
                counters,
                cost: Cost {
                    instructions: cost.0,
                    stages,
                    stack_bytes: cost.1,
                    cycles: cost.2,
                    budget_exhausted: cost.3,
                },
            },
        )
}

fn tile() -> impl Strategy<Value = Tile> {
    let known = any::<(i16, i16, [u16; 2], [u8; 4])>();
    (known, list(any::<u8>()), list(any::<u8>())).prop_map(
        |((x, y, [closed_regions, given_up_regions], visit_stamps), cells, skeleton)| Tile {
            x,
            y,
            cells,
            skeleton,
            closed_regions,
            given_up_regions,
            visit_stamps,
        },
    )
}

fn field_row() -> impl Strategy<Value = FieldRow> {
    let place = any::<(u8, i16, i16, u8)>();
    (place, list(prop::num::f32::NORMAL), list(any::<u8>())).prop_map(
        |((row, origin_x, origin_y, scale), q, cells)| FieldRow {
            row,
            origin_x,
            origin_y,
            scale,
            q,
            cells,
        },
    )
}

fn frontier() -> impl Strategy<Value = ResidualFrontier> {
    let reason = prop::sample::select(vec![
        ResidualReason::Unreachable,
        ResidualReason::Unobservable,
        ResidualReason::OutOfBounds,
        ResidualReason::NoProgress,
        ResidualReason::NotWorthIt,
    ]);
    (any::<(i16, i16, u16)>(), reason).prop_map(|((x, y, cells), reason)| ResidualFrontier {
        x,
        y,
        cells,
        reason,
    })
}

fn path() -> impl Strategy<Value = Path> {
    type MapCell = (i16, i16);
    let ends = any::<(Option<MapCell>, Option<[MapCell; 2]>, u8)>();
    (ends, list(any::<MapCell>())).prop_map(|((tractor, shield, length), cells)| Path {
        tractor,
        shield,
        length,
        cells,
    })
}

fn refusal() -> impl Strategy<Value = Refusal> {
    prop::sample::select(vec![
        Refusal::NotGreeted,
        Refusal::NotStarted,
        Refusal::OutOfOrder,
        Refusal::NoTeam,
        Refusal::BadParameter(Parameter::Beams),
        Refusal::BadParameter(Parameter::MaxAngular),
        Refusal::BadParameter(Parameter::LinearAccel),
        Refusal::BadParameter(Parameter::AngularAccel),
        Refusal::BadParameter(Parameter::Period),
        Refusal::BadParameter(Parameter::UnevenGround),
    ])
}

/// Any reply.
pub(crate) fn reply() -> impl Strategy<Value = Reply> {
    prop_oneof![
        identity().prop_map(Reply::Hello),
        Just(Reply::Incompatible {
            version: fieldline_protocol::VERSION,
            schema: fieldline_protocol::SCHEMA,
        }),
        status().prop_map(Reply::Control),
        command().prop_map(Reply::Command),
        prop::option::of(tile()).prop_map(Reply::Tile),
        prop::option::of(field_row()).prop_map(Reply::FieldRow),
        list(frontier()).prop_map(Reply::Frontiers),
        refusal().prop_map(Reply::Refused),
        crash().prop_map(Reply::Crash),
        path().prop_map(Reply::Path),
        Just(Reply::Heard),
        prop::option::of(packet()).prop_map(Reply::Say),
    ]
}
