//! A link that is looked at after every step: whatever the look reads, it changes no command.

use fieldline_protocol::message::{
    Command, Control, FieldRow, Identity, Observation, ResidualFrontier, Status, Tile,
};
use host_sim::link::{Link, LinkError, LinkStats};

/// A link, and the look taken after each of its steps.
#[derive(Debug)]
pub struct Watched<L, F> {
    link: L,
    look: F,
}

impl<L: Link, F> Watched<L, F>
where
    F: FnMut(&mut L, &Observation, &Command) -> Result<(), LinkError>,
{
    /// Before the first step.
    pub const fn new(link: L, look: F) -> Self {
        Self { link, look }
    }
}

impl<L: Link, F> Link for Watched<L, F>
where
    F: FnMut(&mut L, &Observation, &Command) -> Result<(), LinkError>,
{
    fn hello(&mut self) -> Result<Identity, LinkError> {
        self.link.hello()
    }

    fn control(&mut self, control: &Control) -> Result<Status, LinkError> {
        self.link.control(control)
    }

    fn observe(&mut self, observation: &Observation) -> Result<Command, LinkError> {
        let command = self.link.observe(observation)?;
        (self.look)(&mut self.link, observation, &command)?;
        Ok(command)
    }

    fn tile(&mut self, x: i16, y: i16) -> Result<Option<Tile>, LinkError> {
        self.link.tile(x, y)
    }

    fn field_row(&mut self, row: u8) -> Result<Option<FieldRow>, LinkError> {
        self.link.field_row(row)
    }

    fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
        self.link.frontiers()
    }

    fn stats(&self) -> LinkStats {
        self.link.stats()
    }
}
