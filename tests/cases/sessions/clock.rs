//! The host's clock counts milliseconds from any origin, and wraps: a session whose clock has
//! another origin gets the same commands.

use fieldline_tests::sessions::replay;
use host_sim::session::ask::Ask;
use host_sim::session::campaign::{Campaign, capacity};
use host_sim::session::generate::Generator;
use host_sim::session::script::{Head, Script};
use host_sim::session::target::TargetSpec;

/// Returns the requests with all times later, wrapping.
fn later(asks: &[Ask], by_ms: u32) -> Vec<Ask> {
    let mut asks = asks.to_vec();
    for ask in &mut asks {
        if let Ask::Observation(observation) = ask {
            observation.time_ms = observation.time_ms.wrapping_add(by_ms);
        }
    }
    asks
}

/// Returns the times of the observations, milliseconds.
fn times(asks: &[Ask]) -> Vec<u32> {
    let time = |ask: &Ask| match ask {
        Ask::Observation(observation) => Some(observation.time_ms),
        _ => None,
    };
    asks.iter().filter_map(time).collect()
}

#[test]
fn a_clock_of_another_origin_or_one_that_wraps_changes_no_command() {
    let mut differ = String::new();
    for seed in 500..560 {
        let played = Campaign::default().session(Generator::Plausible, seed);
        let played = played.expect("a device in this process");
        let times = times(&played.asks);
        let Some(middle) = times.get(times.len() / 2) else {
            continue;
        };
        let to_zero = 0_u32.wrapping_sub(times[0]);
        let to_wrap = 0_u32.wrapping_sub(*middle);
        for by_ms in [to_zero, to_wrap, to_wrap ^ 1 << 31] {
            let head = Head {
                capacity: capacity(seed),
                ..Head::default()
            };
            let asks = later(&played.asks, by_ms);
            let again = replay(&Script { head, asks }, &TargetSpec::Device);
            if again.digest != played.digest {
                differ += &format!("seed {seed}, {by_ms} ms later: {:?}\n", again.status);
            }
        }
    }
    assert!(differ.is_empty(), "{differ}");
}
