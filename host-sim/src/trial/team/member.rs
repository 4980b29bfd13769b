//! One robot of a team: its link, its record, and its part in the conversation.
//!
//! ```text
//!               ended                      leave
//!  Exploring ──────────► Standing   any ───────────► Away
//!      ▲                                              │
//!      └──────────────────── join ────────────────────┘
//! ```
//!
//! A robot whose exploration ended stands, hears and says on. One that is away stands, is silent
//! and hears nothing. Joining again is a new session of its planner: a new boot, an empty map.
//! After a broken link the robot's watchdog stops it, and it is silent for good.

use fieldline_protocol::message::{self as wire, Control, Finish, Status, Twist};
use fieldline_protocol::packet::decode_packet;

use super::super::account::Account;
use super::super::freeze::FreezeDetector;
use super::super::itinerary::Itinerary;
use super::super::record::Record;
use super::super::series::Series;
use super::super::sight::Sight;
use super::super::snapshot::{self, Snapshot};
use super::super::{Cast, Corrector, Ending, Setup, Watch, ended, step};
use super::copy::TeamCopy;
use super::seat::{Seat, Witness};
use crate::link::said::Said;
use crate::link::{Link, LinkError};
use crate::metrics::Coverage;
use crate::radio::{Radio, Station};
use crate::sim::{Fleet, Loss};
use crate::slam::{LoopCloser, SlamReport};

/// A robot's place in the team.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Presence {
    /// It explores.
    Exploring,
    /// Its exploration ended; it hears and says on.
    Standing,
    /// It left the team.
    Away,
    /// Its link is broken.
    Silent,
}

/// What a robot said and heard.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Talk {
    /// Bytes said.
    pub(super) said_bytes: u64,
    /// Packets said.
    pub(super) said: u64,
    /// Packets heard.
    pub(super) heard: u64,
}

/// What all robots share.
pub(super) struct Common<'a, 'w> {
    pub(super) fleet: &'a mut Fleet<'w>,
    pub(super) radio: &'a mut Radio<'w>,
    /// Where the robots are and who listens, as this period began.
    pub(super) stations: &'a [Station],
    /// Coverage by all robots together.
    pub(super) coverage: &'a mut Coverage,
    /// Who watches the team.
    pub(super) watch: &'a mut dyn Watch,
}

/// What closes a robot's loops: its graph, and the copy of its map while it explores.
struct Closing {
    motion: fieldline_slam::Motion,
    closer: LoopCloser,
    copy: Option<TeamCopy>,
    /// The copy was the device's map when the exploration ended.
    matches: Option<bool>,
}

impl Closing {
    fn of(setup: &Setup, motion: fieldline_slam::Motion) -> Option<Self> {
        Some(Self {
            motion,
            closer: LoopCloser::new(&setup.start, motion)?,
            copy: Some(TeamCopy::new(&setup.start)),
            matches: None,
        })
    }
}

/// A robot of a team.
pub(super) struct Member<'a> {
    number: usize,
    link: &'a mut dyn Link,
    setup: Setup,
    freeze: FreezeDetector,
    pub(super) presence: Presence,
    pub(super) account: Account,
    pub(super) record: Record,
    pub(super) talk: Talk,
    /// When its map came to lie in the team's coordinates: it said tiles then. Milliseconds.
    pub(super) met_ms: Option<u32>,
    closing: Option<Closing>,
}

impl<'a> Member<'a> {
    /// Begins a robot's session. `setup.start.team` says if it talks.
    pub(super) fn begin(
        number: usize,
        link: &'a mut dyn Link,
        setup: Setup,
        account: Account,
    ) -> Self {
        let mut member = Self {
            number,
            link,
            setup,
            freeze: FreezeDetector::default(),
            presence: Presence::Exploring,
            account,
            record: Record::default(),
            talk: Talk::default(),
            met_ms: None,
            closing: None,
        };
        member.start();
        member
    }

    /// Closes its loops from now on, for wheels with this noise. Call it before the first step.
    pub(super) fn close_loops(&mut self, motion: fieldline_slam::Motion) {
        self.closing = Closing::of(&self.setup, motion);
    }

    /// Returns what became of its loops; `None` if none are closed.
    pub(super) fn slam(&self) -> Option<SlamReport> {
        self.closing.as_ref().map(|it| it.closer.report())
    }

    /// Returns true if the host's copy of its map was right when its exploration ended; `None` if
    /// there was none, or it did not end.
    pub(super) fn copy_matches(&self) -> Option<bool> {
        self.closing.as_ref()?.matches
    }

    /// Returns true if it belongs to the team.
    pub(super) fn is_in_team(&self) -> bool {
        self.presence != Presence::Away
    }

    /// Returns true if it can hear.
    pub(super) fn listens(&self) -> bool {
        matches!(self.presence, Presence::Exploring | Presence::Standing)
    }

    /// Returns the number of its sessions.
    pub(super) fn boots(&self) -> u16 {
        self.setup.start.team.map_or(1, |team| team.member.boot)
    }

    fn start(&mut self) {
        match self.link.control(&Control::Start(self.setup.start.clone())) {
            Ok(Status::Fault(fault)) => self.end(Ending::Fault(fault)),
            Ok(_) => self.presence = Presence::Exploring,
            Err(error) => self.end(Ending::Link(error)),
        }
    }

    /// Leaves the team without a word.
    pub(super) fn leave(&mut self) {
        if self.presence == Presence::Exploring {
            self.record.ending = Ending::Left;
        }
        if self.presence != Presence::Silent {
            self.presence = Presence::Away;
        }
    }

    /// Joins the team again where it stands, with an empty map.
    pub(super) fn join(&mut self) {
        if self.presence != Presence::Away {
            return;
        }
        if let Some(team) = &mut self.setup.start.team {
            team.member.boot = team.member.boot.wrapping_add(1);
        }
        self.account.forget(&self.setup);
        if let Some(motion) = self.closing.as_ref().map(|it| it.motion) {
            self.close_loops(motion);
        }
        self.freeze = FreezeDetector::default();
        self.start();
    }

    /// Ends its exploration; it stands from now on.
    pub(super) fn end(&mut self, ending: Ending) {
        self.presence = match &ending {
            Ending::Link(_) => Presence::Silent,
            _ => Presence::Standing,
        };
        let stop = !matches!(ending, Ending::Finished(_) | Ending::Link(_));
        self.record.ending = ending;
        if stop {
            // A device that does not hear this stands by its own time limit.
            let _ = self.link.control(&Control::Stop);
        }
    }

    /// Takes part in one period; returns the command for the robot, `None` if it gets none.
    pub(super) fn take_part(&mut self, common: &mut Common<'_, '_>) -> Option<Twist> {
        let time_ms = common.fleet.robots()[self.number].time_ms();
        let listens = self.listens();
        let packets = common.radio.hear(time_ms, self.number, listens);
        let standing = Some(Twist::default());
        let told = match self.presence {
            Presence::Silent => Ok(None),
            Presence::Away => Ok(standing),
            Presence::Exploring => self.hear(&packets).and_then(|()| self.explore(common)),
            Presence::Standing => self.hear(&packets).and_then(|()| {
                self.link.observe(&common.fleet.observe(self.number))?;
                Ok(standing)
            }),
        };
        let said = told.and_then(|velocity| {
            if listens {
                self.say(time_ms, common)?;
            }
            Ok(velocity)
        });
        said.unwrap_or_else(|error| {
            self.presence = Presence::Silent;
            if !matches!(self.record.ending, Ending::Finished(_)) {
                self.record.ending = Ending::Link(error);
            }
            None
        })
    }

    /// Makes a step of the exploration.
    fn explore(&mut self, common: &mut Common<'_, '_>) -> Result<Option<Twist>, LinkError> {
        let (mut corrector, copy) = match &mut self.closing {
            Some(it) => (Some(&mut it.closer), it.copy.as_mut()),
            None => (None, None),
        };
        let mut none = ();
        let corrector: &mut dyn Corrector = match &mut corrector {
            Some(closer) => *closer,
            None => &mut none,
        };
        let mut cast = Cast {
            link: self.link,
            body: &mut Seat {
                fleet: common.fleet,
                robot: self.number,
            },
            survey: &mut Witness {
                own: &mut self.account,
                all: common.coverage,
                copy,
            },
            watch: &mut (),
            corrector,
            keeper: &mut (),
        };
        let mut series: Series<Snapshot> = Series::new(0);
        // A team takes no orders.
        let orders = (&mut self.record, &mut Itinerary::default());
        let (observation, command) = step(&self.setup, &mut cast, orders, &mut series, false)?;
        let ending = ended(
            &self.setup,
            &mut (),
            &mut self.freeze,
            &self.record,
            &command,
        );
        let mut sight = Sight {
            setup: &self.setup,
            observation: &observation,
            mirror: None,
            ending: ending.as_ref(),
            again: false,
            record: &mut self.record,
            itinerary: None,
            link: self.link,
        };
        common.watch.see_robot(self.number, &mut sight);
        let Some(ending) = ending else {
            return Ok(Some(command.velocity));
        };
        if let Some(closing) = &mut self.closing {
            // The device hears on, and nothing more is corrected.
            closing.matches = closing.copy.take().map(|copy| copy.equals(self.link));
        }
        self.end(ending);
        Ok(Some(Twist::default()))
    }

    /// Returns the copy of its map, which hears and says what the device does.
    fn copy(&mut self) -> Option<&mut TeamCopy> {
        self.closing.as_mut()?.copy.as_mut()
    }

    fn hear(&mut self, packets: &[Vec<u8>]) -> Result<(), LinkError> {
        for packet in packets.iter().filter_map(|bytes| decode_packet(bytes)) {
            self.link.hear(&packet)?;
            if let Some(copy) = self.copy() {
                copy.hear(&packet);
            }
            self.talk.heard += 1;
        }
        Ok(())
    }

    /// Sends what the planner says, if it is in a team.
    fn say(&mut self, time_ms: u32, common: &mut Common<'_, '_>) -> Result<(), LinkError> {
        if self.setup.start.team.is_none() {
            return Ok(());
        }
        let mut said = Said::new();
        while let Some(bytes) = said.next(self.link)? {
            common
                .radio
                .send(time_ms, self.number, bytes, common.stations);
            self.talk.said += 1;
            self.talk.said_bytes += bytes.len() as u64;
            let body = decode_packet(bytes).map(|packet| packet.body);
            if matches!(body, Some(wire::Body::Digest(_) | wire::Body::Tile(_))) {
                self.met_ms.get_or_insert(time_ms);
            }
        }
        if let Some(copy) = self.copy() {
            copy.say();
        }
        Ok(())
    }

    /// Notes that the robot fell or tipped over while it drove.
    pub(super) fn note_loss(&mut self, loss: Option<Loss>) {
        if let (Some(loss), Presence::Exploring) = (loss, self.presence) {
            self.end(Ending::Lost(loss));
        }
    }

    /// Reads the map and the rest at the end of the run. The map may consist of parts: each holds
    /// one of `places`.
    pub(super) fn read_out(&mut self, places: &[[f64; 2]]) {
        if self.presence != Presence::Silent
            && let Err(error) = snapshot::read(self.link, &mut self.record, places)
        {
            self.record.read_out_error = Some(error);
        }
        self.record.link_stats = self.link.end().stats();
    }

    /// Returns the member of the wire with this number.
    pub(super) fn of_wire(number: usize) -> wire::Team {
        wire::Team {
            member: wire::Member {
                id: number as u8,
                boot: 1,
            },
            ..wire::Team::default()
        }
    }

    /// Returns true if it explored everything, or as much as it was told to.
    pub(super) fn has_explored(&self) -> bool {
        matches!(
            self.record.ending,
            Ending::Finished(Finish::Explored | Finish::Covered)
        )
    }
}
