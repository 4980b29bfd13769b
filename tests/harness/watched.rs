//! A link with a function that is called after every step. The function reads; it changes no
//! command.

use fieldline_protocol::message::{Command, Observation, Reply, Request};
use host_sim::link::{End, Link, LinkError};

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
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        let reply = self.link.ask(request)?;
        if let (Request::Observation(observation), Reply::Command(command)) = (request, &reply) {
            (self.look)(&mut self.link, observation, command)?;
        }
        Ok(reply)
    }

    fn end(&self) -> &dyn End {
        self.link.end()
    }
}

#[cfg(test)]
mod tests {
    use fieldline_protocol::message::{Body, Correct, CorrectedTiles, Member, Packet, Wanted};
    use host_sim::link::LinkStats;

    use super::*;

    /// A link that answers each request with a value of its own.
    struct Marked;

    impl Link for Marked {
        fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
            let refused = match request {
                Request::Observation(_) => return Ok(Reply::Command(Command::default())),
                Request::Path { from } => format!("road from {from}"),
                Request::Hear(packet) => format!("packet {}", packet.sequence),
                Request::Say => "nothing to say".into(),
                Request::Correct(correct) => format!("correction {}", correct.epoch),
                Request::Tiles(part) => format!("tile {}", part.first),
                other => format!("{other:?}"),
            };
            Err(LinkError::Refused(refused))
        }

        fn end(&self) -> &dyn End {
            self
        }
    }

    impl End for Marked {
        fn stats(&self) -> LinkStats {
            LinkStats {
                sent: 123,
                ..LinkStats::default()
            }
        }
    }

    #[test]
    fn the_decorator_forwards_the_road_the_packets_and_the_counters() {
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
        assert_eq!(link.end().stats().sent, 123);
    }
}
