//! What a device answers.

use fieldline_protocol::message::{
    Cause, Command, CorrectionProgress, Cost, Counters, Crash, Doing, Errand, Events, Fault,
    FieldRow, Finish, Identity, InputFaults, Location, Loops, Mistake, Parameter, Path, Quality,
    Refusal, Reply, ResidualFrontier, ResidualReason, Stages, Status, Tile,
};
use proptest::prelude::*;

use super::team::packet;
use super::{list, long, short, text, twist};

fn doing() -> impl Strategy<Value = Doing> {
    prop::sample::select(vec![
        Doing::Stands,
        Doing::Waits,
        Doing::Explores,
        Doing::FollowsForces,
        Doing::GoesToLook,
        Doing::GoesByOrder,
        Doing::Searches,
        Doing::Recovers,
        Doing::GoesBack,
        Doing::LooksForGaps,
        Doing::LooksAbout,
        Doing::MakesWay,
    ])
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
        Fault::StartForbidden,
        Fault::Miswired(Mistake::ScanMirrored),
        Fault::Miswired(Mistake::ClockFast),
    ]);
    let errand = prop::sample::select(vec![Errand::Home, Errand::Goal]);
    prop_oneof![
        Just(Status::Idle),
        Just(Status::Exploring),
        Just(Status::Paused),
        Just(Status::EmergencyStop),
        Just(Status::NoScan),
        errand.clone().prop_map(Status::Going),
        errand.clone().prop_map(Status::Arrived),
        errand.prop_map(Status::Unreachable),
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

fn input_faults() -> impl Strategy<Value = InputFaults> {
    any::<(u32, u32, u32)>().prop_map(|(refused, jumps, clock)| InputFaults {
        refused,
        jumps,
        clock,
    })
}

fn command() -> impl Strategy<Value = Command> {
    (
        twist(),
        (status(), doing(), any::<u16>().prop_map(Events)),
        (
            long(),
            loops(),
            any::<bool>(),
            input_faults(),
            (any::<u16>(), prop::option::of(location())),
        ),
        counters(),
        stages(),
        any::<(u32, u32, u16, bool)>(),
    )
        .prop_map(
            |(
                velocity,
                (status, doing, events),
                (heading, loops, forgot_arrivals, input_faults, (map_epoch, location)),
                counters,
                stages,
                cost,
            )| Command {
                velocity,
                status,
                doing,
                events,
                heading,
                loops,
                forgot_arrivals,
                input_faults,
                map_epoch,
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
        Refusal::NoCorrection,
        Refusal::BadCorrection,
        Refusal::BadTile,
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
        any::<(u16, u16, bool)>().prop_map(|(epoch, next, closed)| {
            Reply::Corrected(CorrectionProgress {
                epoch,
                next,
                closed,
            })
        }),
    ]
}
