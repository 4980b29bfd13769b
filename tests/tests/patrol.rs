//! Patrols of the nested loops: no rail is forgotten, and the field at the robot is never flat [TDBVP, IV]; true odometry, a golden table.
//!
//! `golden/patrol.txt` has two starts, `patrol-full.txt` (`tests/run --full`) all 15. A rail's age is judged on the true path
//! (`host_sim::metrics::patrol`). The window's field is read after every step in which one was solved; *flat* means that the robot's cell
//! has no slope there. A step that solves none goes on by the field before; a step without a command is *still*.

use fieldline_protocol::message::{Command, Observation, Status};
use fieldline_tests::loops::TDBVP;
use fieldline_tests::runs::{self, Unseen, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::watched::Watched;
use fieldline_tests::{full, golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::link::{Link, LinkError};
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::{Step, oracle, snapshot};

const WORLD: &str = "tdbvp-nested";
const LEAST_COVERAGE: f64 = 0.995;
/// Seconds of patrol. The shortest tour of the centre lines, as a postman would go: both loops once, 88 m and 48 m, and the way of 4 m between
/// their lines twice, at half a metre a second.
const PATROL_S: u16 = 1800;
const TOUR_S: f64 = (88.0 + 48.0 + 2.0 * 4.0) / 0.5;
/// No rail waits for longer than so many tours: one until it is overdue, and the way there.
const MOST_TOURS: f64 = 1.5;
/// Steps in a row without a command: the instalments of a search.
const MOST_STILL: usize = 5;
const STEPS_PER_S: usize = 5;

/// Whether the field solved in a step is flat at the robot; nothing where none was solved.
fn is_flat(
    link: &mut dyn Link,
    observation: &Observation,
    command: &Command,
) -> Result<Option<bool>, LinkError> {
    if command.status != Status::Exploring || command.cost.cycles == 0 {
        return Ok(None);
    }
    let window = snapshot::window(link)?;
    Ok(window.map(|window| {
        let q: Vec<f64> = window.q.iter().map(|&q| f64::from(q)).collect();
        let place = |at: f64, origin: i32| at / window.cell_m - f64::from(origin);
        let x = place(observation.pose.x.to_num(), window.origin_x);
        let y = place(observation.pose.y.to_num(), window.origin_y);
        oracle::heading_at(&q, x, y).is_none()
    }))
}

/// A patrol from one start.
struct Patrol {
    start: usize,
    report: Report,
    solved: usize,
    flat: usize,
    /// The longest time without a command, steps.
    still: usize,
}

fn patrol(start: usize) -> Patrol {
    let mission = Mission {
        strategy: TDBVP.into(),
        patrol_s: PATROL_S,
        start,
        ..Mission::default()
    };
    let mut flat = Vec::new();
    let mut link = Watched::new(Direct::new(), |link, observation, command| {
        flat.push(is_flat(link, observation, command)?);
        Ok(())
    });
    let world = worlds::builtin(WORLD);
    let run = explore(&mission, &world, &mut link, &mut Unseen);
    let (report, record) = run.expect("the start is free");
    let steps = usize::from(PATROL_S) * STEPS_PER_S;
    let flat = &flat[flat.len().saturating_sub(steps)..];
    let is_still = |step: &Step| step.command.velocity == Default::default();
    let last = &record.steps[record.steps.len().saturating_sub(steps)..];
    let groups = last.chunk_by(|a, b| is_still(a) == is_still(b));
    let still = groups.filter(|steps| is_still(&steps[0])).map(<[_]>::len);
    Patrol {
        start,
        report,
        solved: flat.iter().flatten().count(),
        flat: flat.iter().filter(|flat| **flat == Some(true)).count(),
        still: still.max().unwrap_or(0),
    }
}

fn table(patrols: &[Patrol]) -> Table {
    let head = [
        "start",
        "explored s",
        "oldest rail s",
        "in tours",
        "mean age s",
        "hits",
        "fields",
        "flat",
        "still steps",
        "digest",
    ];
    let mut table = Table::new(0, &head);
    for patrol in patrols {
        let (report, ages) = (&patrol.report, patrol.report.patrol);
        let explored_s = report.sim_time_s - f64::from(PATROL_S);
        table.row(vec![
            patrol.start.to_string(),
            number(Some(explored_s), 1),
            number(ages.map(|ages| ages.oldest_rail_s), 1),
            number(ages.map(|ages| ages.oldest_rail_s / TOUR_S), 2),
            number(ages.map(|ages| ages.mean_age_s), 1),
            report.safety.collisions.to_string(),
            patrol.solved.to_string(),
            patrol.flat.to_string(),
            patrol.still.to_string(),
            report.digest.chars().take(8).collect(),
        ]);
    }
    table
}

fn faults(patrol: &Patrol) -> Vec<String> {
    let mut faults = runs::faults(&patrol.report, LEAST_COVERAGE);
    match patrol.report.patrol {
        None => faults.push("did not come to its end".into()),
        Some(ages) if ages.oldest_rail_s > MOST_TOURS * TOUR_S => {
            faults.push(format!("a rail waited for {} s", ages.oldest_rail_s));
        }
        Some(ages) if ages.mean_age_s >= TOUR_S => {
            faults.push(format!("rails wait for {} s in the mean", ages.mean_age_s));
        }
        Some(_) => {}
    }
    if patrol.solved == 0 || patrol.flat > 0 {
        faults.push(format!("{} of {} flat", patrol.flat, patrol.solved));
    }
    if patrol.still > MOST_STILL {
        faults.push(format!("stood for {} steps", patrol.still));
    }
    faults
}

fn check(name: &str, starts: usize) {
    let starts: Vec<usize> = (0..starts).collect();
    let patrols = in_parallel(&starts, |&start| patrol(start));
    let text = format!("A tour takes {TOUR_S} s.\n\n{}", table(&patrols));
    golden::compare(name, &text);
    let wrong: Vec<String> = patrols
        .iter()
        .flat_map(|patrol| {
            let start = patrol.start;
            faults(patrol)
                .into_iter()
                .map(move |fault| format!("start {start}: {fault}"))
        })
        .collect();
    assert!(wrong.is_empty(), "\n{}", wrong.join("\n"));
}

#[test]
fn a_patrol_comes_to_every_rail_again_and_again() {
    check("patrol.txt", 2);
}

#[test]
fn a_patrol_from_every_start_does() {
    if !full() {
        return println!("skipped: FIELDLINE_FULL=1 or tests/run --full asks for it");
    }
    check("patrol-full.txt", worlds::builtin(WORLD).starts().len());
}
