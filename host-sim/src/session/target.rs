//! The devices under test: in this process, of several capacities, or behind any link.

use core::fmt;
use core::str::FromStr;

use fieldline_device::{SLOTS, TILES};
use fieldline_planner::Location;
use serde::{Deserialize, Serialize};

use crate::link::endpoint::{Endpoint, RetryPolicy};
use crate::link::loopback::LocalDevice;
use crate::link::spec::{LinkSpec, Options};
use crate::link::{Link, LinkError};
use crate::spec::SpecError;

/// Size of a device's map. A file that names none means the default image's.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Capacity {
    /// Tiles in the map's pool.
    pub tiles: usize,
    /// Most tiles of the map.
    pub slots: usize,
}

impl Capacity {
    /// The sizes that can be opened in this process. The small ones reach their limits soon. The
    /// last one is the default image's.
    pub const ALL: [Self; 4] = [
        Self::new(8, 64),
        Self::new(40, 60),
        Self::new(96, 128),
        Self::new(TILES, SLOTS),
    ];

    const fn new(tiles: usize, slots: usize) -> Self {
        Self { tiles, slots }
    }
}

impl Default for Capacity {
    fn default() -> Self {
        Self::new(TILES, SLOTS)
    }
}

/// A device under test.
pub trait Target {
    /// The link to it.
    fn link(&mut self) -> &mut dyn Link;

    /// Returns the pose that the planner has, with all its bits; `None` if it cannot be seen.
    fn location(&self) -> Option<Location>;
}

/// A device that is seen by its answers only.
struct Distant(Box<dyn Link>);

impl Target for Distant {
    fn link(&mut self) -> &mut dyn Link {
        &mut *self.0
    }

    fn location(&self) -> Option<Location> {
        None
    }
}

impl<const POOL: usize, const MOST: usize> Target for Endpoint<LocalDevice<POOL, MOST>> {
    fn link(&mut self) -> &mut dyn Link {
        self
    }

    fn location(&self) -> Option<Location> {
        Some(self.line().state().location())
    }
}

/// Kind of the devices under test.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub enum TargetSpec {
    /// Bytes to a device in this process, of the session's capacity.
    #[default]
    Device,
    /// Any link.
    Link(LinkSpec),
}

impl FromStr for TargetSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        match text {
            "device" => Ok(Self::Device),
            _ => text.parse().map(Self::Link),
        }
    }
}

impl fmt::Display for TargetSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Device => f.write_str("device"),
            Self::Link(link) => link.fmt(f),
        }
    }
}

fn local<const POOL: usize, const MOST: usize>() -> Box<dyn Target> {
    let device = LocalDevice::<POOL, MOST>::sized();
    Box::new(Endpoint::new(device, RetryPolicy::VIRTUAL, 1))
}

impl TargetSpec {
    /// Opens a device that has just booted. The capacity has an effect on [`Self::Device`] only.
    ///
    /// # Errors
    /// As [`LinkSpec::open`]; [`LinkError::Io`] for a capacity that is not in [`Capacity::ALL`].
    pub fn open(&self, capacity: Capacity) -> Result<Box<dyn Target>, LinkError> {
        match (self, capacity.tiles, capacity.slots) {
            (Self::Link(link), ..) => {
                let link = link.open(&Options::default())?;
                Ok(Box::new(Distant(link)))
            }
            (_, 8, 64) => Ok(local::<8, 64>()),
            (_, 40, 60) => Ok(local::<40, 60>()),
            (_, 96, 128) => Ok(local::<96, 128>()),
            (_, TILES, SLOTS) => Ok(local::<TILES, SLOTS>()),
            (_, tiles, slots) => Err(LinkError::Io(format!(
                "no device of {tiles} tiles and {slots} slots can be opened; \
                 give 8 and 64, 40 and 60, 96 and 128, or {TILES} and {SLOTS}"
            ))),
        }
    }
}
