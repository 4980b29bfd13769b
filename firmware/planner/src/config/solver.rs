//! Parameters of the window's solver.
//!
//! Units: multigrid cycles.

/// The method of a solve.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Multigrid; Gauss–Seidel where the multigrid is weak.
    #[default]
    Auto,
    /// Always multigrid.
    Multigrid,
    /// Gauss–Seidel from q = 0.
    GaussSeidel,
}

/// Parameters of a solve.
///
/// ```
/// use fieldline_planner::{Config, LaserMount, Method, RobotShape, SolverConfig};
///
/// let config = Config::builder(RobotShape::PIONEER_3AT)
///     .laser(LaserMount::level(0.10, 0.40))
///     .solver(SolverConfig { method: Method::GaussSeidel, ..SolverConfig::DEFAULT })
///     .build()?;
/// # Ok::<(), fieldline_planner::ConfigError>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SolverConfig {
    /// Greatest number of multigrid cycles; a cycle is worth five Gauss–Seidel sweeps. Default: 12.
    /// A heading is right after 1 cycle in a warm window and after 2 or 3 in a cold one; 5 cycles
    /// suffice in 19 of 20 cold windows.
    pub max_cycles: u16,
    /// Greatest |x − 1|, a pure number, below which the multigrid stops. Default: 0.05.
    pub tolerance: f32,
    /// The method. Default: [`Method::Auto`].
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
