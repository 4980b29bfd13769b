//! Some hundred sessions of each generator, in this process.

use fieldline_tests::sessions::check_in_process;
use host_sim::session::generate::Generator;

#[test]
fn hostile_hosts_get_answers_and_the_robot_stays_within_its_limits() {
    check_in_process(&Generator::ALL, 0..200);
}
