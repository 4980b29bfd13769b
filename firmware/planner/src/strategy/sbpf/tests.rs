//! Properties of the levels, the edges and the forces, against twins in f64 and in the equations'
//! own words, on random areas and on drawn ones.

use std::boxed::Box;
use std::vec::Vec;

use crate::config::{Area, Config, SbpfTuning, SpaceField, Strategy, Tuning};
use crate::geometry::{CELL_M, Cell, Point};
use crate::map::{Class, Tiles};
use crate::robot::{LaserMount, RobotShape};
use crate::status::{Fault, Finish, Status};
use crate::strategy::sbpf::edges::attractive;
use crate::strategy::sbpf::forces::Claims;
use crate::strategy::sbpf::levels::{Levels, Place, SIDE};
use crate::strategy::sbpf::{Sbpf, forces};

type Map = Tiles<64, 64>;

const TUNING: SbpfTuning = SbpfTuning::DEFAULT;

/// A drawn area: `#` obstacle, `.` covered, ` ` never sensed. The last line has the least y.
struct Drawing(Vec<Vec<u8>>);

impl Drawing {
    fn of(lines: &[&str]) -> Self {
        Self(
            lines
                .iter()
                .rev()
                .map(|line| line.bytes().collect())
                .collect(),
        )
    }

    fn random(seed: &mut u32, side: usize) -> Self {
        let cell = |seed: &mut u32| {
            *seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            b"..# "[(*seed >> 20) as usize % 4]
        };
        Self(
            (0..side)
                .map(|_| (0..side).map(|_| cell(seed)).collect())
                .collect(),
        )
    }

    fn get(&self, x: i32, y: i32) -> u8 {
        let row = usize::try_from(y).ok().and_then(|y| self.0.get(y));
        let cell = usize::try_from(x).ok().and_then(|x| row?.get(x));
        cell.copied().unwrap_or(b' ')
    }

    fn area(&self, scale: i32, least: Cell) -> Area {
        Area {
            least,
            across: (self.0[0].len() as i32 * scale) as u16,
            up: (self.0.len() as i32 * scale) as u16,
        }
    }

    /// Draws the area into a map, with obstacles of one map cell.
    fn map(&self, scale: i32, least: Cell) -> Box<Map> {
        let mut map = Box::new(Map::new());
        map.reset();
        for (y, row) in (0..).zip(&self.0) {
            for (x, &cell) in (0..).zip(row) {
                for k in 0..scale * scale {
                    let class = match cell {
                        b'#' if k == scale => Class::Obstacle,
                        // A cell less than half known is not covered.
                        b' ' if 2 * (k + 1) >= scale * scale => Class::Unknown,
                        _ => Class::Free,
                    };
                    let at = Cell {
                        x: least.x + x * scale + k % scale,
                        y: least.y + y * scale + k / scale,
                    };
                    if class != Class::Unknown {
                        map.set(at, class).expect("the map holds the area");
                    }
                }
            }
        }
        map
    }

    fn levels(&self, scale: i32, least: Cell) -> Levels {
        let mut levels = Levels::new(self.area(scale, least), scale);
        levels.update(&self.map(scale, least));
        levels
    }

    /// The cells that attract, in the words of eqs. 7 to 10.
    fn attracts(&self, x: i32, y: i32, has_gates: bool) -> bool {
        let block = || (-1..=1).flat_map(|j| (-1..=1).map(move |i| (i, j)));
        let open = block()
            .filter(|&(i, j)| self.get(x + i, y + j) == b'.')
            .count();
        let r = open as f64 / 9.0;
        let gap = |i, j| self.get(x + i, y + j) == b'#' && self.get(x - i, y - j) == b'#';
        let gamma = block()
            .filter(|&(i, j)| (i, j) != (0, 0) && gap(i, j))
            .count();
        let is_gate = has_gates && gamma > 1 && open > 0;
        self.get(x, y) == b' ' && ((0.3..=0.7).contains(&r) || is_gate)
    }

    fn cells(&self) -> impl Iterator<Item = (i32, i32)> + use<'_> {
        let width = self.0[0].len() as i32;
        (0..self.0.len() as i32).flat_map(move |y| (0..width).map(move |x| (x, y)))
    }
}

fn bit(row: u64, x: i32) -> bool {
    row >> x & 1 == 1
}

#[test]
fn levels_are_those_of_the_map() {
    let mut seed = 1;
    for (scale, side) in [(2, 64), (3, 40), (5, 20), (7, 9), (20, 6)] {
        let least = Cell { x: -37, y: 11 };
        let drawing = Drawing::random(&mut seed, side);
        let levels = drawing.levels(scale, least);
        assert_eq!(levels.cells() as usize, side * side);
        for (x, y) in drawing.cells() {
            let cell = drawing.get(x, y);
            let planes = [
                levels.covered(y),
                levels.obstacle(y),
                levels.never_sensed(y),
            ];
            let expected = [cell != b' ', cell == b'#', cell == b' '];
            assert_eq!(
                planes.map(|row| bit(row, x)),
                expected,
                "({x}, {y}) of {scale}"
            );
        }
    }
}

#[test]
fn a_long_area_has_larger_cells() {
    let area = |across, up| Area {
        least: Cell::default(),
        across,
        up,
    };
    for (across, up, cells, cell_m) in [
        (100, 80, 20 * 16, 0.5),
        (320, 320, 64 * 64, 0.5),
        (321, 10, 54 * 2, 0.6),
        (1_280, 1_280, 64 * 64, 2.0),
    ] {
        let levels = Levels::new(area(across, up), 5);
        assert_eq!(
            (levels.cells(), levels.cell_m()),
            (cells, cell_m * 10.0 * CELL_M)
        );
    }
}

#[test]
fn cells_attract_as_the_equations_say() {
    let mut seed = 2;
    for _ in 0..20 {
        let drawing = Drawing::random(&mut seed, 30);
        let levels = drawing.levels(2, Cell::default());
        for has_gates in [false, true] {
            for (x, y) in drawing.cells() {
                let is_bright = bit(attractive(&levels, y, has_gates), x);
                assert_eq!(is_bright, drawing.attracts(x, y, has_gates), "({x}, {y})");
            }
        }
    }
}

/// A door of one cell has one covered neighbour: only a gate attracts there.
#[test]
fn a_door_attracts_only_as_a_gate() {
    let drawing = Drawing::of(&["      ", "      ", "### ##", ".....#", "....##"]);
    let levels = drawing.levels(5, Cell::default());
    let bright = |has_gates| {
        let rows = levels.rows().map(|y| attractive(&levels, y, has_gates));
        rows.map(|row| row.count_ones()).sum::<u32>()
    };
    assert_eq!(
        (bright(false), bright(true)),
        (1, 1),
        "three covered cells below"
    );
    let narrow = Drawing::of(&["      ", "### ##", "###.##"]);
    let levels = narrow.levels(5, Cell::default());
    assert!(!bit(attractive(&levels, 1, false), 3));
    assert!(bit(attractive(&levels, 1, true), 3));
}

/// No other robot.
const NOBODY: Claims = Claims {
    rivals: heapless::Vec::new(),
    weight: 1.0,
};

/// The naive twin: every cell, in f64. Places are in cells.
fn naive(
    drawing: &Drawing,
    at: (f64, f64),
    claims: &Claims,
    (cell_m, twist): (f64, f64),
) -> ([f64; 2], [f64; 2]) {
    let (mut attraction, mut repulsion) = ([0.0; 2], [0.0; 2]);
    for (x, y) in drawing.cells() {
        let from = |at: (f64, f64)| [at.0 - f64::from(x) - 0.5, at.1 - f64::from(y) - 0.5];
        let away = from(at).map(|d| d * cell_m);
        let rho = away[0].hypot(away[1]);
        if drawing.attracts(x, y, true) {
            let rivals = claims.rivals.iter().map(|it| (it.x.into(), it.y.into()));
            let nearest = rivals.map(|rival| from(rival).map(|d| d * cell_m));
            let nearest = nearest
                .map(|[dx, dy]| dx.hypot(dy))
                .fold(f64::MAX, f64::min);
            let weight = if nearest < rho {
                f64::from(claims.weight)
            } else {
                1.0
            };
            for (sum, d) in attraction.iter_mut().zip(away) {
                *sum -= weight * d * rho * rho;
            }
        }
        let range = f64::from(TUNING.range_m);
        if drawing.get(x, y) == b'#' && rho <= range {
            let near = rho.max(0.5 * cell_m);
            let part = (1.0 / near - 1.0 / range) / (near * near * near);
            let [dx, dy] = away;
            repulsion[0] += part * (dx * twist.cos() - dy * twist.sin());
            repulsion[1] += part * (dx * twist.sin() + dy * twist.cos());
        }
    }
    (attraction, repulsion)
}

#[test]
fn forces_are_the_naive_sums() {
    let mut seed = 3;
    for round in 0..40 {
        let drawing = Drawing::random(&mut seed, SIDE);
        let levels = drawing.levels(2, Cell::default());
        let at = (0.37 + 1.5 * f64::from(round), 63.1 - 1.4 * f64::from(round));
        let place = levels.place(Point {
            x_m: at.0 as f32 * levels.cell_m(),
            y_m: at.1 as f32 * levels.cell_m(),
        });
        let twist = f64::from(TUNING.twist_rad);
        // One more robot every seven rounds.
        let claims = Claims {
            rivals: (0..round / 7)
                .map(|k| Place {
                    x: place.x + 7.3 * k as f32,
                    y: 31.0 - 9.1 * k as f32,
                })
                .collect(),
            weight: 0.2,
        };
        let (attraction, repulsion) = naive(&drawing, at, &claims, (0.2, twist));
        let found = forces::attraction(&levels, place, &claims, true).expect("something attracts");
        let near =
            |found: f32, true_: f64, size: f64| (f64::from(found) - true_).abs() < 1e-3 * size;
        let size = attraction[0].hypot(attraction[1]);
        assert!(near(found.x, attraction[0], size) && near(found.y, attraction[1], size));
        let found = forces::repulsion(&levels, place, TUNING.twist_rad, &TUNING);
        let size = repulsion[0].hypot(repulsion[1]);
        assert!(near(found.x, repulsion[0], size) && near(found.y, repulsion[1], size));
        let sum = |k: usize| {
            attraction[k] / attraction[0].hypot(attraction[1])
                + f64::from(TUNING.repulsion) * repulsion[k]
        };
        let heading =
            forces::heading_rad(&levels, place, &claims, true, &TUNING).expect("as above");
        let error = f64::from(heading) - sum(1).atan2(sum(0));
        assert!(
            error.sin().abs() < 1e-2 && error.cos() > 0.0,
            "round {round}: {error}"
        );
    }
}

/// With a weight, every covered cell repels too, once and without the twist \[Kenealy15, eq. 3\].
#[test]
fn covered_cells_repel_by_their_weight() {
    let mut seed = 5;
    for round in 0..10 {
        let drawing = Drawing::random(&mut seed, SIDE);
        let levels = drawing.levels(2, Cell::default());
        let at = Place {
            x: 20.3 + round as f32,
            y: 31.6,
        };
        let cell_m = f64::from(levels.cell_m());
        let range_m = f64::from(TUNING.range_m);
        let mut naive = [0.0; 2];
        for (y, row) in drawing.0.iter().enumerate() {
            for x in (0..row.len()).filter(|&x| row[x] == b'.') {
                let away = [(at.x, x), (at.y, y)]
                    .map(|(at, cell)| (f64::from(at) - cell as f64 - 0.5) * cell_m);
                let rho = away[0].hypot(away[1]).max(0.5 * cell_m);
                let part = (1.0 / rho - 1.0 / range_m).max(0.0) / rho.powi(3);
                naive = [0, 1].map(|k| naive[k] + 2.0 * part * away[k]);
            }
        }
        let with = |covered| {
            let tuning = SbpfTuning { covered, ..TUNING };
            forces::repulsion(&levels, at, 0.5, &tuning)
        };
        let (without, found) = (with(0.0), with(2.0));
        let size = naive[0].hypot(naive[1]);
        let near = |found: f32, without: f32, part: f64| {
            (f64::from(found) - f64::from(without) - part).abs() < 1e-3 * size
        };
        assert!(near(found.x, without.x, naive[0]), "round {round}");
        assert!(near(found.y, without.y, naive[1]), "round {round}");
    }
}

#[test]
fn the_conveyor_belt_leads_along_a_wall() {
    // A wall ahead, to the north; the attraction is beyond its two ends.
    let lines: Vec<&str> = [
        "                    ",
        "    ############    ",
        "....................",
        "....................",
        "....................",
        "....................",
    ]
    .into();
    let levels = Drawing::of(&lines).levels(5, Cell::default());
    let at = levels.place(Point { x_m: 5.0, y_m: 1.6 });
    let heading =
        |enhanced| forces::heading_rad(&levels, at, &NOBODY, enhanced, &TUNING).expect("edges");
    let north = crate::math::PI / 2.0;
    let sideways = |heading: f32| (heading.cos()).abs();
    assert!(sideways(heading(false)) < 0.01, "{}", heading(false));
    assert!(sideways(heading(true)) > 0.3, "{}", heading(true));
    assert!((heading(true) - north).abs() > 0.3);
}

/// The cell of a peer repels as an obstacle of its own weight, and it is no obstacle.
#[test]
fn a_peer_repels() {
    let drawing = Drawing::of(&["    ", "....", "....", "...."]);
    let mut levels = drawing.levels(5, Cell::default());
    let at = levels.place(Point {
        x_m: 1.0,
        y_m: 0.75,
    });
    assert_eq!(
        forces::repulsion(&levels, at, 0.5, &TUNING),
        forces::Vector::default()
    );
    levels.visit(Point {
        x_m: 0.25,
        y_m: 0.75,
    });
    let force = forces::repulsion(&levels, at, 0.5, &TUNING);
    assert!(force.x > 0.0 && force.y.abs() < 1e-6, "{force:?}");
    assert_eq!(levels.obstacle(1), 0);
    // Beyond the area nobody has a level.
    levels.visit(Point {
        x_m: -0.1,
        y_m: 9.0,
    });
}

fn config(field: SpaceField) -> Config {
    Config::builder(RobotShape::PIONEER_3AT)
        .laser(LaserMount::level(0.1, 0.4))
        .strategy(Strategy::Esbpf(field))
        .build()
        .expect("the field is valid")
}

/// Surveys a drawn area at this time. The robot stands in its middle.
fn survey(sbpf: &mut Sbpf, lines: &[&str], time_ms: u32, config: &Config) -> Option<Status> {
    let robot = Point { x_m: 1.0, y_m: 0.8 };
    sbpf.note_map(
        &Drawing::of(lines).map(5, Cell::default()),
        (robot, core::iter::empty()),
        time_ms,
        config,
    )
}

#[test]
fn every_end_has_its_reason() {
    let area = Drawing::of(&["    "; 4]).area(5, Cell::default());
    let paper = SpaceField::over(area);
    let all = ["...."; 4];
    let most = ["... ", "....", "....", "...."];
    let walled = ["#   ", "####", "....", "...."];
    let half = ["    ", "    ", "....", "...."];
    let ends = |field: SpaceField, lines: &[&str; 4], times_ms: &[u32]| {
        let config = config(field);
        let mut sbpf = Sbpf::new(field, true, &config);
        let ends = times_ms
            .iter()
            .map(|&time_ms| survey(&mut sbpf, lines, time_ms, &config));
        ends.last().flatten()
    };
    let covered = Some(Status::Finished(Finish::Covered));
    assert_eq!(ends(paper, &all, &[0]), covered);
    let until_90 = SpaceField {
        until_permille: 900,
        ..paper
    };
    assert_eq!(ends(until_90, &most, &[0]), covered);
    let nothing = Some(Status::Finished(Finish::NothingAttracts));
    assert_eq!(ends(paper, &walled, &[0]), nothing);
    assert_eq!(ends(paper, &half, &[0, TUNING.trapped_ms]), None);
    let trapped = Some(Status::Fault(Fault::Trapped));
    assert_eq!(ends(paper, &half, &[0, TUNING.trapped_ms + 1]), trapped);
    // With paths the frontier decides.
    let patient = SpaceField {
        impatience_s: Some(5),
        ..paper
    };
    for lines in [&all, &walled, &half] {
        assert_eq!(ends(patient, lines, &[0, 1_000_000]), None);
    }
    assert_eq!(Tuning::DEFAULT.sbpf, TUNING);
}
