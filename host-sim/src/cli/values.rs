//! Values of arguments: parsed from text, checked against their ranges.

use core::time::Duration;

use fieldline_protocol::message::UnevenGround;
use host_sim::known_map::pose_of;
use host_sim::robot::Limits;
use host_sim::slam::SlamPlace;
use host_sim::spec::{self, SpecError};
use host_sim::trial::itinerary::Pause;
use host_sim::trial::space::Area;
use host_sim::trial::uneven;
use host_sim::world::Start;

use super::args::Impatience;
use super::live::LiveArg;

/// Most pictures during a run. Each is read over the link and held until the end.
const MOST_SNAPSHOTS: u64 = 500;

/// Most sweeps of a step. A minute of the simulated robot then takes hours.
const MOST_SWEEPS: u16 = 10_000;

/// Parses a number without sign or point, at most `most`.
fn whole(text: &str, most: u64) -> Result<u64, String> {
    let number = text.parse().ok().filter(|number| *number <= most);
    number.ok_or_else(|| format!("give a whole number from 0 to {most}"))
}

/// Parses a seed.
pub(super) fn seed(text: &str) -> Result<u64, String> {
    whole(text, u64::MAX)
}

/// Parses where loops are closed.
pub(super) fn slam_place(text: &str) -> Result<SlamPlace, SpecError> {
    let places = [("off", SlamPlace::Off), ("host", SlamPlace::Host)];
    spec::choice("place", text, places)
}

/// Parses the index of a start.
pub(super) fn start(text: &str) -> Result<usize, String> {
    whole(text, u64::from(u16::MAX)).map(|number| number as usize)
}

/// Parses seconds to wait for a board.
pub(super) fn wait(text: &str) -> Result<Duration, String> {
    whole(text, 600).map(Duration::from_secs)
}

/// Parses where a live page is.
pub(super) fn live(text: &str) -> Result<LiveArg, String> {
    match text {
        "usual" => Ok(LiveArg(None)),
        _ => text
            .parse()
            .map(|address| LiveArg(Some(address)))
            .map_err(|_| {
                "give an address and a port, as 127.0.0.1:8047, or nothing; a world stands before \
             --live"
                    .into()
            }),
    }
}

/// Parses a number of people.
pub(super) fn people(text: &str) -> Result<usize, String> {
    whole(text, host_sim::people::MOST as u64).map(|number| number as usize)
}

/// Parses seconds of patrol.
pub(super) fn patrol_for(text: &str) -> Result<u16, String> {
    whole(text, u64::from(u16::MAX)).map(|number| number as u16)
}

/// Parses an area.
pub(super) fn area(text: &str) -> Result<Area, String> {
    match spec::numbers(text).as_deref() {
        Some(&[x, y, width, height])
            if x.abs().max(y.abs()) <= 3_200.0
                && (0.1..=128.0).contains(&width)
                && (0.1..=128.0).contains(&height) =>
        {
            Ok([x, y, width, height])
        }
        _ => Err("give x,y,width,height in metres, with sides of 0.1 to 128".into()),
    }
}

/// Parses what a robot may drive, metres or seconds.
pub(super) fn budget(text: &str) -> Result<u16, String> {
    let number = text.parse().ok().filter(|number| *number > 0);
    number.ok_or_else(|| "give a whole number from 1 to 65535".into())
}

/// Parses seconds from 0 on; returns milliseconds.
pub(super) fn home_at(text: &str) -> Result<u32, String> {
    match text.parse::<f64>() {
        Ok(seconds) if (0.0..=4e6).contains(&seconds) => Ok((seconds * 1000.0).round() as u32),
        _ => Err("give simulated seconds, 0 to 4000000".into()),
    }
}

/// Parses a pause.
pub(super) fn pause(text: &str) -> Result<Pause, String> {
    let parts = text.split_once('-');
    let times = parts.and_then(|(from, to)| Some((home_at(from).ok()?, home_at(to).ok()?)));
    match times {
        Some((from_ms, to_ms)) if from_ms < to_ms => Ok(Pause { from_ms, to_ms }),
        _ => Err("give from-to in simulated seconds, as in 60-80".into()),
    }
}

/// Parses a place.
pub(super) fn place(text: &str) -> Result<[f64; 2], String> {
    match spec::numbers(text).as_deref() {
        Some(&[x, y]) if x.abs().max(y.abs()) <= 3_200.0 => Ok([x, y]),
        _ => Err("give x,y in metres, within 3200 m; several with ; between".into()),
    }
}

/// Parses where a robot stands in a known map.
pub(super) fn known_pose(text: &str) -> Result<Start, String> {
    let numbers = spec::numbers(text);
    let numbers = numbers.as_deref().map(<[f64; 3]>::try_from);
    match numbers {
        Some(Ok(numbers)) => pose_of(numbers),
        _ => None,
    }
    .ok_or_else(|| "give x,y,degrees: metres within 3200, degrees within 360".into())
}

/// Parses a share; returns thousandths.
pub(super) fn until(text: &str) -> Result<u16, String> {
    match text.parse::<f64>() {
        Ok(share) if (0.001..=1.0).contains(&share) => Ok((share * 1000.0).round() as u16),
        _ => Err("give a share from 0.001 to 1".into()),
    }
}

/// Parses seconds without a new place.
pub(super) fn impatience(text: &str) -> Result<Impatience, String> {
    if text == "never" {
        return Ok(Impatience(None));
    }
    let seconds = whole(text, u64::from(u16::MAX)).map_err(|error| format!("{error}, or never"))?;
    Ok(Impatience(Some(seconds as u16)))
}

/// Parses a number of sweeps.
pub(super) fn sweeps(text: &str) -> Result<u16, String> {
    let number = text.parse().ok();
    let number = number.filter(|number| (1..=MOST_SWEEPS).contains(number));
    number.ok_or_else(|| format!("give a whole number from 1 to {MOST_SWEEPS}"))
}

/// Parses a period, milliseconds: what the device takes.
pub(super) fn period(text: &str) -> Result<u16, String> {
    let number = text.parse().ok().filter(|it| (100..=400).contains(it));
    number.ok_or_else(|| "give whole milliseconds from 100 to 400".into())
}

/// Parses a number of pictures.
pub(super) fn snapshots(text: &str) -> Result<usize, String> {
    whole(text, MOST_SNAPSHOTS).map(|number| number as usize)
}

/// Parses seconds; returns milliseconds.
pub(super) fn time_limit(text: &str) -> Result<u32, String> {
    match text.parse::<f64>() {
        Ok(seconds) if seconds > 0.0 && seconds <= 4e6 => Ok((seconds * 1000.0).ceil() as u32),
        _ => Err("give simulated seconds above 0, at most 4000000".into()),
    }
}

/// Parses changes of the usual working limits.
pub(super) fn working(text: &str) -> Result<Limits, SpecError> {
    Limits::WORKING.changed(text)
}

/// Parses changes of the usual failing limits.
pub(super) fn failing(text: &str) -> Result<Limits, SpecError> {
    Limits::FAILING.changed(text)
}

/// Parses changes of the usual parameters.
pub(super) fn ground_parameters(text: &str) -> Result<UnevenGround, SpecError> {
    uneven::changed(uneven::TABLE_I, text)
}

/// Parses degrees.
pub(super) fn imu_noise(text: &str) -> Result<f64, String> {
    deviation(text, 20.0, "degrees")
}

/// Parses metres.
pub(super) fn laser_noise(text: &str) -> Result<f64, String> {
    deviation(text, 1.0, "metres")
}

fn deviation(text: &str, most: f64, unit: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.0..=most).contains(&number) => Ok(number),
        _ => Err(format!("give {unit} from 0 to {most}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quantities_are_checked() {
        assert_eq!(time_limit("1.5"), Ok(1_500));
        for bad in ["0", "-3", "nan", "inf", "soon", "1e9"] {
            assert!(time_limit(bad).is_err(), "{bad}");
        }
        assert_eq!(imu_noise("1.5"), Ok(1.5));
        assert!(imu_noise("21").is_err() && laser_noise("-0.1").is_err());
        assert!(laser_noise("nan").is_err() && laser_noise("x").is_err());
        assert_eq!(impatience("never"), Ok(Impatience(None)));
        assert_eq!(impatience("60"), Ok(Impatience(Some(60))));
        assert!(impatience("65536").is_err() && impatience("ever").is_err());
        assert_eq!((until("0.9"), until("1")), (Ok(900), Ok(1_000)));
        assert!(until("0").is_err() && until("1.1").is_err() && until("all").is_err());
        assert_eq!(area("-1,0.5, 10,8"), Ok([-1.0, 0.5, 10.0, 8.0]));
        for bad in [
            "0,0,10",
            "0,0,10,x",
            "0,0,0,8",
            "0,0,10,129",
            "9999,0,10,8",
            "0,0,nan,8",
        ] {
            assert!(area(bad).is_err(), "{bad}");
        }
        assert_eq!(known_pose("1,-2,180").map(|it| it.x_m), Ok(1.0));
        for bad in ["1,2", "1,2,3,4", "1,2,361", "4000,0,0", "1,2,nan", "x"] {
            assert!(known_pose(bad).is_err(), "{bad}");
        }
        assert_eq!((home_at("0"), home_at("90.5")), (Ok(0), Ok(90_500)));
        assert!(home_at("-1").is_err() && home_at("nan").is_err() && home_at("5e6").is_err());
        let (from_ms, to_ms) = (60_000, 80_500);
        assert_eq!(pause("60-80.5"), Ok(Pause { from_ms, to_ms }));
        assert!(pause("60").is_err() && pause("80-60").is_err() && pause("5-5").is_err());
        assert_eq!((snapshots("0"), snapshots("500")), (Ok(0), Ok(500)));
        assert_eq!((sweeps("1"), sweeps("10000")), (Ok(1), Ok(10_000)));
        assert!(sweeps("0").is_err() && sweeps("10001").is_err() && sweeps("-1").is_err());
        assert!(snapshots("501").is_err() && snapshots("-1").is_err());
    }
}
