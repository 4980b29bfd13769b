//! `--record` and `replay FILE.mcap` where the program was built without them.

use core::convert::Infallible;
use std::path::Path;

use anyhow::{Result, bail};

use host_sim::link::Link;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::report::MadeBy;
use host_sim::trial::Watch;
use host_sim::trial::sight::Sight;
use serde::Serialize;

/// There is none.
pub(super) struct Recorder(Infallible);

impl Recorder {
    /// Says what is missing.
    pub(super) fn open(_: &Path, _: &MadeBy, _: bool) -> Result<Self> {
        bail!(MISSING)
    }

    pub(super) fn see(&self, _: &Sight<'_>) {
        match self.0 {}
    }

    pub(super) fn tap(&self, _: Box<dyn Link>) -> Box<dyn Link> {
        match self.0 {}
    }

    pub(super) fn end(&self, _: Option<&impl Serialize>) {
        match self.0 {}
    }
}

const MISSING: &str = "this host-sim was built without recordings; build it with --features record";

pub(super) const fn is_recording(_: &Path) -> bool {
    false
}

/// Says what is missing.
pub(super) fn replay(
    _: &Path,
    _: &LinkSpec,
    _: &Options,
    _: bool,
    _: &mut dyn Watch,
) -> Result<bool> {
    bail!(MISSING)
}
