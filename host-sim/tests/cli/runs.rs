//! Runs: their files and their output.

use std::fs;

use serde_json::Value;

use crate::{FILES, files, folder, kept_files, outcome, reports};

#[test]
fn without_arguments_it_explores_the_office() {
    let folder = folder();
    let (status, stdout, stderr) = outcome(&folder, &[]);
    assert_eq!(status, 0, "{stdout}{stderr}");
    assert!(
        stdout.starts_with("office · frontier · seed 0: explored, "),
        "{stdout}"
    );
    assert!(
        stderr.contains("office: files in out/office-frontier-0"),
        "{stderr}"
    );
    let run = folder.path().join("out/office-frontier-0");
    assert_eq!(files(&run), FILES);
    let report = fs::read_to_string(run.join("report.json")).unwrap();
    let report: Value = serde_json::from_str(&report).unwrap();
    assert_eq!(report["outcome"]["reason"], "explored");
    assert_eq!(report["link"], "loopback");
    assert_eq!(report["debug"]["map_matches_mirror"], true);
    assert!(report["coverage"]["fraction"].as_f64().unwrap() > 0.98);
    let steps = report["steps"].as_u64().unwrap() as usize;
    let lines = |name: &str| fs::read_to_string(run.join(name)).unwrap().lines().count();
    assert_eq!(lines("commands.csv"), steps + 1);
    assert_eq!(lines("trajectory.tum"), steps);
    assert_eq!(lines("trajectory_truth.tum"), steps);
}

#[test]
fn json_prints_one_report_per_line_and_nothing_else() {
    let folder = folder();
    let arguments = ["explore", "loop", "cave", "loop", "--json", "--out", "runs"];
    let (status, stdout, _) = outcome(&folder, &arguments);
    let reports = reports(&stdout);
    let words: Vec<_> = reports
        .iter()
        .map(|r| {
            (
                r["world"].as_str().unwrap(),
                r["outcome"]["reason"].as_str().unwrap(),
            )
        })
        .collect();
    assert_eq!(
        words,
        [
            ("loop", "explored"),
            ("cave", "explored"),
            ("loop", "explored")
        ]
    );
    assert_eq!(status, 0, "every run ended explored");
    let runs = folder.path().join("runs");
    assert_eq!(
        files(&runs),
        ["cave-frontier-0", "loop-frontier-0", "loop-frontier-0-2"]
    );
    for (name, report) in files(&runs).iter().zip([1, 0, 2]) {
        assert_eq!(files(&runs.join(name)), FILES);
        let file = fs::read_to_string(runs.join(name).join("report.json")).unwrap();
        let file: Value = serde_json::from_str(&file).unwrap();
        assert_eq!(file, reports[report], "file and line are equal");
    }
}

#[test]
fn a_film_shows_the_run_and_changes_no_result() {
    let folder = folder();
    let run = |more: &[&str]| {
        let arguments = ["explore", "loop", "--time-limit", "8", "--json", "--force"];
        let (status, stdout, stderr) = outcome(&folder, &[&arguments, more].concat());
        assert_eq!(status, 1, "the time limit ended it: {stderr}");
        reports(&stdout).remove(0)
    };
    let plain = run(&[]);
    let shown = run(&["--film", "film.gif"]);
    assert_eq!(shown["digest"], plain["digest"]);
    let home = folder.path().join("out/loop-frontier-0");
    assert_eq!(files(&home), kept_files(), "a film needs no snapshots");

    let file = fs::File::open(folder.path().join("film.gif")).expect("a film");
    let film = gif::DecodeOptions::new().read_info(file).expect("a GIF");
    let frames = film.into_iter().map(|frame| frame.expect("a frame"));
    let delays: Vec<u16> = frames.map(|frame| frame.delay).collect();
    // A picture each 2 s, and the end.
    assert_eq!(delays, [10, 10, 10, 10, 300]);
    let refused = ["explore", "loop", "--film", "film.gif"];
    let (status, _, stderr) = outcome(&folder, &refused);
    assert_eq!(status, 2, "{stderr}");
    assert!(stderr.contains("--force"), "{stderr}");
}

#[test]
fn snapshots_of_an_uneven_run_change_no_result() {
    let folder = folder();
    let run = |more: &[&str]| {
        // The score of the map against the true ground needs true poses.
        let arguments = [
            "explore",
            "causeway@1",
            "--time-limit",
            "13",
            "--json",
            "--force",
        ];
        let arguments = [&arguments[..], &["--odometry", "truth"], more].concat();
        let (status, stdout, _) = outcome(&folder, &arguments);
        assert_eq!(status, 1, "the time limit ended it");
        reports(&stdout).remove(0)
    };
    let plain = run(&["--link", "direct"]);
    assert_eq!(plain["start"], 1);
    assert_eq!(plain["true_ground"]["working"]["climb_deg"], 20.0);
    assert!(
        plain["true_ground"]["map_score"]["confusion"][0][1]
            .as_u64()
            .unwrap()
            > 1_000
    );
    let home = folder.path().join("out/causeway@1-frontier-0");
    assert_eq!(files(&home), kept_files(), "no snapshots by default");
    for link in ["direct", "loopback"] {
        let taken = run(&["--link", link, "--snapshots", "3"]);
        assert_eq!(taken["digest"], plain["digest"]);
        assert_eq!(taken["coverage"], plain["coverage"]);
        let series = home.join("snapshots");
        assert_eq!(files(&series), ["001.png", "002.png", "003.png"]);
        let pictures = files(&series).into_iter().map(|name| series.join(name));
        let pictures: Vec<_> = pictures.chain([home.join("run.png")]).collect();
        let sizes = pictures.iter().map(|path| {
            let png = fs::read(path).unwrap();
            assert_eq!(&png[..8], b"\x89PNG\r\n\x1a\n");
            // Width and height.
            png[16..24].to_vec()
        });
        let mut sizes: Vec<_> = sizes.collect();
        sizes.dedup();
        assert_eq!(sizes.len(), 1, "all have one size, so they make a film");
    }
}

#[test]
fn the_alias_terrain_is_frontier_on_uneven_ground() {
    let folder = folder();
    let run = |more: &[&str]| {
        let arguments = ["explore", "slope", "--time-limit", "5", "--json", "--force"];
        let (status, stdout, stderr) = outcome(&folder, &[&arguments, more].concat());
        assert_eq!(status, 1, "the time limit ended it: {stderr}");
        (reports(&stdout).remove(0), stderr)
    };
    let (alias, stderr) = run(&["--strategy", "terrain"]);
    let meaning = "--strategy terrain means --strategy frontier --ground uneven\n";
    assert!(
        stderr.starts_with(&format!("host-sim: {meaning}")),
        "{stderr}"
    );
    assert!(files(&folder.path().join("out")).contains(&"slope-frontier-uneven-0".into()));
    let (plain, stderr) = run(&["--ground", "uneven"]);
    assert!(!stderr.contains("means"), "{stderr}");
    let (implied, _) = run(&["--preference", "both"]);
    for report in [&alias, &plain, &implied] {
        let words = ["strategy", "ground", "preference"].map(|key| report[key].as_str());
        assert_eq!(words, [Some("frontier"), Some("uneven"), Some("both")]);
        assert_eq!(report["digest"], alias["digest"]);
    }
    let (flat, _) = run(&[]);
    assert_eq!(
        (flat["ground"].as_str(), flat["preference"].as_str()),
        (Some("flat"), None)
    );
    assert_ne!(flat["digest"], alias["digest"]);
    for (arguments, levels) in [
        (&["--ground", "flat"][..], None),
        (&["--preference", "height"], Some(true)),
        (&["--preference", "off"], Some(false)),
        (&["--preference", "global"], Some(false)),
        (&["--preference", "off", "--levels", "on"], Some(true)),
        (&["--levels", "off"], Some(false)),
        (&["--strategy", "bvp", "--preference", "both"], None),
    ] {
        assert_eq!(
            run(arguments).0["levels"].as_bool(),
            levels,
            "{arguments:?}"
        );
    }
}

#[test]
fn the_link_and_its_faults_change_no_command() {
    let folder = folder();
    let digest = |more: &[&str]| {
        let arguments = [
            "explore",
            "cluttered",
            "--time-limit",
            "20",
            "--json",
            "--force",
        ];
        let (_, stdout, _) = outcome(&folder, &[&arguments, more].concat());
        let report = reports(&stdout).remove(0);
        (
            report["digest"].clone(),
            report["link_stats"]["retries"].clone(),
        )
    };
    let clean = digest(&["--link", "direct"]);
    assert_eq!(digest(&["--link", "loopback"]).0, clean.0);
    let faults = "drop=0.02,duplicate=0.02,corrupt=0.02,truncate=0.02,delay=0.02";
    let faulty = digest(&["--link", "loopback", "--fault", faults]);
    assert_eq!(faulty.0, clean.0);
    assert!(faulty.1.as_u64().unwrap() > 0, "there were faults");
    assert_ne!(digest(&["--seed", "1"]).0, clean.0);
}

#[test]
fn check_field_reports_the_heading_error() {
    let folder = folder();
    let arguments = [
        "explore",
        "loop",
        "--time-limit",
        "10",
        "--json",
        "--check-field",
    ];
    let (_, stdout, _) = outcome(&folder, &arguments);
    let report = &reports(&stdout)[0];
    let field = &report["field"];
    assert!(field["checked_windows"].as_u64().unwrap() > 30);
    let worst = field["heading_error_deg"]["max"].as_f64().unwrap();
    assert!((0.0..=180.0).contains(&worst));
    assert!(
        field["heading_error_deg"]["p50"].as_f64().unwrap() < 2.0,
        "{field}"
    );
}

#[test]
fn a_folder_of_other_options_is_replaced_by_force_only() {
    let folder = folder();
    let run = |more: &[&str]| {
        let start = ["explore", "hall", "--time-limit", "2", "--out", "run"];
        outcome(&folder, &[&start, more].concat())
    };
    let report = || {
        let text = fs::read_to_string(folder.path().join("run/report.json")).unwrap();
        serde_json::from_str::<Value>(&text).unwrap()
    };
    assert_eq!(run(&[]).0, 1);
    let made_by = &report()["made_by"];
    assert_eq!(made_by["version"], env!("CARGO_PKG_VERSION"));
    assert_eq!(made_by["command_line"][1], "hall");
    assert_eq!(made_by["robot"], "pioneer-3at");
    let options = &made_by["options"];
    assert_eq!(
        (&options["time-limit"], &options["people"]),
        (&"2".into(), &"0".into())
    );
    // The same run, said in other words.
    assert_eq!(run(&["--seed", "0", "--json"]).0, 1);
    let (status, _, stderr) = run(&["--seed", "3"]);
    assert_eq!(status, 2, "{stderr}");
    for words in [
        "`explore --seed 0`",
        "`explore --seed 3`",
        "--force",
        "--out",
    ] {
        assert!(stderr.contains(words), "no {words:?} in {stderr}");
    }
    assert_eq!(report()["seed"], 0);
    assert_eq!(run(&["--seed", "3", "--force"]).0, 1);
    assert_eq!(report()["seed"], 3);
}

/// A room of 6 m whose walls are below the level laser's beam.
#[test]
fn a_map_without_its_walls_says_so() {
    let folder = folder();
    let pixel = |k: usize| {
        let farthest = [k / 164, k % 164]
            .map(|at| (2 * at).abs_diff(163))
            .into_iter()
            .max();
        match farthest {
            Some(0..120) => 254,
            Some(120..124) => 0,
            _ => 205,
        }
    };
    let mut pgm = b"P5 164 164 255\n".to_vec();
    pgm.extend((0..164 * 164).map(pixel));
    fs::write(folder.path().join("map.pgm"), pgm).unwrap();
    let keys = "image: map.pgm\nresolution: 0.05\norigin: [-1, -1, 0]\nrobots: [[3, 3, 0]]\n";
    let share = |name: &str, height: &str| {
        let file = format!("{name}.yaml");
        fs::write(
            folder.path().join(&file),
            format!("{keys}wall_height: {height}\n"),
        )
        .unwrap();
        let line = [
            "explore",
            &file,
            "--odometry",
            "truth",
            "--link",
            "direct",
            "--out",
            name,
        ];
        let (_, stdout, stderr) = outcome(&folder, &line);
        let report = fs::read_to_string(folder.path().join(name).join("report.json"));
        let report: Value = serde_json::from_str(&report.expect(&stderr)).unwrap();
        let share = report["map"]["walls_share"].as_f64().expect("walls");
        (share, stdout)
    };
    let (usual, said) = share("usual", "1.5");
    assert!(
        usual > 0.9 && !said.contains("of the true walls"),
        "{usual}: {said}"
    );
    let (low, said) = share("low", "0.15");
    assert!(
        low < 0.1 && said.contains("% of the true walls are in the map"),
        "{low}: {said}"
    );
}
