//! Robots meet where there is no room to pass: in a corridor, in a dead end, and at a door, from
//! two sides or from one. `golden/meetings.txt` has ten meetings of each kind,
//! `golden/meetings-full.txt` a hundred.

use core::ops::Range;

use fieldline_tests::golden;
use fieldline_tests::meetings::{ALL, Meeting, Narrow, summary, table};
use fieldline_tests::runs::in_parallel;

/// Lets robots meet with every seed. Nobody touches anything, nobody is blocked for good, and in
/// seven of ten runs the robots really meet.
fn meet(file: &str, seeds: Range<u64>) {
    let kinds = ALL.into_iter();
    let all: Vec<(Narrow, u64)> = kinds
        .flat_map(|kind| seeds.clone().map(move |seed| (kind, seed)))
        .collect();
    let meetings = in_parallel(&all, |&(kind, seed)| Meeting::of(kind, seed));
    let text = format!(
        "Seeds {seeds:?}.\n\n{}\nEvery meeting.\n\n{}",
        summary(&meetings),
        table(&meetings)
    );
    golden::compare(file, &text);
    for meeting in &meetings {
        let what = format!("{}, seed {}", meeting.narrow.name(), meeting.seed);
        assert_eq!(meeting.touches(), (0, 0), "{what}: robots, walls");
        assert!(!meeting.is_blocked(), "{what}");
    }
    for same in meetings.chunk_by(|a, b| a.narrow == b.narrow) {
        let met = same.iter().filter(|meeting| meeting.has_met()).count();
        assert!(
            10 * met >= 7 * same.len(),
            "{}: {met}",
            same[0].narrow.name()
        );
    }
}

#[test]
fn ten_meetings_of_each_kind_end_without_touch_or_block() {
    meet("meetings.txt", 0..10);
}

mod full {
    #[test]
    #[ignore = "takes minutes: 400 runs of two and three robots; tests/run --full runs it"]
    fn a_hundred_meetings_of_each_kind_end_without_touch_or_block() {
        super::meet("meetings-full.txt", 0..100);
    }
}
