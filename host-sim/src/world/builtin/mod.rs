//! The worlds that come with the simulator, drawn here: five places to explore, four cases to get wrong, and seven published sizes.
//!
//! All have cells of 5 cm, walls at least 0.2 m thick, and their lower left corner at the origin. A drawing is a
//! function of nothing: it is the same everywhere and always.

mod cases;
mod cave;
mod cluttered;
mod hall;
mod loops;
mod office;
mod places;
mod poses;
mod ring;

use super::occupancy::Occupancy;
use super::{Start, World};

/// A built-in world.
#[derive(Clone, Copy, Debug)]
pub struct Builtin {
    /// Its name on the command line.
    pub name: &'static str,
    /// What it is, in one line.
    pub description: &'static str,
    plan: fn() -> Occupancy,
    starts: &'static [[f64; 3]],
}

/// Every built-in world.
const BUILTINS: [Builtin; 16] = [
    Builtin {
        name: "office",
        description: "nine furnished rooms with doors of 0.8 to 0.9 m along a corridor, 24 x 14 m",
        plan: office::plan,
        starts: &[[12.0, 7.0, 0.0], [2.4, 9.4, 0.0], [21.0, 4.4, 3.0]],
    },
    Builtin {
        name: "cave",
        description: "rough chambers and passages around islands of rock, 22 x 18 m",
        plan: cave::plan,
        starts: &[[4.0, 4.2, 0.8], [17.6, 11.4, -2.0]],
    },
    Builtin {
        name: "loop",
        description: "a corridor that closes a ring of 64 m, with niches and a dead end",
        plan: ring::plan,
        starts: &[[3.0, 1.3, 0.0], [19.2, 8.0, 1.6]],
    },
    Builtin {
        name: "cluttered",
        description: "one room of 15 x 15 m full of small obstacles",
        plan: cluttered::plan,
        starts: &[[1.0, 1.0, 0.8], [7.5, 7.5, 0.0]],
    },
    Builtin {
        name: "hall",
        description: "a hall of 24 x 24 m, open but for a few pillars",
        plan: hall::plan,
        starts: &[[3.0, 3.0, 0.0], [12.0, 14.0, 1.5]],
    },
    Builtin {
        name: "empty-hall",
        description: "an empty hall of 30 x 30 m, larger than the lasers see",
        plan: hall::empty,
        starts: &[[15.0, 15.0, 0.0], [2.0, 2.0, 0.8]],
    },
    Builtin {
        name: "narrow-doors",
        description: "five rooms behind doors of 0.65, 0.70, 0.75, 0.80 and 0.90 m",
        plan: cases::narrow_doors,
        starts: &[[1.2, 1.4, 0.0], [16.6, 4.6, -1.6]],
    },
    Builtin {
        name: "unreachable-room",
        description: "one room without a door, one behind a gap of 0.4 m that only the lasers pass",
        plan: cases::unreachable_room,
        starts: &[[2.0, 2.0, 0.0]],
    },
    Builtin {
        name: "boxed-in",
        description: "the robot starts in a closet of 1 x 1 m that has no door",
        plan: cases::boxed_in,
        starts: &[[3.0, 3.0, 0.0]],
    },
    Builtin {
        name: "ouroboros-a",
        description: "four adjacent loops of corridors, 44, 46, 58 and 78 m",
        plan: loops::a,
        starts: &poses::A,
    },
    Builtin {
        name: "ouroboros-b",
        description: "three adjacent loops of corridors in a row, 72 m each",
        plan: loops::b,
        starts: &poses::B,
    },
    Builtin {
        name: "ouroboros-c",
        description: "rooms along corridors that close no loop, 23 x 25 m",
        plan: places::c,
        starts: &poses::C,
    },
    Builtin {
        name: "ouroboros-d",
        description: "a square of 20 x 20 m with small round obstacles, as of trees",
        plan: places::d,
        starts: &poses::D,
    },
    Builtin {
        name: "tdbvp-adjacent",
        description: "three loops of corridors, each beside both others, 72 m each",
        plan: loops::adjacent,
        starts: &poses::ADJACENT,
    },
    Builtin {
        name: "tdbvp-nested",
        description: "a loop of corridors of 88 m, and one of 48 m within its block",
        plan: loops::nested,
        starts: &poses::NESTED,
    },
    Builtin {
        name: "tdbvp-floor",
        description: "a floor of 72 x 13 m with loops of 90 m and 60 m and halls at both ends",
        plan: loops::floor_72,
        starts: &poses::FLOOR,
    },
];

/// All built-in worlds, in the order of the list.
#[must_use]
pub fn builtins() -> &'static [Builtin] {
    &BUILTINS
}

/// Their names.
pub(super) fn names() -> Vec<&'static str> {
    BUILTINS.iter().map(|world| world.name).collect()
}

/// Draws one.
pub(super) fn draw(name: &str) -> Option<World> {
    let world = BUILTINS.iter().find(|world| world.name == name)?;
    let starts = world.starts.iter().map(|[x_m, y_m, yaw_rad]| Start {
        x_m: *x_m,
        y_m: *y_m,
        yaw_rad: *yaw_rad,
    });
    Some(World::flat(world.name, (world.plan)(), starts.collect()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::metrics::{CellSet, Coverage};
    use crate::robot::{Footprint, RADIUS_M};

    #[test]
    fn the_robot_fits_at_every_start_and_can_turn_there() {
        for builtin in builtins() {
            let world = World::builtin(builtin.name).expect("listed");
            assert!(!world.starts().is_empty());
            for start in world.starts() {
                let turned = |k: u32| Start {
                    yaw_rad: f64::from(k),
                    ..*start
                };
                let clearance = (0..6)
                    .map(|k| world.clearance_m(&Footprint::PIONEER_3AT, turned(k)))
                    .fold(f64::INFINITY, f64::min);
                assert!(clearance > 0.1, "{}: {clearance}", builtin.name);
            }
        }
    }

    #[test]
    fn drawings_stay_as_they_are() {
        // A change of a drawing changes every result on it: free cells, and a sum that depends on their places.
        let fingerprint = |world: &World| {
            let classes = world.occupancy().classes().iter();
            classes.fold((0, 0_u32), |(free, sum), class| {
                let bit = u32::from(*class == super::super::Class::Free);
                (free + bit, sum.wrapping_mul(31).wrapping_add(bit))
            })
        };
        let prints: Vec<_> = builtins()
            .iter()
            .map(|builtin| {
                let world = World::builtin(builtin.name).expect("listed");
                (builtin.name, fingerprint(&world))
            })
            .collect();
        let expected = [
            ("office", (115_412, 3_156_533_628)),
            ("cave", (76_337, 1_078_126_173)),
            ("loop", (52_256, 1_009_329_408)),
            ("cluttered", (86_345, 3_978_289_357)),
            ("hall", (229_376, 3_185_510_912)),
            ("empty-hall", (360_000, 281_830_400)),
            ("narrow-doors", (44_784, 3_584_075_896)),
            ("unreachable-room", (50_296, 2_037_409_664)),
            ("boxed-in", (14_016, 405_072_896)),
            ("ouroboros-a", (149_600, 804_963_840)),
            ("ouroboros-b", (140_800, 3_408_814_080)),
            ("ouroboros-c", (214_172, 3_718_203_840)),
            ("ouroboros-d", (156_762, 2_793_279_844)),
            ("tdbvp-adjacent", (140_800, 1_353_605_120)),
            ("tdbvp-nested", (111_200, 3_258_082_816)),
            ("tdbvp-floor", (180_328, 1_935_914_624)),
        ];
        assert_eq!(prints, expected);
    }

    /// Share of the free floor around the first start that the robot's disc could see.
    fn visible_share(name: &str) -> f64 {
        let world = World::builtin(name).expect("listed");
        let start = world.starts()[0];
        let free = CellSet::free(&world, start).count() as f64 * 0.0025;
        Coverage::new(&world, start, RADIUS_M, 12.0).reachable_m2() / free
    }

    #[test]
    fn every_room_is_as_open_as_the_description_says() {
        for name in [
            "office",
            "cave",
            "loop",
            "cluttered",
            "hall",
            "empty-hall",
            "narrow-doors",
        ] {
            let share = visible_share(name);
            assert!((0.99..1.01).contains(&share), "{name}: {share}");
        }
        assert!(visible_share("unreachable-room") < 0.99);
        let closet = World::builtin("boxed-in").expect("listed");
        assert_eq!(CellSet::free(&closet, closet.starts()[0]).count(), 400);
    }

    #[test]
    fn starts_of_a_world_lie_in_one_piece() {
        for builtin in builtins() {
            let world = World::builtin(builtin.name).expect("listed");
            let reach = CellSet::reach(&world, world.starts()[0], RADIUS_M);
            for start in world.starts() {
                let cell = world.occupancy().cell_at(start.x_m, start.y_m);
                assert!(reach.contains(cell), "{} {start:?}", builtin.name);
            }
        }
    }

    #[test]
    fn doors_are_as_wide_as_they_say() {
        let world = World::builtin("narrow-doors").expect("listed");
        let grid = world.occupancy();
        // Along the middle of the wall with the doors.
        let j = grid.cell_at(0.0, 2.7).j;
        let mut widths = vec![0];
        for i in 0..grid.width() as i64 {
            if grid.is_solid(super::super::GridCell { i, j }) {
                widths.push(0);
            } else if let Some(last) = widths.last_mut() {
                *last += 1;
            }
        }
        widths.retain(|cells| *cells > 0);
        assert_eq!(widths, [13, 14, 15, 16, 18]);
    }
}
