//! Charging the window around the robot: with a local goal on the path, or with the strategy's own
//! boundary values \[Jorge15, Algorithm 1, lines 26 and 27\].
//!
//! Units: map cells.

use crate::field::SIDE;
use crate::field::local_grid::{LocalGrid, Rows, SCALES};
use crate::geometry::Cell;
use crate::path::blocked_passages::NONE;
use crate::path::nearest::Centres;
use crate::path::open_stretch::OpenStretch;
use crate::planner::state::State;
use crate::planner::step::Step;
use crate::planner::workspace::Workspace;
use crate::strategy::ouroboros::Shield;

/// The local goal on the path.
struct LocalGoal {
    /// Its cells in the local grid.
    cells: Rows,
    /// The local grid does not lead along the path as far as the goal could lie.
    is_closed: bool,
}

impl<const TILES: usize, const SLOTS: usize> Step<'_, TILES, SLOTS> {
    /// Charges the window with the local goal on the path. Returns true if the local grid does not
    /// lead along the path as far as the goal could lie; `None` if there is no goal. It is not
    /// inlined, so that what follows does not pay for the goal's stack.
    #[inline(never)]
    pub(super) fn charge_path(&mut self) -> Option<bool> {
        let goal = self.local_goal()?;
        self.workspace.charge(&goal.cells);
        Some(goal.is_closed)
    }

    /// Fills the local grid at the smallest scale that holds a local goal. Returns the goal; `None`
    /// if there is no path, or no scale holds a goal.
    fn local_goal(&mut self) -> Option<LocalGoal> {
        if self.state.strategy.frontier.path().is_empty() {
            return None;
        }
        SCALES.iter().find_map(|&scale| self.local_goal_at(scale))
    }

    fn local_goal_at(&mut self, scale: i32) -> Option<LocalGoal> {
        let robot = self.robot();
        self.read_window(scale, true);
        let ahead = self.state.strategy.frontier.path().ahead_of(robot);
        // A shield is there to be gone round.
        let stretch = match self.state.detour() {
            Some(_) => OpenStretch::default(),
            None => OpenStretch::of(&self.workspace.local_grid, robot.cell(), ahead),
        };
        self.block_peers(None);
        let grid = &self.workspace.local_grid;
        let ahead = self.state.strategy.frontier.path().ahead_of(robot);
        // A goal behind the open stretch counts only if no cell is open.
        let open = ahead
            .iter()
            .rev()
            .skip_while(|&&cell| stretch.last.is_some_and(|last| last != cell));
        let cells = open.copied().find_map(|cell| goal_cells(grid, cell))?;
        Some(LocalGoal {
            cells,
            is_closed: stretch.is_closed,
        })
    }

    /// Reads the window's cells around the robot, without peers, and with or without the shield.
    #[inline(never)]
    pub(super) fn read_window(&mut self, scale: i32, shielded: bool) {
        let (robot, state, grid) = (
            self.input.pose.point(),
            &*self.state,
            &mut self.workspace.local_grid,
        );
        let tiles = state.map.tiles();
        let blocked = state.strategy.frontier.blocked();
        blocked.read(grid, (tiles, &self.footprint), robot.cell(), scale);
        if let Some(shield) = state.detour().filter(|_| shielded) {
            shield.cells().for_each(|cell| grid.block(cell));
        }
        grid.free_robot(robot.cell());
        state
            .ground
            .block_rims(self.config, tiles, &self.footprint, robot, grid);
    }

    /// Charges the window with the strategy's own boundary values. Returns `None` if it has none,
    /// or if the robot reaches none of them.
    #[inline(never)]
    pub(super) fn charge_rails(&mut self) -> Option<()> {
        if self.state.errands.is_going() {
            return None;
        }
        self.state.strategy.tdbvp()?;
        self.read_window(1, false);
        self.block_peers(None);
        self.workspace.slide();
        // Rails search for no way.
        let (state, robot) = (&mut *self.state, self.input.pose.point());
        let tiles = state.map.tiles();
        let centres = Centres::of(&state.skeleton, tiles, &self.footprint, &NONE)?;
        let window = (&mut self.workspace.window, &self.workspace.local_grid);
        state
            .strategy
            .charge(&centres, robot, window, self.config.tuning)
    }
}

impl<const TILES: usize, const SLOTS: usize> State<TILES, SLOTS> {
    /// Returns the shield that the robot goes round.
    fn detour(&self) -> Option<&Shield> {
        let shield = self.strategy.shield();
        shield.filter(|_| !self.errands.is_going())
    }
}

/// Returns the passable window cells of a coarse cell; `None` if it has none.
fn goal_cells(grid: &LocalGrid, cell: Cell) -> Option<Rows> {
    let mut rows: Rows = [0; SIDE];
    grid.mark(&mut rows, cell).then_some(rows)
}

impl Workspace {
    /// Sets the window's boundary values. The last field stays where the two windows overlap.
    pub(super) fn charge(&mut self, goal: &Rows) {
        self.slide();
        self.window.set_boundary(&self.local_grid.passable, goal);
    }

    /// Moves the window to the local grid's place, together with the field where they overlap.
    fn slide(&mut self) {
        let Self {
            window,
            window_at: at,
            local_grid,
            ..
        } = self;
        match *at {
            Some((origin, scale)) if scale == local_grid.scale => {
                let steps = |to: i32, from: i32| (to - from) / scale;
                window.shift(
                    steps(local_grid.origin.x, origin.x),
                    steps(local_grid.origin.y, origin.y),
                );
            }
            // A field at another scale is of no use.
            _ => window.shift(SIDE as i32, 0),
        }
        *at = Some((local_grid.origin, local_grid.scale));
    }
}
