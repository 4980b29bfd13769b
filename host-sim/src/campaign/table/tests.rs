use super::{Figures, table};
use crate::campaign::store::Finished;
use crate::campaign::store::tests::{all, plan};
use crate::campaign::{csv, markdown};

#[test]
fn figures_and_differences_are_those_of_the_trials() {
    let mut plan = plan();
    plan.columns = vec![
        "sim_time_s".into(),
        "outcome.reason".into(),
        "trial.explored".into(),
    ];
    let table = table(&plan, &all());
    let titles: Vec<&str> = table
        .groups
        .iter()
        .map(|group| group.title.as_str())
        .collect();
    assert_eq!(titles, ["office", "cave", "all together"]);
    // Office: frontier 100, 110, 120; ouroboros 130, 140, 150.
    let [frontier, ouroboros] = &table.groups[0].entries[..] else {
        panic!("two strategies");
    };
    let Figures::Numbers(times) = &frontier.figures[0] else {
        panic!("numbers");
    };
    assert_eq!((times.n, times.mean, times.sd), (3, 110.0, Some(10.0)));
    assert_eq!(
        frontier.figures[1],
        Figures::Texts(vec![("explored".into(), 3)])
    );
    assert_eq!(frontier.figures[2], Figures::Share([3, 3]));
    assert!(frontier.differences.is_empty());
    let difference = ouroboros.differences[0].unwrap();
    assert!((difference.percent.unwrap() - 100.0 * 30.0 / 110.0).abs() < 1e-12);
    // All three of one sample above all three of the other: 2 / C(6, 3).
    assert_eq!(difference.rank_sum.unwrap().p, 0.1);
    // Three equal pairs of one sign: 2 / 2³.
    assert_eq!((difference.pairs, difference.signed_rank.p()), (3, 0.25));
    assert!((difference.signs.p - 0.25).abs() < 1e-12);
    assert_eq!(ouroboros.differences[1], None, "texts have no difference");
    let together = table.groups[2].entries[1].differences[0].unwrap();
    assert_eq!((together.pairs, together.rank_sum), (6, None));
    assert_eq!(together.signed_rank.p(), 2.0 / 64.0);
}

#[test]
fn a_failed_trial_is_counted_and_its_pair_is_left_out() {
    let mut plan = plan();
    plan.columns = vec!["sim_time_s".into()];
    let mut finished = all();
    finished[4] = Finished::failed(&plan.trials()[4], "panicked at x: y".into());
    let table = table(&plan, &finished);
    let entry = &table.groups[0].entries[1];
    assert_eq!((entry.trials, entry.failed), (3, 1));
    assert_eq!(entry.differences[0].unwrap().pairs, 2);
    let text = markdown::text(&table, &plan);
    assert!(
        text.contains("3 (1 failed)") && text.contains("(2)"),
        "{text}"
    );
    assert!(
        text.contains("## Failed trials") && text.contains("panicked at x: y"),
        "{text}"
    );
}

#[test]
fn the_order_of_the_lines_changes_nothing() {
    let mut lines = all();
    let texts = |lines: &[Finished]| {
        let table = table(&plan(), lines);
        (markdown::text(&table, &plan()), csv::text(&table))
    };
    let in_order = texts(&lines);
    lines.rotate_left(5);
    lines.swap(0, 3);
    assert_eq!(texts(&lines), in_order);
}

#[test]
fn the_csv_has_a_line_for_each_group_strategy_and_column() {
    let table = table(&plan(), &all());
    let text = csv::text(&table);
    let lines: Vec<&str> = text.lines().collect();
    assert_eq!(lines.len(), 1 + 3 * 2 * table.columns.len());
    let time = lines
        .iter()
        .find(|line| line.starts_with("office,,ouroboros,sim_time_s"));
    let wanted = "office,,ouroboros,sim_time_s,3,0,3,140,10,130,135,140,145,150,,frontier,\
                  27.272727272727273,9,0.1,3,6,0.25,3,0,0.2";
    assert!(time.unwrap().starts_with(wanted), "{time:?}");
}

#[test]
fn without_a_baseline_and_without_trials_there_is_still_a_table() {
    let mut plan = plan();
    plan.baseline = None;
    let table = table(&plan, &[]);
    let text = markdown::text(&table, &plan);
    assert!(
        text.contains("0 of 12 trials") && text.contains("| frontier  | 0      | –"),
        "{text}"
    );
    assert!(!text.contains("Against"), "{text}");
}
