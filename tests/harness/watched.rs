//! A link with a function that is called after every step. The function reads; it changes no
//! command.

use fieldline_protocol::message::{
    Command, Control, Correct, CorrectedTiles, CorrectionProgress, FieldRow, Identity, Observation,
    Packet, Path, Recall, ResidualFrontier, Status, Tile,
};
use host_sim::link::inside::Inside;
use host_sim::link::{Link, LinkError, LinkStats};

/// A link, and the function called after each step.
#[derive(Debug)]
pub struct Watched<L, F> {
    link: L,
    look: F,
}

impl<L: Link, F> Watched<L, F>
where
    F: FnMut(&mut L, &Observation, &Command) -> Result<(), LinkError>,
{
    /// Wraps a link.
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

    fn path(&mut self, from: u8) -> Result<Path, LinkError> {
        self.link.path(from)
    }

    fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
        self.link.hear(packet)
    }

    fn say(&mut self) -> Result<Option<Packet>, LinkError> {
        self.link.say()
    }

    fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
        self.link.open_correction(correct)
    }

    fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
        self.link.send_tiles(part)
    }

    fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
        self.link.recall(recall)
    }

    fn inside(&self) -> Option<Box<dyn Inside + '_>> {
        self.link.inside()
    }

    fn stats(&self) -> LinkStats {
        self.link.stats()
    }

    fn take_log(&mut self) -> Vec<u8> {
        self.link.take_log()
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{Body, Member, Wanted};

    use super::*;

    /// A link that answers each request with a value of its own.
    struct Marked;

    impl Link for Marked {
        fn hello(&mut self) -> Result<Identity, LinkError> {
            Ok(Identity::default())
        }

        fn control(&mut self, _: &Control) -> Result<Status, LinkError> {
            Ok(Status::Paused)
        }

        fn observe(&mut self, _: &Observation) -> Result<Command, LinkError> {
            Ok(Command::default())
        }

        fn tile(&mut self, _: i16, _: i16) -> Result<Option<Tile>, LinkError> {
            Ok(None)
        }

        fn field_row(&mut self, _: u8) -> Result<Option<FieldRow>, LinkError> {
            Ok(None)
        }

        fn frontiers(&mut self) -> Result<Vec<ResidualFrontier>, LinkError> {
            Ok(Vec::new())
        }

        fn path(&mut self, from: u8) -> Result<Path, LinkError> {
            Err(LinkError::Refused(format!("road from {from}")))
        }

        fn hear(&mut self, packet: &Packet) -> Result<(), LinkError> {
            Err(LinkError::Refused(format!("packet {}", packet.sequence)))
        }

        fn say(&mut self) -> Result<Option<Packet>, LinkError> {
            Err(LinkError::Refused("nothing to say".into()))
        }

        fn open_correction(&mut self, correct: &Correct) -> Result<CorrectionProgress, LinkError> {
            Err(LinkError::Refused(format!("correction {}", correct.epoch)))
        }

        fn send_tiles(&mut self, part: &CorrectedTiles) -> Result<CorrectionProgress, LinkError> {
            Err(LinkError::Refused(format!("tile {}", part.first)))
        }

        fn recall(&mut self, recall: &Recall) -> Result<(), LinkError> {
            Err(LinkError::Refused(format!("recall {}", recall.epoch)))
        }

        fn inside(&self) -> Option<Box<dyn Inside + '_>> {
            None
        }

        fn stats(&self) -> LinkStats {
            LinkStats::default()
        }

        fn take_log(&mut self) -> Vec<u8> {
            vec![1, 2, 3]
        }
    }

    #[test]
    fn the_decorator_forwards_the_road_the_packets_and_the_log() {
        let mut link = Watched::new(Marked, |_, _, _| Ok(()));
        let refused = LinkError::Refused("road from 7".into());
        assert_eq!(link.path(7), Err(refused));
        let packet = Packet {
            from: Member::default(),
            sequence: 9,
            body: Body::Wanted(Wanted::default()),
        };
        let refused = LinkError::Refused("packet 9".into());
        assert_eq!(link.hear(&packet), Err(refused));
        assert_eq!(link.say(), Err(LinkError::Refused("nothing to say".into())));
        let correct = Correct {
            epoch: 5,
            ..Correct::default()
        };
        let refused = LinkError::Refused("correction 5".into());
        assert_eq!(link.open_correction(&correct), Err(refused));
        let part = CorrectedTiles {
            first: 6,
            ..CorrectedTiles::default()
        };
        assert_eq!(
            link.send_tiles(&part),
            Err(LinkError::Refused("tile 6".into()))
        );
        assert_eq!(link.take_log(), [1, 2, 3]);
    }
}
