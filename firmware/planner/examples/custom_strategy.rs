//! A strategy of one's own: a function that gives each goal a level. A goal counts as 10 m farther
//! away for each level, so this robot drives to the largest frontier first.
//!
//! ```console
//! $ cargo run --release -p fieldline-planner --example custom_strategy
//! ```

mod world;

use core::error::Error;

use fieldline_planner::{Config, Goal, GoalLevel, LaserMount, RobotShape};

/// Returns 0 for a frontier of at least 64 coarse cells, 12.8 m, and up to 7 for smaller ones.
fn largest_first(goal: &Goal) -> u8 {
    ((Goal::MAX_CELLS - goal.cells) / 8) as u8
}

fn run(order: Option<GoalLevel>) -> Result<u32, Box<dyn Error>> {
    let mut builder = Config::builder(RobotShape::PIONEER_3AT).laser(LaserMount::level(0.10, 0.40));
    if let Some(order) = order {
        builder = builder.goal_level(order);
    }
    Ok(world::explore(&builder.build()?)?.1)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("nearest frontier: explored after {} steps", run(None)?);
    println!(
        "largest frontier: explored after {} steps",
        run(Some(largest_first))?
    );
    Ok(())
}

#[test]
fn the_order_changes_the_drive_and_both_explore() {
    let nearest = run(None).expect("it explores");
    let largest = run(Some(largest_first)).expect("it explores");
    assert_ne!(nearest, largest);
}
