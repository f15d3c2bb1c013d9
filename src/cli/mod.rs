//! The command line: arguments, progress, exit codes.
//!
//! Exit codes: 0 done; 1 the analysis ran but did not succeed (no convergence, out of tolerance); 2 bad
//! input or usage. Results go to standard output, progress and messages to standard error.

mod terminal;
mod tradeoff;

use crate::analysis::matrices::matrices;
use crate::case::{Case, LoadedCase, schema};
use crate::error::{Error, Result};
use crate::instructions::Instructions;
use crate::model::Model;
use crate::report::{files, json, matrix_market, table};
use crate::results::{Diagnostic, Level};
use crate::run::{self, Analysis};
use crate::validate::{Comparison, validate};
use clap::{Args, CommandFactory, FromArgMatches, Parser, Subcommand};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::{IsTerminal, Write};
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};
use terminal::{print, say, written};

/// Exit code of a run that an interrupt ended at once.
const INTERRUPTED: i32 = 130;
/// Time in which a run notices an interrupt.
const PATIENCE: Duration = Duration::from_secs(5);

const EXAMPLES: &str = "\
Examples:
  rotor campbell cases/bauchau.json
  rotor campbell cases/bauchau.json --set shaft.segments.0.elements=32 --out reports/bauchau-32
  rotor modes cases/table3-tube.json --set modes.count=12
  rotor spinup cases/table8-spin-circle.json
  rotor spinup cases/rub-ring.json --set spinup.stators.0.friction=0.02
  rotor static cases/table5-cantilever.json --set shaft.segments.0.elements=16
  rotor contact cases/side-to-side.json
  rotor check cases/jeffcott.json
  rotor tradeoff studies/tradeoff/tradeoff-tube.json --error 1e-3
  rotor validate

Exit codes: 0 done; 1 the analysis did not succeed (no convergence, out of tolerance); 2 bad input or usage.";

/// Rotordynamics on the higher-order ANCF beam element 34X3.
#[derive(Parser)]
#[command(name = "rotor", version, about, after_help = EXAMPLES)]
struct Arguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Say what will be modelled and left out, with size, mass, inertia, memory and time
    Check(RunArguments),
    /// Natural frequencies and mode shapes at rest
    Modes(RunArguments),
    /// Whirl frequencies over spin speed, and critical speeds
    Campbell(RunArguments),
    /// Equilibrium under loads and gravity, with finite displacements
    Static(RunArguments),
    /// Run up to speed: growth, stresses, orbit, torque, energies and rub in rings over time
    Spinup(RunArguments),
    /// Equilibrium or motion of beams in contact: gaps, forces, energies, events
    Contact(RunArguments),
    /// Cost and error over a grid of settings: Pareto front, and the cheapest setting for an error
    Tradeoff(tradeoff::TradeoffArguments),
    /// Write M, G, N and K0 as Matrix Market files, with the meaning of their rows
    Matrices(RunArguments),
    /// Run what cases expect and print ours / reference / error
    Validate(ValidateArguments),
    /// Print the JSON Schema of the case file
    Schema,
}

#[derive(Args)]
struct RunArguments {
    /// Case file (JSON)
    case: PathBuf,
    /// Folder for the report and plots [default: reports/<case file's stem>]
    #[arg(long)]
    out: Option<PathBuf>,
    /// Override a value of the case, e.g. shaft.segments.0.elements=8 (repeatable)
    #[arg(long, value_name = "PATH=VALUE")]
    set: Vec<String>,
    /// Threads for independent speeds [default: all cores]
    #[arg(long, value_parser = clap::value_parser!(u16).range(1..=1024))]
    threads: Option<u16>,
    /// Vector instructions of the force kernels, narrower than the processor's to compute as another one does
    #[arg(long, value_name = "SET", value_parser = instructions)]
    instructions: Option<Instructions>,
    /// No progress and no notes; errors only
    #[arg(long)]
    quiet: bool,
    /// Do not draw
    #[arg(long)]
    no_plots: bool,
}

/// The set of vector instructions of that name, if this processor has it.
fn instructions(name: &str) -> std::result::Result<Instructions, String> {
    let available: Vec<&str> =
        Instructions::NAMED.into_iter().filter(|set| set.are_available()).map(Instructions::name).collect();
    let found = Instructions::from_name(name).filter(|set| set.are_available());
    found.ok_or_else(|| format!("this processor has {}", available.join(", ")))
}

#[derive(Args)]
struct ValidateArguments {
    /// Case files [default: every .json in cases/]
    cases: Vec<PathBuf>,
    /// Print only what is out of tolerance
    #[arg(long)]
    quiet: bool,
}

/// Runs the program on the process' arguments.
pub fn main() -> ExitCode {
    let outcome = match Arguments::command().try_get_matches() {
        Ok(matches) => Arguments::from_arg_matches(&matches)
            .map_err(|e| Error::Usage(e.to_string()))
            .and_then(|arguments| execute(&arguments.command)),
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

fn execute(command: &Command) -> Result<ExitCode> {
    match command {
        Command::Check(arguments) => analyse(arguments, Analysis::Check),
        Command::Modes(arguments) => analyse(arguments, Analysis::Modes),
        Command::Campbell(arguments) => analyse(arguments, Analysis::Campbell),
        Command::Static(arguments) => analyse(arguments, Analysis::Static),
        Command::Spinup(arguments) => analyse(arguments, Analysis::Spinup),
        Command::Contact(arguments) => analyse(arguments, Analysis::Contact),
        Command::Tradeoff(arguments) => tradeoff::tradeoff(arguments),
        Command::Matrices(arguments) => write_matrices(arguments),
        Command::Validate(arguments) => validate_cases(arguments),
        Command::Schema => {
            print(&json::text(&schema()))?;
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

fn load(arguments: &RunArguments, analysis: &str) -> Result<(LoadedCase, PathBuf)> {
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

fn analyse(arguments: &RunArguments, analysis: Analysis) -> Result<ExitCode> {
    let start = Instant::now();
    let (loaded, folder) = load(arguments, analysis.name())?;
    let bar = progress_bar(analysis, run::steps(&loaded, analysis)?, arguments.quiet);
    let (stop, noticed) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicBool::new(false)));
    if matches!(analysis, Analysis::Spinup | Analysis::Contact) {
        stop_on_interrupt(&stop, Some(&noticed))?;
    }
    let watch = |share: f64, line: &str| {
        bar.set_position((share * run::TICKS as f64) as u64);
        bar.set_message(line.to_owned());
        let stopped = stop.load(Ordering::Relaxed);
        noticed.fetch_or(stopped, Ordering::Relaxed);
        !stopped
    };
    let finished = run::run(&loaded, analysis, !arguments.no_plots, &|done| bar.inc(done as u64), &watch)?;
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
                std::thread::sleep(PATIENCE);
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

fn progress_bar(analysis: Analysis, steps: usize, quiet: bool) -> ProgressBar {
    if steps == 0 || quiet || !std::io::stderr().is_terminal() {
        return ProgressBar::hidden();
    }
    let bar = ProgressBar::with_draw_target(Some(steps as u64), ProgressDrawTarget::stderr());
    let template = match analysis {
        Analysis::Spinup => "spinup [{bar:30}] {percent} %, {msg}, {eta} left",
        Analysis::Contact => "contact [{bar:30}] {percent} %, {msg}, {eta} left",
        _ => "campbell [{bar:40}] {pos}/{len} speeds, {eta} left",
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style.progress_chars("=> "));
    }
    bar
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

fn write_matrices(arguments: &RunArguments) -> Result<ExitCode> {
    let start = Instant::now();
    let (loaded, folder) = load(arguments, "matrices")?;
    let model = Model::new(&loaded)?;
    let (rows, list) = matrices(&model);
    let mut pending: Vec<(String, String)> = list
        .iter()
        .map(|m| (format!("{}.mtx", m.name), matrix_market::text(m, &loaded.case.title)))
        .collect();
    pending.push((
        "matrices.json".to_owned(),
        json::text(&matrix_market::sidecar(&rows, &list, &loaded.sha256)),
    ));
    let set =
        files::Set { analysis: "matrices", case: &arguments.case, files: pending, cost: cost(start, None) };
    let paths = files::write_set(&folder, set)?;
    if !arguments.quiet {
        print(&format!("{} unknowns, unconstrained, physical units\n{}", rows.len(), written_paths(&paths)))?;
    }
    Ok(ExitCode::SUCCESS)
}

fn validate_cases(arguments: &ValidateArguments) -> Result<ExitCode> {
    let cases = if arguments.cases.is_empty() { all_cases()? } else { arguments.cases.clone() };
    let (mut total, mut out) = (0, 0);
    for path in &cases {
        let loaded = Case::load(path, &[])?;
        let comparisons = validate(&loaded)?;
        total += comparisons.len();
        let failed = comparisons.iter().filter(|c| !c.holds()).count();
        out += failed;
        if !arguments.quiet || failed > 0 {
            let shown: Vec<&Comparison> =
                comparisons.iter().filter(|c| !arguments.quiet || !c.holds()).collect();
            print(&format!("{}\n{}\n", path.display(), comparison_table(&shown)))?;
        }
    }
    print(&format!("{} of {total} values within tolerance, {} cases\n", total - out, cases.len()))?;
    Ok(ExitCode::from(u8::from(out > 0)))
}

fn all_cases() -> Result<Vec<PathBuf>> {
    let folder = Path::new("cases");
    let entries =
        std::fs::read_dir(folder).map_err(|e| Error::io(folder, "read this folder of cases", &e))?;
    let mut paths: Vec<PathBuf> = entries
        .filter_map(|entry| entry.ok().map(|e| e.path()))
        .filter(|path| path.extension().is_some_and(|e| e == "json"))
        .collect();
    paths.sort();
    Ok(paths)
}

fn comparison_table(comparisons: &[&Comparison]) -> String {
    if comparisons.is_empty() {
        return "  nothing expected\n".to_owned();
    }
    // small values in powers of ten: a growth of micrometres has digits too
    let number = |value: Option<f64>| match value {
        None => "-".to_owned(),
        Some(v) if v != 0.0 && v.abs() < 0.1 => format!("{v:.6e}"),
        Some(v) => format!("{v:.6}"),
    };
    let rows: Vec<Vec<String>> = comparisons
        .iter()
        .map(|c| {
            vec![
                if c.holds() { "ok" } else { "OUT" }.to_owned(),
                number(c.ours),
                number(Some(c.reference)),
                c.error().map_or("-".to_owned(), |e| format!("{e:.1e}")),
                format!("{:.1e}", c.tolerance),
                number(c.published),
                format!("{} {} ({})", c.analysis, c.path, c.source),
            ]
        })
        .collect();
    table::columns(&["", "ours", "reference", "error", "tolerance", "published", "value (source)"], &rows)
}
