//! The command line: arguments, progress, exit codes.
//!
//! Exit codes: 0 done; 1 the analysis ran but did not succeed (no convergence, out of tolerance); 2 bad
//! input or usage. Results go to standard output, progress and messages to standard error.

mod analyse;
mod matrices;
mod terminal;
mod tradeoff;
mod validate;

use crate::case::schema;
use crate::error::{Error, Result};
use crate::report::{files, json};
use crate::results::{Diagnostic, Level};
use crate::run::{Analysis, entry};
use analyse::{RunArguments, analyse};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use clap_complete::Shell;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use terminal::{print, say, written};

/// Exit code of a run that an interrupt ended at once.
const INTERRUPTED: i32 = 130;
/// Time in which a run notices an interrupt.
const NOTICE_TIME: Duration = Duration::from_secs(5);

/// Rotordynamics on the higher-order ANCF beam element 34X3.
#[derive(Parser)]
#[command(name = "rotor", version, about)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

/// The commands that are no analyses.
#[derive(Subcommand)]
enum Command {
    /// Cost and error over a grid of settings: Pareto front, and the cheapest setting for an error
    Tradeoff(tradeoff::TradeoffArguments),
    /// Write M, G, N and K0 as Matrix Market files, with the meaning of their rows
    Matrices(RunArguments),
    /// Run what cases expect and print ours / reference / error
    Validate(validate::ValidateArguments),
    /// Print the JSON Schema of the case file
    Schema,
    /// Print what completes commands and options in a shell, e.g. rotor completions bash > /etc/bash_completion.d/rotor
    Completions {
        /// The shell
        shell: Shell,
    },
}

/// The whole command line: a command for each analysis, then the others.
fn command_line() -> clap::Command {
    let mut examples: Vec<&str> =
        Analysis::all().flat_map(|analysis| entry(analysis).examples).copied().collect();
    examples.extend(["rotor tradeoff studies/tradeoff/tradeoff-tube.json --error 1e-3", "rotor validate"]);
    let after = format!(
        "{}\n\nExit codes: 0 done; 1 the analysis did not succeed (no convergence, out of tolerance); 2 bad input or usage.",
        shown(&examples)
    );
    let of = |(place, analysis): (usize, Analysis)| {
        let entry = entry(analysis);
        RunArguments::augment_args(clap::Command::new(analysis.name()))
            .about(entry.about)
            .long_about(None::<&str>)
            .after_help(shown(entry.examples))
            .display_order(place)
    };
    let others = |command: clap::Command| command.display_order(Analysis::all().count());
    Arguments::command()
        .after_help(after)
        .mut_subcommands(others)
        .subcommands(Analysis::all().enumerate().map(of))
}

/// Command lines in a help text.
fn shown(examples: &[&str]) -> String {
    format!("Examples:\n  {}", examples.join("\n  "))
}

/// Runs the program on the process' arguments.
pub fn main() -> ExitCode {
    let outcome = match command_line().try_get_matches() {
        Ok(matches) => execute(&matches),
        Err(e) => usage(&e),
    };
    match outcome {
        Ok(code) => code,
        Err(e) => {
            // the exit code tells what could not be said
            let _ = say(&format!("error: {e}"));
            ExitCode::from(e.exit_code())
        }
    }
}

/// Help goes to standard output with code 0, faults of usage to standard error with code 2.
fn usage(message: &clap::Error) -> Result<ExitCode> {
    let stream = if message.use_stderr() { "standard error" } else { "standard output" };
    let printed = message.print().and_then(|()| std::io::stdout().flush());
    let code = u8::try_from(message.exit_code()).unwrap_or(2);
    match written(stream, printed) {
        Err(lost) if code == 0 => Err(lost),
        _ => Ok(ExitCode::from(code)),
    }
}

fn execute(matches: &clap::ArgMatches) -> Result<ExitCode> {
    let unread = |e: clap::Error| Error::Usage(e.to_string());
    if let Some((name, of)) = matches.subcommand()
        && let Some(analysis) = Analysis::from_name(name)
    {
        return analyse(&RunArguments::from_arg_matches(of).map_err(unread)?, analysis);
    }
    match Arguments::from_arg_matches(matches).map_err(unread)?.command {
        Command::Tradeoff(arguments) => tradeoff::tradeoff(&arguments),
        Command::Matrices(arguments) => matrices::write_matrices(&arguments),
        Command::Validate(arguments) => validate::validate_cases(&arguments),
        Command::Schema => {
            print(&json::text(&schema()))?;
            Ok(ExitCode::SUCCESS)
        }
        Command::Completions { shell } => {
            let mut text = Vec::new();
            clap_complete::generate(shell, &mut command_line(), "rotor", &mut text);
            print(&String::from_utf8_lossy(&text))?;
            Ok(ExitCode::SUCCESS)
        }
    }
}

/// The folder of the reports of a case, by default named for it.
fn folder(out: Option<&PathBuf>, case: &Path) -> PathBuf {
    out.cloned().unwrap_or_else(|| {
        // "...json" has the stem "..", which is no name for a folder
        let name = match case.file_stem() {
            Some(stem) if stem != "." && stem != ".." => Some(stem),
            _ => case.file_name(),
        };
        Path::new("reports").join(name.unwrap_or("case".as_ref()))
    })
}

/// Reports of two case files of one name do not replace each other unnoticed.
fn respect(folder: &Path, given: bool, case: &Path, analysis: &str, quiet: bool) -> Result<()> {
    let others = files::foreign(folder, case);
    let case_of = |other: &files::Foreign| other.case.display().to_string();
    match others.first() {
        Some(other) if !given => Err(Error::Usage(format!(
            "{} holds reports of another case file, {}\n  allowed: --out with another folder, e.g. --out {}; or remove the old reports",
            folder.display(),
            case_of(other),
            beside(folder, case).display()
        ))),
        _ => match others.iter().find(|other| other.analysis == analysis) {
            Some(other) if !quiet => say(&format!(
                "note: {} of {} is replaced by that of {}",
                folder.join(format!("{analysis}.json")).display(),
                case_of(other),
                case.display()
            )),
            _ => Ok(()),
        },
    }
}

/// A folder beside the usual one, named for the folder of the case, too.
fn beside(folder: &Path, case: &Path) -> PathBuf {
    let full = std::fs::canonicalize(case).unwrap_or_else(|_| case.to_owned());
    let parent = full.parent().and_then(Path::file_name).unwrap_or("other".as_ref());
    let mut name = parent.to_os_string();
    name.push("-");
    name.push(folder.file_name().unwrap_or_default());
    folder.with_file_name(name)
}

/// The first interrupt ends the run with what is done, the second one at once; so does time, where the run is in a part
/// that has nothing to report yet and does not notice.
fn stop_on_interrupt(stop: &Arc<AtomicBool>, noticed: Option<&Arc<AtomicBool>>) -> Result<()> {
    let (stop, noticed) = (stop.clone(), noticed.cloned());
    let on_interrupt = move || {
        if stop.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
        if let Some(noticed) = noticed.clone() {
            std::thread::spawn(move || {
                std::thread::sleep(NOTICE_TIME);
                if !noticed.load(Ordering::Relaxed) {
                    std::process::exit(INTERRUPTED);
                }
            });
        }
    };
    ctrlc::set_handler(on_interrupt).map_err(|e| Error::Usage(format!("no interrupt handler: {e}")))
}

/// Prints the table and the paths, failed checks to standard error, and gives the exit code.
fn conclude(table: &str, diagnostics: &[Diagnostic], paths: &[PathBuf], quiet: bool) -> Result<ExitCode> {
    let failed: Vec<&Diagnostic> = diagnostics.iter().filter(|d| d.level == Level::Error).collect();
    for d in &failed {
        say(&format!("error: {} [{}]", d.message, d.code))?;
    }
    if !quiet {
        print(&format!("{table}{}", written_paths(paths)))?;
    }
    Ok(ExitCode::from(u8::from(!failed.is_empty())))
}

/// The reports and plots that were written, a line each.
fn written_paths(paths: &[PathBuf]) -> String {
    let shown = paths.iter().filter(|p| !p.to_string_lossy().ends_with(".cost.json"));
    shown.map(|path| format!("wrote {}\n", path.display())).collect()
}

/// Wall time and peak memory of this run; kept beside the report, not in it, so that reports repeat.
fn cost(start: Instant, phases: Option<serde_json::Value>) -> serde_json::Value {
    let peak = std::fs::read_to_string("/proc/self/status").ok().and_then(|status| {
        let line = status.lines().find(|l| l.starts_with("VmHWM:"))?;
        line.split_whitespace().nth(1)?.parse::<f64>().ok()
    });
    serde_json::json!({
        "wall_s": start.elapsed().as_secs_f64(),
        "peak_memory_mb": peak.map(|kb| kb / 1024.0),
        "threads": rayon::current_num_threads(),
        "phases": phases,
    })
}
