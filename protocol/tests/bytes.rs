//! Exact bytes: every message as a value and as what is on the wire, in both directions.
//!
//! Bodies are literals; the frame around them is rebuilt with a bitwise CRC-24 and another crate's COBS, so that no line of
//! the codec under test is used to say what is right. The hello's frames, which never change, are literals as a whole.

mod common;

use common::{hello, replies, reply_frame, request_frame, requests};
use fieldline_protocol::SCHEMA;
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::encode_log;
use fieldline_protocol::message::{
    Cause, Command, Control, Cost, Counters, Crash, Fault, FieldRow, Finish, Frontier, INVALID_MM,
    Identity, Laser, Loops, NO_RETURN_MM, Observation, Parameter, Pose, Preference, Refusal, Reply,
    Request, Residue, Road, Scan, Stages, Start, Status, Strategy, TILE_BYTES, TILE_SKELETON_BYTES,
    Terrain, Tile, Twist,
};
use fixed::types::{I4F12, I16F16};

fn long(value: f32) -> I16F16 {
    I16F16::from_num(value)
}

fn short(value: f32) -> I4F12 {
    I4F12::from_num(value)
}

/// CRC-24/OPENPGP, bit by bit.
fn crc24(content: &[u8]) -> u32 {
    content.iter().fold(0xb7_04ce, |crc, byte| {
        (0..8).fold(crc ^ u32::from(*byte) << 16, |crc, _| {
            let shifted = crc << 1;
            if shifted & 1 << 24 == 0 {
                shifted
            } else {
                shifted ^ 0x0186_4cfb
            }
        })
    })
}

fn frame(kind: Kind, sequence: u16, body: &[u8]) -> Vec<u8> {
    let mut content = [&sequence.to_le_bytes()[..], body].concat();
    let check = crc24(&content) ^ kind.key();
    content.extend(&check.to_le_bytes()[..3]);
    [cobs::encode_vec(&content), vec![0]].concat()
}

#[track_caller]
fn request_is(request: Request, body: &[u8]) {
    assert_eq!(postcard::to_allocvec(&request).unwrap(), body);
    let kind = if matches!(request, Request::Hello { .. }) {
        Kind::Greeting
    } else {
        Kind::Request
    };
    let bytes = request_frame(0x1234, &request);
    assert_eq!(bytes, frame(kind, 0x1234, body));
    assert_eq!(requests(&bytes).0, [(0x1234, request)]);
    assert_eq!(replies(&bytes).0, [], "a host is deaf to requests");
}

#[track_caller]
fn reply_is(reply: Reply, body: &[u8]) {
    assert_eq!(postcard::to_allocvec(&reply).unwrap(), body);
    let kind = match reply {
        Reply::Hello(_) | Reply::Incompatible { .. } => Kind::Welcome,
        _ => Kind::Reply,
    };
    let bytes = reply_frame(0x00ff, &reply);
    assert_eq!(bytes, frame(kind, 0x00ff, body));
    assert_eq!(replies(&bytes).0, [(0x00ff, reply)]);
    assert_eq!(requests(&bytes).0, [], "a device is deaf to replies");
}

/// The schema hash as a varint: its bytes change with the schema.
fn schema() -> Vec<u8> {
    postcard::to_allocvec(&SCHEMA).unwrap()
}

#[test]
fn request_hello() {
    request_is(hello(300), &[&[0, 1][..], &schema(), &[0xac, 2]].concat());
}

#[test]
fn request_control_start_on_uneven_ground() {
    let terrain = Terrain {
        preference: Preference::Global,
        obstacle: short(0.25),
        near: short(1.5),
        hole: short(-0.5),
        least: short(-0.5),
        most: short(2.0),
        height_scale: short(2.0),
        global_scale: long(0.25),
        climb: short(0.5),
        roll: short(0.25),
        step: short(0.0625),
    };
    request_is(
        Request::Control(Control::Start(Start {
            terrain: Some(terrain),
            ..Start::default()
        })),
        &[
            1, 0, // Control, Start
            0, // frontier
            0, 0, // box
            0, // no lasers
            0, 0, 0, 0, 0, 0, // radius, speeds, accelerations, period
            1, 2, // uneven ground: some, global
            0x80, 0x10, // obstacle 0.25 m = 1024/4096
            0x80, 0x60, // near 1.5 m = 6144/4096
            0xff, 0x1f, // hole -0.5 m = -2048/4096, zigzag 4095
            0xff, 0x1f, // least -0.5
            0x80, 0x80, 0x01, // most 2 = 8192/4096
            0x80, 0x80, 0x01, // height scale 2
            0x80, 0x80, 0x02, // global scale 1/4 = 16384/65536
            0x80, 0x20, // climb 0.5 rad = 2048/4096
            0x80, 0x10, // roll 0.25 rad = 1024/4096
            0x80, 0x04, // step 1/16 m = 256/4096
        ],
    );
}

#[test]
fn strategies_have_their_numbers() {
    for (strategy, number) in [(Strategy::Frontier, 0), (Strategy::Ouroboros, 1)] {
        assert_eq!(postcard::to_allocvec(&strategy).unwrap(), [number]);
    }
    let strategy = Strategy::Tdbvp { patrol_s: 1800 };
    assert_eq!(postcard::to_allocvec(&strategy).unwrap(), [2, 0x88, 14]);
}

#[test]
fn request_control_start() {
    let laser = Laser {
        x: short(0.5),
        y: short(-0.25),
        z: short(1.0),
        pitch: short(0.0),
        first_bearing: long(-1.5),
        bearing_step: long(0.015_625),
        beams: 181,
        range_limit_mm: 12_000,
    };
    request_is(
        Request::Control(Control::Start(Start {
            strategy: Strategy::Frontier,
            box_tiles: (20, 12),
            lasers: [laser].into_iter().collect(),
            robot_radius_mm: 300,
            max_linear: short(0.75),
            max_angular: short(2.5),
            linear_accel: short(0.25),
            angular_accel: short(1.75),
            period_ms: 200,
            terrain: None,
        })),
        &[
            1, 0, // Control, Start
            0, 20, 12, // Frontier, box
            1,  // one laser
            0x80, 0x20, // x 0.5 m = 2048/4096, zigzag 4096
            0xff, 0x0f, // y −0.25 m = −1024/4096, zigzag 2047
            0x80, 0x40, // z 1 m
            0,    // pitch
            0xff, 0xff, 0x0b, // first bearing −1.5 rad = −98304/65536, zigzag 196607
            0x80, 0x10, // step 1/64 rad = 1024/65536
            0xb5, 0x01, // 181 beams
            0xe0, 0x5d, // 12000 mm
            0xac, 0x02, // radius 300 mm
            0x80, 0x30, // 0.75 m/s
            0x80, 0xa0, 0x01, // 2.5 rad/s
            0x80, 0x10, // 0.25 m/s² = 1024/4096
            0x80, 0x70, // 1.75 rad/s² = 7168/4096
            0xc8, 0x01, // 200 ms
            0,    // flat ground
        ],
    );
}

#[test]
fn request_control_without_parameters() {
    request_is(Request::Control(Control::Pause), &[1, 1]);
    request_is(Request::Control(Control::Resume), &[1, 2]);
    request_is(Request::Control(Control::Stop), &[1, 3]);
    request_is(Request::Control(Control::Reset), &[1, 4]);
}

#[test]
fn request_observation() {
    request_is(
        Request::Observation(Observation {
            time_ms: 100,
            pose: Pose {
                x: long(1.0),
                y: long(-1.0),
                z: long(0.0),
                roll: long(0.5),
                pitch: I16F16::DELTA,
                yaw: -I16F16::DELTA,
            },
            velocity: Twist {
                linear: short(0.5),
                angular: -I4F12::DELTA,
            },
            scans: [
                Scan {
                    ranges_mm: [INVALID_MM, 127, 128, NO_RETURN_MM].into_iter().collect(),
                },
                Scan::default(),
            ]
            .into_iter()
            .collect(),
        }),
        &[
            2, 100, // Observation, time
            0x80, 0x80, 0x08, // x 1 m = 65536, zigzag 131072
            0xff, 0xff, 0x07, // y −1 m
            0,    // z
            0x80, 0x80, 0x04, // roll 0.5 rad
            2, 1, // the least pitch and yaw
            0x80, 0x20, 1, // velocity
            2, // two scans
            4, 0, 127, 0x80, 0x01, 0xff, 0x7f, // four ranges
            0,    // none
        ],
    );
}

#[test]
fn request_pictures() {
    request_is(Request::Tile { x: -1, y: 64 }, &[3, 1, 0x80, 0x01]);
    request_is(Request::FieldRow { row: 60 }, &[4, 60]);
    request_is(Request::Frontiers, &[5]);
    request_is(Request::Road { from: 32 }, &[6, 32]);
}

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
        (Status::Fault(Fault::StartBlocked), &[2, 5, 0]),
        (Status::Fault(Fault::MapFull), &[2, 5, 1]),
        (Status::Fault(Fault::OutOfBox), &[2, 5, 2]),
        (Status::Fault(Fault::BadObservation), &[2, 5, 3]),
        (Status::Fault(Fault::Stuck), &[2, 5, 4]),
    ] {
        reply_is(Reply::Control(status), body);
    }
}

#[test]
fn reply_command() {
    reply_is(
        Reply::Command(Command {
            velocity: Twist {
                linear: short(0.25),
                angular: short(-1.0),
            },
            status: Status::Exploring,
            heading: long(-0.5),
            loops: Loops {
                closing: true,
                closed: 300,
                given_up: 2,
            },
            counters: Counters {
                received: 200,
                crc_errors: 1,
                dropped: 2,
                duplicates: 3,
                stale_stops: 4,
            },
            cost: Cost {
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
            },
        }),
        &[
            3, // Command
            0x80, 0x10, 0xff, 0x3f, // velocity
            1,    // exploring
            0xff, 0xff, 0x03, // heading −0.5 rad = −32768/65536
            1, 0xac, 0x02, 2, // loops
            0xc8, 0x01, 1, 2, 3, 4, // counters
            0xc0, 0x84, 0x3d, 1, 2, 3, 4, 5, 0x80, 0x01, 7, // instructions, by stages
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
            marks: 0x8001,
            dates: [0, 1, 254, 255],
        })),
        &[
            &[4, 1, 4, 3, 0x80, 0x02][..],
            &cells,
            &[32],
            &skeleton,
            &[0x81, 0x80, 0x02],
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
    let frontier = |x, reason| Frontier {
        x,
        y: -1,
        cells: 9,
        reason,
    };
    reply_is(Reply::Frontiers(heapless::Vec::new()), &[6, 0]);
    reply_is(
        Reply::Frontiers(
            [
                frontier(0, Residue::Unreachable),
                frontier(1, Residue::Unobservable),
                frontier(2, Residue::OutOfBounds),
                frontier(3, Residue::NoProgress),
            ]
            .into_iter()
            .collect(),
        ),
        &[6, 4, 0, 1, 9, 0, 2, 1, 9, 1, 4, 1, 9, 2, 6, 1, 9, 3],
    );
}

#[test]
fn reply_road() {
    reply_is(Reply::Road(Road::default()), &[9, 0, 0, 0, 0]);
    reply_is(
        Reply::Road(Road {
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
        (Refusal::BadBox, &[7, 3]),
        (Refusal::BadParameter(Parameter::Lasers), &[7, 4, 0]),
        (Refusal::BadParameter(Parameter::Beams), &[7, 4, 1]),
        (Refusal::BadParameter(Parameter::RangeLimit), &[7, 4, 2]),
        (Refusal::BadParameter(Parameter::Bearing), &[7, 4, 3]),
        (Refusal::BadParameter(Parameter::Pitch), &[7, 4, 4]),
        (Refusal::BadParameter(Parameter::Mount), &[7, 4, 5]),
        (Refusal::BadParameter(Parameter::Radius), &[7, 4, 6]),
        (Refusal::BadParameter(Parameter::MaxLinear), &[7, 4, 7]),
        (Refusal::BadParameter(Parameter::MaxAngular), &[7, 4, 8]),
        (Refusal::BadParameter(Parameter::LinearAccel), &[7, 4, 9]),
        (Refusal::BadParameter(Parameter::AngularAccel), &[7, 4, 10]),
        (Refusal::BadParameter(Parameter::Period), &[7, 4, 11]),
        (Refusal::UnknownStrategy, &[7, 5]),
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

#[test]
fn logs_go_as_they_are() {
    let mut out = [0; 32];
    let length = encode_log(7, &[0, 1, 0xff], &mut out).unwrap();
    assert_eq!(out[..length], frame(Kind::Log, 7, &[0, 1, 0xff]));
    assert_eq!(requests(&out[..length]).0, []);
}

/// These bytes never change, whatever becomes of the protocol: version 9 with schema 1 greets, and is answered.
#[test]
fn the_hello_of_any_version_has_this_frame() {
    let greeting = Request::Hello {
        version: 9,
        schema: 1,
        nonce: 2,
    };
    assert_eq!(request_frame(1, &greeting), GREETING_OF_VERSION_9);
    let refusal = Reply::Incompatible {
        version: 9,
        schema: 1,
    };
    assert_eq!(reply_frame(1, &refusal), REFUSAL_OF_VERSION_9);
}

const GREETING_OF_VERSION_9: &[u8] = &[2, 1, 1, 7, 9, 1, 2, 0x72, 0x8c, 0x12, 0];
const REFUSAL_OF_VERSION_9: &[u8] = &[2, 1, 7, 1, 9, 1, 0x85, 5, 0x69, 0];
