//! Patrols of the nested loops: every rail is visited again and again, and the field at the robot
//! is never flat \[Maffei14, IV\]. True odometry.
//!
//! `golden/patrol.txt` has two starts, `patrol-full.txt` all 15. A rail's age is judged on the true
//! path (`host_sim::metrics::patrol`). The window's field is read after every step that solved one.
//! It is *flat* if the robot's cell has no slope in it. A step that solves no field uses the field
//! before. A step without a command is *still*.

use fieldline_protocol::message::{Command, Observation, Status};
use fieldline_tests::digests::Digest;
use fieldline_tests::loops::TDBVP;
use fieldline_tests::runs::{self, in_parallel};
use fieldline_tests::table::{Table, number};
use fieldline_tests::watched::Watched;
use fieldline_tests::{golden, worlds};
use host_sim::link::direct::Direct;
use host_sim::link::{Link, LinkError};
use host_sim::report::Report;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::{Step, oracle, snapshot};

/// World of all patrols.
const WORLD: &str = "tdbvp-nested";
/// Least share known before the patrol.
const LEAST_COVERAGE: f64 = 0.995;
/// Length of a patrol, seconds.
const PATROL_S: u16 = 1800;
/// Time of the shortest tour of all centre lines at 0.5 m/s: both loops once, 88 m and 48 m, and
/// the 4 m between them twice.
const TOUR_S: f64 = (88.0 + 48.0 + 2.0 * 4.0) / 0.5;
/// Most tours that a rail waits: one until it is overdue, and half a tour for the way there.
const MOST_TOURS: f64 = 1.5;
/// Most steps in a row without a command: the instalments of a search.
const MOST_STILL: usize = 5;
/// Steps of a second.
const STEPS_PER_S: usize = 5;

/// Returns true if the field solved in a step is flat at the robot; `None` if none was solved.
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

/// The result of a patrol.
struct Patrol {
    start: usize,
    report: Report,
    /// Steps that solved a field.
    solved: usize,
    /// Fields that were flat at the robot.
    flat: usize,
    /// Most steps in a row without a command.
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
    let run = explore(&mission, &world, &mut link, &mut ());
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
    ];
    let mut table = Table::new(0, &head);
    for patrol in patrols {
        let (report, ages) = (&patrol.report, patrol.report.patrol);
        let explored_s = report.sim_time_s - f64::from(PATROL_S);
        table.row(vec![
            patrol.start.to_string(),
            number(Some(explored_s), 1),
            number(ages.map(|ages| ages.max_rail_age_s), 1),
            number(ages.map(|ages| ages.max_rail_age_s / TOUR_S), 2),
            number(ages.map(|ages| ages.mean_rail_age_s), 1),
            report.safety.collisions.to_string(),
            patrol.solved.to_string(),
            patrol.flat.to_string(),
            patrol.still.to_string(),
        ]);
    }
    table
}

fn faults(patrol: &Patrol) -> Vec<String> {
    let mut faults = runs::faults(&patrol.report, LEAST_COVERAGE);
    match patrol.report.patrol {
        None => faults.push("did not reach its end".into()),
        Some(ages) if ages.max_rail_age_s > MOST_TOURS * TOUR_S => {
            faults.push(format!("a rail waited for {} s", ages.max_rail_age_s));
        }
        Some(ages) if ages.mean_rail_age_s >= TOUR_S => {
            faults.push(format!(
                "rails wait for {} s in the mean",
                ages.mean_rail_age_s
            ));
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
    let settings = format!("patrol={PATROL_S}s");
    let digest = |patrol: &Patrol| Digest::of(&patrol.report, &settings);
    let digests: Vec<Digest> = patrols.iter().map(digest).collect();
    golden::compare_runs(name, &text, &digests);
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

/// Compares patrols from all starts with golden table `name`.
pub(crate) fn check_every_start(name: &str) {
    check(name, worlds::builtin(WORLD).starts().len());
}

#[test]
fn a_patrol_visits_every_rail_again_and_again() {
    check("patrol", 2);
}
