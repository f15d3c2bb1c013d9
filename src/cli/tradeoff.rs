//! `rotor tradeoff`: arguments, progress and files of a study of cost and error.

use crate::case::Case;
use crate::cli::{conclude, cost, folder, respect, stop_on_interrupt};
use crate::error::{Error, Result};
use crate::report::{files, json};
use crate::study::{self, Conditions, TARGETS, check_target};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{ErrorKind, IsTerminal};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::{Duration, Instant};

/// Name of the case file with the chosen settings.
const CHOSEN_FILE: &str = "chosen.json";
/// Name of the folder of finished points.
const POINTS_FOLDER: &str = "tradeoff.points";

const NOTES: &str = "\
Every point of the grid runs as a process of its own on one thread; its time is the analysis' wall time (median of \
the runs; one run where it takes more than 10 s), its memory that of the process. Finished points are kept in \
tradeoff.points/ and used again by a later run of the same program on the same processor; an interrupt leaves them. \
Times differ from run to run, and tradeoff.json with them.

With --error the cheapest point within the error is written to chosen.json, a case file that is ready to run. A point \
that finer points of the grid confirm goes before one that has none, and that before one that a finer point refutes.

Examples:
  rotor tradeoff studies/tradeoff/tradeoff-tube.json
  rotor tradeoff studies/tradeoff/tradeoff-tube.json --error 1e-3 --out reports/tube
  rotor modes reports/tube/chosen.json

Exit codes: 0 done; 1 no point reaches the error, or none has a value; 2 bad input or usage.";

/// Arguments of a study.
#[derive(Args)]
#[command(after_help = NOTES)]
pub(super) struct TradeoffArguments {
    /// Case file (JSON) with a `tradeoff` block
    case: PathBuf,
    /// Choose the cheapest point with at most this relative error and write it to chosen.json
    #[arg(long, value_name = "ERROR")]
    error: Option<f64>,
    /// Folder for the report, the plot and the kept points [default: reports/<case file's stem>]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Override a value of the case, e.g. tradeoff.repeats=1 (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Points at a time; more than one disturb each other's times [default: 1]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Measure all points anew
    #[arg(long)]
    fresh: bool,
    /// No progress and no notes; errors only
    #[arg(long)]
    quiet: bool,
    /// Do not draw
    #[arg(long)]
    no_plots: bool,
}

/// Runs a study.
///
/// # Errors
/// Bad input, an interrupt, or files that can't be written.
pub(super) fn tradeoff(arguments: &TradeoffArguments) -> Result<ExitCode> {
    let start = Instant::now();
    if let Some(error) = arguments.error {
        check_target(error).map_err(|p| Error::Usage(format!("--error {error}: {p}; give {TARGETS}")))?;
    }
    let loaded = Case::load(&arguments.case, &arguments.set)?;
    let folder = folder(arguments.out.as_ref(), &arguments.case);
    files::check_folder(&folder)?;
    respect(&folder, arguments.out.is_some(), &arguments.case, "tradeoff", arguments.quiet)?;
    let plan = study::plan(&loaded)?;
    let program = std::env::current_exe()
        .map_err(|e| Error::Usage(format!("the path of this program is not known: {e}")))?;
    let conditions = Conditions {
        program,
        folder: folder.join(POINTS_FOLDER),
        at_a_time: arguments.threads.map_or(1, usize::from),
        fresh: arguments.fresh,
    };
    let stop = Arc::new(AtomicBool::new(false));
    stop_on_interrupt(&stop, None)?;
    let bar = progress_bar(plan.points.len(), arguments.quiet);
    let progress = |done: usize, name: &str| {
        bar.set_position(done as u64);
        bar.set_message(name.to_owned());
    };
    let measured = study::measure(&plan, &conditions, &stop, &progress);
    bar.finish_and_clear();
    let measured = measured?;
    let plots = !arguments.no_plots;
    let concluded = study::finish(&loaded, &plan, &measured, arguments.error, conditions.at_a_time, plots)?;
    let finished = concluded.finished;
    let mut pending = vec![("tradeoff.json".to_owned(), json::text(&finished.json))];
    pending.extend(finished.plots);
    match concluded.chosen {
        Some(case) => pending.push((CHOSEN_FILE.to_owned(), study::case_text(&case))),
        None if concluded.target.is_some() => remove(&folder.join(CHOSEN_FILE))?,
        None => {}
    }
    let set =
        files::Set { analysis: "tradeoff", case: &arguments.case, files: pending, cost: cost(start, None) };
    let paths = files::write_set(&folder, set)?;
    conclude(&finished.table, &finished.diagnostics, &paths, arguments.quiet)
}

/// Removes the choice of an earlier run, which this one contradicts.
fn remove(path: &std::path::Path) -> Result<()> {
    match std::fs::remove_file(path) {
        Err(e) if e.kind() != ErrorKind::NotFound => Err(Error::io(path, "remove", &e)),
        _ => Ok(()),
    }
}

fn progress_bar(points: usize, quiet: bool) -> ProgressBar {
    if quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(points as u64), ProgressDrawTarget::stderr());
    let template = "tradeoff [{bar:30}] {pos}/{len} points, {msg}, {elapsed}, {eta} left";
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar.enable_steady_tick(Duration::from_millis(500));
    bar
}
