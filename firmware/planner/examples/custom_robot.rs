//! Another robot: its hull, its speeds and its laser are parameters. A value out of range is an
//! error with a name and a range.
//!
//! ```console
//! $ cargo run --release -p fieldline-planner --example custom_robot
//! ```

mod world;

use core::error::Error;

use fieldline_planner::{Config, LaserMount, RobotShape};

fn run(shape: RobotShape) -> Result<u32, Box<dyn Error>> {
    let config = Config::builder(shape)
        .laser(LaserMount {
            range_limit_mm: 8_000,
            ..LaserMount::level(0.5 * shape.half_length_m, 0.2)
        })
        .max_speed(0.5, 1.5)
        .acceleration(0.5, 1.5)
        .build()?;
    Ok(world::explore(&config)?.1)
}

fn main() -> Result<(), Box<dyn Error>> {
    for (name, shape) in [
        ("round, 0.35 m", RobotShape::round(0.35, 0.3)),
        ("0.9 m x 0.6 m", RobotShape::rectangle(0.9, 0.6, 0.4)),
    ] {
        println!("{name}: explored after {} steps", run(shape)?);
    }
    if let Err(error) = run(RobotShape::round(1.4, 0.3)) {
        println!("round, 1.4 m: {error}");
    }
    Ok(())
}

#[test]
fn both_robots_explore_and_a_third_one_is_refused() {
    for shape in [
        RobotShape::round(0.35, 0.3),
        RobotShape::rectangle(0.9, 0.6, 0.4),
    ] {
        run(shape).expect("it explores");
    }
    let error = run(RobotShape::round(1.4, 0.3)).expect_err("too wide");
    assert!(error.to_string().starts_with("planning radius"), "{error}");
}
