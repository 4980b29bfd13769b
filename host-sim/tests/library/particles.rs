//! A particle filter beside a run judges it and changes nothing.

use host_sim::link::spec::{LinkSpec, Options};
use host_sim::report::Report;
use host_sim::slam::particles::ParticleReport;
use host_sim::trial::mission::{self, Mission, OdometryProfile};
use host_sim::world::World;

fn explore(odometry: OdometryProfile, particles: Option<&str>) -> Report {
    let mission = Mission {
        seed: 3,
        odometry,
        localise: odometry != OdometryProfile::Truth,
        particles: particles.map(|spec| spec.parse().expect("a filter")),
        ..Mission::default()
    };
    let world = World::builtin("office").expect("a built-in world");
    let options = Options::default();
    let mut link = LinkSpec::Direct.open(&options).expect("a link");
    let run = mission::explore(&mission, &world, link.as_mut(), &mut ());
    run.expect("it begins").0
}

fn told(odometry: OdometryProfile, particles: &str) -> ParticleReport {
    let report = explore(odometry, Some(particles));
    report.particles.expect("a report of the particles")
}

#[test]
fn the_run_is_the_same_with_a_filter_beside_it() {
    for odometry in [OdometryProfile::Truth, OdometryProfile::Papers] {
        let (without, with) = (explore(odometry, None), explore(odometry, Some("8")));
        assert_eq!(without.digest, with.digest);
        assert!(without.particles.is_none() && with.particles.is_some());
    }
}

#[test]
fn with_wheels_that_barely_err_the_particles_are_right_and_the_map_is_whole() {
    let told = told(OdometryProfile::Truth, "10,proposal=matched,noise=0.01");
    assert!(told.pf_error_m < 0.1 && told.end_error_m < 0.1, "{told:?}");
    assert_eq!(told.below_1m, 1.0);
    assert!((97.0..=103.0).contains(&told.area_percent), "{told:?}");
}

#[test]
fn particles_of_one_seed_are_the_same_and_more_noise_makes_them_worse() {
    let one = told(OdometryProfile::Truth, "30,proposal=motion,noise=1");
    assert_eq!(
        one,
        told(OdometryProfile::Truth, "30,proposal=motion,noise=1")
    );
    let worse = told(OdometryProfile::Truth, "30,proposal=motion,noise=80");
    assert!(worse.pf_error_m > 2.0 * one.pf_error_m, "{one:?} {worse:?}");
}

#[test]
fn the_filter_takes_the_odometry_of_a_run_that_drifts() {
    // By the run's own wheels, and by wheels drawn with the same noise and seed.
    let own = told(OdometryProfile::Noisy, "30");
    let drawn = told(OdometryProfile::Noisy, "30,noise=1");
    assert!(
        own.pf_error_m < 0.3 && drawn.pf_error_m < 0.3,
        "{own:?} {drawn:?}"
    );
    assert_ne!(own.pf_error_m, drawn.pf_error_m);
}
