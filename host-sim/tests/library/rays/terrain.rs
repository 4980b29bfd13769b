//! Rays over uneven ground with walls, against parry's height field and cuboids.
//!
//! parry's ground has triangles, ours has bilinear patches. If the heights are the sum of a
//! function of x and a function of y, every patch is plane, so both are the same surface. Each wall
//! cell is a cuboid of its own.

use host_sim::robot::{LaserNoise, LaserScanner, Pose, Source, laser, stand};
use host_sim::world::{Class, Elevation, GridCell, Occupancy, Ray, WALL_HEIGHT_M, World};
use parry3d::math::Vector;
use parry3d::query::RayCast;
use parry3d::shape::HeightField;
use parry3d::utils::Array2;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::{Rng, SeedableRng};

use super::{LIMIT_M, Solid, direction, grazes, hits, uniform, vector};

const RESOLUTION_M: f64 = 0.1;
const CELLS: [usize; 2] = [130, 90];
/// Heights far below and far above everything, metres.
const DEEP_M: f64 = -20.0;
const HIGH_M: f64 = 40.0;

/// A world, and the same for parry: the field's centre is the middle of the world, its up is y.
struct Twins {
    world: World,
    field: HeightField,
    middle: [f64; 2],
    boxes: Vec<Solid>,
}

/// Heights with small random steps and a few kerbs.
fn profile(rng: &mut ChaCha8Rng, count: usize) -> Vec<f64> {
    let mut height_m = 0.0;
    (0..count)
        .map(|_| {
            let kerb = rng.next_u32().is_multiple_of(12);
            height_m += uniform(rng, -1.0, 1.0) * if kerb { 0.4 } else { 0.03 };
            height_m
        })
        .collect()
}

impl Twins {
    fn random(rng: &mut ChaCha8Rng) -> Self {
        let [width, height] = CELLS;
        let origin = [uniform(rng, -9.0, 9.0), uniform(rng, -9.0, 9.0)];
        let (along, up) = (profile(rng, width), profile(rng, height));
        let index = |m: f64, axis: usize| ((m - origin[axis]) / RESOLUTION_M) as usize;
        let elevation = Elevation::from_fn(CELLS, RESOLUTION_M, origin, |x, y| {
            along[index(x, 0)] + up[index(y, 1)]
        });
        // One more sample on each side, because the outermost half pixels are level.
        let clamped = |k: usize, count: usize| k.saturating_sub(1).min(count - 1);
        let mut heights = Array2::repeat(height + 2, width + 2, 0.0_f32);
        for row in 0..height + 2 {
            for column in 0..width + 2 {
                let sum = along[clamped(column, width)] + up[clamped(row, height)];
                heights[(row, column)] = sum as f32;
            }
        }
        let span = |count: usize| ((count + 1) as f64 * RESOLUTION_M) as f32;
        let field = HeightField::new(heights, Vector::new(span(width), 1.0, span(height)));
        let place = |k: usize, axis: usize| origin[axis] + k as f64 * RESOLUTION_M;
        let mut grid = Occupancy::filled(width, height, RESOLUTION_M, origin, Class::Free);
        let (x0, x1) = (origin[0], place(width, 0));
        let (y0, y1) = (origin[1], place(height, 1));
        let mut boxes = vec![
            [[x0 - 9.0, y0 - 9.0, DEEP_M], [x0, y1 + 9.0, HIGH_M]],
            [[x1, y0 - 9.0, DEEP_M], [x1 + 9.0, y1 + 9.0, HIGH_M]],
            [[x0 - 9.0, y0 - 9.0, DEEP_M], [x1 + 9.0, y0, HIGH_M]],
            [[x0 - 9.0, y1, DEEP_M], [x1 + 9.0, y1 + 9.0, HIGH_M]],
        ];
        for _ in 0..40 {
            let i = rng.next_u32() as usize % width;
            let j = rng.next_u32() as usize % height;
            grid.set(
                GridCell {
                    i: i as i64,
                    j: j as i64,
                },
                Class::Wall,
            );
            let top_m = along[i] + up[j] + WALL_HEIGHT_M;
            boxes.push([
                [place(i, 0), place(j, 1), DEEP_M],
                [place(i + 1, 0), place(j + 1, 1), top_m],
            ]);
        }
        Self {
            world: World::uneven("random", grid, elevation, Vec::new()),
            field,
            middle: [0.5 * (x0 + x1), 0.5 * (y0 + y1)],
            boxes,
        }
    }

    /// Range of parry's first hit.
    fn oracle(&self, ray: &Ray) -> Option<f64> {
        let [x, y, z] = ray.origin_m;
        let from = vector([x - self.middle[0], z, y - self.middle[1]]);
        let [dx, dy, dz] = ray.direction;
        let turned = parry3d::query::Ray::new(from, vector([dx, dz, dy]));
        let ground = self.field.cast_local_ray(&turned, LIMIT_M as f32, true);
        let all = hits(&self.boxes, ray).chain(ground);
        all.map(f64::from).min_by(f64::total_cmp)
    }

    /// A free place, up to 2 m above the ground.
    fn place(&self, rng: &mut ChaCha8Rng) -> [f64; 3] {
        let [x0, y0] = self.world.occupancy().origin_m();
        let [width, height] = self.world.size_m();
        loop {
            let x = uniform(rng, x0 + 0.5, x0 + width - 0.5);
            let y = uniform(rng, y0 + 0.5, y0 + height - 0.5);
            if let Some(ground_m) = self.world.ground_m(x, y)
                && !self.world.is_solid(x, y)
            {
                return [x, y, ground_m + uniform(rng, 0.05, 2.0)];
            }
        }
    }
}

#[test]
fn rays_agree_with_parry_over_hills_and_walls() {
    let mut rng = ChaCha8Rng::seed_from_u64(40);
    let (mut cast, mut grazed, mut ground) = (0, 0, 0);
    for _ in 0..16 {
        let twins = Twins::random(&mut rng);
        for _ in 0..1500 {
            let bearing = uniform(&mut rng, 0.0, core::f64::consts::TAU);
            let slope = match rng.next_u32() % 3 {
                0 => uniform(&mut rng, -0.1, 0.1),
                1 => uniform(&mut rng, -0.5, 0.0),
                _ => uniform(&mut rng, -1.5, 1.5),
            };
            let ray = Ray {
                origin_m: twins.place(&mut rng),
                direction: direction(bearing, slope),
            };
            cast += 1;
            grazed += u32::from(grazes(&twins.world, |ray| twins.oracle(ray), &ray));
            let hit = twins.world.cast(&ray, LIMIT_M);
            ground +=
                u32::from(hit.is_some_and(|hit| hit.surface == host_sim::world::Surface::Ground));
        }
    }
    println!("{cast} rays, {grazed} grazing, {ground} on the ground");
    assert!(grazed * 300 < cast, "{grazed} of {cast} rays disagree");
    assert!(ground * 3 > cast, "{ground} of {cast} rays hit the ground");
}

type Matrix = [[f64; 3]; 3];

fn times(a: &Matrix, b: &Matrix) -> Matrix {
    [0, 1, 2].map(|i| [0, 1, 2].map(|j| (0..3).map(|k| a[i][k] * b[k][j]).sum()))
}

fn apply(m: &Matrix, v: [f64; 3]) -> [f64; 3] {
    [0, 1, 2].map(|i| (0..3).map(|k| m[i][k] * v[k]).sum())
}

/// The attitude as a product of three elementary rotations: yaw, then pitch, then roll.
fn attitude(pose: &Pose) -> Matrix {
    let (sr, cr) = pose.roll_rad.sin_cos();
    let (sp, cp) = pose.pitch_rad.sin_cos();
    let (sy, cy) = pose.yaw_rad.sin_cos();
    let yaw = [[cy, -sy, 0.0], [sy, cy, 0.0], [0.0, 0.0, 1.0]];
    let pitch = [[cp, 0.0, sp], [0.0, 1.0, 0.0], [-sp, 0.0, cp]];
    let roll = [[1.0, 0.0, 0.0], [0.0, cr, -sr], [0.0, sr, cr]];
    times(&times(&yaw, &pitch), &roll)
}

/// Compares whole sweeps of both lasers, beam by beam, from robots that stand tilted on the ground.
#[test]
fn sweeps_of_a_tilted_robot_agree_with_parry() {
    let mut rng = ChaCha8Rng::seed_from_u64(41);
    let sources = [Source::LevelRange, Source::LevelFault];
    let (mut beams, mut apart, mut tilted) = (0, 0, 0);
    for _ in 0..6 {
        let twins = Twins::random(&mut rng);
        for _ in 0..5 {
            let [x_m, y_m, _] = twins.place(&mut rng);
            let planar = Pose {
                x_m,
                y_m,
                yaw_rad: uniform(&mut rng, -3.0, 3.0),
                ..Pose::default()
            };
            let pose = stand(&twins.world, &planar).expect("ground");
            tilted += u32::from(pose.pitch_rad.abs().max(pose.roll_rad.abs()) > 0.05);
            let turn = attitude(&pose);
            for mount in [laser::level(), laser::tilted()] {
                let scan = LaserScanner::new(&mount, LaserNoise::NONE, 1, sources)
                    .scan(&twins.world, &pose);
                let offset = apply(&turn, [mount.x.to_num(), 0.0, mount.z.to_num()]);
                let (sin, cos) = mount.pitch.to_num::<f64>().sin_cos();
                for (beam, code) in scan.ranges_mm.iter().enumerate() {
                    let bearing = mount.first_bearing.to_num::<f64>()
                        + mount.bearing_step.to_num::<f64>() * beam as f64;
                    let own = [bearing.cos() * cos, bearing.sin(), -bearing.cos() * sin];
                    let ray = Ray {
                        origin_m: [pose.x_m, pose.y_m, pose.z_m]
                            .into_iter()
                            .zip(offset)
                            .map(|(a, b)| a + b)
                            .collect::<Vec<_>>()
                            .try_into()
                            .expect("three"),
                        direction: apply(&turn, own),
                    };
                    let theirs = twins.oracle(&ray).filter(|range| *range < 11.999);
                    let ours = Some(f64::from(*code) / 1000.0).filter(|range| *range < 11.999);
                    beams += 1;
                    let same = match (ours, theirs) {
                        (Some(a), Some(b)) => (a - b.max(0.02)).abs() < 2e-3,
                        (None, None) => true,
                        _ => false,
                    };
                    apart += u32::from(!same);
                }
            }
        }
    }
    assert!(tilted > 15, "{tilted} of 30 stances are tilted");
    assert!(apart * 200 < beams, "{apart} of {beams} beams disagree");
}
