//! Text of refusals and crashes for people: what is wrong, and what to do about it.

use core::fmt;

use crate::message::{Cause, Crash, Parameter, Refusal};

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Lasers => "the robot must have one or two lasers, and two on uneven ground",
            Self::Beams => "a laser must have 1 to 181 beams",
            Self::RangeLimit => "the range limit of a laser must be 1 to 16382 mm",
            Self::Bearing => {
                "the beams of a laser must lie within one turn, \
                 and the bearing step must be positive"
            }
            Self::Pitch => {
                "the first laser must be level, and the second must look down by less than 90°"
            }
            Self::Mount => "a laser must be above the ground, at most 2 m from the robot's centre",
            Self::TurnTime => {
                "the turn time of a laser must be at most 500 ms, and 0 if it looks down"
            }
            Self::Hull => {
                "the robot's hull must be 1 to 4000 mm long and wide and at most 2000 mm high"
            }
            Self::Radius => "the robot's radius must be 50 to 600 mm",
            Self::MaxLinear => "the maximum speed must be positive",
            Self::MaxAngular => "the maximum turn rate must be positive",
            Self::LinearAccel => {
                "the linear acceleration must stop the robot from its maximum speed within 3 s"
            }
            Self::AngularAccel => {
                "the angular acceleration must stop the robot from its maximum turn rate within 3 s"
            }
            Self::Period => "the time from one observation to the next must be 100 to 400 ms",
            Self::Preference => {
                "the least preference must be -2 to 0 and the greatest 0 to 2, \
                 because the field diverges beyond 2"
            }
            Self::UnevenGround => {
                "uneven ground needs scales of at least 0, heights that are not 0, \
                 and slopes above 0 and at most 45°"
            }
            Self::Worth => "the worth of a trip must be within 0 and 7 m²/m",
            Self::LoopLimits => "the limits of loops must be at least 0",
            Self::Area => "the area must have sides of 0.1 to 128 m within 3200 m of the origin",
            Self::Coverage => "the target coverage must be 1 to 1000 thousandths",
            Self::Team => {
                "the odometry's origin must lie within 400 m and a hundred turns of the team's"
            }
            Self::Fence => {
                "the fence must have at most 10 polygons and 32 corners within 3200 m, and each \
                 polygon 3 corners or more, an area, and sides that do not cross"
            }
        })
    }
}

impl fmt::Display for Refusal {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NotGreeted => f.write_str("no hello since the device booted; send a hello first"),
            Self::NotStarted => f.write_str("no session is running; start one first"),
            Self::OutOfOrder => f.write_str("the request is older than the last one answered"),
            Self::BadParameter(parameter) => write!(f, "bad parameter: {parameter}"),
            Self::NoTeam => f.write_str("the session has no team; start it with one"),
            Self::NoCorrection => {
                f.write_str("no correction of this epoch is open; open one with a greater epoch")
            }
            Self::BadCorrection => f.write_str(
                "a correction must have at most 512 tiles, keep the robot within 10 km, \
                 and be for flat ground",
            ),
            Self::BadTile => f.write_str("the runs of a tile do not have 1024 cells"),
            Self::NotReady => f.write_str(
                "the robot takes no order to drive: it has no scan yet, does not know where it is, \
                 started where it cannot or must not be, or only surveys",
            ),
            Self::BadGoal => f.write_str(
                "the goal must lie within 3200 m of the map's origin, where the fence allows it",
            ),
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
            Cause::Watchdog => f.write_str("watchdog: the main loop took too long"),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::string::ToString;

    use crate::message::{Cause, Crash, Parameter, Refusal};

    #[test]
    fn a_refusal_names_the_parameter_and_its_range() {
        let refusal = Refusal::BadParameter(Parameter::Radius);
        assert_eq!(
            refusal.to_string(),
            "bad parameter: the robot's radius must be 50 to 600 mm"
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
