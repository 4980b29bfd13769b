//! Ray casting against an independent implementation, parry3d.
//!
//! Both must agree to 1 mm. A ray that grazes an edge may hit it or not, by a rounding error. Such
//! a ray must agree after a shift of 0.1 mm, and such rays must be rare.

mod boxes;
mod terrain;

use host_sim::world::{Ray, World};
use parry3d::math::Vector;
use parry3d::query::RayCast;
use parry3d::shape::Cuboid;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::Rng;

/// Range of the rays, metres.
const LIMIT_M: f64 = 12.0;
/// Greatest difference of two equal ranges, metres.
const AGREE_M: f64 = 1e-3;
/// Shift of a grazing ray, metres.
const GRAZE_M: f64 = 1e-4;

/// A cuboid from corner to corner, metres.
type Solid = [[f64; 3]; 2];

fn uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX)
}

/// A unit vector from a bearing and a slope, radians.
fn direction(bearing: f64, slope: f64) -> [f64; 3] {
    [
        bearing.cos() * slope.cos(),
        bearing.sin() * slope.cos(),
        slope.sin(),
    ]
}

fn vector(v: [f64; 3]) -> Vector {
    Vector::new(v[0] as f32, v[1] as f32, v[2] as f32)
}

/// Ranges of parry's hits on cuboids. Each ray is moved to the cuboid's centre, so f32 is precise
/// enough.
fn hits<'a>(solids: &'a [Solid], ray: &'a Ray) -> impl Iterator<Item = f32> + 'a {
    solids.iter().filter_map(|[low, high]| {
        let half = [0, 1, 2].map(|k| 0.5 * (high[k] - low[k]));
        let from = [0, 1, 2].map(|k| ray.origin_m[k] - 0.5 * (low[k] + high[k]));
        let ray = parry3d::query::Ray::new(vector(from), vector(ray.direction));
        Cuboid::new(vector(half)).cast_local_ray(&ray, LIMIT_M as f32, true)
    })
}

/// Returns true if both ranges agree, or neither ray hits anything.
fn agree(world: &World, oracle: impl Fn(&Ray) -> Option<f64>, ray: &Ray) -> bool {
    let ours = world.cast(ray, LIMIT_M).map(|hit| hit.range_m);
    match (ours, oracle(ray)) {
        (Some(ours), Some(theirs)) => (ours - theirs).abs() <= AGREE_M,
        (None, None) => true,
        (Some(range), None) | (None, Some(range)) => (range - LIMIT_M).abs() <= AGREE_M,
    }
}

fn shifted(ray: &Ray, by_m: f64) -> Ray {
    let [dx, dy, _] = ray.direction;
    let [x, y, z] = ray.origin_m;
    Ray {
        origin_m: [x - dy * by_m, y + dx * by_m, z + by_m],
        ..*ray
    }
}

/// Returns true if the ray grazes: it disagrees, and agrees after a shift. Any other disagreement
/// fails the test.
fn grazes(world: &World, oracle: impl Fn(&Ray) -> Option<f64>, ray: &Ray) -> bool {
    if agree(world, &oracle, ray) {
        return false;
    }
    let aside = [GRAZE_M, -GRAZE_M].map(|by_m| shifted(ray, by_m));
    assert!(
        aside.iter().any(|ray| agree(world, &oracle, ray)),
        "{ray:?}: {:?}, parry {:?}",
        world.cast(ray, LIMIT_M),
        oracle(ray)
    );
    true
}
