//! The smallest host: scans and odometry in, a velocity out, until everything is explored. Then it
//! prints the map.
//!
//! ```console
//! $ cargo run --release -p fieldline-planner --example host_loop
//! ```

mod world;

use core::error::Error;

use fieldline_planner::{Config, F405, LaserMount, Planner, RobotShape};

/// Tiles around the start that the map is printed of: least and greatest column and row.
const TILES: core::ops::RangeInclusive<i16> = -2..=1;

/// Returns the map as text, a character a cell: `.` free, `#` obstacle, blank unknown.
fn drawn(planner: &Planner<F405>) -> String {
    let mut text = String::new();
    for row in TILES.rev() {
        let tiles: Vec<_> = TILES.map(|column| planner.tile(column, row)).collect();
        for y in (0..32).rev() {
            for tile in &tiles {
                // Four cells a byte, the least x in the lowest bits.
                let cell = |x: usize| tile.map_or(0, |tile| tile[8 * y + x / 4] >> (2 * (x % 4)));
                text.extend((0..32).map(|x| match cell(x) & 3 {
                    0 => ' ',
                    1 => '.',
                    _ => '#',
                }));
            }
            text.push('\n');
        }
    }
    text
}

fn run() -> Result<String, Box<dyn Error>> {
    let config = Config::builder(RobotShape::PIONEER_3AT)
        .laser(LaserMount::level(0.10, 0.40))
        .build()?;
    let (planner, steps) = world::explore(&config)?;
    Ok(format!("explored after {steps} steps\n{}", drawn(&planner)))
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("{}", run()?);
    Ok(())
}

#[test]
fn it_explores_and_draws_the_map() {
    let text = run().expect("it explores");
    let count = |kind: char| text.chars().filter(|&character| character == kind).count();
    // The world has 7.8 × 5 m inside, less its walls.
    assert!(count('.') > 3_000 && count('#') > 200, "{text}");
}
