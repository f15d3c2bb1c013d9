//! Writing files whole or not at all: everything is computed first, written to temporary names in the
//! target folder, and renamed only when all of it is on disk.

use crate::error::{Error, Result};
use serde_json::Value;
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::Duration;

/// What ends the name of the file beside a report that tells what the run took, of which case and with which files.
const COST: &str = ".cost.json";
/// Age of a temporary file that no run can still be writing: they are written when all is computed.
const STALE_AGE: Duration = Duration::from_secs(3600);

/// Refuses an output folder that can't be one, before any work is done.
///
/// # Errors
/// When the path, or a part of it, exists and is not a folder.
pub fn check_folder(folder: &Path) -> Result<()> {
    let existing = folder.ancestors().find(|p| p.as_os_str().is_empty() || p.symlink_metadata().is_ok());
    match existing {
        Some(p) if !p.as_os_str().is_empty() && !p.is_dir() => Err(Error::Io {
            path: folder.to_owned(),
            action: "write reports to this folder",
            message: format!("{} is not a folder", p.display()),
            remedy: "give another one with --out".to_owned(),
        }),
        _ => Ok(()),
    }
}

/// The files of one run.
#[derive(Debug)]
pub struct Set<'a> {
    /// The analysis: the report is `<analysis>.json`.
    pub analysis: &'a str,
    /// The case file, as given.
    pub case: &'a Path,
    /// Names and contents of report and plots.
    pub files: Vec<(String, String)>,
    /// Time and memory of the run.
    pub cost: Value,
}

/// Another case whose reports a folder holds.
#[derive(Debug, PartialEq, Eq)]
pub struct Foreign {
    /// File of the other case.
    pub case: PathBuf,
    /// The analysis it was run with.
    pub analysis: String,
}

/// Reports of other case files in a folder. A case that is gone or was moved is no other one.
pub fn foreign(folder: &Path, case: &Path) -> Vec<Foreign> {
    let here = place(case);
    let mut list: Vec<Foreign> = names(folder)
        .into_iter()
        .filter_map(|name| {
            let analysis = name.strip_suffix(COST)?.to_owned();
            let other = PathBuf::from(beside(folder, &analysis)?.get("case")?.as_str()?);
            (other != here && other.exists() && folder.join(format!("{analysis}.json")).exists())
                .then_some(Foreign { case: other, analysis })
        })
        .collect();
    list.sort_by(|a, b| a.analysis.cmp(&b.analysis));
    list
}

/// Where a file is, however it was named.
fn place(file: &Path) -> PathBuf {
    fs::canonicalize(file).unwrap_or_else(|_| file.to_owned())
}

fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten();
    entries.filter_map(|entry| entry.file_name().into_string().ok()).collect()
}

/// What the last run of an analysis left beside its report.
fn beside(folder: &Path, analysis: &str) -> Option<Value> {
    serde_json::from_str(&fs::read_to_string(folder.join(format!("{analysis}{COST}"))).ok()?).ok()
}

/// Writes the files of a run in place of those of the run before: its plots that this one does not draw go.
/// Returns the paths.
///
/// # Errors
/// When a file can't be written; files already there are then left as they were.
pub fn write_set(folder: &Path, set: Set<'_>) -> Result<Vec<PathBuf>> {
    let plots: Vec<&String> = set.files.iter().map(|f| &f.0).filter(|name| is_plot(name)).collect();
    let mut cost = set.cost;
    cost["case"] = place(set.case).to_string_lossy().into();
    cost["plots"] = plots.iter().map(|name| name.as_str()).collect();
    let before = beside(folder, set.analysis).and_then(|old| old.get("plots")?.as_array().cloned());
    let outdated: Vec<PathBuf> = before
        .iter()
        .flatten()
        .filter_map(Value::as_str)
        .filter(|name| is_plot(name) && !plots.iter().any(|new| new == name))
        .map(|name| folder.join(name))
        .collect();
    let mut files = set.files;
    files.push((format!("{}{COST}", set.analysis), crate::report::json::text(&cost)));
    let paths = write_all(folder, &files)?;
    for path in outdated.iter().filter(|path| path.exists()) {
        fs::remove_file(path).map_err(|e| Error::io(path, "remove the plot of an earlier run", &e))?;
    }
    Ok(paths)
}

/// A plain name of a plot, which can't lead out of its folder.
fn is_plot(name: &str) -> bool {
    name.ends_with(".svg") && !name.contains(['/', '\\'])
}

/// Writes `(name, content)` pairs to `folder`, creating it; returns the paths.
///
/// # Errors
/// When a file can't be written; files already there are then left as they were.
pub fn write_all(folder: &Path, files: &[(String, String)]) -> Result<Vec<PathBuf>> {
    fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create this folder", &e))?;
    sweep(folder);
    let mut pending: Vec<(PathBuf, PathBuf)> = Vec::new();
    for (name, content) in files {
        let path = folder.join(name);
        let temporary = folder.join(format!(".{name}.{}.tmp", std::process::id()));
        let written = File::create(&temporary)
            .and_then(|mut file| file.write_all(content.as_bytes()).and_then(|()| file.sync_all()));
        pending.push((temporary, path));
        if let Err(e) = written {
            discard(&pending);
            return Err(Error::io(&folder.join(name), "write", &e));
        }
    }
    for (at, (temporary, path)) in pending.iter().enumerate() {
        if let Err(e) = fs::rename(temporary, path) {
            discard(&pending[at..]);
            return Err(Error::io(path, "replace", &e));
        }
    }
    Ok(pending.into_iter().map(|(_, path)| path).collect())
}

fn discard(pending: &[(PathBuf, PathBuf)]) {
    for (temporary, _) in pending {
        // nothing better can be done about a temporary file that can't be removed either
        let _ = fs::remove_file(temporary);
    }
}

/// Removes temporary files of runs that were killed.
fn sweep(folder: &Path) {
    for name in names(folder) {
        let Some(pid) = name.strip_prefix('.').and_then(|n| n.strip_suffix(".tmp")?.rsplit('.').next())
        else {
            continue;
        };
        let path = folder.join(&name);
        if pid.parse::<u32>().is_ok_and(|pid| !is_running(pid)) || is_old(&path) {
            // what can't be removed disturbs nobody
            let _ = fs::remove_file(path);
        }
    }
}

/// Whether a process with this number may be running; where that can't be seen, age decides.
fn is_running(pid: u32) -> bool {
    let processes = Path::new("/proc");
    !processes.join("self").exists() || processes.join(pid.to_string()).exists()
}

fn is_old(path: &Path) -> bool {
    let written = path.metadata().and_then(|m| m.modified());
    written.ok().and_then(|at| at.elapsed().ok()).is_some_and(|age| age > STALE_AGE)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_old_files_whole() {
        let folder = tempfile::tempdir().unwrap();
        let old = [("a.json".to_owned(), "old".to_owned())];
        write_all(folder.path(), &old).unwrap();
        let bad = [("a.json".to_owned(), "new".to_owned()), ("no/such/folder".to_owned(), String::new())];
        assert!(write_all(folder.path(), &bad).is_err());
        assert_eq!(fs::read_to_string(folder.path().join("a.json")).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    fn set<'a>(case: &'a Path, files: &[(&str, &str)]) -> Set<'a> {
        let files = files.iter().map(|(a, b)| (a.to_string(), b.to_string())).collect();
        Set { analysis: "modes", case, files, cost: serde_json::json!({}) }
    }

    /// The plots of a run go with its report; plots of other analyses and files of the user stay.
    #[test]
    fn a_set_replaces_the_set_before() {
        let folder = tempfile::tempdir().unwrap();
        let (out, case) = (folder.path().join("o"), folder.path().join("a.json"));
        fs::write(&case, "").unwrap();
        write_set(&out, set(&case, &[("modes.json", "1"), ("a.svg", "1"), ("b.svg", "1")])).unwrap();
        fs::write(out.join("mine.svg"), "").unwrap();
        write_set(&out, set(&case, &[("modes.json", "2"), ("b.svg", "2")])).unwrap();
        let mut left = names(&out);
        left.sort();
        assert_eq!(left, ["b.svg", "mine.svg", "modes.cost.json", "modes.json"]);
        // a file beside the report that was tampered with removes nothing elsewhere
        fs::write(out.join("modes.cost.json"), r#"{ "plots": ["../a.svg", 3, "x/../../a.svg"] }"#).unwrap();
        fs::write(folder.path().join("a.svg"), "").unwrap();
        write_set(&out, set(&case, &[("modes.json", "3")])).unwrap();
        assert!(folder.path().join("a.svg").exists());
    }

    #[test]
    fn another_case_is_noticed() {
        let folder = tempfile::tempdir().unwrap();
        let (out, a, b) = ["o", "a.json", "b.json"].map(|n| folder.path().join(n)).into();
        for case in [&a, &b] {
            fs::write(case, "").unwrap();
        }
        assert!(foreign(&out, &a).is_empty());
        write_set(&out, set(&a, &[("modes.json", "1")])).unwrap();
        assert!(foreign(&out, &a).is_empty());
        let found = foreign(&out, &b);
        assert!(found.len() == 1 && found[0].analysis == "modes" && found[0].case.ends_with("a.json"));
        // the case was renamed
        fs::remove_file(&a).unwrap();
        assert!(foreign(&out, &b).is_empty());
    }

    /// The process is this one, or one that can't exist.
    #[cfg(target_os = "linux")]
    #[test]
    fn what_killed_runs_left_is_removed() {
        let folder = tempfile::tempdir().unwrap();
        let mine = format!(".a.json.{}.tmp", std::process::id());
        for name in [".a.json.4194999.tmp", &mine, ".profile", "b.tmp", ".b.tmp"] {
            fs::write(folder.path().join(name), "").unwrap();
        }
        write_all(folder.path(), &[("c.json".to_owned(), String::new())]).unwrap();
        let mut left = names(folder.path());
        left.sort();
        assert_eq!(left, [mine.as_str(), ".b.tmp", ".profile", "b.tmp", "c.json"]);
    }

    #[test]
    fn a_file_is_not_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(check_folder(&file.join("deeper")).is_err());
        assert!(check_folder(&folder.path().join("new/deeper")).is_ok());
    }
}
