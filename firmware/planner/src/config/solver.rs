//! Parameters of the window's solver.
//!
//! Units: multigrid cycles.

/// How to solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Multigrid where it works, Gauss–Seidel where it does not.
    #[default]
    Auto,
    /// Multigrid, come what may.
    Multigrid,
    /// Gauss–Seidel from q = 0.
    GaussSeidel,
}

/// Parameters of a solve.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverConfig {
    /// Most multigrid cycles, each worth [`crate::field::solver::SWEEPS_PER_CYCLE`] sweeps.
    /// Default: 12; a heading is right in 1 when warm, in 2 or 3 cold, and in 5 in all but one of
    /// twenty cold windows.
    pub max_cycles: u16,
    /// max |x − 1| below which the multigrid stops. Default: 0.05.
    pub tolerance: f32,
    /// How to solve. Default: [`Method::Auto`].
    pub method: Method,
}

impl SolverConfig {
    /// The defaults of all parameters.
    pub const DEFAULT: Self = Self {
        max_cycles: 12,
        tolerance: 0.05,
        method: Method::Auto,
    };
}

impl Default for SolverConfig {
    fn default() -> Self {
        Self::DEFAULT
    }
}
