//! One point of a study: the program itself, run on the point's case in a folder of its own.

use crate::case::Quantity;
use crate::error::{Error, Result};
use crate::study::design::{Measurement, is_of_accuracy};
use crate::study::store::{PointOutcome, words};
use crate::validate::lookup;
use serde_json::Value;
use std::fs::{self, File};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, ExitStatus, Stdio};
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::time::Duration;

/// What to run.
pub struct Task<'a> {
    /// Path of this program.
    pub program: &'a Path,
    /// Name of the analysis.
    pub analysis: &'static str,
    /// The case as JSON text.
    pub case: &'a str,
    /// The case file that messages are to name.
    pub file: &'a str,
    /// What to read from the report.
    pub quantity: &'a Quantity,
    /// Runs, whose times are all kept.
    pub repeats: u32,
    /// A run that takes longer than this is not repeated, s.
    pub slow: f64,
}

/// How it ended.
pub enum Ended {
    /// A measurement, or a reason that will not change.
    Done(PointOutcome),
    /// The process ended in a way that another run need not repeat (killed, out of memory).
    Crashed(String),
    /// It was stopped.
    Stopped,
}

/// Runs a point, as often as asked.
///
/// # Errors
/// A temporary folder that can't be written, or a program that can't be run.
pub fn point(task: &Task<'_>, stop: &AtomicBool) -> Result<Ended> {
    let folder = Temporary::new()?;
    let case = folder.0.join("case.json");
    fs::write(&case, task.case).map_err(|e| Error::io(&case, "write", &e))?;
    let mut found: Option<Measurement> = None;
    for _ in 0..task.repeats {
        let messages = folder.0.join("messages");
        let Some(status) = run(task, &folder.0, &messages, stop)? else { return Ok(Ended::Stopped) };
        let words = fs::read_to_string(&messages).unwrap_or_default();
        match status.code() {
            None => return Ok(Ended::Crashed(format!("the process was ended from outside ({status})"))),
            Some(0) => {}
            Some(1 | 2) => {
                return Ok(Ended::Done(Err(reason(&words, &case.display().to_string(), task.file))));
            }
            Some(_) => return Ok(Ended::Crashed(format!("the process failed ({status}): {}", words.trim()))),
        }
        let one = match measurement(task, &folder.0.join("out")) {
            Ok(one) => one,
            Err(why) => return Ok(Ended::Done(Err(why))),
        };
        let slow = one.wall_s.first().is_some_and(|wall| *wall > task.slow);
        match &mut found {
            None => found = Some(one),
            Some(found) => {
                found.wall_s.extend(one.wall_s);
                found.peak_memory_mb =
                    [found.peak_memory_mb, one.peak_memory_mb].into_iter().flatten().reduce(f64::max);
            }
        }
        if slow {
            break;
        }
    }
    Ok(Ended::Done(found.ok_or_else(|| "it was never run".to_owned())))
}

/// Runs the program once; none when it was stopped.
fn run(task: &Task<'_>, folder: &Path, messages: &Path, stop: &AtomicBool) -> Result<Option<ExitStatus>> {
    let file = File::create(messages).map_err(|e| Error::io(messages, "write", &e))?;
    let mut command = Command::new(task.program);
    command.arg(task.analysis).arg(folder.join("case.json")).arg("--out").arg(folder.join("out"));
    command.args(["--threads", "1", "--quiet", "--no-plots"]);
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(file);
    // an interrupt from the keyboard is for the study, which then ends its processes itself
    #[cfg(unix)]
    std::os::unix::process::CommandExt::process_group(&mut command, 0);
    let mut child = command.spawn().map_err(|e| Error::io(task.program, "run", &e))?;
    let mut pause = Duration::from_millis(1);
    loop {
        match child.try_wait() {
            Ok(Some(status)) => return Ok(Some(status)),
            Ok(None) if stop.load(Ordering::Relaxed) => {
                end(&mut child);
                return Ok(None);
            }
            Ok(None) => {
                std::thread::sleep(pause);
                pause = (pause * 2).min(Duration::from_millis(20));
            }
            Err(e) => {
                end(&mut child);
                return Err(Error::io(task.program, "wait for", &e));
            }
        }
    }
}

fn end(child: &mut Child) {
    // it may have ended by itself meanwhile
    let _ = child.kill();
    let _ = child.wait();
}

/// The message of a run that failed, in one line, about the user's file.
fn reason(words: &str, temporary: &str, file: &str) -> String {
    let words = words.replace(temporary, file);
    let in_one = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
    let lines: Vec<String> = words.lines().map(in_one).filter(|line| !line.is_empty()).collect();
    let line = lines.join("; ");
    let line = line.strip_prefix("error: ").unwrap_or(&line);
    if line.is_empty() { "it failed without a word".to_owned() } else { line.to_owned() }
}

fn measurement(task: &Task<'_>, out: &Path) -> std::result::Result<Measurement, String> {
    let read = |name: String| -> std::result::Result<Value, String> {
        let text = fs::read_to_string(out.join(&name)).map_err(|e| format!("{name} can't be read: {e}"))?;
        serde_json::from_str(&text).map_err(|e| format!("{name} can't be read: {e}"))
    };
    let report = read(format!("{}.json", task.analysis))?;
    let cost = read(format!("{}.cost.json", task.analysis))?;
    let path = task.quantity.path();
    let value = match lookup(&report, path, task.quantity.filter()).as_slice() {
        [Some(value)] => *value,
        [] | [None] => return Err(format!("its report has no number at {path}")),
        several => {
            return Err(format!(
                "its report has {} numbers at {path}, not one; pick one with `where`",
                several.len()
            ));
        }
    };
    let unknowns = report["model"]["degrees_of_freedom"].as_u64();
    Ok(Measurement {
        value,
        wall_s: vec![cost["wall_s"].as_f64().ok_or("its cost has no time")?],
        peak_memory_mb: cost["peak_memory_mb"].as_f64(),
        degrees_of_freedom: unknowns.ok_or("its report has no number of unknowns")?,
        steps: report["results"]["integrator"]["steps"].as_u64(),
        estimated_error: report["model"]["estimated_error"].as_f64(),
        warnings: warnings(&report["diagnostics"]),
        modelled: words(&report["model"]["modelled"]),
        left_out: words(&report["model"]["left_out"]),
    })
}

/// Warnings and errors of a report that touch the accuracy of its numbers, `code: message`.
fn warnings(diagnostics: &Value) -> Vec<String> {
    let text = |d: &Value| {
        let (level, code) = (d["level"].as_str()?, d["code"].as_str()?);
        (level != "info" && is_of_accuracy(code))
            .then(|| format!("{code}: {}", d["message"].as_str().unwrap_or_default()))
    };
    diagnostics.as_array().into_iter().flatten().filter_map(text).collect()
}

/// A folder that goes when it is dropped.
struct Temporary(PathBuf);

impl Temporary {
    fn new() -> Result<Self> {
        static NEXT: AtomicUsize = AtomicUsize::new(0);
        let base = std::env::temp_dir();
        loop {
            let number = NEXT.fetch_add(1, Ordering::Relaxed);
            let folder = base.join(format!("rotor-point-{}-{number}", std::process::id()));
            match fs::create_dir(&folder) {
                Ok(()) => return Ok(Self(folder)),
                // left by an earlier process of the same number
                Err(e) if e.kind() == std::io::ErrorKind::AlreadyExists && number < 100_000 => {}
                Err(e) => return Err(Error::io(&folder, "create this folder", &e)),
            }
        }
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // what can't be removed is left to the system's temporary folder
        let _ = fs::remove_dir_all(&self.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_reason_is_one_line_about_the_users_file() {
        let words = "error: /tmp/x/case.json: at `shaft`: wrong\n  found:   1\n  allowed: 2\n";
        assert_eq!(
            reason(words, "/tmp/x/case.json", "a.json"),
            "a.json: at `shaft`: wrong; found: 1; allowed: 2"
        );
    }

    #[test]
    fn temporary_folders_go() {
        let folder = Temporary::new().unwrap();
        let path = folder.0.clone();
        assert!(path.is_dir());
        drop(folder);
        assert!(!path.exists());
    }
}
