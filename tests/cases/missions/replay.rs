//! Recorded logs through the planner's localisation: errors against known relations.
//!
//! `golden/replay-data.txt` has every log of `$FIELDLINE_DATA/logs` with its own odometry. A log
//! that relations belong to is also replayed with odometry that drifts from its poses.

mod data {
    use std::path::{Path, PathBuf};

    use fieldline_tests::golden;
    use fieldline_tests::runs::in_parallel;
    use fieldline_tests::table::{Table, number};
    use host_sim::link::direct::Direct;
    use host_sim::replay::carmen::{self, LogScan};
    use host_sim::replay::relations::{self, Pose, Relation, RelationError};
    use host_sim::replay::report::{self, RelationErrors};
    use host_sim::replay::wire::LogLaser;
    use host_sim::replay::{clock, run};
    use host_sim::report::QualityShares;

    /// Factors of the drift's variances.
    const DRIFTS: [f64; 3] = [1.0, 2.0, 4.0];
    const SEEDS: u64 = 10;

    /// A log, with the relations that belong to it.
    struct Log {
        name: String,
        scans: Vec<LogScan>,
        relations: Vec<Relation>,
    }

    /// One replay of a log.
    struct Job<'a> {
        log: &'a Log,
        degrade: Option<f64>,
        seed: u64,
    }

    fn folder() -> PathBuf {
        let data = std::env::var_os("FIELDLINE_DATA");
        let data = data.expect("FIELDLINE_DATA names the folder that holds a folder logs");
        Path::new(&data).join("logs")
    }

    /// Returns logs and files of relations, each with name and text, sorted by name.
    fn files() -> [Vec<(String, String)>; 2] {
        let entries = folder()
            .read_dir()
            .expect("FIELDLINE_DATA has a folder logs");
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.unwrap().path()).collect();
        paths.sort();
        let read = |path: &PathBuf| {
            let name = path.file_name().unwrap_or_default().to_string_lossy();
            (name.into_owned(), carmen::read(path).unwrap())
        };
        let (relations, logs): (Vec<_>, Vec<_>) =
            (paths.iter().map(read)).partition(|(name, _)| name.ends_with(".relations"));
        [logs, relations]
    }

    fn logs() -> Vec<Log> {
        let [logs, known] = files();
        let known = known
            .iter()
            .map(|(name, text)| relations::read(name, text).unwrap());
        let known: Vec<Vec<Relation>> = known.collect();
        let log = |(name, text): (String, String)| {
            let scans = carmen::log(&name, &text).unwrap().scans;
            let own = timed(&scans, scans.iter().map(|scan| scan.odometry));
            let relations = known.iter().find_map(|known| {
                let offset = clock::offset(known, &own)?;
                Some(known.iter().map(|it| it.shifted(offset)).collect())
            });
            Log {
                name,
                scans,
                relations: relations.unwrap_or_default(),
            }
        };
        logs.into_iter().map(log).collect()
    }

    fn timed(scans: &[LogScan], poses: impl Iterator<Item = Pose>) -> Vec<(f64, Pose)> {
        scans.iter().map(|scan| scan.time).zip(poses).collect()
    }

    fn jobs(log: &Log) -> Vec<Job<'_>> {
        let drifts = DRIFTS
            .iter()
            .flat_map(|&k| (0..SEEDS).map(move |seed| (Some(k), seed)));
        let drifts = drifts.filter(|_| !log.relations.is_empty());
        let all = core::iter::once((None, 0)).chain(drifts);
        all.map(|(degrade, seed)| Job { log, degrade, seed })
            .collect()
    }

    /// Returns the errors of the relations that `is_asked` is true for.
    fn errors(
        log: &Log,
        poses: &[Pose],
        is_asked: fn(&Relation) -> bool,
    ) -> Option<RelationErrors> {
        let poses = timed(&log.scans, poses.iter().copied());
        let errors = relations::errors(&log.relations, &poses).into_iter();
        let asked = errors.filter(|(relation, _)| is_asked(relation));
        let asked: Vec<RelationError> = asked.map(|(_, error)| error).collect();
        RelationErrors::of(&asked)
    }

    /// Returns true for a relation of less than ten seconds, whose error is that of matching alone.
    fn is_short(relation: &Relation) -> bool {
        relation.to - relation.from < 10.0
    }

    fn row(job: &Job<'_>) -> Vec<String> {
        let log = job.log;
        let odometry = run::odometry(&log.scans, job.degrade, job.seed);
        let laser = LogLaser::of(&log.scans);
        let replayed = run::run(
            &laser,
            &log.scans,
            &odometry,
            &mut Direct::default(),
            None,
            &mut (),
        );
        let replayed = replayed.expect("the planner answers");
        let poses = &replayed.poses;
        let by_odometry = errors(log, &odometry, |_| true);
        let found = errors(log, poses, |_| true);
        let short = errors(log, poses, is_short);
        let long = errors(log, poses, |relation| !is_short(relation));
        let metres = |errors: &Option<RelationErrors>| errors.map(|it| it.translation_m.mean);
        let shares = QualityShares::of(&replayed.qualities);
        let cells = |poses: &[Pose]| report::occupied_cells(&laser, &log.scans, poses).to_string();
        vec![
            log.name.clone(),
            number(job.degrade, 0),
            job.seed.to_string(),
            number(metres(&by_odometry), 3),
            number(metres(&found), 4),
            number(metres(&short), 4),
            number(metres(&long), 4),
            number(found.map(|it| it.translation_m.max), 3),
            number(found.map(|it| it.rotation_deg.mean), 2),
            cells(&odometry),
            cells(poses),
            number(Some(100.0 * shares.tracking), 1),
            number(Some(100.0 * shares.lost), 1),
        ]
    }

    #[test]
    #[ignore = "needs logs that are no part of the project"]
    fn logs_against_their_relations() {
        let columns = [
            "log",
            "k",
            "seed",
            "odometry m",
            "mean m",
            "<10 s m",
            "others m",
            "max m",
            "mean deg",
            "odometry cells",
            "cells",
            "tracking %",
            "lost %",
        ];
        let mut table = Table::new(1, &columns);
        let logs = logs();
        assert!(!logs.is_empty(), "{} has no log", folder().display());
        let jobs: Vec<Job<'_>> = logs.iter().flat_map(jobs).collect();
        for row in in_parallel(&jobs, row) {
            table.row(row);
        }
        golden::compare("replay-data.txt", &table.to_string());
    }
}
