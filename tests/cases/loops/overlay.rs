//! Knowledge of a strategy beyond the map is read over the link: pictures of a run are the same by
//! call and by bytes.

use fieldline_protocol::message::{Cost, Counters};
use fieldline_tests::loops::{OUROBOROS, TDBVP};
use fieldline_tests::worlds;
use host_sim::link::Link;
use host_sim::link::direct::Direct;
use host_sim::link::loopback::loopback;
use host_sim::trial::Record;
use host_sim::trial::mission::{Mission, explore};
use host_sim::trial::snapshot::Snapshot;

/// Pictures during a run.
const SNAPSHOTS: usize = 12;

fn run(strategy: &str, link: &mut dyn Link) -> Record {
    let mission = Mission {
        strategy: strategy.into(),
        snapshots: SNAPSHOTS,
        ..Mission::default()
    };
    let world = worlds::builtin("loop");
    let (report, record) = explore(&mission, &world, link, &mut ()).expect("the start is free");
    assert!(report.explored(), "{:?}", report.outcome);
    assert_eq!(report.loop_closing.is_some(), strategy == OUROBOROS);
    record
}

/// Returns the pictures of a run without what the link counts and measures.
fn shown(record: &Record) -> Vec<Snapshot> {
    let mut snapshots = record.snapshots.clone();
    for snapshot in &mut snapshots {
        let command = &mut snapshot.progress.command;
        (command.counters, command.cost) = (Counters::default(), Cost::default());
    }
    snapshots
}

/// Makes a run by call and by bytes, asserts that both have the same pictures, and returns the
/// first.
fn by_call(strategy: &str) -> Record {
    let (call, bytes) = (
        run(strategy, &mut Direct::new()),
        run(strategy, &mut loopback()),
    );
    assert_eq!(call.snapshots.len(), SNAPSHOTS);
    assert_eq!(shown(&call), shown(&bytes));
    assert_eq!(
        (&call.map, &call.planned_path),
        (&bytes.map, &bytes.planned_path)
    );
    call
}

#[test]
fn pictures_show_a_loop_being_closed_and_its_marks_later() {
    let record = by_call(OUROBOROS);
    let closing: Vec<_> = record
        .snapshots
        .iter()
        .filter(|snapshot| snapshot.progress.command.loops.closing)
        .collect();
    assert!(
        !closing.is_empty(),
        "no picture shows a loop that is being closed"
    );
    for snapshot in closing {
        let planned_path = &snapshot.planned_path;
        assert!(
            planned_path.shield.is_some() && planned_path.tractor.is_some(),
            "{planned_path:?}"
        );
        assert!(!planned_path.cells.is_empty());
    }
    for snapshot in &record.snapshots {
        let loops = snapshot.progress.command.loops;
        let map = &snapshot.map;
        assert_eq!(map.has_closed_regions(), loops.closed > 0, "{loops:?}");
        let is_over = map.has_closed_regions() || map.has_given_up_regions();
        assert_eq!(is_over, loops.closed + loops.given_up > 0, "{loops:?}");
    }
    let said = record.loop_closing();
    assert!(
        said.closed > 0 && said.closing_s > said.wasted_s,
        "{said:?}"
    );
    assert!(record.map.has_closed_regions());
    assert_eq!(
        record.map.visit_stamp_span(),
        None,
        "it keeps no account of visits"
    );
    // In some picture the path fills more than one page.
    assert!(
        record
            .snapshots
            .iter()
            .any(|snapshot| snapshot.planned_path.cells.len() > 32)
    );
}

#[test]
fn rails_have_ages_and_no_loops() {
    let record = by_call(TDBVP);
    let (oldest, newest) = record.map.visit_stamp_span().expect("rails were visited");
    assert!(oldest < newest);
    assert!(!record.map.has_closed_regions() && !record.map.has_given_up_regions());
    let planned_paths = record
        .snapshots
        .iter()
        .map(|snapshot| &snapshot.planned_path);
    assert!(
        planned_paths
            .clone()
            .all(|planned_path| planned_path.tractor.is_none() && planned_path.shield.is_none())
    );
}
