//! The hit of a ray on the ground.
//!
//! The ground is the plane z = 0, or the bilinear patches of an [`Elevation`]. Along a ray the
//! height over a patch is a parabola in t, and its first root is computed exactly:
//!
//! ```text
//! z(t) − ground(t) = a + b t + c t²
//! ```
//!
//! Two traversals are nested. The outer one goes over blocks of patches and skips every block
//! that the ray stays above. The inner one goes over the patches of a block. Over a hole (no
//! surface) a ray passes; if it leaves the hole on the far side below the rim, it has hit the
//! hole's wall. Metres; the direction is a unit vector.

use super::elevation::{BLOCK, Elevation};
use super::ray::{Hit, Ray, Surface};
use super::traversal::GridTraversal;

/// The hit on the plane z = 0.
pub(super) fn plane(ray: &Ray) -> Option<Hit> {
    let range_m = if ray.origin_m[2] <= 0.0 {
        0.0
    } else if ray.direction[2] < 0.0 {
        -ray.origin_m[2] / ray.direction[2]
    } else {
        return None;
    };
    Some(Hit {
        range_m,
        surface: Surface::Ground,
    })
}

/// The hit on the ground of an elevation, within `limit_m`.
pub(super) fn ground(elevation: &Elevation, ray: &Ray, limit_m: f64) -> Option<Hit> {
    let (resolution_m, origin_m) = (elevation.resolution_m(), elevation.origin_m());
    // Patches lie between the samples, and samples lie at the centres of the pixels. So the first
    // patch begins half a pixel before the image and has the number −1.
    let start = [0, 1].map(|k| (ray.origin_m[k] - origin_m[k]) / resolution_m - 0.5);
    let speed = [0, 1].map(|k| ray.direction[k] / resolution_m);
    let size = [elevation.width() as f64, elevation.height() as f64];
    let (enter_m, leave_m) = within(start.map(|s| s + 0.5), speed, size);
    let limit_m = leave_m.min(limit_m);
    let side = BLOCK as f64;
    let mut blocks = GridTraversal::new(
        start.map(|s| (s + 1.0) / side),
        speed.map(|cells_per_m| cells_per_m / side),
    );
    if enter_m > 0.0 {
        blocks.jump(enter_m);
    }
    while blocks.entered_m <= limit_m {
        let span = (blocks.entered_m, blocks.left_m().min(limit_m));
        let height_m = |t: f64| ray.origin_m[2] + ray.direction[2] * t;
        if height_m(span.0).min(height_m(span.1)) <= elevation.ceiling_m(blocks.cell)
            && let Some(range_m) = in_block(elevation, ray, (start, speed), span)
        {
            return Some(Hit {
                range_m,
                surface: Surface::Ground,
            });
        }
        if span.1 >= limit_m {
            return None;
        }
        blocks.advance();
    }
    None
}

/// The first t in a span at which a ray is on or below the ground, searched patch by patch.
fn in_block(
    elevation: &Elevation,
    ray: &Ray,
    (start, speed): ([f64; 2], [f64; 2]),
    (from_m, to_m): (f64, f64),
) -> Option<f64> {
    let mut traversal = GridTraversal::new(start, speed);
    if from_m > 0.0 {
        traversal.jump(from_m);
    }
    while traversal.entered_m <= to_m {
        let corners = elevation.patch(traversal.cell[0], traversal.cell[1]);
        let left_m = traversal.left_m().min(to_m);
        let place = [0, 1].map(|k| start[k] - traversal.cell[k] as f64);
        let met = patch(corners, ray, (place, speed), (traversal.entered_m, left_m));
        if met.is_some() || left_m >= to_m {
            return met;
        }
        traversal.advance();
    }
    None
}

/// The span of t in which a line is within the box [0, size]; the end lies before the beginning
/// if it never is.
fn within(start: [f64; 2], speed: [f64; 2], size: [f64; 2]) -> (f64, f64) {
    let mut inside = (0.0_f64, f64::INFINITY);
    for axis in 0..2 {
        let (from, to) = if speed[axis].abs() > 1e-12 {
            let ends = [0.0, size[axis]].map(|edge| (edge - start[axis]) / speed[axis]);
            (ends[0].min(ends[1]), ends[0].max(ends[1]))
        } else if (0.0..=size[axis]).contains(&start[axis]) {
            continue;
        } else {
            (0.0, -1.0)
        };
        inside = (inside.0.max(from), inside.1.min(to));
    }
    inside
}

/// First t in [from, to] at which a ray is on or below a bilinear patch.
///
/// Along the ray, at `place + speed t` in the patch's unit square, the ground is `a + b t + c t²`.
fn patch(
    [low_left, low_right, high_left, high_right]: [f64; 4],
    ray: &Ray,
    (place, speed): ([f64; 2], [f64; 2]),
    (from, to): (f64, f64),
) -> Option<f64> {
    let across = low_right - low_left;
    let up = high_left - low_left;
    let twist = low_left - low_right - high_left + high_right;
    let [x, y] = place;
    let [u, v] = speed;
    // Height of the ray above the ground: a + b t + c t².
    let a = ray.origin_m[2] - (low_left + across * x + up * y + twist * x * y);
    let b = ray.direction[2] - (across * u + up * v + twist * (x * v + y * u));
    let c = -twist * u * v;
    if a.is_nan() {
        return None;
    }
    let above = |t: f64| a + t * (b + t * c);
    if above(from) <= 0.0 {
        return Some(from);
    }
    first_root(a, b, c, from).filter(|t| *t <= to)
}

/// Least root of a + b t + c t² that is greater than `from`.
fn first_root(a: f64, b: f64, c: f64, from: f64) -> Option<f64> {
    if c == 0.0 {
        return (b < 0.0).then(|| -a / b).filter(|t| *t > from);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 {
        return None;
    }
    // The stable formula for both roots: it has no difference of nearly equal numbers.
    let q = -0.5 * (b + discriminant.sqrt().copysign(b));
    let roots = [q / c, if q == 0.0 { q / c } else { a / q }];
    roots
        .into_iter()
        .filter(|t| *t > from)
        .min_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::world::{HeightScale, Image};
    use rand_chacha::ChaCha8Rng;
    use rand_chacha::rand_core::{Rng, SeedableRng};

    /// Rough hills with a hole.
    fn hills() -> Elevation {
        let mut rng = ChaCha8Rng::seed_from_u64(9);
        let image = Image {
            width: 30,
            height: 24,
            samples: (0..30 * 24)
                .map(|_| 1 + rng.next_u32() % 65_535)
                .map(|v| if v < 900 { 0 } else { v })
                .collect(),
            full: 65_535,
            channels: 1,
            transparent: Vec::new(),
        };
        let scale = HeightScale {
            z_min_m: -0.4,
            z_max_m: 0.6,
            no_data: Some(0),
        };
        Elevation::from_image(&image, scale, 0.3, [-2.0, 1.0])
    }

    #[test]
    fn the_hit_is_where_a_march_in_small_steps_finds_it() {
        let elevation = hills();
        let mut rng = ChaCha8Rng::seed_from_u64(11);
        let mut uniform =
            |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / 4_294_967_295.0;
        let mut met = 0;
        for _ in 0..3000 {
            let beam = Ray::towards(
                [uniform(-1.5, 6.5), uniform(1.5, 7.5), 1.0],
                [uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-1.0, 0.0)],
            );
            let at = |t: f64| [0, 1, 2].map(|k| beam.origin_m[k] + t * beam.direction[k]);
            let below = |t: f64| {
                let [x, y, z] = at(t);
                elevation.ground_m(x, y).is_some_and(|ground| z <= ground)
            };
            let step_m = 5e-4;
            let marched = (0..20_000)
                .map(|k| f64::from(k) * step_m)
                .find(|t| below(*t));
            match (ground(&elevation, &beam, 10.0), marched) {
                // The march may step over the very tip of a hill, the exact hit never does.
                (Some(hit), Some(t)) => {
                    assert!(hit.range_m <= t + 1e-9, "{beam:?} {hit:?} {t}");
                    if t - hit.range_m > step_m {
                        assert!(below(hit.range_m + 1e-9), "{beam:?} {hit:?} {t}");
                    }
                    met += 1;
                }
                (Some(hit), None) => assert!(below(hit.range_m + 1e-9), "{beam:?} {hit:?}"),
                (None, Some(t)) => panic!("{beam:?} passed the ground at {t}"),
                (None, None) => {}
            }
        }
        assert!(met > 2000, "{met}");
    }

    #[test]
    fn skipping_blocks_changes_no_hit() {
        let elevation = hills();
        let mut rng = ChaCha8Rng::seed_from_u64(12);
        let mut uniform =
            |low: f64, high: f64| low + (high - low) * f64::from(rng.next_u32()) / 4_294_967_295.0;
        let mut met = 0;
        for _ in 0..5000 {
            let beam = Ray::towards(
                [uniform(-3.0, 8.0), uniform(0.0, 9.0), uniform(0.2, 1.5)],
                [uniform(-1.0, 1.0), uniform(-1.0, 1.0), uniform(-0.5, 0.2)],
            );
            let start = [0, 1].map(|k| (beam.origin_m[k] - elevation.origin_m()[k]) / 0.3 - 0.5);
            let speed = [0, 1].map(|k| beam.direction[k] / 0.3);
            let (enter_m, leave_m) = within(start.map(|s| s + 0.5), speed, [30.0, 24.0]);
            let every_patch = in_block(
                &elevation,
                &beam,
                (start, speed),
                (enter_m, leave_m.min(9.0)),
            );
            let ours = ground(&elevation, &beam, 9.0).map(|hit| hit.range_m);
            match (ours, every_patch) {
                (Some(a), Some(b)) => assert!((a - b).abs() < 1e-9, "{beam:?}: {a} {b}"),
                (a, b) => assert_eq!(a, b, "{beam:?}"),
            }
            met += u32::from(ours.is_some());
        }
        assert!((1500..4500).contains(&met), "{met}");
    }
}
