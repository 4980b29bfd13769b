//! A look through a gap: a ray back from it to where the robot can stand, and on to what is
//! unexplored.
//!
//! Units: map cells.

use crate::geometry::Cell;
use crate::map::neighbourhood::Neighbourhood;
use crate::map::{Class, Tiles};
use crate::path::rays::{RAYS, along, ray};
use crate::path::viewpoint::Viewpoint;
use crate::roadmap::reachability::Reachability;

/// Minimum number of unexplored cells at a ray's end, 0.5 m: fewer are hardly worth the way.
const LEAST_BEYOND: i32 = 5;
/// Maximum length of a ray beyond the gap and back from it, cells. A laser of 8 m sees farther,
/// only little of it is behind the gap.
const MOST_ON: i32 = 30;
const MOST_BACK: i32 = 60;

/// Returns the viewpoint of a gap whose stand is nearest to it.
pub(super) fn look_back<const TILES: usize, const SLOTS: usize>(
    tiles: &Tiles<TILES, SLOTS>,
    reachability: &Reachability<'_>,
    gap: Cell,
    walked: &mut i32,
) -> Option<Viewpoint> {
    let mut best: Option<(i32, Viewpoint)> = None;
    let mut is_reached = reachability.is_reached();
    // A ray's cells lie in few tiles.
    let mut near = Neighbourhood::of(tiles);
    for ray in (0..RAYS).map(ray) {
        let Some(beyond) = look_on((tiles, &mut near), gap, ray, walked) else {
            continue;
        };
        let most = best.map_or(MOST_BACK, |(back, _)| back - 1);
        for back in 0..=most {
            *walked += 1;
            let stand = along(gap, ray, -back);
            if near.class(stand) != Class::Free {
                break;
            }
            if is_reached(stand) {
                best = Some((back, Viewpoint { stand, gap, beyond }));
                break;
            }
        }
    }
    best.map(|(_, viewpoint)| viewpoint)
}

/// Returns the middle one of the unexplored cells at a ray's end; `None` if there are too few, or
/// the map has no room for it.
fn look_on<const TILES: usize, const SLOTS: usize>(
    (tiles, near): (&Tiles<TILES, SLOTS>, &mut Neighbourhood<'_, TILES, SLOTS>),
    gap: Cell,
    ray: (i32, i32),
    walked: &mut i32,
) -> Option<Cell> {
    let mut is = |class, on| near.class(along(gap, ray, on)) == class;
    let first = (1..MOST_ON).find(|&on| !is(Class::Free, on))?;
    *walked += first + 1;
    let dark = first..first + LEAST_BEYOND;
    let middle = along(gap, ray, first + LEAST_BEYOND / 2);
    let is_dark = dark.clone().all(|on| is(Class::Unknown, on))
        && tiles.room(middle.x >> 5, middle.y >> 5).is_ok()
        && dark
            .into_iter()
            .all(|on| tiles.fence().allows(along(gap, ray, on)));
    is_dark.then_some(middle)
}
