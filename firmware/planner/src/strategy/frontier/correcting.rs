//! What remains of the state when the map is corrected ([`crate::planner`] has the whole table).
//!
//! Units: map cells.

use crate::geometry::Point;
use crate::grid::Shifts;
use crate::path::viewpoint::Viewpoint;
use crate::strategy::frontier::Frontier;

impl Frontier {
    /// Moves what lies in the map with its tiles. The robot drives on along the moved path until
    /// the next one is planned. `robot` is its place afterwards. The chances that are spent stay
    /// spent.
    pub(crate) fn correct(&mut self, shifts: Shifts<'_>, robot: Point) {
        self.residual.shift(shifts);
        self.blocked.shift(shifts);
        if let Some(Viewpoint { stand, gap, beyond }) = &mut self.viewpoint {
            for place in [stand, gap, beyond] {
                *place = shifts.moved(*place);
            }
        }
        self.progress.correct(robot);
        self.path.shift(shifts);
        self.judged = 0;
        self.goes_back = false;
    }
}
