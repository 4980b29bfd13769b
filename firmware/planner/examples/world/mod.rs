//! A small flat world for the examples: walls drawn as text, one level scanner, a robot that drives
//! exactly what it is told.
//!
//! Units: metres, radians; a character is 0.2 × 0.2 m.

use fieldline_planner::{
    Config, F405, Finish, Input, LaserMount, NO_RETURN_MM, Planner, Pose, Status, Twist,
};

/// Two rooms, a corridor and a hall; `#` is a wall.
const PICTURE: [&str; 26] = [
    "########################################",
    "#..................#...................#",
    "#..................#...................#",
    "#..................#...................#",
    "#..................#...................#",
    "#..................#...................#",
    "#..................#.........##........#",
    "#..................#.........##........#",
    "#..................#...................#",
    "#..................#...................#",
    "#..................#...................#",
    "########.....################......#####",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "############......######################",
    "#......................................#",
    "#......................................#",
    "#......................................#",
    "#.............................##.......#",
    "#.............................##.......#",
    "#......................................#",
    "#......................................#",
    "########################################",
];
/// Side of a character.
const SIDE_M: f32 = 0.2;
/// The robot's start in the world: in the corridor, heading east.
const START_M: (f32, f32) = (4.0, 2.3);
/// Steps after which a run ends.
const MAX_STEPS: u32 = 5_000;

/// Returns true if a point lies in a wall. The planner counts from the start.
fn is_wall(x_m: f32, y_m: f32) -> bool {
    let column = ((x_m + START_M.0) / SIDE_M).floor();
    let row = PICTURE.len() as f32 - 1.0 - ((y_m + START_M.1) / SIDE_M).floor();
    let row = PICTURE.get(row as usize).filter(|_| row >= 0.0);
    let character = row.and_then(|row| row.as_bytes().get(column as usize));
    column < 0.0 || character.is_none_or(|&character| character == b'#')
}

/// Returns the ranges of a level scanner, millimetres.
fn scan(pose: &Pose, laser: &LaserMount) -> Vec<u16> {
    let (sin, cos) = pose.yaw_rad.sin_cos();
    let (x_m, y_m) = (pose.x_m + laser.x_m * cos, pose.y_m + laser.x_m * sin);
    let range_mm = |beam: u16| {
        let bearing = laser.first_bearing_rad + f32::from(beam) * laser.bearing_step_rad;
        let (sin, cos) = (pose.yaw_rad + bearing).sin_cos();
        (20..laser.range_limit_mm)
            .step_by(10)
            .find(|&mm| {
                let range_m = f32::from(mm) / 1000.0;
                is_wall(x_m + range_m * cos, y_m + range_m * sin)
            })
            .unwrap_or(NO_RETURN_MM)
    };
    (0..laser.beams).map(range_mm).collect()
}

/// Explores the world. Returns the planner and the number of steps.
///
/// # Errors
/// The status, if it is not "explored" in the end.
pub(crate) fn explore(config: &Config) -> Result<(Box<Planner<F405>>, u32), String> {
    let mut planner = Box::new(Planner::<F405>::new(config));
    let (mut pose, mut velocity) = (Pose::default(), Twist::default());
    let period_s = config.period_s();
    for step in 0..MAX_STEPS {
        let ranges_mm = scan(&pose, &config.lasers()[0]);
        let output = planner.step(&Input {
            time_ms: (step as f32 * period_s * 1000.0) as u32,
            pose,
            velocity,
            scans: [&ranges_mm, &[]],
        });
        match output.status {
            Status::Exploring => {}
            Status::Finished(Finish::Explored) => return Ok((planner, step)),
            status => return Err(status.to_string()),
        }
        velocity = output.velocity;
        pose.yaw_rad += velocity.angular_radps * period_s;
        pose.x_m += velocity.linear_mps * period_s * pose.yaw_rad.cos();
        pose.y_m += velocity.linear_mps * period_s * pose.yaw_rad.sin();
    }
    Err(format!("not explored after {MAX_STEPS} steps"))
}
