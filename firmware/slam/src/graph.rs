//! The pose graph: keyframes in the order of the way, the motions between them, and closures.
//!
//! ```text
//! X₀ given,   Xᵢ = Xᵢ₋₁ ∘ (zᵢ + yᵢ)          z measured, y the residual that the solver chooses
//! minimise    Σ yᵢᵀ Ωᵢ yᵢ + Σ s(χ²) rᵀ Ω r    r = between(X_a, X_b) − z of each closure
//! s(χ²) = min(1, 2Φ / (Φ + χ²))²              dynamic covariance scaling: far outliers lose weight
//! ```
//!
//! The residuals of the chain are the graph's state, and poses follow from them: the chain holds by
//! construction, and a solver needs only the closures beside it; see [`crate::solver`].
//!
//! Invariant: keyframe i > 0 has the motion from keyframe i − 1. A closure's keyframes exist.
//! Units: metres, radians.

use heapless::Vec;

use crate::matrix::{Cholesky, Matrix, Vector, dot, times};
use crate::pose::Pose;

/// A keyframe: a scan, and where it was taken.
#[derive(Clone, Debug)]
pub(crate) struct Keyframe<const BEAMS: usize> {
    /// Pose in the map.
    pub(crate) pose: Pose,
    /// Way from the first keyframe, metres.
    pub(crate) way_m: f32,
    /// Motion from the last keyframe, as measured.
    measured: Pose,
    /// What the solver adds to it.
    pub(crate) residual: Vector,
    /// Factor of the motion's information.
    pub(crate) factor: Cholesky,
    /// Ranges of the scan, millimetres; those beyond its length are 0.
    pub(crate) ranges_mm: [u16; BEAMS],
}

/// A closure: a motion between two keyframes that the way does not join.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Closure {
    /// The older keyframe.
    pub(crate) from: u16,
    /// The newer one.
    pub(crate) to: u16,
    /// The measured motion.
    pub(crate) measured: Pose,
    /// Its information, in the frame of the older keyframe.
    pub(crate) information: Matrix,
}

/// The graph: at most `KEYS` keyframes and `LOOPS` closures.
#[derive(Clone, Debug)]
pub(crate) struct Graph<const KEYS: usize, const LOOPS: usize, const BEAMS: usize> {
    /// Φ of the scaling.
    scaling: f32,
    pub(crate) keys: Vec<Keyframe<BEAMS>, KEYS>,
    pub(crate) closures: Vec<Closure, LOOPS>,
}

impl Closure {
    /// Returns the residual between two poses.
    pub(crate) fn residual(&self, from: &Pose, to: &Pose) -> Vector {
        from.between(to).minus(&self.measured)
    }

    /// Returns χ² of a residual.
    fn chi2(&self, residual: &Vector) -> f32 {
        dot(residual, &times(&self.information, residual))
    }
}

impl<const KEYS: usize, const LOOPS: usize, const BEAMS: usize> Graph<KEYS, LOOPS, BEAMS> {
    /// Returns an empty graph, for Φ of its scaling.
    pub(crate) const fn new(scaling: f32) -> Self {
        Self {
            scaling,
            keys: Vec::new(),
            closures: Vec::new(),
        }
    }

    /// Adds a keyframe at a motion from the last one, with the factor of the motion's information
    /// in the last one's frame. Returns its number; `None` if the graph is full.
    pub(crate) fn add(
        &mut self,
        motion: &Pose,
        factor: Cholesky,
        ranges_mm: &[u16],
    ) -> Option<usize> {
        let (pose, way_m) = self.keys.last().map_or((*motion, 0.0), |last| {
            (last.pose.compose(motion), last.way_m + motion.length_m())
        });
        let mut ranges = [0; BEAMS];
        for (kept, range) in ranges.iter_mut().zip(ranges_mm) {
            *kept = *range;
        }
        let number = self.keys.len();
        let key = Keyframe {
            pose,
            way_m,
            measured: *motion,
            residual: [0.0; 3],
            factor,
            ranges_mm: ranges,
        };
        self.keys.push(key).ok().map(|()| number)
    }

    /// Returns a keyframe's pose.
    pub(crate) fn pose(&self, key: usize) -> Option<Pose> {
        self.keys.get(key).map(|key| key.pose)
    }

    /// Makes all poses from the chain.
    pub(crate) fn place(&mut self) {
        let mut last: Option<Pose> = None;
        for key in &mut self.keys {
            let motion = key.measured.plus(key.residual);
            key.pose = last.map_or(key.pose, |last| last.compose(&motion));
            last = Some(key.pose);
        }
    }

    /// Returns the cost of the present residuals.
    pub(crate) fn cost(&self) -> f32 {
        let chain = self.keys.iter().map(|key| {
            let white = key.factor.whitened(&key.residual);
            dot(&white, &white)
        });
        let closures = self.closures.iter().filter_map(|closure| {
            let [from, to] = self.ends(closure)?;
            let chi2 = closure.chi2(&closure.residual(&from, &to));
            Some(robust(chi2, self.scaling))
        });
        chain.sum::<f32>() + closures.sum::<f32>()
    }

    /// Returns the weight of a closure's residual.
    pub(crate) fn weight(&self, closure: &Closure, residual: &Vector) -> f32 {
        let scale = 2.0 * self.scaling / (self.scaling + closure.chi2(residual));
        scale.min(1.0) * scale.min(1.0)
    }

    /// Returns the poses of a closure's keyframes.
    pub(crate) fn ends(&self, closure: &Closure) -> Option<[Pose; 2]> {
        let [from, to] = [closure.from, closure.to].map(|key| self.pose(usize::from(key)));
        Some([from?, to?])
    }
}

/// Returns what a closure's χ² costs: χ² up to Φ, then flatter, at most 3 Φ. Its slope is s(χ²).
fn robust(chi2: f32, scaling: f32) -> f32 {
    if chi2 <= scaling {
        chi2
    } else {
        3.0 * scaling - 4.0 * scaling * scaling / (scaling + chi2)
    }
}
