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
            "a.log:1: of 1 scans 1 cannot be used (FLASER says 3",
        ),
        (
            "FLASER 18446744073709551615 1",
            "a.log:1: of 1 scans 1 cannot be used (FLASER says",
        ),
        (
            "FLASER 2 1 2 9 9 9 3 4 NaN 7.5 host 7.5",
            "a.log:1: of 1 scans 1 cannot be used (`NaN` is not a finite number): 1 line with NaN",
        ),
        (
            "ODOM 1 2 NaN 0 0 0 1 host 1",
            "a.log:1: no FLASER, RLASER or ROBOTLASER1",
        ),
        ("", "a.log:1: no FLASER, RLASER or ROBOTLASER1"),
    ] {
        let error = log("a.log", bad).unwrap_err();
        assert!(error.starts_with(what), "{error}");
    }
}

/// Reads `good` scans a second apart from 100 s on, with `lines` in their middle.
fn among(good: u32, lines: &str) -> Result<Log, String> {
    let scan = |k: u32| flaser_line("3 1 2 3", 100.0 + f64::from(k));
    let half = good / 2;
    let before: String = (0..half).map(scan).collect();
    let after: String = (half..good).map(scan).collect();
    log("a", &(before + lines + &after))
}

#[test]
fn ranges_that_are_no_numbers_are_codes() {
    let line = "8 inf -inf nan -nan 1.#INF -1.#IND 0 2.5";
    let read = log("a", &flaser_line(line, 1.0)).unwrap();
    let ranges = &read.scans[0].ranges;
    assert_eq!((ranges[0], ranges[1]), (f64::INFINITY, f64::NEG_INFINITY));
    assert!(ranges[2].is_nan() && ranges[3].is_nan() && ranges[5].is_nan());
    assert_eq!(ranges[4], f64::INFINITY);
    assert_eq!(ranges[6..], [0.0, 2.5]);
    assert!(read.left_out.is_empty());
}

#[test]
fn what_cannot_be_used_is_left_out_and_counted_by_its_reason() {
    let pose = "FLASER 3 1 2 3 0 0 0 0 inf 0 105 host 105\n";
    for (lines, why, count) in [
        (pose.to_owned(), Why::NotFinite, 1),
        (flaser_line("3 1 2 3", f64::NAN), Why::NotFinite, 1),
        ("ODOM 1 2 3 nan 0 0 5 host 5\n".into(), Why::NotFinite, 1),
        ("FLASER 3 1 2 3 0 0\n".into(), Why::Garbled, 1),
        (flaser_line("3 1 x 3", 105.0), Why::Garbled, 1),
        (flaser_line("3 0 0 0", 105.0).repeat(2), Why::Empty, 2),
        (flaser_line("3 0 nan -1", 105.0), Why::Empty, 1),
        (flaser_line("9 1 2 3 4 5 6 7 8 9", 105.0), Why::Beams, 1),
        (flaser_line("3 1 2 3", 90.0), Why::TimeBack, 1),
        (flaser_line("3 1 2 3", 9e5), Why::TimeBack, 1),
        (robotlaser_line(90.0, 105.0), Why::OtherLaser, 1),
    ] {
        let read = among(10, &lines).unwrap();
        let expected = Lines {
            lines: count,
            first_line: 6,
        };
        assert_eq!(read.left_out.of(why), Some(expected), "{lines}");
        assert_eq!(read.scans.len(), 10, "{lines}");
        let text = read.left_out.to_string();
        assert!(
            text.contains("line 6") && text.starts_with(&count.to_string()),
            "{text}"
        );
    }
}

#[test]
fn some_beams_more_or_less_are_told_and_kept() {
    let read = among(10, &flaser_line("2 1 3", 104.5)).unwrap();
    assert_eq!((read.scans.len(), usual_beams(&read.scans)), (11, Some(3)));
    let told = read.resampled.unwrap();
    assert_eq!((told.lines, told.first_line), (1, 6));
    assert!(
        read.scans
            .iter()
            .all(|scan| scan.beams == Beams::half_turn(3))
    );
}

#[test]
fn a_log_of_which_most_scans_cannot_be_used_is_refused() {
    let zeros = flaser_line("3 0 0 0", 102.0);
    assert!(among(4, &zeros.repeat(4)).is_ok());
    let error = among(4, &zeros.repeat(5)).unwrap_err();
    let start = "a:3: of 9 scans 5 cannot be used: 5 lines without any information";
    assert!(error.starts_with(start), "{error}");
    assert!(error.contains("the first is line 3"), "{error}");
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
fn of_two_lasers_that_of_most_scans_is_read() {
    let behind = flaser_line("3 1 2 3", 100.5).replace("FLASER", "RLASER");
    let both = among(4, &behind.repeat(4)).unwrap();
    assert_eq!((both.scans.len(), both.form), (4, Form::Flaser));
    let other = both.left_out.of(Why::OtherLaser).unwrap();
    assert_eq!((other.lines, other.first_line), (4, 3));
    let alone = log("a", &behind).unwrap();
    assert_eq!((alone.scans.len(), alone.form), (1, Form::Rlaser));
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
            "(ROBOTLASER1 says 3 beams and 2 remissions and has 28",
        ),
        (robotlaser_line(0.0, 1.0), "(ROBOTLASER1 has the angle 0"),
        (
            good.replace(" 0.7 ", " inf "),
            "(`inf` is not a finite number",
        ),
        (
            "ROBOTLASER1 0 0".into(),
            "(ROBOTLASER1 has no number of beams",
        ),
        (
            good.replace(" 0 3 1 ", " 0 18446744073709551615 1 "),
            "(ROBOTLASER1 has no number",
        ),
    ] {
        let error = log("a", &bad).unwrap_err();
        assert!(
            error.starts_with("a:1: ") && error.contains(what),
            "{error}"
        );
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
