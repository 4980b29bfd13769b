//! One random mission, to see why it ends as it does:
//! `cargo run --release -p fieldline-tests --example mission -- SEED [calm]`.
//!
//! It prints what was drawn, the report of the way home, the mission's log, and the map around the
//! place where the robot ended. With `calm` nothing is reset or killed.
//!
//! ```text
//! ' ' unknown   . free   # obstacle   + the robot's way   @ its end      a cell is 10 cm
//! ```

use std::process::ExitCode;

use fieldline_tests::random_missions::Draw;
use host_sim::report::{MapCell, mission_log};
use host_sim::trial::Record;
use host_sim::world::World;

/// Cells of the map to each side of the robot's end.
const SIDE: [i32; 2] = [45, 25];

fn main() -> ExitCode {
    let mut args = std::env::args().skip(1);
    let Some(seed) = args.next().and_then(|it| it.parse().ok()) else {
        eprintln!("give the seed of a mission, as in: --example mission -- 27 calm");
        return ExitCode::FAILURE;
    };
    let is_calm = args.next().is_some_and(|it| it == "calm");
    let draw = Draw::new(seed);
    println!("{draw:#?}");
    let world = match World::open(&draw.world) {
        Ok(world) => world,
        Err(error) => {
            eprintln!("{error}");
            return ExitCode::FAILURE;
        }
    };
    let (report, record) = if is_calm {
        draw.undisturbed(&world)
    } else {
        let (report, record, _) = draw.disturbed(&world);
        (report, record)
    };
    println!("{:#?}\n{:#?}", report.outcome, report.trips);
    let steps = record.steps.iter();
    let entries = mission_log::entries(steps.map(|step| (&step.estimate, &step.command)));
    print!("{}", mission_log::text(&entries));
    print_map(&record);
    ExitCode::SUCCESS
}

fn print_map(record: &Record) {
    let cell = |metres: f64| (10.0 * metres).floor() as i32;
    let steps = record.steps.iter();
    let way: Vec<[i32; 2]> = steps
        .map(|step| [cell(step.estimate.x_m), cell(step.estimate.y_m)])
        .collect();
    let Some(&[x, y]) = way.last() else {
        return;
    };
    let drawn = |at: [i32; 2]| match record.map.get(at[0], at[1]) {
        _ if at == [x, y] => '@',
        _ if way.contains(&at) => '+',
        MapCell::Unknown => ' ',
        MapCell::Free => '.',
        MapCell::Obstacle | MapCell::NegativeObstacle => '#',
    };
    let [across, up] = SIDE;
    for y in (y - up..=y + up).rev() {
        let line: String = (x - across..=x + across).map(|x| drawn([x, y])).collect();
        println!("{}", line.trim_end());
    }
}
