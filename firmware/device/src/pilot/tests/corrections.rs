//! Corrections of the map: parts that come late, twice or not at all.

use fieldline_protocol::message::{
    Control, Correct, CorrectedTile, CorrectedTiles, CorrectionProgress, Recall, RecalledPoint,
    Refusal, Status, TRAIL_BYTES, TeamTile, Twist,
};

use super::{Device, observation, start};

/// Tile (40, k), far from the robot, all free.
fn part(epoch: u16, numbers: core::ops::Range<u16>, last: bool) -> CorrectedTiles {
    let bytes = TeamTile::pack(core::iter::repeat_n(1, 1024));
    let mut part = CorrectedTiles {
        epoch,
        first: numbers.start,
        last,
        ..CorrectedTiles::default()
    };
    for k in numbers {
        let tile = CorrectedTile {
            x: 40,
            y: k as i16,
            shift: (1, 1),
            bytes: bytes.len() as u16,
            trail: false,
        };
        part.tiles.push(tile).expect("room");
        part.cells.extend_from_slice(&bytes).expect("room");
    }
    part
}

fn open(device: &mut Device, epoch: u16, tiles: u16) {
    let correct = Correct {
        epoch,
        tiles,
        ..Correct::default()
    };
    let begun = device.correct(&correct);
    assert_eq!(begun, Ok(progress(epoch, 0, false)));
}

const fn progress(epoch: u16, next: u16, closed: bool) -> CorrectionProgress {
    CorrectionProgress {
        epoch,
        next,
        closed,
    }
}

fn is_known(device: &mut Device, k: i16) -> bool {
    device.bench.memory().tile(40, k).is_some()
}

#[test]
fn parts_may_be_lost_and_come_twice() {
    let mut device = Device::started(start());
    open(&mut device, 3, 3);
    let mut send = |part: &CorrectedTiles| device.tiles(part);
    let whole = send(&part(3, 0..1, false));
    assert_eq!(whole, Ok(progress(3, 1, false)));
    let early = send(&part(3, 2..3, true));
    assert_eq!(early, Ok(progress(3, 1, false)), "tile 1 is missing");
    let again = send(&part(3, 0..1, false));
    assert_eq!(again, Ok(progress(3, 1, false)), "it changes nothing");
    let overlapping = send(&part(3, 0..3, true));
    assert_eq!(overlapping, Ok(progress(3, 3, true)));
    let late = send(&part(3, 1..3, true));
    assert_eq!(late, Ok(progress(3, 3, true)));
    assert!((0..3).all(|k| is_known(&mut device, k)));
    let command = device.observe(&observation(0));
    assert_eq!(command.map(|it| it.map_epoch), Ok(3));
}

#[test]
fn a_part_of_another_correction_or_with_bad_cells_is_refused() {
    let mut device = Device::new();
    let refused = device.tiles(&part(1, 0..1, true));
    assert_eq!(refused, Err(Refusal::NotStarted));
    let refused = device.correct(&Correct::default());
    assert_eq!(refused, Err(Refusal::NotStarted));

    let mut device = Device::started(start());
    let refused = device.tiles(&part(1, 0..1, true));
    assert_eq!(refused, Err(Refusal::NoCorrection));
    open(&mut device, 2, 2);
    let refused = device.tiles(&part(1, 0..1, true));
    assert_eq!(refused, Err(Refusal::NoCorrection));
    let mut short = part(2, 0..2, true);
    short.cells.pop();
    let refused = device.tiles(&short);
    assert_eq!(refused, Err(Refusal::BadTile));
    assert!(is_known(&mut device, 0) && !is_known(&mut device, 1));
    let mut wrong = part(2, 1..2, true);
    wrong.cells[3] = 0;
    let refused = device.tiles(&wrong);
    assert_eq!(refused, Err(Refusal::BadTile));
    let whole = device.tiles(&part(2, 1..2, true));
    assert_eq!(whole, Ok(progress(2, 2, true)));
    let correct = Correct {
        epoch: 3,
        tiles: 513,
        ..Correct::default()
    };
    let refused = device.correct(&correct);
    assert_eq!(refused, Err(Refusal::BadCorrection));
}

#[test]
fn a_newer_correction_takes_the_place_of_an_open_one() {
    let mut device = Device::started(start());
    open(&mut device, 1, 2);
    let command = device.observe(&observation(0));
    let told = command.map(|it| (it.velocity, it.status, it.map_epoch));
    assert_eq!(told, Ok((Twist::default(), Status::Exploring, 0)));
    open(&mut device, 2, 0);
    let closed = device.tiles(&part(2, 0..0, true));
    assert_eq!(closed, Ok(progress(2, 0, true)));
    let refused = device.tiles(&part(1, 0..2, true));
    assert_eq!(refused, Err(Refusal::NoCorrection));
    let command = device.observe(&observation(200));
    assert_eq!(command.map(|it| it.map_epoch), Ok(2));
    // The next session begins without.
    device.order(&Control::Start(start())).expect("valid");
    let command = device.observe(&observation(400));
    assert_eq!(command.map(|it| it.map_epoch), Ok(0));
}

#[test]
fn a_recall_is_taken_once_the_map_is_back_and_before_the_first_scan() {
    let mut device = Device::started(start());
    let recall = |epoch| Recall {
        epoch,
        points: [RecalledPoint {
            x_mm: 0,
            y_mm: 400,
            returns: 8,
        }]
        .into_iter()
        .collect(),
        ..Recall::default()
    };
    let refused = device.recall(&recall(1));
    assert_eq!(refused, Err(Refusal::NoCorrection));
    open(&mut device, 1, 1);
    let refused = device.recall(&recall(1));
    assert_eq!(refused, Err(Refusal::NoCorrection), "it is open");
    let mut trailed = part(1, 0..1, true);
    trailed.tiles[0].trail = true;
    let refused = device.tiles(&trailed);
    assert_eq!(refused, Err(Refusal::BadTile), "it has no trail");
    trailed
        .cells
        .extend_from_slice(&[1; TRAIL_BYTES])
        .expect("room");
    let whole = device.tiles(&trailed);
    assert_eq!(whole, Ok(progress(1, 1, true)));
    let mut absurd = recall(1);
    absurd.points[0].returns = 0;
    let refused = device.recall(&absurd);
    assert_eq!(refused, Err(Refusal::BadCorrection));
    for _ in 0..2 {
        let taken = device.recall(&recall(1));
        assert_eq!(taken, Ok(progress(1, 1, true)));
    }
    let command = device.observe(&observation(0));
    assert_eq!(command.map(|it| it.status), Ok(Status::Exploring));
    let refused = device.recall(&recall(1));
    assert_eq!(
        refused,
        Err(Refusal::NoCorrection),
        "it has seen for itself"
    );
}
