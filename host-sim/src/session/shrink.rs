//! The fewest and simplest requests that cause a finding: delta debugging.
//!
//! Chunks of requests are left out, from halves down to single ones (A. Zeller and R. Hildebrandt,
//! "Simplifying and isolating failure-inducing input", IEEE TSE 28(2), 2002). Then the parts of
//! each request are replaced by simpler ones. A change stays if the same kind of finding does.

use fieldline_protocol::message::{
    LoopLimits, Observation, Packet, Pose, Scan, Start, Strategy, Twist,
};

use super::ask::Ask;
use super::generate::Replayed;
use super::judge::Kind;
use super::play::Trial;
use crate::link::LinkError;

/// A shrinking in progress.
struct Shrinker<'a> {
    trial: &'a Trial,
    kind: &'a Kind,
    /// Number of trials that are left.
    left: usize,
    asks: Vec<Ask>,
}

/// Shrinks requests that cause a finding of `kind`, in at most `trials` trials. Requests that do
/// not cause it are returned as they are.
///
/// # Errors
/// If no device can be opened.
pub fn shrink(
    trial: &Trial,
    kind: &Kind,
    asks: &[Ask],
    trials: usize,
) -> Result<Vec<Ask>, LinkError> {
    let mut shrinker = Shrinker {
        trial,
        kind,
        left: trials,
        asks: asks.to_vec(),
    };
    shrinker.cut()?;
    shrinker.remove()?;
    shrinker.simplify()?;
    shrinker.remove()?;
    Ok(shrinker.asks)
}

impl Shrinker<'_> {
    /// Keeps `asks` if they cause the finding. Returns true if they do.
    fn keeps(&mut self, asks: Vec<Ask>) -> Result<bool, LinkError> {
        if self.left == 0 || asks == self.asks {
            return Ok(false);
        }
        self.left -= 1;
        let causes = self.trial.play(&mut Replayed::new(&asks))?.has(self.kind);
        if causes {
            self.asks = asks;
        }
        Ok(causes)
    }

    /// Leaves out what comes after the finding.
    fn cut(&mut self) -> Result<(), LinkError> {
        let played = self.trial.play(&mut Replayed::new(&self.asks))?;
        let found = played.findings.iter().find(|it| it.kind == *self.kind);
        if let Some(finding) = found {
            self.asks.truncate(finding.request + 1);
        }
        Ok(())
    }

    /// Leaves out chunks of requests, ever smaller ones.
    fn remove(&mut self) -> Result<(), LinkError> {
        let mut chunk = self.asks.len().div_ceil(2);
        while chunk > 0 && self.left > 0 {
            let mut from = 0;
            while from < self.asks.len() {
                let to = (from + chunk).min(self.asks.len());
                let rest = [&self.asks[..from], &self.asks[to..]].concat();
                if !self.keeps(rest)? {
                    from = to;
                }
            }
            chunk = if chunk == 1 { 0 } else { chunk.div_ceil(2) };
        }
        Ok(())
    }

    /// Replaces parts of the requests by simpler ones.
    fn simplify(&mut self) -> Result<(), LinkError> {
        for index in (0..self.asks.len()).rev() {
            for change in 0.. {
                let Some(simpler) = simpler(&self.asks[index], change) else {
                    break;
                };
                let mut asks = self.asks.clone();
                asks[index] = simpler;
                self.keeps(asks)?;
            }
        }
        Ok(())
    }
}

/// Returns a request with one part replaced by a simpler one; `None` after the last change.
fn simpler(ask: &Ask, change: usize) -> Option<Ask> {
    match ask {
        Ask::Observation(observation) => {
            simpler_observation(observation, change).map(|it| Ask::Observation(Box::new(it)))
        }
        Ask::Start(start) => simpler_start(start, change).map(|it| Ask::Start(Box::new(it))),
        Ask::Hear(packet) => simpler_packet(packet, change).map(|it| Ask::Hear(Box::new(it))),
        _ => None,
    }
}

fn simpler_observation(observation: &Observation, change: usize) -> Option<Observation> {
    let mut simple = observation.clone();
    match change {
        0 => simple.pose = Pose::default(),
        1 => {
            let Pose { x, y, yaw, .. } = simple.pose;
            simple.pose = Pose {
                x,
                y,
                yaw,
                ..Pose::default()
            };
        }
        2 => simple.velocity = Twist::default(),
        3 => simple.scans.iter_mut().for_each(even),
        4.. => {
            let scan = simple.scans.get_mut(change - 4)?;
            even(scan);
        }
    }
    Some(simple)
}

/// Gives all beams of a scan the range of the middle one.
fn even(scan: &mut Scan) {
    let middle = scan.ranges_mm.get(scan.ranges_mm.len() / 2).copied();
    scan.ranges_mm.fill(middle.unwrap_or_default());
}

fn simpler_start(start: &Start, change: usize) -> Option<Start> {
    let mut simple = start.clone();
    match change {
        0 => simple.strategy = Strategy::Frontier,
        1 => simple.team = None,
        2 => simple.uneven_ground = None,
        3 => simple.localise = false,
        4 => simple.survey = false,
        5 => simple.loops = LoopLimits::default(),
        6 => simple.hull = Start::default().hull,
        7 => simple.order = simple.strategy.order(),
        _ => return None,
    }
    Some(simple)
}

fn simpler_packet(packet: &Packet, change: usize) -> Option<Packet> {
    use fieldline_protocol::message::Body;
    let mut simple = packet.clone();
    match (&mut simple.body, change) {
        (_, 0) => simple.sequence = 0,
        (Body::Beacon(beacon), 1) => beacon.goal = None,
        (Body::Beacon(beacon), 2) => beacon.road.clear(),
        (Body::Beacon(beacon), 3) => beacon.velocity = Twist::default(),
        (Body::Digest(digest), 1) => digest.tiles.truncate(1),
        (Body::Wanted(wanted), 1) => wanted.tiles.truncate(1),
        _ => return None,
    }
    Some(simple)
}
