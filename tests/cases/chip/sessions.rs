//! Whole sessions of hostile hosts on the emulated chip: no crash, a bounded step, a bounded stack,
//! and the commands of a device in this process.
//!
//! `golden/sessions.txt` has the dearest step and the deepest stack of these sessions.

use core::ops::Range;

use fieldline_tests::runs::in_parallel;
use fieldline_tests::sessions::{assert_clean, assert_mended, corpus, cost_table, run};
use fieldline_tests::{costs, emulator, golden};
use host_sim::link::spec::LinkSpec;
use host_sim::session::campaign::Campaign;
use host_sim::session::generate::Generator;
use host_sim::session::target::TargetSpec;
use host_sim::session::totals::Totals;

const CHIP: TargetSpec = TargetSpec::Link(LinkSpec::Qemu);

/// Runs the sessions of some seeds of each generator.
fn sessions(seeds: &Range<u64>) -> Vec<(Generator, Totals)> {
    // Built once, before the threads ask for it.
    let _ = emulator::image();
    in_parallel(&Generator::ALL, |&generator| {
        let campaign = Campaign {
            generators: vec![generator],
            seeds: seeds.clone(),
            target: CHIP,
            twin: true,
            ..Campaign::default()
        };
        (generator, run(&campaign))
    })
}

/// Runs sessions, compares their costs with golden file `name`, and asserts that nothing is found.
pub(crate) fn check(name: &str, seeds: &Range<u64>) {
    let totals = sessions(seeds);
    golden::compare_about(name, &cost_table(&totals).to_string(), costs::DRIFT);
    for (_, totals) in &totals {
        assert_clean(totals);
    }
}

#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn hostile_sessions_keep_within_time_and_stack() {
    check("sessions.txt", &(3_000_000..3_000_030));
}

/// What was found on the chip: crashes, slow steps, deep stacks.
#[test]
#[ignore = "needs the image and QEMU; tests/run runs it"]
fn no_session_of_the_corpus_is_dear_again() {
    let words = ["crash", "slow", "deep"];
    let mut corpus = corpus();
    corpus.retain(|(_, script)| {
        words
            .iter()
            .any(|word| script.head.causes.starts_with(word))
    });
    assert!(!corpus.is_empty(), "the corpus has files for the chip");
    assert_mended(&corpus, &CHIP);
}
