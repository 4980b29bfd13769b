//! Lines of logs, good and bad.

use super::*;

#[test]
fn a_scan_has_its_odometry_and_its_angles() {
    let text = "# x\nFLASER 2 1 2 9 9 9 3 4 0.5 7.5 host 7.5\n";
    let scan = &log("a.log", text).unwrap().scans[0];
    assert_eq!(
        (scan.line, scan.time, scan.odometry),
        (2, 7.5, [3.0, 4.0, 0.5])
    );
    assert_eq!((scan.angle(0), scan.angle(1)), (-FRAC_PI_2, 0.0));
}

#[test]
fn bad_input_names_file_and_line() {
    for (bad, what) in [
        (
            "FLASER 3 1 2 9 9 9 3 4 0.5 7.5 host 7.5",
            "a.log:1: FLASER says 3",
        ),
        ("FLASER 18446744073709551615 1", "a.log:1: FLASER says"),
        (
            "FLASER 2 1 NaN 9 9 9 3 4 0.5 7.5 host 7.5",
            "a.log:1: `NaN`",
        ),
        ("ODOM 1 2 NaN 0 0 0 1 host 1", "a.log:1: `NaN`"),
        ("", "a.log:1: no FLASER or ROBOTLASER1"),
    ] {
        let error = log("a.log", bad).unwrap_err();
        assert!(error.starts_with(what), "{error}");
    }
}

fn flaser_line(beams: &str, time: f64) -> String {
    format!("FLASER {beams} 0 0 0 0 0 0 {time} host {time}\n")
}

/// A `ROBOTLASER1` line with three beams from −135° on.
fn robotlaser_line(step_deg: f64, time: f64) -> String {
    let (first, step) = (-135_f64.to_radians(), step_deg.to_radians());
    format!(
        "ROBOTLASER1 0 {first} 4.7 {step} 20 0.01 0 3 1 2 3 2 9 9 1 2 0.5 3 4 0.5 0.7 -0.1 \
         0.3 0.3 1e6 {time} host 99\n"
    )
}

#[test]
fn scans_of_two_lasers_are_refused() {
    let mixed = flaser_line("2 1 2", 1.0) + &flaser_line("3 1 2 3", 2.0);
    let error = log("a", &mixed).unwrap_err();
    assert!(error.starts_with("a:2: the scan has 3 beams"), "{error}");
    let mixed = flaser_line("3 1 2 3", 1.0) + &robotlaser_line(90.0, 2.0);
    let error = log("a", &mixed).unwrap_err();
    assert!(
        error.starts_with("a:2: the scan has other angles"),
        "{error}"
    );
}

#[test]
fn scans_whose_times_go_back_a_little_are_sorted_and_counted() {
    let times = [1.0, 1.4, 1.2, 1.3, 1.4, 2.0, 1.75];
    let text: String = times.map(|time| flaser_line("2 1 2", time)).concat();
    let read = log("a", &text).unwrap();
    let found = read.scans.iter().map(|scan| (scan.time, scan.line));
    let sorted = [
        (1.0, 1),
        (1.2, 3),
        (1.3, 4),
        (1.4, 2),
        (1.4, 5),
        (1.75, 7),
        (2.0, 6),
    ];
    assert_eq!(found.collect::<Vec<_>>(), sorted);
    assert_eq!(read.late, 3);
    assert!((read.late_s - 0.25).abs() < 1e-9, "{}", read.late_s);
}

#[test]
fn a_time_that_goes_back_by_more_than_a_second_is_refused() {
    let text = flaser_line("2 1 2", 3.0) + &flaser_line("2 1 2", 1.5);
    let error = log("a", &text).unwrap_err();
    assert!(
        error.starts_with("a:2: time 1.5 is 1.50 s before that of line 1; "),
        "{error}"
    );
    assert!(
        error.contains("sort the log by time, or cut it there"),
        "{error}"
    );
}

#[test]
fn a_scan_of_the_newer_form_has_its_own_angles_and_speed() {
    let scan = &log("a", &robotlaser_line(90.0, 7.5)).unwrap().scans[0];
    assert_eq!(
        (scan.time, scan.odometry, scan.laser),
        (7.5, [3.0, 4.0, 0.5], [1.0, 2.0, 0.5])
    );
    assert_eq!(
        (scan.ranges.as_slice(), scan.speed),
        ([1.0, 2.0, 3.0].as_slice(), [0.7, -0.1])
    );
    assert!((scan.angle(2).to_degrees() - 45.0).abs() < 1e-9);
    assert_eq!(scan.beams.most_m, 20.0);
}

#[test]
fn a_bad_line_of_the_newer_form_is_named() {
    let good = robotlaser_line(90.0, 1.0);
    for (bad, what) in [
        (
            good.replace(" host", ""),
            "a:1: ROBOTLASER1 says 3 beams and 2 remissions and has 28",
        ),
        (
            robotlaser_line(0.0, 1.0),
            "a:1: ROBOTLASER1 has the angle 0",
        ),
        (
            good.replace(" 0.7 ", " inf "),
            "a:1: `inf` is not a finite number",
        ),
        (
            "ROBOTLASER1 0 0".into(),
            "a:1: ROBOTLASER1 has no number of beams",
        ),
        (
            good.replace(" 0 3 1 ", " 0 18446744073709551615 1 "),
            "a:1: ROBOTLASER1 has no number",
        ),
    ] {
        let error = log("a", &bad).unwrap_err();
        assert!(error.starts_with(what), "{error}");
    }
}

#[test]
fn a_gzip_file_is_unpacked_and_a_broken_one_names_its_line() {
    use std::io::Write as _;
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("a.gz");
    let text: String = (0..2000_u64)
        .map(|k| format!("{} line\n", k * k * 7919))
        .collect();
    let mut packer = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    packer.write_all(text.as_bytes()).unwrap();
    let packed = packer.finish().unwrap();
    std::fs::write(&path, &packed).unwrap();
    assert_eq!(read(&path).unwrap(), text);
    std::fs::write(&path, &packed[..packed.len() / 2]).unwrap();
    let error = read(&path).unwrap_err();
    assert!(
        error.contains("a.gz:") && error.contains("copy it again"),
        "{error}"
    );
}
