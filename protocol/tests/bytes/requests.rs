//! Bytes of every request.

use fieldline_protocol::check::Kind;
use fieldline_protocol::message::{
    Budget, Control, Correct, CorrectedTile, CorrectedTiles, CorrectionProgress, Fence,
    FencePolygon, Hull, INVALID_MM, Laser, LoopLimits, Member, Motion, NO_RETURN_MM, Observation,
    Order, Pose, Preference, Recall, RecalledPoint, Reply, Request, Scan, SpaceField, Start,
    Strategy, TRAIL_BYTES, Team, TeamTile, Twist, UnevenGround,
};
use fixed::types::{I4F12, I16F16};

use super::common::{hello, requests};
use super::{frame, long, reply_is, request_is, schema, short};

#[test]
fn request_hello() {
    request_is(hello(300), &[&[0, 1][..], &schema(), &[0xac, 2]].concat());
}

#[test]
fn request_control_start_on_uneven_ground() {
    let uneven_ground = UnevenGround {
        preference: Preference::Global,
        levels: true,
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
            uneven_ground: Some(uneven_ground),
            ..Start::default()
        })),
        &[
            1, 0, // Control, Start
            0, // frontier
            0, // no lasers
            0xfc, 0x03, 0xf1, 0x03, 0x95, 0x02, // hull of the 3-AT
            0, 0, 0, 0, 0, 0, // radius, speeds, accelerations, period
            1, 2, 1, // uneven ground: some, global, levels on
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
            0x80, 0x80, 0xa0, 0x01, 0x80, 0x80, 0xc0, 0x07, // default limits of loops
            0x80, 0x80, 0x50, 0x80, 0x80, 0x10, 0x80, 0x80, 0xa0, 0x01, //
            0, 0x80, 0x10, // by gain, worth 0.25 = 1024/4096
            0, 0, 0, // no team, no localisation, no survey
            0, 0, // no corner and no polygon of a fence
            0, 0, // no budget of way or time
        ],
    );
}

#[test]
fn strategies_have_fixed_numbers() {
    for (strategy, number) in [(Strategy::Frontier, 0), (Strategy::Ouroboros, 1)] {
        assert_eq!(postcard::to_allocvec(&strategy).unwrap(), [number]);
    }
    let bytes = |impatience_s| {
        let strategy = Strategy::Tdbvp {
            patrol_s: 1800,
            impatience_s,
        };
        postcard::to_allocvec(&strategy).unwrap()
    };
    assert_eq!(bytes(None), [2, 0x88, 14, 0]);
    assert_eq!(bytes(Some(300)), [2, 0x88, 14, 1, 0xac, 2]);
}

#[test]
fn a_space_field_is_its_area_its_target_and_its_impatience() {
    let metres = I16F16::from_num::<f64>;
    let field = SpaceField {
        origin: (metres(-0.5), metres(0.25)),
        size: (metres(10.0), metres(8.0)),
        until_permille: 900,
        impatience_s: Some(5),
    };
    let body = [
        0xff, 0xff, 3, 0x80, 0x80, 2, // -32,768 and 16,384 of 2^-16 m
        0x80, 0x80, 80, 0x80, 0x80, 64, // 655,360 and 524,288
        0x84, 7, 1, 5, // 900, some, 5
    ];
    for (strategy, number) in [(Strategy::Sbpf(field), 3), (Strategy::Esbpf(field), 4)] {
        let bytes = postcard::to_allocvec(&strategy).unwrap();
        assert_eq!(bytes, [&[number], &body[..]].concat());
    }
}

fn laser() -> Laser {
    Laser {
        x: short(0.5),
        y: short(-0.25),
        z: short(1.0),
        pitch: short(0.0),
        first_bearing: long(-1.5),
        bearing_step: long(0.015_625),
        beams: 181,
        range_limit_mm: 12_000,
        turn_time_ms: 130,
        newest_first: true,
    }
}

fn team() -> Team {
    Team {
        member: Member { id: 2, boot: 128 },
        origin: (long(1.0), long(-0.5)),
        yaw: long(0.0),
        sd_mm: 300,
        sd_mrad: 87,
    }
}

fn fence() -> Fence {
    Fence {
        corners: [(0.0, 0.0), (1.0, 0.0), (0.0, -1.0)]
            .into_iter()
            .map(|(x, y)| (long(x), long(y)))
            .collect(),
        polygons: [FencePolygon {
            corners: 3,
            bounds: true,
        }]
        .into_iter()
        .collect(),
    }
}

fn start() -> Start {
    Start {
        strategy: Strategy::Frontier,
        lasers: [laser()].into_iter().collect(),
        hull: Hull::default(),
        robot_radius_mm: 300,
        max_linear: short(0.75),
        max_angular: short(2.5),
        linear_accel: short(0.25),
        angular_accel: short(1.75),
        period_ms: 200,
        uneven_ground: None,
        loops: LoopLimits::default(),
        order: Order::Nearest { worth: I4F12::ZERO },
        team: Some(team()),
        localise: true,
        survey: false,
        fence: fence(),
        budget: Budget {
            range_m: None,
            time_s: Some(600),
        },
    }
}

#[test]
fn request_control_start() {
    request_is(
        Request::Control(Control::Start(start())),
        &[
            1, 0, // Control, Start
            0, // Frontier
            1, // one laser
            0x80, 0x20, // x 0.5 m = 2048/4096, zigzag 4096
            0xff, 0x0f, // y −0.25 m = −1024/4096, zigzag 2047
            0x80, 0x40, // z 1 m
            0,    // pitch
            0xff, 0xff, 0x0b, // first bearing −1.5 rad = −98304/65536, zigzag 196607
            0x80, 0x10, // step 1/64 rad = 1024/65536
            0xb5, 0x01, // 181 beams
            0xe0, 0x5d, // 12000 mm
            0x82, 0x01, 1, // 130 ms a turn, the newest beam first
            0xfc, 0x03, 0xf1, 0x03, 0x95, 0x02, // hull 508 x 497 x 277 mm
            0xac, 0x02, // radius 300 mm
            0x80, 0x30, // 0.75 m/s
            0x80, 0xa0, 0x01, // 2.5 rad/s
            0x80, 0x10, // 0.25 m/s² = 1024/4096
            0x80, 0x70, // 1.75 rad/s² = 7168/4096
            0xc8, 0x01, // 200 ms
            0,    // flat ground
            0x80, 0x80, 0xa0, 0x01, // loops of at least 20 m = 1310720/65536
            0x80, 0x80, 0xc0, 0x07, // at most 120 m
            0x80, 0x80, 0x50, // 10 m more for each metre of frontier
            0x80, 0x80, 0x10, // twice the length
            0x80, 0x80, 0xa0, 0x01, // and 20 m
            1, 0, // nearest first, any worth
            1, 2, 0x80, 0x01, // a team's robot 2, boot 128
            0x80, 0x80, 0x08, 0xff, 0xff, 0x03,
            0, // odometry from (1 m, −0.5 m), not turned
            0xac, 0x02, 87, // within 300 mm and 87 mrad
            1,  // localise
            0,  // survey
            3, 0, 0, 0x80, 0x80, 0x08, 0, 0, 0xff, 0xff, 0x07, // three corners of a fence
            1, 3, 1, // one polygon of three corners: bounds
            0, 1, 0xd8, 0x04, // any range, 600 s
        ],
    );
}

#[test]
fn request_control_without_parameters() {
    request_is(Request::Control(Control::Pause), &[1, 1]);
    request_is(Request::Control(Control::Resume), &[1, 2]);
    request_is(Request::Control(Control::Stop), &[1, 3]);
    request_is(Request::Control(Control::Reset), &[1, 4]);
    request_is(Request::Control(Control::Home), &[1, 5]);
    request_is(Request::Control(Control::Explore), &[1, 7]);
}

#[test]
fn request_control_go_to() {
    let (x, y) = (long(1.0), long(-0.5));
    request_is(
        Request::Control(Control::GoTo { x, y }),
        &[1, 6, 0x80, 0x80, 0x08, 0xff, 0xff, 0x03],
    );
}

#[test]
fn request_control_set_home() {
    let (x, y, yaw) = (long(1.0), long(-0.5), long(0.25));
    request_is(
        Request::Control(Control::SetHome { x, y, yaw }),
        &[1, 8, 0x80, 0x80, 0x08, 0xff, 0xff, 0x03, 0x80, 0x80, 0x02],
    );
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
            2, 1, // smallest pitch and yaw
            0x80, 0x20, 1, // velocity
            2, // two scans
            4, 0, 127, 0x80, 0x01, 0xff, 0x7f, // four ranges
            0,    // no ranges
        ],
    );
}

#[test]
fn request_readouts() {
    request_is(Request::Tile { x: -1, y: 64 }, &[3, 1, 0x80, 0x01]);
    request_is(Request::FieldRow { row: 60 }, &[4, 60]);
    request_is(Request::Frontiers, &[5]);
    request_is(Request::Path { from: 32 }, &[6, 32]);
}

#[test]
fn corrections() {
    let correct = Correct {
        epoch: 300,
        motion: Motion {
            x: long(1.0),
            y: long(-0.5),
            yaw: long(0.0),
        },
        tiles: 2,
    };
    request_is(
        Request::Correct(correct),
        &[
            9, 0xac, 0x02, // epoch 300
            0x80, 0x80, 0x08, 0xff, 0xff, 0x03, 0, // 1 m, −0.5 m, no turn
            2, // two tiles
        ],
    );
    let tile = |x, shift, bytes| CorrectedTile {
        x,
        y: -1,
        shift,
        bytes,
        trail: bytes > 0,
    };
    let free = TeamTile::pack([1; 1024].into_iter());
    let mut trail = [0; TRAIL_BYTES];
    trail[3] = 0x80;
    let part = CorrectedTiles {
        epoch: 300,
        first: 0,
        last: true,
        tiles: [tile(64, (-1, 5), 16), tile(0, (0, 0), 0)]
            .into_iter()
            .collect(),
        cells: free.iter().copied().chain(trail).collect(),
    };
    let head = [
        10, 0xac, 0x02, 0, 1, // the last part
        2, 0x80, 0x01, 1, 0xff, 5, 16, 1, // sixteen runs, and a trail
        0, 1, 0, 0, 0, 0, // a tile that is forgotten
        48,
    ];
    request_is(
        Request::Tiles(part),
        &[&head[..], &[63 << 2 | 1; 16], &trail].concat(),
    );
    let recall = Recall {
        epoch: 300,
        origin: (long(1.0), long(-0.5)),
        points: [RecalledPoint {
            x_mm: -400,
            y_mm: 64,
            returns: 8,
        }]
        .into_iter()
        .collect(),
        track_end: Some(Motion {
            x: long(1.0),
            y: long(-0.5),
            yaw: long(0.0),
        }),
        track: [[100, -1, 0]].into_iter().collect(),
    };
    request_is(
        Request::Recall(recall),
        &[
            11, 0xac, 0x02, // epoch 300
            0x80, 0x80, 0x08, 0xff, 0xff, 0x03, // from 1 m, −0.5 m
            1, 0x9f, 0x06, 0x80, 0x01, 8, // a point of eight returns
            1, 0x80, 0x80, 0x08, 0xff, 0xff, 0x03, 0, // the track's end
            1, 100, 0xff, 0, // 0.4 m ahead, 1 mm to the right
        ],
    );
    let progress = CorrectionProgress {
        epoch: 300,
        next: 2,
        closed: true,
    };
    reply_is(Reply::Corrected(progress), &[12, 0xac, 0x02, 2, 1]);
}

/// A schema without the strategy's number cannot decode the start, so the device drops it.
#[test]
fn an_unknown_strategy_is_not_a_request() {
    let mut body =
        postcard::to_allocvec(&Request::Control(Control::Start(Start::default()))).unwrap();
    assert_eq!(requests(&frame(Kind::Request, 1, &body)).0.len(), 1);
    body[2] = 3;
    assert_eq!(requests(&frame(Kind::Request, 1, &body)).0, []);
}
