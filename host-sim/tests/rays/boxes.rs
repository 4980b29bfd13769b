//! Ray casting against an independent implementation: parry3d's cuboids.
//!
//! Worlds of random boxes on the grid, random rays in space. Both must agree to a millimetre. A ray that grazes an edge may
//! see it or not, by a rounding error; such a ray must agree after being shifted sideways by 0.1 mm, and must be rare.

use host_sim::world::{Class, GridCell, Occupancy, Ray, WALL_HEIGHT_M, World};
use parry3d::math::Vector;
use parry3d::query::RayCast;
use parry3d::shape::Cuboid;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

const RESOLUTION_M: f64 = 0.05;
const CELLS: [i64; 2] = [240, 160];
const LIMIT_M: f64 = 12.0;
const AGREE_M: f64 = 1e-3;
const GRAZE_M: f64 = 1e-4;

/// A solid from corner to corner, metres.
type Solid = [[f64; 3]; 2];

fn uniform(rng: &mut ChaCha8Rng, low: f64, high: f64) -> f64 {
    low + (high - low) * f64::from(rng.next_u32()) / f64::from(u32::MAX)
}

/// A world of random boxes, and the same as cuboids, with the border and the ground.
fn random_world(rng: &mut ChaCha8Rng) -> (World, Vec<Solid>) {
    let origin = [uniform(rng, -9.0, 9.0), uniform(rng, -9.0, 9.0)];
    let [width, height] = CELLS.map(|cells| cells as usize);
    let mut grid = Occupancy::filled(width, height, RESOLUTION_M, origin, Class::Free);
    let place = |k: usize, cells: i64| origin[k] + cells as f64 * RESOLUTION_M;
    let (x0, x1) = (origin[0], place(0, CELLS[0]));
    let (y0, y1) = (origin[1], place(1, CELLS[1]));
    let mut solids = vec![
        [[x0 - 9.0, y0 - 9.0, -1.0], [x1 + 9.0, y1 + 9.0, 0.0]],
        [[x0 - 9.0, y0 - 9.0, -1.0], [x0, y1 + 9.0, 50.0]],
        [[x1, y0 - 9.0, -1.0], [x1 + 9.0, y1 + 9.0, 50.0]],
        [[x0 - 9.0, y0 - 9.0, -1.0], [x1 + 9.0, y0, 50.0]],
        [[x0 - 9.0, y1, -1.0], [x1 + 9.0, y1 + 9.0, 50.0]],
    ];
    for _ in 0..40 {
        let size = [0, 1].map(|_| 1 + i64::from(rng.next_u32() % 18));
        let low = [0, 1].map(|k| i64::from(rng.next_u32()) % (CELLS[k] - size[k]));
        for j in low[1]..low[1] + size[1] {
            for i in low[0]..low[0] + size[0] {
                grid.set(GridCell { i, j }, Class::Wall);
            }
        }
        solids.push([
            [place(0, low[0]), place(1, low[1]), 0.0],
            [
                place(0, low[0] + size[0]),
                place(1, low[1] + size[1]),
                WALL_HEIGHT_M,
            ],
        ]);
    }
    (World::flat("random", grid, Vec::new()), solids)
}

fn random_ray(rng: &mut ChaCha8Rng, world: &World) -> Ray {
    let [x0, y0] = world.occupancy().origin_m();
    let [width, height] = world.size_m();
    let origin_m = loop {
        let x = uniform(rng, x0, x0 + width);
        let y = uniform(rng, y0, y0 + height);
        if !world.is_solid(x, y) {
            break [x, y, uniform(rng, 0.05, 2.5)];
        }
    };
    let bearing = uniform(rng, 0.0, core::f64::consts::TAU);
    // A third level, a third as the tilted laser, a third anywhere.
    let slope = match rng.next_u32() % 3 {
        0 => 0.0,
        1 => uniform(rng, -0.35, 0.0),
        _ => uniform(rng, -1.5, 1.5),
    };
    Ray {
        origin_m,
        direction: [
            bearing.cos() * slope.cos(),
            bearing.sin() * slope.cos(),
            slope.sin(),
        ],
    }
}

/// What parry sees, on the origin's side of everything so that f32 suffices.
fn oracle(solids: &[Solid], ray: &Ray) -> Option<f64> {
    let vector = |v: [f64; 3]| Vector::new(v[0] as f32, v[1] as f32, v[2] as f32);
    solids
        .iter()
        .filter_map(|[low, high]| {
            let half = [0, 1, 2].map(|k| 0.5 * (high[k] - low[k]));
            let from = [0, 1, 2].map(|k| ray.origin_m[k] - 0.5 * (low[k] + high[k]));
            let ray = parry3d::query::Ray::new(vector(from), vector(ray.direction));
            Cuboid::new(vector(half)).cast_local_ray(&ray, LIMIT_M as f32, true)
        })
        .map(f64::from)
        .min_by(f64::total_cmp)
}

/// Do both see the same, to a millimetre, both nothing included?
fn agree(world: &World, solids: &[Solid], ray: &Ray) -> bool {
    let ours = world.cast(ray, LIMIT_M).map(|hit| hit.range_m);
    match (ours, oracle(solids, ray)) {
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

#[test]
fn agrees_with_parry_on_random_boxes() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let (mut cast, mut grazed) = (0, 0);
    for _ in 0..40 {
        let (world, solids) = random_world(&mut rng);
        for _ in 0..2500 {
            let ray = random_ray(&mut rng, &world);
            cast += 1;
            if !agree(&world, &solids, &ray) {
                grazed += 1;
                let aside = [GRAZE_M, -GRAZE_M].map(|by_m| shifted(&ray, by_m));
                assert!(
                    aside.iter().any(|ray| agree(&world, &solids, ray)),
                    "{ray:?}: {:?}, parry {:?}",
                    world.cast(&ray, LIMIT_M),
                    oracle(&solids, &ray)
                );
            }
        }
    }
    println!("{cast} rays, {grazed} grazing");
    assert!(grazed * 1000 < cast, "{grazed} of {cast} rays disagree");
}
