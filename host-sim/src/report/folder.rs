//! The folder of a run. Errors name the file and the remedy.
//!
//! Invariant: a file that has its name is whole. It is written beside, and renamed. A run that is
//! killed leaves the files of an earlier run as they were, and a file that says so. The report
//! comes last, so a folder with a new report has all of its files.

use std::fs;
use std::path::{Path, PathBuf};

use super::{GridMap, Report, TeamReport, commands, mission_log, ros_map, tum};
use crate::trial::Record;

/// Folder of the pictures during the run.
const SNAPSHOTS: &str = "snapshots";
/// In the folder of a run that has begun and not ended.
const UNFINISHED: &str = "unfinished.txt";
/// What that file says.
const EXPLANATION: &str = "A run began here and has not ended: it is under way, or was killed.\n\
                           Other files in this folder are those of an earlier run.\n";
/// The path as closed loops corrected it.
const CORRECTED: &str = "trajectory_corrected.tum";

/// A file of the run could not be written.
#[derive(Debug)]
pub struct WriteError {
    /// The file or folder.
    pub path: PathBuf,
    /// The system's error.
    pub source: std::io::Error,
}

impl core::fmt::Display for WriteError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "cannot write {}: {}; choose a writable folder with --out",
            self.path.display(),
            self.source
        )
    }
}

// No source: the message includes it.
impl core::error::Error for WriteError {}

/// Makes `folder`, checks that files can be written to it, and marks it as that of a run that has
/// not ended. The files of an earlier run stay.
///
/// # Errors
/// As [`WriteError`].
pub fn prepare(folder: &Path) -> Result<(), WriteError> {
    make(folder)?;
    put(folder, UNFINISHED, EXPLANATION.as_bytes())
}

/// Writes every file of a run into `folder`, in place of those of an earlier run.
///
/// # Errors
/// As [`WriteError`], at the first file that cannot be written.
pub fn write(
    folder: &Path,
    report: &Report,
    record: &Record,
    picture: &[u8],
) -> Result<(), WriteError> {
    let estimates: Vec<_> = record.steps.iter().map(|step| step.estimate).collect();
    let truths: Vec<_> = record.steps.iter().map(|step| step.truth).collect();
    let rows = record.steps.iter().map(|s| (&s.estimate, &s.command));
    remove_snapshots(folder)?;
    put(folder, "map.pgm", &ros_map::pgm(&record.map))?;
    put(
        folder,
        "map.yaml",
        ros_map::yaml(&record.map, "map.pgm").as_bytes(),
    )?;
    put(folder, "trajectory.tum", tum::text(&estimates).as_bytes())?;
    put(
        folder,
        "trajectory_truth.tum",
        tum::text(&truths).as_bytes(),
    )?;
    if record.corrected.is_empty() {
        remove(folder, CORRECTED)?;
    } else {
        let corrected = tum::text(&record.corrected);
        put(folder, CORRECTED, corrected.as_bytes())?;
    }
    put(
        folder,
        "commands.csv",
        commands::text(rows.clone()).as_bytes(),
    )?;
    let log = mission_log::text(&mission_log::entries(rows));
    put(folder, "mission.log", log.as_bytes())?;
    put(folder, "run.png", picture)?;
    end(folder, &report.to_json_pretty())
}

/// Writes the report, and takes the mark of a run that has not ended away.
fn end(folder: &Path, report: &str) -> Result<(), WriteError> {
    put(folder, "report.json", report.as_bytes())?;
    remove(folder, UNFINISHED).map(|_| ())
}

/// Writes the files of a team as a whole into `folder`.
///
/// # Errors
/// As [`WriteError`], at the first file that cannot be written.
pub fn write_team(
    folder: &Path,
    report: &TeamReport,
    map: &GridMap,
    picture: &[u8],
) -> Result<(), WriteError> {
    put(folder, "map.pgm", &ros_map::pgm(map))?;
    put(folder, "map.yaml", ros_map::yaml(map, "map.pgm").as_bytes())?;
    put(folder, "run.png", picture)?;
    end(folder, &report.to_json_pretty())
}

/// Makes `folder`, and changes nothing in it.
///
/// # Errors
/// As [`WriteError`].
pub fn make(folder: &Path) -> Result<(), WriteError> {
    fs::create_dir_all(folder).map_err(|source| WriteError {
        path: folder.to_owned(),
        source,
    })
}

/// Writes the files of a replay into `folder`: the map, `files`, and `relations.csv` if there are
/// relations. Without them an earlier one is removed.
///
/// # Errors
/// As [`WriteError`], at the first file that cannot be written.
pub fn write_replay(
    folder: &Path,
    map: &GridMap,
    files: &[(&str, &[u8])],
    relations: Option<&str>,
) -> Result<(), WriteError> {
    const RELATIONS: &str = "relations.csv";
    put(folder, "map.pgm", &ros_map::pgm(map))?;
    put(folder, "map.yaml", ros_map::yaml(map, "map.pgm").as_bytes())?;
    for (name, bytes) in files {
        put(folder, name, bytes)?;
    }
    if let Some(relations) = relations {
        return put(folder, RELATIONS, relations.as_bytes());
    }
    remove(folder, RELATIONS).map(|_| ())
}

/// Writes pictures as `snapshots/001.png` and on; makes no folder if there are none.
///
/// # Errors
/// As [`WriteError`], at the first file that cannot be written.
pub fn write_snapshots(
    folder: &Path,
    pictures: impl Iterator<Item = Vec<u8>>,
) -> Result<(), WriteError> {
    let folder = folder.join(SNAPSHOTS);
    for (number, picture) in (1..).zip(pictures) {
        make(&folder)?;
        put(&folder, &moment(number), &picture)?;
    }
    Ok(())
}

/// Writes pictures before and after each correction as `snapshots/correction-001-before.png` and
/// `snapshots/correction-001-after.png` and on.
///
/// # Errors
/// As [`WriteError`], at the first file that cannot be written.
pub fn write_corrections(
    folder: &Path,
    pictures: impl Iterator<Item = [Vec<u8>; 2]>,
) -> Result<(), WriteError> {
    let folder = folder.join(SNAPSHOTS);
    for (number, pictures) in (1..).zip(pictures) {
        make(&folder)?;
        for (name, picture) in correction(number).iter().zip(pictures) {
            put(&folder, name, &picture)?;
        }
    }
    Ok(())
}

fn moment(number: usize) -> String {
    format!("{number:03}.png")
}

fn correction(number: usize) -> [String; 2] {
    ["before", "after"].map(|when| format!("correction-{number:03}-{when}.png"))
}

/// Removes the pictures of an earlier run. Other files in the folder stay.
fn remove_snapshots(folder: &Path) -> Result<(), WriteError> {
    let folder = folder.join(SNAPSHOTS);
    for number in 1.. {
        if !remove(&folder, &moment(number))? {
            break;
        }
    }
    for number in 1.. {
        let [before, after] = correction(number);
        if !(remove(&folder, &before)? | remove(&folder, &after)?) {
            break;
        }
    }
    // Fails if the folder is not empty.
    let _ = fs::remove_dir(&folder);
    Ok(())
}

/// Removes a file. Returns false if there is none.
fn remove(folder: &Path, name: &str) -> Result<bool, WriteError> {
    let path = folder.join(name);
    match fs::remove_file(&path) {
        Ok(()) => Ok(true),
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => Ok(false),
        Err(source) => Err(WriteError { path, source }),
    }
}

fn put(folder: &Path, name: &str, bytes: &[u8]) -> Result<(), WriteError> {
    let (path, beside) = (folder.join(name), folder.join(format!(".{name}.part")));
    let written = fs::write(&beside, bytes).and_then(|()| fs::rename(&beside, &path));
    written.map_err(|source| {
        let _ = fs::remove_file(&beside);
        WriteError { path, source }
    })
}

#[cfg(test)]
mod tests {
    use super::{prepare, write, write_corrections, write_snapshots};
    use crate::report::tests::sample;
    use crate::trial::Record;

    #[test]
    fn every_file_is_there() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path().join("a/b");
        prepare(&folder).unwrap();
        write(&folder, &sample(), &Record::default(), b"picture").unwrap();
        let mut names: Vec<_> = std::fs::read_dir(&folder)
            .unwrap()
            .map(|entry| entry.unwrap().file_name().into_string().unwrap())
            .collect();
        names.sort();
        assert_eq!(
            names,
            [
                "commands.csv",
                "map.pgm",
                "map.yaml",
                "mission.log",
                "report.json",
                "run.png",
                "trajectory.tum",
                "trajectory_truth.tum"
            ]
        );
        assert_eq!(std::fs::read(folder.join("run.png")).unwrap(), b"picture");
    }

    #[test]
    fn a_run_that_does_not_end_leaves_the_earlier_files_whole_and_a_mark() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        prepare(folder).unwrap();
        write(folder, &sample(), &Record::default(), b"picture").unwrap();
        let report = || std::fs::read(folder.join("report.json")).unwrap();
        let before = report();
        assert!(!folder.join("unfinished.txt").exists());
        prepare(folder).unwrap();
        assert_eq!(report(), before);
        let mark = std::fs::read_to_string(folder.join("unfinished.txt")).unwrap();
        assert!(mark.contains("earlier run"), "{mark}");
        // A folder stands where the picture is to go: the report stays that of the earlier run.
        std::fs::remove_file(folder.join("run.png")).unwrap();
        std::fs::create_dir(folder.join("run.png")).unwrap();
        let mut other = sample();
        other.seed += 1;
        let error = write(folder, &other, &Record::default(), b"").unwrap_err();
        assert!(error.to_string().contains("run.png"), "{error}");
        assert_eq!(report(), before);
        assert!(folder.join("unfinished.txt").exists());
        assert!(!folder.join(".run.png.part").exists());
    }

    #[test]
    fn a_series_replaces_the_earlier_one_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let folder = folder.path();
        let series = folder.join("snapshots");
        let names = || {
            let entries = std::fs::read_dir(&series).unwrap();
            let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
            names.collect::<std::collections::BTreeSet<_>>()
        };
        let begin = || write(folder, &sample(), &Record::default(), b"").unwrap();
        prepare(folder).unwrap();
        write_snapshots(folder, core::iter::empty()).unwrap();
        assert!(!series.exists());
        write_snapshots(folder, (0..12).map(|k| vec![k])).unwrap();
        write_corrections(folder, (0..2).map(|k| [vec![k], vec![k + 1]])).unwrap();
        assert_eq!(names().len(), 16);
        let after = std::fs::read(series.join("correction-002-after.png"));
        assert_eq!(after.unwrap(), [2]);
        assert_eq!(std::fs::read(series.join("012.png")).unwrap(), [11]);
        std::fs::write(series.join("mine.png"), b"").unwrap();
        begin();
        write_snapshots(folder, (0..1).map(|k| vec![k])).unwrap();
        assert_eq!(names(), ["001.png", "mine.png"].map(String::from).into());
        std::fs::remove_file(series.join("mine.png")).unwrap();
        begin();
        assert!(!series.exists());
    }

    #[test]
    fn a_folder_that_cannot_be_made_is_named() {
        let file = tempfile::NamedTempFile::new().unwrap();
        let error = prepare(&file.path().join("sub")).unwrap_err().to_string();
        assert!(
            error.contains(&file.path().display().to_string()),
            "{error}"
        );
        assert!(error.contains("--out") && !error.contains('\n'), "{error}");
    }
}
