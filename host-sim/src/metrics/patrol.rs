//! Ages of the rails on a patrol: the time since each was last visited, on the true path.
//!
//! A rail is a centre cell of the last map. The robot visits it whenever the robot's centre is
//! within 1 m of it. Its *age* is the time since its last visit, in the exploration or on patrol,
//! or since the start if there was none. Every step of the patrol counts the ages of all rails.
//!
//! Spurs of up to 1.5 m are left out: a spur into a corner or a dent of a wall comes and goes with
//! the noise of the map, and may exist only in the last map.

use std::collections::BTreeSet;

/// Distance at which the robot visits a rail, metres.
const VISIT_M: f64 = 1.0;

/// Greatest length of a spur, metres: from the middle of a corridor of 2 m into the corner where it
/// turns is a little less.
const SPUR_M: f64 = 1.5;
/// Side of a centre cell, metres.
const CENTRE_CELL_M: f64 = 0.2;

/// Ages of the rails on a patrol.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Patrol {
    /// Greatest age of any rail in any step, seconds.
    pub oldest_rail_s: f64,
    /// Mean age of all rails in all steps, seconds.
    pub mean_age_s: f64,
}

impl Patrol {
    /// Measures the last `patrol_s` seconds of a path of time, x and y; `None` if they have no
    /// steps or there are no rails.
    #[must_use]
    pub fn judge(rails: &[[f64; 2]], path: &[[f64; 3]], patrol_s: f64) -> Option<Self> {
        let begins_s = path.last()?[0] - patrol_s;
        let mut visited_s = vec![0.0; rails.len()];
        let (mut oldest, mut sum, mut ages) = (0.0_f64, 0.0, 0.0);
        for &[time_s, x, y] in path {
            for (rail, visited_s) in rails.iter().zip(&mut visited_s) {
                if (rail[0] - x).hypot(rail[1] - y) <= VISIT_M {
                    *visited_s = time_s;
                }
                if time_s > begins_s {
                    let age = time_s - *visited_s;
                    (oldest, sum, ages) = (oldest.max(age), sum + age, ages + 1.0);
                }
            }
        }
        (ages > 0.0).then(|| Self {
            oldest_rail_s: oldest,
            mean_age_s: sum / ages,
        })
    }
}

/// The rails without their spurs. A spur leads from an end to the next fork, within 1.5 m.
#[must_use]
pub fn without_spurs(rails: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let cells: BTreeSet<[i32; 2]> = rails.iter().map(cell_of).collect();
    let beside = |[x, y]: [i32; 2]| -> Vec<[i32; 2]> {
        let around = (-1..=1).flat_map(|dy| (-1..=1).map(move |dx| [x + dx, y + dy]));
        around
            .filter(|&near| near != [x, y] && cells.contains(&near))
            .collect()
    };
    let mut spurs = BTreeSet::new();
    for &end in cells.iter().filter(|&&cell| beside(cell).len() == 1) {
        let mut branch = vec![end];
        let way = |branch: &[[i32; 2]]| {
            let ways = beside(*branch.last()?);
            ways.into_iter().find(|near| !branch.contains(near))
        };
        while let Some(next) = way(&branch).filter(|&next| is_near(end, next)) {
            if beside(next).len() > 2 {
                spurs.extend(branch);
                break;
            }
            branch.push(next);
        }
    }
    let is_rail = |rail: &&[f64; 2]| !spurs.contains(&cell_of(rail));
    rails.iter().filter(is_rail).copied().collect()
}

fn cell_of(rail: &[f64; 2]) -> [i32; 2] {
    rail.map(|at| (at / CENTRE_CELL_M).floor() as i32)
}

/// Returns true if a cell and its neighbours are within a spur's length of an end.
fn is_near(end: [i32; 2], cell: [i32; 2]) -> bool {
    let [dx, dy] = [0, 1].map(|k| f64::from(end[k] - cell[k]) * CENTRE_CELL_M);
    dx.hypot(dy) + CENTRE_CELL_M <= SPUR_M
}

#[cfg(test)]
mod tests {
    use super::{CENTRE_CELL_M, Patrol, without_spurs};

    /// The centre cells of a picture that have one of the marks.
    fn marked(picture: &str, marks: &str) -> Vec<[f64; 2]> {
        let rows = picture.split_whitespace().enumerate();
        let cells = rows.flat_map(|(y, row)| {
            let cells = row.char_indices().filter(|(_, c)| marks.contains(*c));
            cells.map(move |(x, _)| [x, y].map(|at| (at as f64 + 0.5) * CENTRE_CELL_M))
        });
        cells.collect()
    }

    #[test]
    fn spurs_are_left_out_and_dead_ends_are_not() {
        let picture = "
            .........s......................
            ..........s......s..............
            ...........#.....#..............
            ################################
            ...........#.........#..........
            ...........#.........s..........
            ...........#.........s..........
            ...........#.........s..........
            ...........#....................
            ...........#....................
            ...........#....................
            ...........#.............##.....";
        let left = without_spurs(&marked(picture, "#s"));
        assert_eq!(left, marked(picture, "#"));
        assert_eq!(marked(picture, "s").len(), 6);
    }

    /// A path to and fro over 10 m at 1 m/s, for this many seconds.
    fn path(seconds: u32) -> Vec<[f64; 3]> {
        let at = |t: f64| 10.0 - (t % 20.0 - 10.0).abs();
        let times = (0..=10 * seconds).map(|k| f64::from(k) / 10.0);
        times.map(|t| [t, at(t), 0.0]).collect()
    }

    #[test]
    fn a_path_to_and_fro_visits_each_end_once_per_round() {
        let rails: Vec<[f64; 2]> = (0..=10).map(|x| [f64::from(x), 0.0]).collect();
        let patrol = Patrol::judge(&rails, &path(200), 100.0).unwrap();
        // It leaves the end's circle of 1 m and comes back: 20 s less twice 1 m.
        assert!((patrol.oldest_rail_s - 18.0).abs() < 0.2, "{patrol:?}");
        assert!((2.0..9.0).contains(&patrol.mean_age_s), "{patrol:?}");
        let far = Patrol::judge(&[[5.0, 9.0]], &path(200), 100.0).unwrap();
        assert!(
            (far.oldest_rail_s - 200.0).abs() < 0.2,
            "never visited: {far:?}"
        );
        assert_eq!(Patrol::judge(&[], &path(9), 5.0), None);
        assert_eq!(Patrol::judge(&rails, &[], 5.0), None);
    }
}
