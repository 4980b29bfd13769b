//! A session does not depend on the session before it on the same device.

use host_sim::link::Link;
use host_sim::link::digest::Digest;
use host_sim::link::spec::{LinkSpec, Options};
use host_sim::session::ask::{Answer, Ask};
use host_sim::session::campaign::Campaign;
use host_sim::session::generate::Generator;

/// Returns the requests of a session.
fn asks(seed: u64) -> Vec<Ask> {
    let played = Campaign::default().session(Generator::Tame, seed);
    played.expect("a device in this process").asks
}

/// Plays requests; returns the digest of the commands.
fn digest(asks: &[Ask], link: &mut dyn Link) -> Digest {
    let mut digest = Digest::new();
    for ask in asks {
        if let Ok(Answer::Command(command)) = ask.of(link) {
            digest.add(&command);
        }
    }
    digest
}

#[test]
fn a_session_after_another_gives_the_same_commands() {
    let open = || {
        LinkSpec::Direct
            .open(&Options::default())
            .expect("a device")
    };
    let mut differ = Vec::new();
    for seed in 500..540 {
        let (before, after) = (asks(seed), asks(seed + 40));
        // What comes before its start is answered by the session before.
        let start = after.iter().position(|ask| matches!(ask, Ask::Start(_)));
        let after = &after[start.unwrap_or(after.len())..];
        let (mut used, mut fresh) = (open(), open());
        digest(&before, used.as_mut());
        if digest(after, used.as_mut()) != digest(after, fresh.as_mut()) {
            differ.push(seed);
        }
    }
    assert_eq!(differ, [0; 0], "sessions whose commands differ");
}
