//! The laser scanners: the two usual mounts, the beams, and their errors.
//!
//! A beam at bearing b leaves along `(cos b, sin b, 0)`, turned by the mount's pitch and then by
//! the robot's attitude. Mount and bearings are first rounded to the wire's fixed-point numbers,
//! so the simulated geometry is the announced one.
//!
//! A measured range is `r + σ·N(0,1)`, rounded to millimetres. With a small probability no return
//! comes (dark or shiny surfaces); with a smaller one a return comes from nearer than the wall
//! (dust, an edge hit by half of the beam). The readings go through [`Sectors`], as those of a real
//! lidar: the simulated one turns the way that it turns, and has as many beams as it has. One that
//! takes a turn time casts each beam from where the robot was at that beam's instant.

use fieldline_protocol::message::{self, MAX_BEAMS, Scan};
use fixed::types::{I4F12, I16F16};

use super::footprint::Footprint;
use super::lidar::Lidar;
use super::noise::{Noise, Source};
use super::pose::Pose;
use super::sectors::Sectors;
use crate::world::{Ray, World};

/// Errors of a laser.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LaserNoise {
    /// Standard deviation of a range, metres. Default: 0.01.
    pub sigma_m: f64,
    /// Probability that a return is lost. Default: 0.001.
    pub lost: f64,
    /// Probability of a false return, uniform between the laser and the wall. Default: 0.0005.
    pub false_return: f64,
}

impl Default for LaserNoise {
    fn default() -> Self {
        Self {
            sigma_m: 0.01,
            lost: 0.001,
            false_return: 0.0005,
        }
    }
}

impl LaserNoise {
    /// No errors except the rounding to millimetres.
    pub const NONE: Self = Self {
        sigma_m: 0.0,
        lost: 0.0,
        false_return: 0.0,
    };
}

/// Least range that a beam measures, metres: anything nearer is the laser's own housing.
pub(super) const NEAREST_M: f64 = 0.02;

/// The level scanner: 0.10 m ahead of the centre, 0.40 m up.
#[must_use]
pub fn level() -> message::Laser {
    mount(0.10, 0.40, 0.0)
}

/// The tilted scanner: 0.15 m ahead of the centre, 0.45 m up, 20° down.
#[must_use]
pub fn tilted() -> message::Laser {
    mount(0.15, 0.45, 20.0)
}

/// A scanner with 181 beams from −90° to +90° and a range of 12 m.
fn mount(x_m: f64, z_m: f64, down_deg: f64) -> message::Laser {
    message::Laser {
        x: I4F12::from_num(x_m),
        y: I4F12::ZERO,
        z: I4F12::from_num(z_m),
        pitch: I4F12::from_num(down_deg.to_radians()),
        first_bearing: I16F16::from_num(-core::f64::consts::FRAC_PI_2),
        bearing_step: I16F16::from_num(1.0_f64.to_radians()),
        beams: MAX_BEAMS as u16,
        range_limit_mm: 12_000,
        ..message::Laser::default()
    }
}

/// One scanner.
#[derive(Clone, Debug)]
pub struct LaserScanner {
    sectors: Sectors,
    /// Origin of the beams in the robot's frame, metres.
    position_m: [f64; 3],
    /// Directions of the beams in the robot's frame, from right to left.
    directions: Vec<[f64; 3]>,
    /// Ages of these beams, seconds; empty if all are of one instant.
    ages_s: Vec<f64>,
    limit_m: f64,
    errors: LaserNoise,
    range: Noise,
    fault: Noise,
}

impl LaserScanner {
    /// A scanner as announced by `laser`, with `errors`, and with noise `sources` for ranges and
    /// faults.
    #[must_use]
    pub fn new(
        laser: &message::Laser,
        errors: LaserNoise,
        seed: u64,
        sources: [Source; 2],
    ) -> Self {
        let lidar = Lidar::announced(laser, errors);
        Self::of(&lidar, &Footprint::PIONEER_3AT, seed, sources)
    }

    /// A lidar on a robot with this hull, with noise `sources` for ranges and faults.
    #[must_use]
    pub fn of(lidar: &Lidar, hull: &Footprint, seed: u64, [range, fault]: [Source; 2]) -> Self {
        let sectors = Sectors::new(lidar, hull);
        let laser = sectors.laser();
        Self {
            position_m: [laser.x.to_num(), laser.y.to_num(), laser.z.to_num()],
            directions: (0..sectors.promised())
                .map(|position| sectors.direction(position))
                .collect(),
            ages_s: if lidar.turn_time_s > 0.0 {
                (0..sectors.promised())
                    .map(|position| lidar.age_s(position))
                    .collect()
            } else {
                Vec::new()
            },
            limit_m: lidar.most_m,
            errors: lidar.noise,
            range: Noise::new(seed, range),
            fault: Noise::new(seed, fault),
            sectors,
        }
    }

    /// The laser to announce to the planner.
    #[must_use]
    pub const fn announced(&self) -> &message::Laser {
        self.sectors.laser()
    }

    /// Mirrors the beams at the axis ahead, and turns them to the left, radians. What is announced
    /// stays as it is.
    pub fn misplace(&mut self, turn_rad: f64, is_mirrored: bool) {
        let (sin, cos) = (libm::sin(turn_rad), libm::cos(turn_rad));
        for [x, y, _] in &mut self.directions {
            let side = if is_mirrored { -*y } else { *y };
            [*x, *y] = [cos * *x - sin * side, sin * *x + cos * side];
        }
    }

    /// Measures one sweep from a pose.
    pub fn scan(&mut self, world: &World, pose: &Pose) -> Scan {
        self.scan_among(world, |_, _| None, |_| *pose)
    }

    /// Longest age of a beam, seconds.
    #[must_use]
    pub fn turn_time_s(&self) -> f64 {
        self.ages_s.iter().copied().fold(0.0, f64::max)
    }

    /// Measures one sweep. `moving` returns the metres along a ray to the nearest of what moves in
    /// the world, if it is within a limit. `pose` returns the robot's pose so many seconds ago.
    pub fn scan_among(
        &mut self,
        world: &World,
        moving: impl Fn(&Ray, f64) -> Option<f64>,
        pose: impl Fn(f64) -> Pose,
    ) -> Scan {
        let mut mount = Mount::at(&pose(0.0), &self.position_m);
        let mut readings_m = Vec::with_capacity(self.directions.len());
        for beam in 0..self.directions.len() {
            if let Some(age_s) = self.ages_s.get(beam) {
                mount = Mount::at(&pose(*age_s), &self.position_m);
            }
            let ray = mount.ray(&self.directions[beam]);
            let hit_m = world.cast(&ray, self.limit_m).map(|hit| hit.range_m);
            let nearer_m = moving(&ray, hit_m.unwrap_or(self.limit_m));
            readings_m.push(self.measure(nearer_m.or(hit_m)));
        }
        if self.sectors.is_reversed() {
            readings_m.reverse();
        }
        self.sectors.fold(&readings_m)
    }

    /// Returns the reading that the scanner reports for a true range, metres; infinite without a
    /// return.
    fn measure(&mut self, range_m: Option<f64>) -> f64 {
        // Every beam makes all draws, so that no beam shifts the draws of the next.
        let error_m = self.errors.sigma_m * self.range.normal();
        let (fate, place) = (self.fault.uniform(), self.fault.uniform());
        let reach_m = range_m.unwrap_or(self.limit_m);
        if fate < self.errors.false_return {
            return NEAREST_M + place * (reach_m - NEAREST_M).max(0.0);
        }
        match range_m {
            Some(range_m) if fate < 1.0 - self.errors.lost => (range_m + error_m).max(NEAREST_M),
            _ => f64::INFINITY,
        }
    }
}

/// A laser in the world.
struct Mount {
    axes: [[f64; 3]; 3],
    origin_m: [f64; 3],
}

impl Mount {
    /// Returns the laser at a place on a robot with this pose.
    fn at(pose: &Pose, position_m: &[f64; 3]) -> Self {
        let mut mount = Self {
            axes: pose.axes(),
            origin_m: [0.0; 3],
        };
        let offset = mount.rotate(position_m);
        mount.origin_m = [
            pose.x_m + offset[0],
            pose.y_m + offset[1],
            pose.z_m + offset[2],
        ];
        mount
    }

    fn rotate(&self, v: &[f64; 3]) -> [f64; 3] {
        let axes = &self.axes;
        [0, 1, 2].map(|k| axes[0][k] * v[0] + axes[1][k] * v[1] + axes[2][k] * v[2])
    }

    /// Returns the beam that leaves in a direction of the robot's frame.
    fn ray(&self, direction: &[f64; 3]) -> Ray {
        Ray {
            origin_m: self.origin_m,
            direction: self.rotate(direction),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use fieldline_protocol::message::NO_RETURN_MM;

    fn scanner(laser: &message::Laser, errors: LaserNoise, seed: u64) -> LaserScanner {
        LaserScanner::new(
            laser,
            errors,
            seed,
            [Source::LevelRange, Source::LevelFault],
        )
    }

    /// A room of 6 × 6 m with its walls at 0 and 6.
    fn room() -> World {
        let row = ".".repeat(12);
        World::picture("room", 0.5, &[row.as_str(); 12])
    }

    fn middle() -> Pose {
        Pose {
            x_m: 3.0,
            y_m: 3.0,
            ..Pose::default()
        }
    }

    #[test]
    fn perfect_lasers_measure_the_room() {
        let scan = scanner(&level(), LaserNoise::NONE, 1).scan(&room(), &middle());
        let mount_m: f64 = level().x.to_num();
        assert_eq!(scan.ranges_mm.len(), 181);
        assert_eq!(
            scan.ranges_mm[90],
            ((3.0 - mount_m) * 1000.0).round() as u16
        );
        for (beam, range_mm) in scan.ranges_mm.iter().enumerate() {
            let bearing = level().first_bearing.to_num::<f64>()
                + level().bearing_step.to_num::<f64>() * beam as f64;
            let [along, across] = [bearing.cos(), bearing.sin()];
            let wall = ((3.0 - mount_m) / along.max(1e-9)).min(3.0 / across.abs());
            assert!(
                (f64::from(*range_mm) / 1000.0 - wall).abs() < 6e-4,
                "{beam}"
            );
        }
    }

    #[test]
    fn the_tilted_laser_sees_the_ground_and_the_sides() {
        let scan = scanner(&tilted(), LaserNoise::NONE, 1).scan(&room(), &middle());
        let (height, pitch): (f64, f64) = (tilted().z.to_num(), tilted().pitch.to_num());
        assert_eq!(
            scan.ranges_mm[90],
            (height / pitch.sin() * 1000.0).round() as u16
        );
        // Straight to the side its beams are level and hit the wall.
        assert_eq!(scan.ranges_mm[180], 3000);
    }

    #[test]
    fn a_beam_without_a_hit_within_the_limit_gives_the_code() {
        let wide = World::builtin("empty-hall").expect("built in");
        let pose = Pose {
            x_m: 15.0,
            y_m: 15.0,
            ..Pose::default()
        };
        let scan = scanner(&level(), LaserNoise::NONE, 1).scan(&wide, &pose);
        assert!(scan.ranges_mm.iter().all(|code| *code == NO_RETURN_MM));
    }

    #[test]
    fn noise_has_the_stated_rates_and_spread() {
        let errors = LaserNoise {
            sigma_m: 0.02,
            lost: 0.05,
            false_return: 0.03,
        };
        let mut laser = scanner(&level(), errors, 8);
        let world = room();
        let truth = f64::from(
            scanner(&level(), LaserNoise::NONE, 1)
                .scan(&world, &middle())
                .ranges_mm[90],
        );
        let count = 20_000;
        let ahead: Vec<f64> = (0..count)
            .map(|_| 1000.0 * laser.measure(Some(truth / 1000.0)))
            .collect();
        let share = |test: &dyn Fn(f64) -> bool| {
            ahead.iter().filter(|r| test(**r)).count() as f64 / f64::from(count)
        };
        let lost = share(&|range| range.is_infinite());
        let near = share(&|range| range < truth - 100.0);
        // Four standard errors; a false return is within 100 mm of the wall in 3.5 % of its cases.
        assert!((lost - 0.05).abs() < 0.0062, "{lost}");
        assert!((near - 0.029).abs() < 0.0048, "{near}");
        let good: Vec<f64> = ahead
            .iter()
            .map(|range| range - truth)
            .filter(|error| error.abs() < 100.0)
            .collect();
        let variance = good.iter().map(|e| e * e).sum::<f64>() / good.len() as f64;
        assert!((variance.sqrt() - 20.0).abs() < 0.8, "{}", variance.sqrt());
    }

    #[test]
    fn a_change_of_one_rate_leaves_the_other_draws_as_they_were() {
        let quiet = LaserNoise {
            lost: 0.0,
            false_return: 0.0,
            ..LaserNoise::default()
        };
        let scan = |errors| scanner(&level(), errors, 5).scan(&room(), &middle());
        let (clean, faulty) = (scan(quiet), scan(LaserNoise { lost: 0.2, ..quiet }));
        let mut lost = 0;
        for (clean, faulty) in clean.ranges_mm.iter().zip(&faulty.ranges_mm) {
            if *faulty == NO_RETURN_MM {
                lost += 1;
            } else {
                assert_eq!(clean, faulty);
            }
        }
        assert!((15..60).contains(&lost), "{lost}");
    }
}
