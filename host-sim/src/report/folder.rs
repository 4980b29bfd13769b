//! The folder of a run. Errors name the file and the remedy.

use std::fs;
use std::path::{Path, PathBuf};

use super::{GridMap, Report, TeamReport, commands, ros_map, tum};
use crate::trial::Record;

/// Folder of the pictures during the run.
const SNAPSHOTS: &str = "snapshots";
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

/// Makes `folder` and checks that files can be written to it.
///
/// # Errors
/// As [`WriteError`].
pub fn prepare(folder: &Path) -> Result<(), WriteError> {
    make(folder)?;
    remove_snapshots(folder)?;
    remove(folder, CORRECTED)?;
    // If the run is killed, the folder has an empty report instead of an older run's.
    put(folder, "report.json", b"")
}

/// Writes every file of a run into `folder`.
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
    put(folder, "report.json", report.to_json_pretty().as_bytes())?;
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
    if !record.corrected.is_empty() {
        let corrected = tum::text(&record.corrected);
        put(folder, CORRECTED, corrected.as_bytes())?;
    }
    put(folder, "commands.csv", commands::text(rows).as_bytes())?;
    put(folder, "run.png", picture)
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
    put(folder, "report.json", report.to_json_pretty().as_bytes())?;
    put(folder, "map.pgm", &ros_map::pgm(map))?;
    put(folder, "map.yaml", ros_map::yaml(map, "map.pgm").as_bytes())?;
    put(folder, "run.png", picture)
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
    let path = folder.join(RELATIONS);
    match fs::remove_file(&path) {
        Err(source) if source.kind() != std::io::ErrorKind::NotFound => {
            Err(WriteError { path, source })
        }
        _ => Ok(()),
    }
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
    let path = folder.join(name);
    fs::write(&path, bytes).map_err(|source| WriteError { path, source })
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
                "report.json",
                "run.png",
                "trajectory.tum",
                "trajectory_truth.tum"
            ]
        );
        assert_eq!(std::fs::read(folder.join("run.png")).unwrap(), b"picture");
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
        prepare(folder).unwrap();
        write_snapshots(folder, (0..1).map(|k| vec![k])).unwrap();
        assert_eq!(names(), ["001.png", "mine.png"].map(String::from).into());
        std::fs::remove_file(series.join("mine.png")).unwrap();
        prepare(folder).unwrap();
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
