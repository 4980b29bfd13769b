//! Rays among random boxes on level ground.

use host_sim::world::{Class, GridCell, Occupancy, Ray, WALL_HEIGHT_M, World};
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{Solid, direction, grazes, hits, uniform};

const RESOLUTION_M: f64 = 0.05;
const CELLS: [i64; 2] = [240, 160];

/// A world of random boxes, and its boxes, border and ground as cuboids.
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
    // A third of the rays is level, a third slopes like the tilted laser's, a third anywhere.
    let slope = match rng.next_u32() % 3 {
        0 => 0.0,
        1 => uniform(rng, -0.35, 0.0),
        _ => uniform(rng, -1.5, 1.5),
    };
    Ray {
        origin_m,
        direction: direction(bearing, slope),
    }
}

/// Range of parry's first hit.
fn oracle(solids: &[Solid], ray: &Ray) -> Option<f64> {
    hits(solids, ray).map(f64::from).min_by(f64::total_cmp)
}

#[test]
fn rays_agree_with_parry_on_random_boxes() {
    let mut rng = ChaCha8Rng::seed_from_u64(20);
    let (mut cast, mut grazed) = (0, 0);
    for _ in 0..40 {
        let (world, solids) = random_world(&mut rng);
        for _ in 0..2500 {
            let ray = random_ray(&mut rng, &world);
            cast += 1;
            grazed += u32::from(grazes(&world, |ray| oracle(&solids, ray), &ray));
        }
    }
    println!("{cast} rays, {grazed} grazing");
    assert!(grazed * 1000 < cast, "{grazed} of {cast} rays disagree");
}
