//! A Rao–Blackwellised particle filter: each particle has a pose and a map of its own.
//!
//! ```text
//! advance      pose and weight of every particle, by its own stream of random numbers
//! normalise    Σ w = 1;   effective number N_eff = 1 / Σ w²
//! resample     if N_eff < N / 2, by one comb over the weights
//! enter        the scan, in the map of every particle
//! ```
//!
//! Source: Ouroboros §4 and TDBVP §5 (300 and 200 particles), after [Thrun05].
//!
//! Particles are shared out among threads. Each has its own random numbers, and sums are taken in
//! order, so the number of threads changes no bit.
//!
//! [Thrun05]: S. Thrun, W. Burgard, D. Fox, "Probabilistic Robotics", 2005.
//!
//! Units: metres, radians.

use std::collections::HashSet;

use rayon::iter::{
    IndexedParallelIterator as _, IntoParallelRefMutIterator as _, ParallelIterator as _,
};

use super::grid::Grid;
use super::proposal::{Proposal, advance};
use super::scan::Scan;
use crate::replay::relations::{Pose, compose};
use crate::robot::{Noise, OdometryNoise, Source};

/// One particle.
#[derive(Clone, Debug)]
struct Particle {
    pose: Pose,
    log_weight: f64,
    grid: Grid,
}

/// The filter.
#[derive(Debug)]
pub(super) struct Filter {
    proposal: Proposal,
    wheels: OdometryNoise,
    particles: Vec<Particle>,
    /// A stream for each place in the list; a copy of a particle goes on with that of its place.
    streams: Vec<Noise>,
    comb: Noise,
    /// The place of the heaviest particle; after resampling, of a copy of it.
    best: usize,
    updates: u64,
    resampled: u64,
}

/// Distances of the particles from a place, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Distances {
    /// Mean of all particles, without their weights, as in the papers.
    pub mean_m: f64,
    /// Of the best particle.
    pub best_m: f64,
}

impl Filter {
    /// Makes a filter whose particles all stand at a start, with a map over a rectangle.
    pub(super) fn new(
        (count, proposal): (usize, Proposal),
        wheels: OdometryNoise,
        (start, bounds_m): (Pose, [f64; 4]),
        seed: u64,
    ) -> Self {
        let particle = Particle {
            pose: start,
            log_weight: -libm::log(count as f64),
            grid: Grid::over(bounds_m),
        };
        let stream = |number| Noise::numbered(seed, Source::Particle, number);
        Self {
            proposal,
            wheels,
            particles: vec![particle; count],
            streams: (1..=count as u64).map(stream).collect(),
            comb: stream(0),
            best: 0,
            updates: 0,
            resampled: 0,
        }
    }

    /// Moves the particles by an increment of odometry, and takes a scan. The first scan is only
    /// entered: there is no map to weigh it by. If they were resampled, it returns for each the
    /// place of the one that it is a copy of.
    pub(super) fn update(&mut self, increment: Pose, scan: &Scan) -> Option<Vec<usize>> {
        let mut parents = None;
        if self.updates > 0 {
            self.advance(increment, scan);
            let effective = self.normalise();
            self.best = self.heaviest();
            if effective < 0.5 * self.particles.len() as f64 {
                parents = Some(self.resample());
            }
        }
        self.updates += 1;
        self.particles
            .par_iter_mut()
            .for_each(|particle| particle.grid.enter(particle.pose, scan));
        parents
    }

    fn advance(&mut self, increment: Pose, scan: &Scan) {
        let how = (self.proposal, &self.wheels);
        let each = self
            .particles
            .par_iter_mut()
            .zip(self.streams.par_iter_mut());
        each.for_each(|(particle, stream)| {
            let at = (&mut particle.pose, &particle.grid);
            particle.log_weight += advance(how, at, (increment, scan), stream);
        });
    }

    /// Scales the weights to the sum 1; returns the effective number of particles.
    fn normalise(&mut self) -> f64 {
        let logs = || self.particles.iter().map(|particle| particle.log_weight);
        let most = logs().fold(f64::MIN, f64::max);
        let sum: f64 = logs().map(|log| libm::exp(log - most)).sum();
        let scale = most + libm::log(sum);
        let mut squares = 0.0;
        for particle in &mut self.particles {
            particle.log_weight -= scale;
            squares += libm::exp(2.0 * particle.log_weight);
        }
        1.0 / squares
    }

    fn heaviest(&self) -> usize {
        let places = self.particles.iter().enumerate();
        // Of equal weights the first wins, so that the choice does not wander.
        let best = places
            .rev()
            .max_by(|(_, one), (_, other)| one.log_weight.total_cmp(&other.log_weight));
        best.map_or(0, |(place, _)| place)
    }

    /// Draws as many particles as there are, each as often as its weight says. One random number
    /// moves a comb of equal teeth, so a particle of weight w is drawn ⌊N w⌋ or ⌈N w⌉ times.
    /// Returns the places of those that were drawn.
    fn resample(&mut self) -> Vec<usize> {
        let count = self.particles.len();
        let first = self.comb.uniform();
        let weights = self
            .particles
            .iter()
            .map(|particle| libm::exp(particle.log_weight));
        let mut drawn = Vec::with_capacity(count);
        let (mut sum, mut best) = (0.0, None);
        for (place, weight) in weights.enumerate() {
            sum += weight;
            let teeth = (sum * count as f64 - first).ceil().max(0.0) as usize;
            while drawn.len() < teeth.min(count) {
                if place == self.best {
                    best.get_or_insert(drawn.len());
                }
                drawn.push(place);
            }
        }
        // The last tooth may fall behind a sum that is 1 but for its rounding.
        drawn.resize(count, drawn.last().copied().unwrap_or(self.best));
        let even = -libm::log(count as f64);
        let copy = |&place: &usize| Particle {
            log_weight: even,
            ..self.particles[place].clone()
        };
        self.particles = drawn.iter().map(copy).collect();
        self.best = best.unwrap_or(0);
        self.resampled += 1;
        drawn
    }

    /// Returns the distances from a true place, once the particles have moved on by odometry.
    pub(super) fn distances(&self, since: Pose, truth: [f64; 2]) -> Distances {
        let distance = |particle: &Particle| {
            let [x, y, _] = compose(particle.pose, since);
            let [dx, dy] = [x - truth[0], y - truth[1]];
            (dx * dx + dy * dy).sqrt()
        };
        let sum: f64 = self.particles.iter().map(distance).sum();
        Distances {
            mean_m: sum / self.particles.len() as f64,
            best_m: distance(&self.particles[self.best]),
        }
    }

    /// Returns the poses of all particles.
    pub(super) fn poses(&self) -> Vec<Pose> {
        self.particles
            .iter()
            .map(|particle| particle.pose)
            .collect()
    }

    /// Returns the place of the best particle.
    pub(super) const fn best(&self) -> usize {
        self.best
    }

    /// Returns the map of the best particle.
    pub(super) fn best_grid(&self) -> &Grid {
        &self.particles[self.best].grid
    }

    /// Returns the number of scans taken, and of resamplings.
    pub(super) const fn counts(&self) -> (u64, u64) {
        (self.updates, self.resampled)
    }

    /// Returns the bytes of all maps: shared tiles once, and a list of tiles a particle.
    pub(super) fn bytes(&self) -> usize {
        let grids = || self.particles.iter().map(|particle| &particle.grid);
        let tiles: HashSet<usize> = grids().flat_map(Grid::addresses).collect();
        let lists: usize = grids().map(Grid::list_bytes).sum();
        tiles.len() * Grid::TILE_BYTES + lists
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOUNDS: [f64; 4] = [-5.0, -5.0, 5.0, 5.0];

    fn filter(count: usize) -> Filter {
        let wheels = OdometryNoise::papers();
        Filter::new((count, Proposal::Motion), wheels, ([0.0; 3], BOUNDS), 7)
    }

    #[test]
    fn a_particle_is_drawn_as_often_as_its_weight_says() {
        let weights = [0.5, 0.26, 0.0, 0.24];
        for seed in 0..40 {
            let mut filter = filter(4);
            filter.comb = Noise::new(seed, Source::Particle);
            for (number, (particle, weight)) in filter.particles.iter_mut().zip(weights).enumerate()
            {
                particle.log_weight = f64::ln(weight);
                particle.pose[0] = number as f64;
            }
            filter.best = filter.heaviest();
            filter.resample();
            let times = |number: usize| {
                let is_it = |it: &&Particle| it.pose[0] == number as f64;
                filter.particles.iter().filter(is_it).count() as f64
            };
            for (number, weight) in weights.iter().enumerate() {
                assert!(
                    (times(number) - 4.0 * weight).abs() < 1.0,
                    "{seed} {number}"
                );
            }
            assert_eq!(filter.particles[filter.best].pose[0], 0.0);
        }
    }

    #[test]
    fn the_effective_number_is_that_of_equal_weights() {
        let mut filter = filter(10);
        for (number, particle) in filter.particles.iter_mut().enumerate() {
            particle.log_weight = if number < 4 { -300.0 } else { -900.0 };
        }
        assert!((filter.normalise() - 4.0).abs() < 1e-9);
        assert_eq!(filter.heaviest(), 0);
    }

    #[test]
    fn threads_change_no_bit() {
        let run = |threads| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
            pool.expect("threads").install(|| {
                let mut filter = filter(40);
                let ranges: Vec<u16> = (0..181).map(|k| 1_500 + 9 * (k % 30)).collect();
                let scan = Scan::of(&crate::robot::laser::level(), &ranges);
                for _ in 0..12 {
                    filter.update([0.1, 0.0, 0.05], &scan);
                }
                let poses = filter.particles.iter().map(|particle| particle.pose);
                let bits: Vec<u64> = poses.flatten().map(f64::to_bits).collect();
                let grids: Vec<Grid> = filter.particles.into_iter().map(|it| it.grid).collect();
                (bits, grids, filter.resampled)
            })
        };
        let one = run(1);
        assert!(one.2 > 0);
        assert_eq!(one, run(2));
        assert_eq!(one, run(8));
    }
}
