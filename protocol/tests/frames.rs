//! Round trips of arbitrary messages, the sizes of the largest messages, and the cost of a frame.

mod common;

use common::arbitrary::{replies::reply, requests::request};
use common::{
    checked_frame, hello, largest_observation, replies, reply_frame, request_frame, requests,
};
use fieldline_protocol::check::Kind;
use fieldline_protocol::frame::{
    BodyError, MAX_LOG_BYTES, MAX_REPLY_FRAME, MAX_REQUEST_FRAME, Receiver, Side, TooLong,
    encode_log, encode_reply, encode_request, overhead,
};
use fieldline_protocol::message::{
    self, BUILD_BYTES, Budget, CORRECTED_BYTES, CORRECTED_TILES, CRASH_FILE_BYTES, Cause, Control,
    CorrectedTile, CorrectedTiles, Counters, Crash, FENCE_CORNERS, FENCE_POLYGONS,
    FIELD_CELL_BYTES, FIELD_SIDE, Fence, FencePolygon, FieldRow, Hull, Identity, Laser, LoopLimits,
    MAX_FRONTIERS, MAX_SCANS, Member, Motion, NO_RETURN_MM, Order, PATH_PAGE, Path, Preference,
    RECALLED_POINTS, RECALLED_TRACK, Recall, RecalledPoint, Reply, Request, ResidualFrontier,
    ResidualReason, Start, TILE_BYTES, TILE_SKELETON_BYTES, TILE_STAMPS, Team, Tile, UnevenGround,
};
use fieldline_protocol::{SCHEMA, VERSION};
use fixed::types::{I4F12, I16F16};
use proptest::prelude::*;

proptest! {
    #[test]
    fn every_request_round_trips(sequence in any::<u16>(), request in request()) {
        let (heard, tally) = requests(&request_frame(sequence, &request));
        prop_assert_eq!(heard, [(sequence, request)]);
        prop_assert_eq!((tally.received, tally.crc_errors, tally.dropped), (1, 0, 0));
    }

    #[test]
    fn every_reply_round_trips(sequence in any::<u16>(), reply in reply()) {
        let (heard, tally) = replies(&reply_frame(sequence, &reply));
        prop_assert_eq!(heard, [(sequence, reply)]);
        prop_assert_eq!((tally.received, tally.crc_errors, tally.dropped), (1, 0, 0));
    }

    #[test]
    fn every_log_round_trips(log in prop::collection::vec(any::<u8>(), 0..=MAX_LOG_BYTES)) {
        let mut out = [0; MAX_REPLY_FRAME];
        let length = encode_log(3, &log, &mut out).unwrap();
        let mut receiver = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
        let mut heard = Vec::new();
        for byte in &out[..length] {
            heard.extend(receiver.push(*byte).map(|frame| frame.body.to_vec()));
        }
        prop_assert_eq!(heard, [log]);
    }

    #[test]
    fn adjacent_frames_are_separated(requests_in in prop::collection::vec(request(), 0..6)) {
        let frames = requests_in.iter().flat_map(|request| request_frame(1, request));
        let heard = requests(&frames.collect::<Vec<u8>>()).0.into_iter();
        let heard: Vec<Request> = heard.map(|(_, request)| request).collect();
        prop_assert_eq!(heard, requests_in);
    }

    #[test]
    fn a_short_buffer_is_an_error(request in request(), room in 0usize..64) {
        let length = request_frame(1, &request).len();
        let mut out = vec![0; room];
        let fits = encode_request(1, &request, &mut out);
        prop_assert_eq!(fits, if length <= room { Ok(length) } else { Err(TooLong) });
    }
}

/// The least number of 16 bits: it takes most bytes.
const FAR: I4F12 = I4F12::MIN;
/// The least number of 32 bits.
const FARTHEST: I16F16 = I16F16::MIN;

fn largest_tile() -> Reply {
    Reply::Tile(Some(Tile {
        x: i16::MIN,
        y: i16::MIN,
        cells: [0xff; TILE_BYTES].into_iter().collect(),
        skeleton: [0xff; TILE_SKELETON_BYTES].into_iter().collect(),
        closed_regions: u16::MAX,
        given_up_regions: u16::MAX,
        visit_stamps: [u8::MAX; TILE_STAMPS],
    }))
}

fn largest_laser() -> Laser {
    Laser {
        x: FAR,
        y: FAR,
        z: FAR,
        pitch: FAR,
        first_bearing: FARTHEST,
        bearing_step: FARTHEST,
        beams: u16::MAX,
        range_limit_mm: u16::MAX,
        turn_time_ms: u16::MAX,
        newest_first: true,
    }
}

fn largest_strategy() -> message::Strategy {
    message::Strategy::Esbpf(message::SpaceField {
        origin: (FARTHEST, FARTHEST),
        size: (FARTHEST, FARTHEST),
        until_permille: u16::MAX,
        impatience_s: Some(u16::MAX),
    })
}

fn largest_ground() -> UnevenGround {
    UnevenGround {
        preference: Preference::Both,
        levels: true,
        obstacle: FAR,
        near: FAR,
        hole: FAR,
        least: FAR,
        most: FAR,
        height_scale: FAR,
        global_scale: FARTHEST,
        climb: FAR,
        roll: FAR,
        step: FAR,
    }
}

fn largest_loops() -> LoopLimits {
    LoopLimits {
        least: FARTHEST,
        most: FARTHEST,
        most_per_frontier: FARTHEST,
        detour: FARTHEST,
        slack: FARTHEST,
    }
}

fn largest_team() -> Team {
    Team {
        member: Member {
            id: u8::MAX,
            boot: u16::MAX,
        },
        origin: (FARTHEST, FARTHEST),
        yaw: FARTHEST,
        sd_mm: u16::MAX,
        sd_mrad: u16::MAX,
    }
}

fn largest_fence() -> Fence {
    Fence {
        corners: [(FARTHEST, FARTHEST); FENCE_CORNERS].into_iter().collect(),
        polygons: [FencePolygon {
            corners: u8::MAX,
            bounds: true,
        }; FENCE_POLYGONS]
            .into_iter()
            .collect(),
    }
}

fn largest_start() -> Start {
    Start {
        strategy: largest_strategy(),
        lasers: [largest_laser(); MAX_SCANS].into_iter().collect(),
        hull: Hull {
            length_mm: u16::MAX,
            width_mm: u16::MAX,
            height_mm: u16::MAX,
        },
        robot_radius_mm: u16::MAX,
        max_linear: FAR,
        max_angular: FAR,
        linear_accel: FAR,
        angular_accel: FAR,
        period_ms: u16::MAX,
        uneven_ground: Some(largest_ground()),
        loops: largest_loops(),
        order: Order::Gain { worth: FAR },
        team: Some(largest_team()),
        localise: true,
        survey: true,
        fence: largest_fence(),
        budget: Budget {
            range_m: Some(u16::MAX),
            time_s: Some(u16::MAX),
        },
    }
}

fn largest_part() -> CorrectedTiles {
    let tile = CorrectedTile {
        x: i16::MIN,
        y: i16::MIN,
        shift: (i8::MIN, i8::MIN),
        bytes: u16::MAX,
        trail: true,
    };
    CorrectedTiles {
        epoch: u16::MAX,
        first: u16::MAX,
        last: true,
        tiles: [tile; CORRECTED_TILES].into_iter().collect(),
        cells: [0xff; CORRECTED_BYTES].into_iter().collect(),
    }
}

fn largest_recall() -> Recall {
    Recall {
        epoch: u16::MAX,
        origin: (I16F16::MIN, I16F16::MIN),
        points: [RecalledPoint {
            x_mm: i16::MIN,
            y_mm: i16::MIN,
            returns: u8::MAX,
        }; RECALLED_POINTS]
            .into_iter()
            .collect(),
        track_end: Some(Motion {
            x: I16F16::MIN,
            y: I16F16::MIN,
            yaw: I16F16::MIN,
        }),
        track: [[i8::MIN; 3]; RECALLED_TRACK].into_iter().collect(),
    }
}

fn largest_crash() -> Crash {
    let file = "f".repeat(CRASH_FILE_BYTES).as_str().try_into().unwrap();
    Crash {
        cause: Cause::Fault,
        at: u32::MAX,
        file,
    }
}

fn largest_identity() -> Identity {
    Identity {
        version: u16::MAX,
        schema: u32::MAX,
        build: "b".repeat(BUILD_BYTES).as_str().try_into().unwrap(),
        boots: u32::MAX,
        tile_slots: u16::MAX,
        tile_pool: u16::MAX,
        max_frame: u16::MAX,
        stale_ms: u16::MAX,
        crash: Some(largest_crash()),
        counters: Counters {
            received: u32::MAX,
            crc_errors: u32::MAX,
            dropped: u32::MAX,
            duplicates: u32::MAX,
            stale_stops: u32::MAX,
        },
    }
}

fn largest_row() -> FieldRow {
    FieldRow {
        row: 255,
        origin_x: i16::MIN,
        origin_y: i16::MIN,
        scale: 255,
        q: [f32::MAX; FIELD_SIDE].into_iter().collect(),
        cells: [u8::MAX; FIELD_CELL_BYTES].into_iter().collect(),
    }
}

fn largest_path() -> Path {
    Path {
        tractor: Some((i16::MIN, i16::MIN)),
        shield: Some([(i16::MIN, i16::MIN); 2]),
        length: u8::MAX,
        cells: [(i16::MIN, i16::MIN); PATH_PAGE].into_iter().collect(),
    }
}

fn most_frontiers() -> Reply {
    Reply::Frontiers(
        [ResidualFrontier {
            x: i16::MIN,
            y: i16::MIN,
            cells: u16::MAX,
            reason: ResidualReason::NoProgress,
        }; MAX_FRONTIERS]
            .into_iter()
            .collect(),
    )
}

/// The largest message of each kind, written by hand.
#[test]
fn the_largest_messages_fit_and_fill_their_frames() {
    let worst = request_frame(
        u16::MAX,
        &Request::Observation(largest_observation(u16::MAX)),
    );
    assert_eq!(worst.len(), MAX_REQUEST_FRAME);
    assert_eq!(
        reply_frame(u16::MAX, &largest_tile()).len(),
        MAX_REPLY_FRAME
    );
    let start = Request::Control(Control::Start(largest_start()));
    assert!(request_frame(1, &start).len() <= MAX_REQUEST_FRAME);
    let part = Request::Tiles(largest_part());
    assert!(request_frame(1, &part).len() <= MAX_REQUEST_FRAME);
    let recall = Request::Recall(largest_recall());
    assert!(request_frame(1, &recall).len() <= MAX_REQUEST_FRAME);
    for reply in [
        Reply::Hello(largest_identity()),
        Reply::Crash(largest_crash()),
        Reply::FieldRow(Some(largest_row())),
        Reply::Path(largest_path()),
        most_frontiers(),
    ] {
        assert!(reply_frame(1, &reply).len() <= MAX_REPLY_FRAME);
    }
    let mut out = [0; MAX_REPLY_FRAME];
    assert!(encode_log(1, &[0xff; MAX_LOG_BYTES], &mut out).is_ok());
}

#[test]
fn a_frame_costs_at_most_ten_bytes() {
    let full = Request::Observation(largest_observation(NO_RETURN_MM));
    let body = postcard::to_allocvec(&full).unwrap().len();
    let cost = request_frame(0xffff, &full).len() - body;
    assert_eq!((body, cost), (771, 10));
    assert_eq!(overhead(body), 10);
    assert_eq!(MAX_REPLY_FRAME - overhead(309), 309);
    assert!(overhead(309) <= 10);
    let small = request_frame(0xffff, &Request::Frontiers);
    assert_eq!(small.len() - 1, 7);
}

#[test]
fn a_hello_of_another_version_is_foreign_on_both_sides() {
    let foreign = BodyError::Foreign {
        version: VERSION + 1,
        schema: SCHEMA ^ 1,
    };
    let request = Request::Hello {
        version: VERSION + 1,
        schema: SCHEMA ^ 1,
        nonce: 0,
    };
    let mut device = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
    let mut heard = None;
    for byte in request_frame(1, &request) {
        heard = device.push(byte).map(|frame| frame.request()).or(heard);
    }
    assert_eq!(heard, Some(Err(foreign)));

    let mut out = [0; MAX_REPLY_FRAME];
    let reply = Reply::Incompatible {
        version: VERSION + 1,
        schema: SCHEMA ^ 1,
    };
    let length = encode_reply(1, &reply, &mut out).unwrap();
    let mut host = Receiver::<MAX_REPLY_FRAME>::new(Side::Host);
    let mut heard = None;
    for byte in &out[..length] {
        heard = host.push(*byte).map(|frame| frame.reply()).or(heard);
    }
    assert_eq!(heard, Some(Err(foreign)));
    let text = foreign.to_string();
    assert!(
        text.contains("protocol 2") && text.contains("not 1"),
        "{text}"
    );
}

/// An end ignores its own kind of frame, so it never takes an echo for an answer.
#[test]
fn no_end_accepts_its_own_frames() {
    assert_eq!(replies(&request_frame(1, &hello(1))).0, []);
    assert_eq!(
        requests(&reply_frame(1, &Reply::Hello(Identity::default()))).0,
        []
    );
}

/// A body with a correct checksum can still be malformed: left-over bytes, or a hello in a frame of
/// kind request.
#[test]
fn a_checked_body_can_be_malformed() {
    let hello_body = postcard::to_allocvec(&hello(1)).unwrap();
    for (kind, body) in [
        (Kind::Request, &[5, 0][..]),
        (Kind::Request, &[99]),
        (Kind::Request, &[]),
        (Kind::Request, &hello_body),
        (Kind::Greeting, &[5]),
        (Kind::Greeting, &[0, 1]),
    ] {
        let mut device = Receiver::<MAX_REQUEST_FRAME>::new(Side::Device);
        let mut heard = None;
        for byte in checked_frame(kind, 0, body) {
            heard = device.push(byte).map(|frame| frame.request()).or(heard);
        }
        assert_eq!(heard, Some(Err(BodyError::Malformed)), "{kind:?} {body:?}");
    }
}
