//! Radio specifications: a list like `range=10,loss=0.2,partition@60-120`, or `off`.
//!
//! | word | meaning | default |
//! | --- | --- | --- |
//! | `off` | no robot hears another | |
//! | `range=M` | greatest distance, metres | no limit |
//! | `walls=M`, `walls=block` | each wall between counts as M metres more, or blocks | 0 |
//! | `loss=P` | probability that a hearer does not hear a packet | 0 |
//! | `duplicate=P` | probability that a hearer hears a packet twice | 0 |
//! | `delay=S` | greatest delay, seconds: uniform from 0 | 0 |
//! | `reorder=P` | probability that a packet is [`HELD_MS`] later than that | 0 |
//! | `partition@A-B` | from A to B seconds, only robots of one group hear each other | none |
//!
//! The groups of a partition are the first half of the robots and the others, or as given:
//! `partition@60-120:0/12` has robot 0 in one group, and robots 1 and 2 in another. A robot that is
//! in no group hears nobody. There may be several partitions.

use core::str::FromStr;

use crate::spec::{Form, SpecError, Word};

/// Greatest number of robots in a team: a beacon's receiver keeps seven others.
pub const MOST_ROBOTS: usize = 8;
/// Time for which a packet out of order is held, milliseconds: two periods of the robots.
pub const HELD_MS: u32 = 400;
/// Greatest range, metres; greatest delay, seconds.
const MOST: f64 = 1e4;

/// What a wall does to a packet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Walls {
    /// It counts as so many metres more.
    Metres(f64),
    /// It ends the packet's way.
    Block,
}

/// A time in which only robots of one group hear each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Partition {
    /// Beginning and end, milliseconds.
    pub span_ms: [u32; 2],
    /// Numbers of the robots of each group; halves if empty.
    pub groups: Vec<Vec<usize>>,
}

/// A simulated radio.
#[derive(Clone, Debug, PartialEq)]
pub struct RadioSpec {
    /// The text that names it, for the report.
    pub text: String,
    /// False if no robot hears another.
    pub on: bool,
    /// Greatest distance, metres.
    pub range_m: f64,
    /// What a wall does.
    pub walls: Walls,
    /// Probability of a loss.
    pub loss: f64,
    /// Probability of a second copy.
    pub duplicate: f64,
    /// Greatest delay, milliseconds.
    pub delay_ms: u32,
    /// Probability of [`HELD_MS`] more.
    pub reorder: f64,
    /// Partitions.
    pub partitions: Vec<Partition>,
}

impl Default for RadioSpec {
    fn default() -> Self {
        Self {
            text: "perfect".into(),
            on: true,
            range_m: f64::INFINITY,
            walls: Walls::Metres(0.0),
            loss: 0.0,
            duplicate: 0.0,
            delay_ms: 0,
            reorder: 0.0,
            partitions: Vec::new(),
        }
    }
}

const FORM: Form = Form {
    what: "word",
    usage: "off, or range=M, walls=M or walls=block, loss=P, duplicate=P, delay=S, reorder=P, \
            partition@A-B or partition@A-B:0/12, separated by commas",
    repeated: "partition",
};

impl FromStr for RadioSpec {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let words = text.split(',').map(str::trim);
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        let mut spec = Self {
            text: words.join(","),
            on: words != ["off"],
            ..Self::default()
        };
        if spec.on {
            FORM.read(text, |word| spec.read(word))?;
        }
        Ok(spec)
    }
}

impl RadioSpec {
    fn read(&mut self, word: &Word<'_>) -> Result<(), SpecError> {
        let share = || word.number(0.0..=0.95, "a probability from 0 to 0.95");
        match word.key.as_str() {
            "range=" => self.range_m = word.number(0.1..=MOST, "from 0.1 to 10000 m")?,
            "walls=" if word.value == "block" => self.walls = Walls::Block,
            "walls=" => {
                let metres = word.number(0.0..=MOST, "from 0 to 10000 m, or block")?;
                self.walls = Walls::Metres(metres);
            }
            "loss=" => self.loss = share()?,
            "duplicate=" => self.duplicate = share()?,
            "reorder=" => self.reorder = share()?,
            "delay=" => {
                let seconds = word.number(0.0..=60.0, "from 0 to 60 s")?;
                self.delay_ms = (seconds * 1000.0).round() as u32;
            }
            "partition@" => self.partitions.push(partition(word)?),
            _ => return Err(word.unknown()),
        }
        Ok(())
    }

    /// Returns the robot that a partition names and a team of `robots` does not have.
    #[must_use]
    pub fn stranger(&self, robots: usize) -> Option<usize> {
        let groups = self
            .partitions
            .iter()
            .flat_map(|it| it.groups.iter().flatten());
        groups.copied().find(|robot| *robot >= robots)
    }
}

impl Partition {
    /// Returns true if two robots of a team do not hear each other at a time.
    #[must_use]
    pub fn parts(&self, time_ms: u32, [a, b]: [usize; 2], robots: usize) -> bool {
        if !(self.span_ms[0]..self.span_ms[1]).contains(&time_ms) {
            return false;
        }
        if self.groups.is_empty() {
            let first_half = |robot: usize| robot < robots.div_ceil(2);
            return first_half(a) != first_half(b);
        }
        let mut groups = self.groups.iter();
        !groups.any(|group| group.contains(&a) && group.contains(&b))
    }
}

/// Parses `A-B` or `A-B:0/12`.
fn partition(word: &Word<'_>) -> Result<Partition, SpecError> {
    let (span, groups) = word.value.split_once(':').unwrap_or((word.value, ""));
    let span_ms = word
        .span_s(span, 4e6)?
        .map(|seconds| (seconds * 1000.0) as u32);
    let digit = |digit: char| {
        let robot = digit.to_digit(10).map(|robot| robot as usize);
        robot.filter(|robot| *robot < MOST_ROBOTS)
    };
    let group = |text: &str| text.chars().map(digit).collect::<Option<Vec<usize>>>();
    let parts = groups.split('/').filter(|_| word.value.contains(':'));
    let groups = parts.map(group).collect::<Option<Vec<_>>>();
    let groups = groups.ok_or_else(|| word.bad("groups of robots from 0 to 7, as in :0/12"))?;
    Ok(Partition { span_ms, groups })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_specification_is_read() {
        let spec: RadioSpec = "range=10, loss=0.2,walls=block,delay=0.5,duplicate=0.1,reorder=0.3,\
                               partition@60-120,partition@5-6.5:0/12"
            .parse()
            .unwrap();
        assert_eq!(
            (spec.range_m, spec.loss, spec.walls),
            (10.0, 0.2, Walls::Block)
        );
        assert_eq!(
            (spec.delay_ms, spec.duplicate, spec.reorder),
            (500, 0.1, 0.3)
        );
        assert_eq!(spec.partitions[0].span_ms, [60_000, 120_000]);
        assert_eq!(spec.partitions[1].span_ms, [5_000, 6_500]);
        assert_eq!(spec.partitions[1].groups, [vec![0], vec![1, 2]]);
        assert_eq!((spec.stranger(3), spec.stranger(2)), (None, Some(2)));
        let off: RadioSpec = "off".parse().unwrap();
        assert!(!off.on && spec.on);
        let walls: RadioSpec = "walls=3".parse().unwrap();
        assert_eq!(walls.walls, Walls::Metres(3.0));
    }

    #[test]
    fn a_partition_parts_halves_or_the_groups_that_it_names() {
        let spec: RadioSpec = "partition@60-120,partition@200-300:02/1".parse().unwrap();
        let parts = |time_ms, pair| {
            let mut partitions = spec.partitions.iter();
            partitions.any(|partition| partition.parts(time_ms, pair, 4))
        };
        assert!(!parts(59_999, [0, 2]) && parts(60_000, [0, 2]) && !parts(120_000, [0, 2]));
        assert!(!parts(60_000, [0, 1]) && !parts(60_000, [3, 2]));
        assert!(!parts(200_000, [0, 2]) && parts(200_000, [1, 2]));
        // Robot 3 is in no group.
        assert!(parts(200_000, [3, 0]) && parts(200_000, [1, 3]));
    }

    #[test]
    fn an_invalid_specification_is_named() {
        let error = |text: &str| text.parse::<RadioSpec>().unwrap_err().to_string();
        for text in ["", " , "] {
            assert!(error(text).contains("no word is named"));
        }
        for (text, word) in [
            ("power=3", "'power=3'"),
            ("loss", "'loss'"),
            ("range=10,off", "'off'"),
            ("jam@3-4", "'jam@3-4'"),
        ] {
            let error = error(text);
            assert!(error.contains("unknown") && error.contains(word), "{error}");
        }
        let twice = error("loss=0.1,loss=0.2");
        assert!(twice.contains("'loss' is given twice"), "{twice}");
        for text in [
            "loss=1",
            "loss=-0.1",
            "loss=nan",
            "range=0",
            "range=inf",
            "walls=thick",
            "delay=61",
            "partition@60",
            "partition@60-50",
            "partition@60-x",
            "partition@60-120:0/19",
            "partition@60-120:a",
        ] {
            let error = error(text);
            assert!(
                error.contains("bad value") && error.contains(text),
                "{error}"
            );
        }
        assert!(error("power=3").contains("range=M"));
    }
}
