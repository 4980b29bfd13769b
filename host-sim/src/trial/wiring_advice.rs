//! What to look at when a robot is wired wrongly, for each mistake that the device tells.

use fieldline_protocol::message::Mistake;

const SCAN_MIRRORED: &str = "\
    the scan turns against the odometry: is it mirrored? set clockwise or upside_down of the \
    lidar in the robot file";
const LASER_TURNED_LEFT: &str = "\
    the laser looks 90 degrees to the left of where its mount says: correct its yaw by 90, or \
    the first angle; with two lasers, are they swapped?";
const LASER_TURNED_BACK: &str = "\
    the laser looks backwards: correct its yaw by 180, or the first angle; with two lasers, are \
    they swapped?";
const LASER_TURNED_RIGHT: &str = "\
    the laser looks 90 degrees to the right of where its mount says: correct its yaw by -90, or \
    the first angle; with two lasers, are they swapped?";
const SCAN_STANDS: &str = "\
    the scan does not change while the odometry moves: does the driver repeat an old scan, are \
    two lasers swapped, do the wheels spin?";
const YAW_REVERSED: &str = "\
    the odometry turns against the command and the scan: the yaw must grow when the robot turns \
    left; change its sign";
const WAY_REVERSED: &str = "\
    the odometry drives against the command and the scan: change the sign of its distance";
const TURNS_REVERSED: &str = "\
    the robot turns against the command: are the left and the right motor swapped, or is the \
    sign of the yaw wrong?";
const DRIVE_REVERSED: &str = "\
    the robot drives against the command: are the motors reversed, or is the sign of the \
    distance wrong?";
const WAY_TOO_LONG: &str = "\
    the odometry counts a longer way than the robot drives: are millimetres given as metres, or \
    are wheel radius and ticks a turn too great?";
const WAY_TOO_SHORT: &str = "\
    the odometry counts a shorter way than the robot drives: are its units metres, are both \
    encoders plugged in, are wheel radius and ticks a turn right?";
const TURN_TOO_GREAT: &str = "\
    the odometry counts a greater turn than the robot makes: is the yaw in radians, is the track \
    too small?";
const TURN_TOO_SMALL: &str = "\
    the odometry counts a smaller turn than the robot makes: is the yaw in radians, is the track \
    too great?";
const RANGES_TOO_SHORT: &str = "\
    every range is a few millimetres: are metres given as millimetres, or does something cover \
    the lidar?";
const LASERS_SWAPPED: &str = "\
    the level laser sees the ground that the tilted one should see: swap the two scans";
const CLOCK_STANDS: &str = "\
    the time of the observations stands: give milliseconds of a clock that goes on";
const CLOCK_FAST: &str = "\
    the time of the observations runs 50 times too fast or more: give milliseconds, not \
    microseconds";

/// Returns what contradicts what, and what to look at.
#[must_use]
pub const fn wiring_advice(mistake: Mistake) -> &'static str {
    match mistake {
        Mistake::ScanMirrored => SCAN_MIRRORED,
        Mistake::LaserTurnedLeft => LASER_TURNED_LEFT,
        Mistake::LaserTurnedBack => LASER_TURNED_BACK,
        Mistake::LaserTurnedRight => LASER_TURNED_RIGHT,
        Mistake::ScanStands => SCAN_STANDS,
        Mistake::YawReversed => YAW_REVERSED,
        Mistake::WayReversed => WAY_REVERSED,
        Mistake::TurnsReversed => TURNS_REVERSED,
        Mistake::DriveReversed => DRIVE_REVERSED,
        Mistake::WayTooLong => WAY_TOO_LONG,
        Mistake::WayTooShort => WAY_TOO_SHORT,
        Mistake::TurnTooGreat => TURN_TOO_GREAT,
        Mistake::TurnTooSmall => TURN_TOO_SMALL,
        Mistake::RangesTooShort => RANGES_TOO_SHORT,
        Mistake::LasersSwapped => LASERS_SWAPPED,
        Mistake::ClockStands => CLOCK_STANDS,
        Mistake::ClockFast => CLOCK_FAST,
    }
}
