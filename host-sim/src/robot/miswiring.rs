//! Wiring mistakes of a simulated robot: what somebody has wrong on a first day.
//!
//! | word | mistake |
//! | --- | --- |
//! | `mirrored` | the beams of the level lidar come in the other sense of turning |
//! | `laser-turned=90` | it looks by so many degrees to the left of where its mount says |
//! | `lasers-swapped` | the two lidars stand in each other's place |
//! | `yaw-sign` | odometry turns the other way |
//! | `way-sign` | odometry drives the other way |
//! | `wheels-swapped` | the robot turns against the command |
//! | `reversed` | both motors run backwards: it drives and turns against the command |
//! | `millimetres` | odometry gives its place in millimetres: `odometry-times=1000` |
//! | `odometry-times=F` | odometry counts F times the way |
//! | `yaw-times=F` | odometry counts F times the turn |
//! | `ranges-times=F` | the lidars measure F times the range |
//! | `turn-time-untold` | a lidar turns while the robot moves, and its mount does not say it |
//! | `clock-stands` | the time of the observations stands |
//! | `clock-times=F` | it goes on F times as fast |
//!
//! Several are joined by commas. Lasers are wrong before their beams are cast, odometry and clock
//! when an observation is told, wheels when a command is heard. So a mistake is the same over every
//! link. Odometry that turns the other way has the place that follows from it: its path is the
//! mirror image. Units: degrees in the text, radians inside.

use core::fmt;
use core::str::FromStr;

use fieldline_protocol::message::{INVALID_MM, NO_RETURN_MM, Observation};

use super::pose::{Pose, Velocity, wrap};
use crate::spec::{Form, SpecError, Word};

/// Greatest factor.
const MOST_TIMES: f64 = 1e6;

/// Wiring mistakes of a run; by default none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Miswiring {
    /// The level lidar's beams are mirrored.
    pub mirrored: bool,
    /// Turn of the level lidar to the left, radians.
    pub laser_turned_rad: f64,
    /// The two lidars stand in each other's place.
    pub lasers_swapped: bool,
    /// Commands of speed and turn are heard with these factors.
    pub wheels: [f64; 2],
    /// Odometry counts way and turn with these factors.
    pub odometry: [f64; 2],
    /// Factor of all ranges.
    pub ranges_times: f64,
    /// Factor of the clock.
    pub clock_times: f64,
    /// No mount says the turn time of its lidar.
    pub turn_time_untold: bool,
}

impl Default for Miswiring {
    fn default() -> Self {
        Self {
            mirrored: false,
            laser_turned_rad: 0.0,
            lasers_swapped: false,
            wheels: [1.0; 2],
            odometry: [1.0; 2],
            ranges_times: 1.0,
            clock_times: 1.0,
            turn_time_untold: false,
        }
    }
}

impl Miswiring {
    /// Returns the command that the wheels hear.
    #[must_use]
    pub fn heard(&self, command: Velocity) -> Velocity {
        Velocity {
            linear_mps: self.wheels[0] * command.linear_mps,
            angular_radps: self.wheels[1] * command.angular_radps,
        }
    }

    /// Returns the velocity that odometry tells.
    #[must_use]
    pub fn measured(&self, velocity: Velocity) -> Velocity {
        Velocity {
            linear_mps: self.odometry[0] * velocity.linear_mps,
            angular_radps: self.odometry[1] * velocity.angular_radps,
        }
    }

    /// Returns the pose that odometry tells, if its first one was `start`. A sign turns the path
    /// into its mirror image.
    #[must_use]
    pub fn told(&self, pose: Pose, start: &Pose) -> Pose {
        let [way, turn] = self.odometry;
        if self.odometry == [1.0; 2] {
            return pose;
        }
        let frame = start.planar_frame();
        let [ahead_m, left_m] = frame.to_local([pose.x_m, pose.y_m]);
        let side = if turn < 0.0 { -way } else { way };
        let [x_m, y_m] = frame.to_world([way * ahead_m, side * left_m]);
        Pose {
            x_m,
            y_m,
            yaw_rad: wrap(start.yaw_rad + turn * wrap(pose.yaw_rad - start.yaw_rad)),
            ..pose
        }
    }

    /// Puts the mistakes of lasers and clock into an observation.
    pub fn spoil(&self, observation: &mut Observation) {
        if self.lasers_swapped {
            observation.scans.reverse();
        }
        if self.ranges_times != 1.0 {
            let scans = observation.scans.iter_mut();
            let ranges = scans.flat_map(|scan| &mut scan.ranges_mm);
            for range_mm in ranges.filter(|it| !matches!(**it, INVALID_MM | NO_RETURN_MM)) {
                let told = f64::from(*range_mm) * self.ranges_times;
                *range_mm = told.round().min(f64::from(NO_RETURN_MM)) as u16;
            }
        }
        if self.clock_times != 1.0 {
            let told_ms = f64::from(observation.time_ms) * self.clock_times;
            observation.time_ms = told_ms.round() as u64 as u32;
        }
    }

    fn read(&mut self, word: &Word<'_>) -> Result<(), SpecError> {
        let factor = || {
            let fits = |it: &f64| *it > 0.0 && *it <= MOST_TIMES;
            word.parse(fits, "a factor above 0, at most 1000000")
        };
        match word.key.as_str() {
            "mirrored" => self.mirrored = true,
            "laser-turned=" => {
                let deg = word.number(-360.0..=360.0, "degrees from -360 to 360")?;
                self.laser_turned_rad = deg.to_radians();
            }
            "lasers-swapped" => self.lasers_swapped = true,
            "yaw-sign" => self.odometry[1] = -1.0,
            "way-sign" => self.odometry[0] = -1.0,
            "wheels-swapped" => self.wheels[1] = -1.0,
            "reversed" => self.wheels = [-1.0; 2],
            "millimetres" => self.odometry[0] = 1000.0,
            "odometry-times=" => self.odometry[0] = factor()?,
            "yaw-times=" => self.odometry[1] = factor()?,
            "ranges-times=" => self.ranges_times = factor()?,
            "turn-time-untold" => self.turn_time_untold = true,
            "clock-stands" => self.clock_times = 0.0,
            "clock-times=" => self.clock_times = factor()?,
            _ => return Err(word.unknown()),
        }
        Ok(())
    }
}

const FORM: Form = Form {
    what: "wiring mistake",
    usage: "one or more of mirrored, laser-turned=DEG, lasers-swapped, yaw-sign, way-sign, \
            wheels-swapped, reversed, millimetres, odometry-times=F, yaw-times=F, ranges-times=F, \
            turn-time-untold, clock-stands, clock-times=F, separated by commas",
    repeated: "",
};

impl FromStr for Miswiring {
    type Err = SpecError;

    fn from_str(text: &str) -> Result<Self, SpecError> {
        let mut read = Self::default();
        FORM.read(text, |word| read.read(word))?;
        Ok(read)
    }
}

impl fmt::Display for Miswiring {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut words: Vec<String> = Vec::new();
        let mut say = |is_so: bool, word: String| {
            if is_so {
                words.push(word);
            }
        };
        let [way, turn] = self.odometry;
        say(self.mirrored, "mirrored".into());
        let deg = self.laser_turned_rad.to_degrees();
        say(deg != 0.0, format!("laser-turned={deg:.0}"));
        say(self.lasers_swapped, "lasers-swapped".into());
        say(turn == -1.0, "yaw-sign".into());
        say(way == -1.0, "way-sign".into());
        say(self.wheels == [1.0, -1.0], "wheels-swapped".into());
        say(self.wheels == [-1.0; 2], "reversed".into());
        say(way > 0.0 && way != 1.0, format!("odometry-times={way}"));
        say(turn > 0.0 && turn != 1.0, format!("yaw-times={turn}"));
        let (ranges, clock) = (self.ranges_times, self.clock_times);
        say(ranges != 1.0, format!("ranges-times={ranges}"));
        say(self.turn_time_untold, "turn-time-untold".into());
        say(clock == 0.0, "clock-stands".into());
        say(clock != 0.0 && clock != 1.0, format!("clock-times={clock}"));
        f.write_str(&words.join(","))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_text_is_read_and_written() {
        let text = "mirrored,laser-turned=90,lasers-swapped,yaw-sign,way-sign,wheels-swapped,\
                    ranges-times=0.001,turn-time-untold,clock-stands";
        let read: Miswiring = text.parse().expect("valid");
        assert_eq!(read.to_string(), text);
        let millimetres: Miswiring = "millimetres".parse().expect("valid");
        assert_eq!(millimetres.to_string(), "odometry-times=1000");
        assert_eq!(Miswiring::default().to_string(), "");
    }

    #[test]
    fn a_bad_word_is_named() {
        for (text, remedy) in [
            ("", "lasers-swapped"),
            ("mirror", "did you mean mirrored?"),
            ("laser-turned", "lasers-swapped"),
            ("laser-turned=x", "degrees from -360 to 360"),
            ("clock-times=0", "a factor above 0"),
            ("yaw-times=NaN", "a factor above 0"),
        ] {
            let error = text.parse::<Miswiring>().expect_err(text).to_string();
            assert!(error.contains(text) && error.contains(remedy), "{error}");
        }
    }

    /// A quarter circle to the left becomes one to the right.
    #[test]
    fn a_yaw_of_the_wrong_sign_mirrors_the_path() {
        let wrong: Miswiring = "yaw-sign".parse().expect("valid");
        let start = Pose::default().moved(3.0, 1.0);
        let told = wrong.told(start.moved(1.0, 1.5), &start);
        let mirrored = start.moved(1.0, -1.5);
        assert!(told.distance_m(&mirrored) < 1e-12);
        assert!((told.yaw_rad - mirrored.yaw_rad).abs() < 1e-12);
    }

    #[test]
    fn millimetres_are_a_thousand_times_the_way() {
        let wrong: Miswiring = "millimetres".parse().expect("valid");
        let start = Pose::default().moved(3.0, 1.0);
        let told = wrong.told(start.moved(0.01, 0.0), &start);
        assert!((told.distance_m(&start) - 10.0).abs() < 1e-9);
    }
}
