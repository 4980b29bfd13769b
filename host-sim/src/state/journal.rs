//! The planner's answers in a run: kept as they come, and given again.
//!
//! ```text
//! run ─► Recorder ─► link        live: the answer is kept
//!           └──► kept answers    again: the link hears nothing
//! ```
//!
//! After the last kept answer the recorder says that the device was reset. So the run gives the
//! device behind the link its session and its map, by the same code as after a reset.
//!
//! Reading map, field and path changes nothing, so it is not kept; while answers are given again
//! there is nothing to read.

use core::cell::RefCell;
use std::rc::Rc;

use fieldline_protocol::message::{Command, CorrectionProgress, Path, Reply, Request, Status};
use serde::{Deserialize, Serialize};

use crate::link::correction::MapCorrection;
use crate::link::{End, Link, LinkError};

/// An answer of the planner, or why there was none.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Answer {
    /// To an observation.
    Command(Command),
    /// To a control.
    Status(Status),
    /// To a correction of the map, or to a recall.
    Done,
    /// A request was refused for this reason.
    Refused(String),
    /// The device was reset.
    Reset,
}

/// The answers of a run.
#[derive(Debug, Default)]
pub(crate) struct Journal {
    answers: Vec<Answer>,
    /// The next answer that is given again.
    next: usize,
    /// Number of answers to give again, and if the device was reset after them.
    kept: usize,
    is_handed_over: bool,
}

impl Journal {
    /// Makes the journal of a run that goes on after these answers; of a new run without any.
    pub(crate) fn after(answers: Vec<Answer>) -> Self {
        Self {
            kept: answers.len(),
            is_handed_over: answers.is_empty(),
            answers,
            next: 0,
        }
    }

    /// Returns the number of answers.
    pub(crate) const fn len(&self) -> usize {
        self.answers.len()
    }

    /// Returns the number of answers up to the last command.
    pub(crate) fn to_last_command(&self) -> usize {
        let is_command = |answer: &Answer| matches!(answer, Answer::Command(_));
        self.answers
            .iter()
            .rposition(is_command)
            .map_or(0, |it| it + 1)
    }

    /// Returns the first answers.
    pub(crate) fn first(&self, count: usize) -> Vec<Answer> {
        let count = count.min(self.answers.len());
        self.answers[..count].to_vec()
    }

    /// Returns true while answers are given again.
    const fn is_again(&self) -> bool {
        self.next < self.kept
    }

    /// Returns the next answer that is given again, or the reset that follows the last one; `None`
    /// if the link is to be asked.
    fn again(&mut self) -> Option<Answer> {
        if self.is_again() {
            self.next += 1;
            return self.answers.get(self.next - 1).cloned();
        }
        if self.is_handed_over {
            return None;
        }
        self.is_handed_over = true;
        self.answers.push(Answer::Reset);
        Some(Answer::Reset)
    }
}

/// A link whose answers are kept. The first of them may be given again.
pub(crate) struct Recorder<'l> {
    link: &'l mut dyn Link,
    journal: Rc<RefCell<Journal>>,
}

impl<'l> Recorder<'l> {
    /// Makes the recorder of a link.
    pub(crate) fn new(link: &'l mut dyn Link, journal: Rc<RefCell<Journal>>) -> Self {
        Self { link, journal }
    }

    /// Gives a kept answer again, or asks the link and keeps its answer.
    fn answer<T>(
        &mut self,
        ask: impl FnOnce(&mut dyn Link) -> Result<T, LinkError>,
        kept: impl FnOnce(&T) -> Answer,
        again: impl FnOnce(Answer) -> Option<T>,
    ) -> Result<T, LinkError> {
        let answer = self.journal.borrow_mut().again();
        match answer {
            Some(Answer::Reset) => return Err(LinkError::Reset),
            Some(Answer::Refused(reason)) => return Err(LinkError::Refused(reason)),
            Some(answer) => return again(answer).ok_or_else(strays),
            None => {}
        }
        let answer = ask(self.link);
        let kept = match &answer {
            Ok(answer) => kept(answer),
            Err(LinkError::Refused(reason)) => Answer::Refused(reason.clone()),
            Err(LinkError::Reset) => Answer::Reset,
            // The run ends.
            Err(_) => return answer,
        };
        self.journal.borrow_mut().answers.push(kept);
        answer
    }
}

/// The run asks for another kind of answer than the kept one.
fn strays() -> LinkError {
    LinkError::Io(
        "the state does not fit this world and program; resume it with the program that kept it"
            .into(),
    )
}

impl Link for Recorder<'_> {
    fn ask(&mut self, request: &Request) -> Result<Reply, LinkError> {
        let is_again = self.journal.borrow().is_again();
        match request {
            Request::Control(control) => {
                let status = self.answer(
                    |link| link.control(control),
                    |status| Answer::Status(*status),
                    |answer| match answer {
                        Answer::Status(status) => Some(status),
                        _ => None,
                    },
                )?;
                Ok(Reply::Control(status))
            }
            Request::Observation(observation) => {
                let command = self.answer(
                    |link| link.observe(observation),
                    |command| Answer::Command(*command),
                    |answer| match answer {
                        Answer::Command(command) => Some(command),
                        _ => None,
                    },
                )?;
                Ok(Reply::Command(command))
            }
            Request::Recall(recall) => {
                self.answer(
                    |link| link.recall(recall),
                    |()| Answer::Done,
                    |answer| (answer == Answer::Done).then_some(()),
                )?;
                Ok(Reply::Corrected(CorrectionProgress::default()))
            }
            Request::Tile { .. } if is_again => Ok(Reply::Tile(None)),
            Request::FieldRow { .. } if is_again => Ok(Reply::FieldRow(None)),
            Request::Frontiers if is_again => Ok(Reply::Frontiers(heapless::Vec::new())),
            Request::Path { .. } if is_again => Ok(Reply::Path(Path::default())),
            _ => self.link.ask(request),
        }
    }

    /// A correction has one answer, whatever its parts.
    fn correct(&mut self, correction: &MapCorrection) -> Result<(), LinkError> {
        self.answer(
            |link| link.correct(correction),
            |()| Answer::Done,
            |answer| (answer == Answer::Done).then_some(()),
        )
    }

    fn end(&self) -> &dyn End {
        self.link.end()
    }
}

#[cfg(test)]
mod tests {
    use super::{Answer, Journal, Recorder};
    use crate::link::direct::Direct;
    use crate::link::{Link, LinkError};
    use crate::sim::{SimConfig, Simulator};
    use crate::world::World;
    use core::cell::RefCell;
    use fieldline_protocol::message::{Control, Status, Strategy};
    use std::rc::Rc;

    #[test]
    fn answers_come_again_and_then_a_reset_and_then_the_link() {
        let world = World::builtin("office").expect("a world");
        let mut sim = Simulator::new(&world, SimConfig::default()).expect("a start");
        let start = Control::Start(sim.start_message(Strategy::Frontier));
        let journal = |answers| Rc::new(RefCell::new(Journal::after(answers)));
        let (first, mut device) = (journal(Vec::new()), Direct::new());
        let mut link = Recorder::new(&mut device, Rc::clone(&first));
        link.control(&start).expect("a session");
        let command = link.observe(&sim.observe()).expect("a command");
        let answers = first.borrow().first(9);
        let wanted = [Answer::Status(Status::Exploring), Answer::Command(command)];
        assert_eq!(answers, wanted);

        let (second, mut device) = (journal(answers), Direct::new());
        let mut link = Recorder::new(&mut device, Rc::clone(&second));
        assert_eq!(link.control(&start), Ok(Status::Exploring));
        assert_eq!(link.observe(&sim.observe()), Ok(command));
        assert_eq!(link.observe(&sim.observe()), Err(LinkError::Reset));
        let refused = link.observe(&sim.observe()).expect_err("it has no session");
        assert!(matches!(refused, LinkError::Refused(_)));
        assert_eq!(link.control(&start), Ok(Status::Exploring));
        assert_eq!(second.borrow().len(), 5);

        let (third, mut device) = (journal(vec![Answer::Done]), Direct::new());
        let mut link = Recorder::new(&mut device, third);
        assert!(
            matches!(link.control(&start), Err(LinkError::Io(_))),
            "another kind"
        );
    }
}
