//! Area and end of an exploration by a space-based potential field.
//!
//! The area is known before the exploration: the bounds of the world's floor, unless the mission
//! says another.
//!
//! Units: metres in the world's frame.

use fieldline_protocol::message::SpaceField;
use fixed::types::I16F16;

use crate::world::World;

/// A rectangle: least x and y, width and height, metres.
pub type Area = [f64; 4];

/// The settings of a space-based potential field.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpaceMission {
    /// The area; the bounds of the world's floor if `None`.
    pub area_m: Option<Area>,
    /// Coverage that ends the exploration, thousandths of the area.
    pub until_permille: u16,
    /// Time without a newly covered cell after which the robot follows a path, seconds, or
    /// `Some(None)` for never; the strategy's own if `None`.
    pub impatience_s: Option<Option<u16>>,
}

impl Default for SpaceMission {
    fn default() -> Self {
        Self {
            area_m: None,
            until_permille: 1_000,
            impatience_s: None,
        }
    }
}

impl SpaceMission {
    /// Returns the settings as the device is told them in a world.
    pub(super) fn message(&self, world: &World, usual_s: Option<u16>) -> SpaceField {
        let area = self.area_m.unwrap_or_else(|| floor_m(world));
        let [x, y, width, height] = area.map(I16F16::saturating_from_num);
        SpaceField {
            origin: (x, y),
            size: (width, height),
            until_permille: self.until_permille,
            impatience_s: self.impatience_s.unwrap_or(usual_s),
        }
    }
}

/// Returns the bounds of the world's floor.
fn floor_m(world: &World) -> Area {
    let bounds = world.occupancy().free_bounds_m();
    let [x0, y0, x1, y1] = bounds.unwrap_or_default();
    [x0, y0, x1 - x0, y1 - y0]
}

#[cfg(test)]
mod tests {
    use super::{SpaceMission, floor_m};
    use crate::world::World;

    #[test]
    fn the_area_is_the_floor_of_the_world() {
        let world = World::builtin("two-rooms").expect("built in");
        let floor = floor_m(&world).map(|metres| (metres * 100.0).round() as i32);
        assert_eq!(floor, [20, 20, 1_000, 800]);
        let mission = SpaceMission {
            area_m: Some([-1.0, 2.0, 3.0, 4.5]),
            ..SpaceMission::default()
        };
        let message = mission.message(&world, Some(5));
        assert_eq!(
            (message.origin.0.to_num(), message.size.1.to_num()),
            (-1.0, 4.5)
        );
        assert_eq!(message.impatience_s, Some(5));
        let never = SpaceMission {
            impatience_s: Some(None),
            ..mission
        };
        assert_eq!(never.message(&world, Some(5)).impatience_s, None);
    }
}
