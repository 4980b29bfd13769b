use proptest::prelude::*;

use super::super::laser::{self, LaserNoise};
use super::*;

const HULL: Footprint = Footprint::rectangle(0.5, 0.4, 0.3);

fn lidar(first_deg: f64, step_deg: f64, beams: usize) -> Lidar {
    Lidar {
        position_m: [0.0, 0.0, 0.2],
        first_rad: first_deg.to_radians(),
        step_rad: step_deg.to_radians(),
        beams,
        least_m: 0.1,
        most_m: 12.0,
        ..Lidar::announced(&laser::level(), LaserNoise::NONE)
    }
}

fn sectors(lidar: &Lidar) -> Sectors {
    Sectors::new(lidar, &HULL)
}

#[test]
fn the_usual_scanner_is_announced_bit_for_bit() {
    for wire in [laser::level(), laser::tilted()] {
        let sectors = sectors(&Lidar::announced(&wire, LaserNoise::NONE));
        assert_eq!(*sectors.laser(), wire);
        assert_eq!((sectors.group(), sectors.promised()), (1, 181));
    }
}

#[test]
fn many_beams_become_sectors_of_equal_width() {
    for (beams, step_deg, on_wire, group) in [
        (180, 2.0, 180, 1),
        (361, 0.5, 181, 2),
        (360, 1.0, 180, 2),
        (450, 0.8, 150, 3),
        (541, 0.5, 181, 3),
        (720, 0.5, 180, 4),
        (1081, 0.25, 181, 6),
    ] {
        let sectors = sectors(&lidar(0.0, step_deg, beams));
        assert_eq!(usize::from(sectors.laser().beams), on_wire, "{beams}");
        assert_eq!(sectors.group(), group);
        let step = sectors.laser().bearing_step.to_num::<f64>().to_degrees();
        assert!((step - step_deg * group as f64).abs() < 1e-3, "{step}");
        let turn = step * (on_wire - 1) as f64;
        assert!(turn <= 360.0 && sectors.fold(&vec![1.0; beams]).ranges_mm.len() == on_wire);
    }
}

#[test]
fn every_reading_has_its_code() {
    let sectors = sectors(&lidar(-2.0, 1.0, 1));
    for (range_m, code) in [
        (f64::NAN, INVALID_MM),
        (f64::NEG_INFINITY, INVALID_MM),
        (-1.0, INVALID_MM),
        (0.0, INVALID_MM),
        (0.099, INVALID_MM),
        (0.1, 100),
        (11.9994, 11_999),
        (12.0, NO_RETURN_MM),
        (81.91, NO_RETURN_MM),
        (f64::INFINITY, NO_RETURN_MM),
    ] {
        assert_eq!(sectors.fold(&[range_m]).ranges_mm[..], [code], "{range_m}");
    }
}

#[test]
fn a_range_beyond_the_wire_is_free_up_to_what_the_wire_can_say() {
    let far = sectors(&Lidar {
        most_m: 30.0,
        ..lidar(0.0, 1.0, 1)
    });
    assert_eq!(far.laser().range_limit_mm, NO_RETURN_MM - 1);
    for (range_m, code) in [(16.3, 16_300), (16.382, NO_RETURN_MM), (29.0, NO_RETURN_MM)] {
        assert_eq!(far.fold(&[range_m]).ranges_mm[..], [code], "{range_m}");
    }
}

/// A wall on the left only, 1 m away, seen by lidars mounted in four ways.
#[test]
fn a_wall_on_the_left_is_on_the_left_however_the_lidar_turns() {
    for (clockwise, upside_down) in [(false, false), (true, false), (false, true), (true, true)] {
        let lidar = Lidar {
            clockwise,
            upside_down,
            ..lidar(30.0, 0.8, 450)
        };
        let seen = |beam: usize| {
            let own = 30.0 + if clockwise { -0.8 } else { 0.8 } * beam as f64;
            let on_robot = if upside_down { -own } else { own };
            let on_left = (80.0..100.0).contains(&f64::rem_euclid(on_robot, 360.0));
            if on_left { 1.0 } else { f64::INFINITY }
        };
        let sectors = sectors(&lidar);
        let scan = sectors.fold(&(0..450).map(seen).collect::<Vec<f64>>());
        let first: f64 = sectors.laser().first_bearing.to_num();
        let step: f64 = sectors.laser().bearing_step.to_num();
        let mut returns = 0;
        for (sector, range_mm) in scan.ranges_mm.iter().enumerate() {
            let bearing = (first + step * sector as f64)
                .to_degrees()
                .rem_euclid(360.0);
            let is_return = *range_mm == 1000;
            returns += u32::from(is_return);
            let off = (bearing - 90.0).abs();
            assert!(
                is_return || off > 8.0,
                "{clockwise} {upside_down} {bearing}"
            );
            assert!(
                !is_return || off < 12.0,
                "{clockwise} {upside_down} {bearing}"
            );
        }
        assert!(returns >= 8, "{returns}");
    }
}

#[test]
fn posts_and_the_hull_are_no_obstacles() {
    let lidar = Lidar {
        mask: vec![[40.0_f64.to_radians(), 50.0_f64.to_radians()]],
        ignores_hull: true,
        ..lidar(0.0, 1.0, 91)
    };
    let own = sectors(&lidar);
    // The hull ends 0.25 m ahead and 0.2 m to the left.
    let near = own.fold(&[0.22; 91]).ranges_mm;
    assert_eq!((near[0], near[45], near[90]), (INVALID_MM, INVALID_MM, 220));
    let far = own.fold(&[0.5; 91]).ranges_mm;
    assert_eq!((far[0], far[39], far[90]), (500, 500, 500));
    assert!(far[40..=50].iter().all(|code| *code == INVALID_MM));
    let keeps = sectors(&Lidar {
        ignores_hull: false,
        ..lidar
    });
    assert_eq!(keeps.fold(&[0.22; 91]).ranges_mm[0], 220);
}

/// A reading of any kind.
fn reading() -> impl Strategy<Value = f64> {
    prop_oneof![
        any::<f64>(),
        0.1..12.0_f64,
        0.1..12.0_f64,
        Just(f64::INFINITY),
        Just(0.0),
        Just(f64::NAN),
    ]
}

fn scans() -> impl Strategy<Value = (Lidar, Vec<f64>)> {
    let shape = (
        4..=720_usize,
        any::<bool>(),
        any::<bool>(),
        -400.0..400.0_f64,
    );
    shape.prop_flat_map(|(beams, clockwise, upside_down, first_deg)| {
        let lidar = Lidar {
            clockwise,
            upside_down,
            ..lidar(first_deg, 360.0 / beams as f64, beams)
        };
        let least = beams - beams / 8;
        let ranges = prop::collection::vec(reading(), least..=beams + beams / 8);
        (Just(lidar), ranges)
    })
}

fn is_return(range_m: f64) -> bool {
    (0.1..12.0).contains(&range_m)
}

/// Returns true if a code is that of the nearest return, or behind it by no more than one surface.
fn is_of_surface(sectors: &Sectors, nearest_m: f64, code: u16) -> bool {
    let step_rad = sectors.bearing_rad(1) - sectors.bearing_rad(0);
    let depth = 2.0 * step_rad * (sectors.group() - 1) as f64;
    let code_m = f64::from(code) / 1000.0;
    (nearest_m - 6e-4..=nearest_m * (1.0 + depth) + 1e-3).contains(&code_m)
}

proptest! {
    /// Every list of numbers is a scan of the announced laser, and its nearest return is the
    /// scan's, or the mean of its surface.
    #[test]
    fn the_nearest_return_is_never_lost((lidar, ranges_m) in scans()) {
        let sectors = sectors(&lidar);
        let codes = sectors.fold(&ranges_m).ranges_mm;
        prop_assert_eq!(codes.len(), usize::from(sectors.laser().beams));
        let nearest = ranges_m.iter().copied().filter(|range| is_return(*range));
        let nearest = nearest.fold(f64::INFINITY, f64::min);
        let codes = codes.iter().copied();
        let least = codes.filter(|code| ![INVALID_MM, NO_RETURN_MM].contains(code)).min();
        prop_assert_eq!(least.is_some(), nearest.is_finite());
        if let Some(least) = least {
            prop_assert!(is_of_surface(&sectors, nearest, least), "{} {}", nearest, least);
        }
    }

    /// Each sector, by the beams that lie in it.
    #[test]
    fn a_sector_is_free_only_if_all_its_beams_are((lidar, ranges_m) in scans()) {
        let sectors = sectors(&lidar);
        let codes = sectors.fold(&ranges_m).ranges_mm;
        // Sorted by the robot's bearing, as many beams as promised.
        let mut ordered = ranges_m;
        if ordered.len() != lidar.beams {
            return Ok(());
        }
        if sectors.is_reversed() {
            ordered.reverse();
        }
        for (code, beams) in codes.iter().zip(ordered.chunks(sectors.group())) {
            let returns = beams.iter().filter(|range| is_return(**range));
            let nearest = returns.copied().fold(f64::INFINITY, f64::min);
            let expected = if nearest.is_finite() {
                prop_assert!(is_of_surface(&sectors, nearest, *code), "{:?}", beams);
                continue;
            } else if beams.iter().all(|range| *range >= 12.0) {
                NO_RETURN_MM
            } else {
                INVALID_MM
            };
            prop_assert_eq!(*code, expected, "{:?}", beams);
        }
    }

    /// Beams too many or too few: no return moves by more than two beams.
    #[test]
    fn a_scan_of_another_length_keeps_its_bearings(
        promised in 4..=720_usize,
        more in -1_isize..=1,
        share in 0.0..1.0_f64,
    ) {
        let sectors = sectors(&lidar(0.0, 360.0 / promised as f64, promised));
        let beams = promised.saturating_add_signed(more);
        let at = (share * beams as f64) as usize;
        let mut ranges_m = vec![f64::INFINITY; beams];
        ranges_m[at] = 2.0;
        let codes = sectors.fold(&ranges_m).ranges_mm;
        let expected = (at as f64 + 0.5) / beams as f64 * promised as f64;
        let found: Vec<usize> = (0..codes.len()).filter(|k| codes[*k] == 2000).collect();
        prop_assert!(!found.is_empty());
        for sector in found {
            let middle = (sector as f64 + 0.5) * sectors.group() as f64;
            let off = (middle - expected).abs() - 0.5 * sectors.group() as f64;
            prop_assert!(off <= 2.0, "{} {}", middle, expected);
        }
    }
}

/// A plane askew by less than 63° is where it is at the sector's middle; something before it wins.
#[test]
fn a_wall_askew_is_not_thickened_and_a_post_before_it_is_kept() {
    let sectors = sectors(&lidar(0.0, 1.0, 360));
    assert_eq!(sectors.group(), 2);
    let askew = |beam: usize| 3.0 / (f64::to_radians(beam as f64 - 45.0)).cos();
    let mut ranges_m: Vec<f64> = (0..90).map(askew).collect();
    ranges_m.resize(360, f64::INFINITY);
    let codes = sectors.fold(&ranges_m).ranges_mm;
    for (sector, code) in codes[..45].iter().enumerate() {
        let middle = 3.0 / (f64::to_radians(2.0 * sector as f64 + 0.5 - 45.0)).cos();
        assert!(
            (f64::from(*code) / 1000.0 - middle).abs() < 2e-3,
            "{sector}"
        );
    }
    ranges_m[31] = 2.5;
    assert_eq!(sectors.fold(&ranges_m).ranges_mm[15], 2500);
}

#[test]
fn no_beams_at_all_are_no_information() {
    let codes = sectors(&lidar(0.0, 1.0, 360)).fold(&[]).ranges_mm;
    assert_eq!(codes.len(), 180);
    assert!(codes.iter().all(|code| *code == INVALID_MM));
}
