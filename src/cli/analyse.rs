//! The commands that run one analysis and write its report.

use crate::case::{Case, LoadedCase};
use crate::cli::{conclude, cost, folder, respect, stop_on_interrupt};
use crate::error::Result;
use crate::instructions::Instructions;
use crate::report::{files, json};
use crate::run::{self, Analysis, Host, Steps};
use clap::Args;
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Steps of the progress of a transient.
const TICKS: usize = 1000;

/// Arguments of a run.
#[derive(Args)]
pub(super) struct RunArguments {
    /// Case file (JSON)
    pub(super) case: PathBuf,
    /// Folder for the report and plots [default: reports/<case file's stem>]
    #[arg(long)]
    pub(super) out: Option<PathBuf>,
    /// Override a value of the case, e.g. shaft.segments.0.elements=8 (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    pub(super) set: Vec<String>,
    /// Threads for independent speeds [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    pub(super) threads: Option<u16>,
    /// Vector instructions of the force kernels, narrower than the processor's to compute as another one does
    #[arg(long, value_name = "SET", value_parser = instructions)]
    pub(super) instructions: Option<Instructions>,
    /// No progress and no notes; errors only
    #[arg(long)]
    pub(super) quiet: bool,
    /// Do not draw
    #[arg(long)]
    pub(super) no_plots: bool,
}

/// The set of vector instructions of that name, if this processor has it.
fn instructions(name: &str) -> std::result::Result<Instructions, String> {
    let available: Vec<&str> =
        Instructions::NAMED.into_iter().filter(|set| set.are_available()).map(Instructions::name).collect();
    let found = Instructions::from_name(name).filter(|set| set.are_available());
    found.ok_or_else(|| format!("this processor has {}", available.join(", ")))
}

/// Loads the case of a run, and the folder that its files go to; sets threads and instructions.
///
/// # Errors
/// Bad input, or a folder that can't be used.
pub(super) fn load(arguments: &RunArguments, analysis: &str) -> Result<(LoadedCase, PathBuf)> {
    let loaded = Case::load(&arguments.case, &arguments.set)?;
    let folder = folder(arguments.out.as_ref(), &arguments.case);
    files::check_folder(&folder)?;
    respect(&folder, arguments.out.is_some(), &arguments.case, analysis, arguments.quiet)?;
    if let Some(set) = arguments.instructions {
        set.narrow_process();
    }
    if let Some(threads) = arguments.threads {
        // fails only when a pool exists already, which then has the right size
        let _ = rayon::ThreadPoolBuilder::new().num_threads(usize::from(threads)).build_global();
    }
    Ok((loaded, folder))
}

/// Runs an analysis and writes what it gives.
///
/// # Errors
/// Bad input, an analysis that does not succeed, or files that can't be written.
pub(super) fn analyse(arguments: &RunArguments, analysis: Analysis) -> Result<ExitCode> {
    let start = Instant::now();
    let (loaded, folder) = load(arguments, analysis.name())?;
    let steps = run::steps(&loaded, analysis)?;
    let bar = progress_bar(analysis, steps, arguments.quiet);
    let (stop, noticed) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    if steps == Steps::Share {
        stop_on_interrupt(&stop, Some(&noticed))?;
    }
    let watch = |share: f64, line: &str| {
        bar.set_position((share * TICKS as f64) as u64);
        bar.set_message(line.to_owned());
        let stopped = stop.load(Ordering::Relaxed);
        noticed.fetch_or(stopped, Ordering::Relaxed);
        !stopped
    };
    let progress = |done| bar.inc(done as u64);
    let host = Host { plots: !arguments.no_plots, progress: &progress, watch: &watch };
    let finished = run::run(&loaded, analysis, &host)?;
    bar.finish_and_clear();
    let mut pending = vec![(format!("{}.json", analysis.name()), json::text(&finished.json))];
    pending.extend(finished.plots);
    let set = files::Set {
        analysis: analysis.name(),
        case: &arguments.case,
        files: pending,
        cost: cost(start, finished.cost),
    };
    let paths = files::write_set(&folder, set)?;
    conclude(&finished.table, &finished.diagnostics, &paths, arguments.quiet)
}

fn progress_bar(analysis: Analysis, steps: Steps, quiet: bool) -> ProgressBar {
    let (count, template) = match steps {
        _ if quiet || !std::io::stderr().is_terminal() => return ProgressBar::hidden(),
        Steps::None => return ProgressBar::hidden(),
        Steps::Speeds(count) => (count, "[{bar:40}] {pos}/{len} speeds, {eta} left"),
        Steps::Share => (TICKS, "[{bar:30}] {percent} %, {msg}, {eta} left"),
    };
    let bar = ProgressBar::with_draw_target(Some(count as u64), ProgressDrawTarget::stderr());
    if let Ok(style) = ProgressStyle::with_template(&format!("{} {template}", analysis.name())) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
}
