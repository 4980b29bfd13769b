//! Every session that once caused a finding, in this process.

use fieldline_tests::sessions::{assert_mended, corpus};
use host_sim::session::target::TargetSpec;

#[test]
fn no_session_of_the_corpus_causes_its_finding_again() {
    let corpus = corpus();
    assert!(!corpus.is_empty(), "the corpus has files");
    assert_mended(&corpus, &TargetSpec::Device);
}
