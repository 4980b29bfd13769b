//! Refusals and crashes in words: what is wrong, and what to do about it.

use core::fmt;

use crate::message::{Cause, Crash, Parameter, Refusal};

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lasers => "lasers must be one or two",
            Self::Beams => "a laser's beams must be 1 to 181",
            Self::RangeLimit => "a laser's range limit must be 1 to 16382 mm",
            Self::Bearing => {
                "a laser's beams must lie within one turn, at a positive step of bearing"
            }
            Self::Pitch => {
                "the first laser must be level and the second look down by less than 90°"
            }
            Self::Mount => "a laser must sit above the ground, at most 2 m from the centre",
            Self::Radius => "the robot's radius must be 50 to 2000 mm",
            Self::MaxLinear => "the greatest speed must be positive",
            Self::MaxAngular => "the greatest turn rate must be positive",
            Self::LinearAccel => {
                "the linear acceleration must stop the robot from its greatest speed within 3 s"
            }
            Self::AngularAccel => {
                "the angular acceleration must stop the robot from its greatest turn rate within 3 s"
            }
            Self::Period => "the time from one observation to the next must be 100 to 400 ms",
        })
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotGreeted => f.write_str("no hello since it booted; say hello first"),
            Self::NotStarted => f.write_str("no session is running; start one first"),
            Self::OutOfOrder => f.write_str("a request older than the last one answered"),
            Self::BadBox => {
                f.write_str("the map's box must be an even number of tiles across, both sides at least 4, and their product within the tile slots")
            }
            Self::BadParameter(parameter) => write!(f, "bad parameter: {parameter}"),
            Self::UnknownStrategy => f.write_str("the strategy is not in this image"),
        }
    }
}

impl core::error::Error for Refusal {}

impl fmt::Display for Crash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self.cause {
            Cause::Panic => write!(f, "panic at {}:{}", self.file, self.at),
            Cause::Fault => write!(f, "processor fault at {:#010x}", self.at),
            Cause::StackOverflow => f.write_str("stack overflow"),
            Cause::Watchdog => f.write_str("watchdog: the main loop did not come round"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use crate::message::{Cause, Crash, Parameter, Refusal};

    #[test]
    fn a_refusal_names_the_thing_and_its_range() {
        let refusal = Refusal::BadParameter(Parameter::Radius);
        assert_eq!(
            refusal.to_string(),
            "bad parameter: the robot's radius must be 50 to 2000 mm"
        );
    }

    #[test]
    fn a_crash_names_its_place() {
        let mut crash = Crash {
            cause: Cause::Panic,
            at: 12,
            file: "map.rs".try_into().unwrap(),
        };
        assert_eq!(crash.to_string(), "panic at map.rs:12");
        (crash.cause, crash.at) = (Cause::Fault, 0x0800_1234);
        assert_eq!(crash.to_string(), "processor fault at 0x08001234");
    }
}
