//! Bytes of every reply.

use fieldline_protocol::SCHEMA;
use fieldline_protocol::check::Kind;
use fieldline_protocol::message::{
    Cause, Command, Cost, Counters, Crash, Doing, Errand, Events, Fault, FieldRow, Finish,
    Identity, InputFaults, Location, Loops, Mistake, Parameter, Path, Quality, Refusal, Reply,
    ResidualFrontier, ResidualReason, Stages, Status, TILE_BYTES, TILE_SKELETON_BYTES, Tile, Twist,
};

use super::common::replies;
use super::{frame, long, reply_is, schema, short};

#[test]
fn reply_hello() {
    let identity = Identity {
        version: 1,
        schema: SCHEMA,
        build: "0.1.0".try_into().unwrap(),
        boots: 3,
        tile_slots: 400,
        tile_pool: 192,
        max_frame: 1144,
        stale_ms: 500,
        crash: None,
        counters: Counters {
            received: 1,
            crc_errors: 2,
            dropped: 3,
            duplicates: 4,
            stale_stops: 5,
        },
    };
    let body = [
        &[0, 1][..],
        &schema(),
        &[5, b'0', b'.', b'1', b'.', b'0'],
        &[3, 0x90, 0x03, 0xc0, 0x01, 0xf8, 0x08, 0xf4, 0x03],
    ]
    .concat();
    reply_is(
        Reply::Hello(identity.clone()),
        &[&body[..], &[0, 1, 2, 3, 4, 5]].concat(),
    );
    reply_is(
        Reply::Hello(Identity {
            crash: Some(Crash {
                cause: Cause::Fault,
                at: 0x0800_0102,
                file: heapless::String::new(),
            }),
            ..identity
        }),
        &[&body[..], &[1, 1, 0x82, 0x82, 0x80, 0x40, 0, 1, 2, 3, 4, 5]].concat(),
    );
}

#[test]
fn reply_incompatible() {
    reply_is(
        Reply::Incompatible {
            version: 1,
            schema: SCHEMA,
        },
        &[&[1, 1][..], &schema()].concat(),
    );
}

#[test]
fn reply_control_with_every_status() {
    for (status, body) in [
        (Status::Idle, &[2, 0][..]),
        (Status::Exploring, &[2, 1]),
        (Status::Paused, &[2, 2]),
        (Status::EmergencyStop, &[2, 3]),
        (Status::Finished(Finish::Explored), &[2, 4, 0]),
        (Status::Finished(Finish::BoxedIn), &[2, 4, 1]),
        (Status::Finished(Finish::Stopped), &[2, 4, 2]),
        (Status::Finished(Finish::Covered), &[2, 4, 3]),
        (Status::Finished(Finish::NothingAttracts), &[2, 4, 4]),
        (Status::Fault(Fault::StartBlocked), &[2, 5, 0]),
        (Status::Fault(Fault::MapFull), &[2, 5, 1]),
        (Status::Fault(Fault::OutOfBox), &[2, 5, 2]),
        (Status::Fault(Fault::BadObservation), &[2, 5, 3]),
        (Status::Fault(Fault::Stuck), &[2, 5, 4]),
        (Status::Fault(Fault::PoseLost), &[2, 5, 5]),
        (Status::Fault(Fault::Trapped), &[2, 5, 6]),
        (Status::Fault(Fault::StartForbidden), &[2, 5, 7]),
        (
            Status::Fault(Fault::Miswired(Mistake::ScanMirrored)),
            &[2, 5, 8, 0],
        ),
        (
            Status::Fault(Fault::Miswired(Mistake::ClockFast)),
            &[2, 5, 8, 16],
        ),
        (Status::NoScan, &[2, 6]),
        (Status::Going(Errand::Home), &[2, 7, 0]),
        (Status::Going(Errand::Goal), &[2, 7, 1]),
        (Status::Arrived(Errand::Home), &[2, 8, 0]),
        (Status::Unreachable(Errand::Goal), &[2, 9, 1]),
    ] {
        reply_is(Reply::Control(status), body);
    }
}

fn location() -> Location {
    Location {
        x: long(1.0),
        y: long(-0.5),
        yaw: long(0.25),
        covariance: [1.0, 0.0, 2.0, 0.0, -0.5, 0.25].map(long),
        quality: Quality::Degenerate {
            direction: Some(short(0.5)),
        },
    }
}

fn cost() -> Cost {
    Cost {
        instructions: 1_000_000,
        stages: Stages {
            session: 1,
            sense: 2,
            topology: 3,
            plan: 4,
            window: 5,
            solve: 128,
            drive: 7,
        },
        stack_bytes: 4096,
        cycles: 3,
        budget_exhausted: true,
    }
}

fn command() -> Command {
    Command {
        velocity: Twist {
            linear: short(0.25),
            angular: short(-1.0),
        },
        status: Status::Exploring,
        doing: Doing::GoesBack,
        events: Events(0x81),
        heading: long(-0.5),
        loops: Loops {
            closing: true,
            closed: 300,
            given_up: 2,
        },
        forgot_arrivals: true,
        input_faults: InputFaults {
            refused: 5,
            jumps: 6,
            clock: 130,
        },
        map_epoch: 200,
        location: Some(location()),
        counters: Counters {
            received: 200,
            crc_errors: 1,
            dropped: 2,
            duplicates: 3,
            stale_stops: 4,
        },
        cost: cost(),
    }
}

#[test]
fn reply_command() {
    reply_is(
        Reply::Command(command()),
        &[
            3, // Command
            0x80, 0x10, 0xff, 0x3f, // velocity
            1,    // exploring
            8, 0x81, 0x01, // goes back; two events
            0xff, 0xff, 0x03, // heading −0.5 rad = −32768/65536
            1, 0xac, 0x02, 2, // loops
            1, // what came is forgotten
            5, 6, 0x82, 0x01, // faults of the input
            0xc8, 0x01, // epoch of the map
            1,    // a location
            0x80, 0x80, 0x08, 0xff, 0xff, 0x03, 0x80, 0x80, 0x02, // x, y, yaw
            0x80, 0x80, 0x08, 0, 0x80, 0x80, 0x10, 0, 0xff, 0xff, 0x03, 0x80, 0x80, 0x02, 1, 1,
            0x80, 0x20, // degenerate, at 0.5 rad
            0xc8, 0x01, 1, 2, 3, 4, // counters
            0xc0, 0x84, 0x3d, 1, 2, 3, 4, 5, 0x80, 0x01, 7, // instructions, then each stage
            0x80, 0x20, 3, 1, // the rest of the cost
        ],
    );
}

#[test]
fn reply_tile() {
    reply_is(Reply::Tile(None), &[4, 0]);
    let cells: [u8; TILE_BYTES] = core::array::from_fn(|at| at as u8);
    let skeleton = [0x81; TILE_SKELETON_BYTES];
    reply_is(
        Reply::Tile(Some(Tile {
            x: 2,
            y: -2,
            cells: cells.into_iter().collect(),
            skeleton: skeleton.into_iter().collect(),
            closed_regions: 0x8001,
            given_up_regions: 0x0180,
            visit_stamps: [0, 1, 254, 255],
        })),
        &[
            &[4, 1, 4, 3, 0x80, 0x02][..],
            &cells,
            &[32],
            &skeleton,
            &[0x81, 0x80, 0x02], // closed regions
            &[0x80, 0x03],       // given up regions
            &[0, 1, 254, 255],
        ]
        .concat(),
    );
}

#[test]
fn reply_field_row() {
    reply_is(Reply::FieldRow(None), &[5, 0]);
    reply_is(
        Reply::FieldRow(Some(FieldRow {
            row: 7,
            origin_x: -30,
            origin_y: 30,
            scale: 1,
            q: [1.0, 0.5, 0.0].into_iter().collect(),
            cells: [0b01_00_10].into_iter().collect(),
        })),
        &[
            5, 1, 7, 59, 60, 1, // row, origin, scale
            3, 0, 0, 0x80, 0x3f, 0, 0, 0, 0x3f, 0, 0, 0, 0, // three cells
            1, 18, // goal, free, obstacle
        ],
    );
}

#[test]
fn reply_frontiers() {
    let frontier = |x, reason| ResidualFrontier {
        x,
        y: -1,
        cells: 9,
        reason,
    };
    reply_is(Reply::Frontiers(heapless::Vec::new()), &[6, 0]);
    reply_is(
        Reply::Frontiers(
            [
                frontier(0, ResidualReason::Unreachable),
                frontier(1, ResidualReason::Unobservable),
                frontier(2, ResidualReason::OutOfBounds),
                frontier(3, ResidualReason::NoProgress),
                frontier(4, ResidualReason::NotWorthIt),
            ]
            .into_iter()
            .collect(),
        ),
        &[
            6, 5, 0, 1, 9, 0, 2, 1, 9, 1, 4, 1, 9, 2, 6, 1, 9, 3, 8, 1, 9, 4,
        ],
    );
}

#[test]
fn reply_path() {
    reply_is(Reply::Path(Path::default()), &[9, 0, 0, 0, 0]);
    reply_is(
        Reply::Path(Path {
            tractor: Some((-2, 64)),
            shield: Some([(0, 2), (4, 6)]),
            length: 96,
            cells: [(8, 0), (10, -2)].into_iter().collect(),
        }),
        &[
            9, 1, 3, 0x80, 0x01, // tractor point
            1, 0, 4, 8, 12, // shield
            96, 2, 16, 0, 20, 3, // two cells of 96
        ],
    );
}

#[test]
fn reply_refused() {
    for (refusal, body) in [
        (Refusal::NotGreeted, &[7, 0][..]),
        (Refusal::NotStarted, &[7, 1]),
        (Refusal::OutOfOrder, &[7, 2]),
        (Refusal::BadParameter(Parameter::Lasers), &[7, 3, 0]),
        (Refusal::BadParameter(Parameter::Beams), &[7, 3, 1]),
        (Refusal::BadParameter(Parameter::RangeLimit), &[7, 3, 2]),
        (Refusal::BadParameter(Parameter::Bearing), &[7, 3, 3]),
        (Refusal::BadParameter(Parameter::Pitch), &[7, 3, 4]),
        (Refusal::BadParameter(Parameter::Mount), &[7, 3, 5]),
        (Refusal::BadParameter(Parameter::Radius), &[7, 3, 6]),
        (Refusal::BadParameter(Parameter::MaxLinear), &[7, 3, 7]),
        (Refusal::BadParameter(Parameter::MaxAngular), &[7, 3, 8]),
        (Refusal::BadParameter(Parameter::LinearAccel), &[7, 3, 9]),
        (Refusal::BadParameter(Parameter::AngularAccel), &[7, 3, 10]),
        (Refusal::BadParameter(Parameter::Period), &[7, 3, 11]),
        (Refusal::BadParameter(Parameter::Preference), &[7, 3, 12]),
        (Refusal::BadParameter(Parameter::UnevenGround), &[7, 3, 13]),
        (Refusal::BadParameter(Parameter::Hull), &[7, 3, 14]),
        (Refusal::BadParameter(Parameter::LoopLimits), &[7, 3, 15]),
        (Refusal::BadParameter(Parameter::Worth), &[7, 3, 16]),
        (Refusal::BadParameter(Parameter::Area), &[7, 3, 17]),
        (Refusal::BadParameter(Parameter::Coverage), &[7, 3, 18]),
        (Refusal::BadParameter(Parameter::Team), &[7, 3, 19]),
        (Refusal::BadParameter(Parameter::Fence), &[7, 3, 20]),
        (Refusal::BadParameter(Parameter::TurnTime), &[7, 3, 21]),
        (Refusal::NoTeam, &[7, 4]),
        (Refusal::NoCorrection, &[7, 5]),
        (Refusal::BadCorrection, &[7, 6]),
        (Refusal::BadTile, &[7, 7]),
        (Refusal::NotReady, &[7, 8]),
        (Refusal::BadGoal, &[7, 9]),
    ] {
        reply_is(Reply::Refused(refusal), body);
    }
}

#[test]
fn reply_crash() {
    reply_is(
        Reply::Crash(Crash {
            cause: Cause::Panic,
            at: 128,
            file: "src/a.rs".try_into().unwrap(),
        }),
        b"\x08\x00\x80\x01\x08src/a.rs",
    );
    for (cause, number) in [
        (Cause::Fault, 1),
        (Cause::StackOverflow, 2),
        (Cause::Watchdog, 3),
    ] {
        let crash = Crash {
            cause,
            ..Crash::default()
        };
        reply_is(Reply::Crash(crash), &[8, number, 0, 0]);
    }
}

/// Number 10 is free: no refusal has it.
#[test]
fn an_unknown_refusal_is_not_a_reply() {
    assert_eq!(replies(&frame(Kind::Reply, 1, &[7, 2])).0.len(), 1);
    assert_eq!(replies(&frame(Kind::Reply, 1, &[7, 10])).0, []);
}
