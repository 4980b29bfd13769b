//! Any whole session of a host, from absurd to plausible: it never makes the device panic, drive
//! too fast or unasked, or answer with a number that is not finite.
//!
//! The input chooses the generator, the size of the map and every number of the session.
#![no_main]

use host_sim::session::generate::of_bytes;
use host_sim::session::judge::Limits;
use host_sim::session::play::{Played, converse};
use host_sim::session::target::TargetSpec;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| {
    let (_, capacity, mut host) = of_bytes(data);
    let mut target = TargetSpec::Device
        .open(capacity)
        .expect("a device of every size can be opened");
    let mut played = Played::default();
    converse(&mut *host, &mut *target, Limits::default(), &mut played);
    assert!(played.findings.is_empty(), "{:?}", played.findings);
});
