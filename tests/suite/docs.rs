//! The pages under docs/: references that must lead somewhere, commands that must print what stands below them.
//!
//! A block marked ```` ```json NAME ```` is a file of that name, ```` ```json NAME (added) ```` keys that are added at the top level of it.
//! A block marked ```` ```console ```` has commands (`$ ...`) and lines that their output has, in that order, numbers to a relative 1e-3
//! or one unit of their last digit; `...` stands for lines left out. A command succeeds, or the next one is `$ echo $?`, whose
//! line is its exit code. Blocks marked ```` ```console long ```` are left to the long tests. With `ROTOR_WRITE_DOCS` set, a line that
//! is not printed any more is replaced by the printed line that shares most words with it: read the difference before it is kept.

use crate::cli::{files, read, workplace};
use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};
use std::process::Command;

fn project() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Files with an extension under a folder, sorted.
fn under(folder: &str, extension: &str) -> Vec<PathBuf> {
    let mut list = Vec::new();
    for name in files(&project().join(folder)) {
        let path = format!("{folder}/{name}");
        if project().join(&path).is_dir() {
            list.extend(under(&path, extension));
        } else if name.ends_with(extension) {
            list.push(PathBuf::from(path));
        }
    }
    list
}

/// Anchors of a page: the explicit ones and those of its headings, as GitHub makes them.
fn anchors(page: &Path) -> BTreeSet<String> {
    let text = read(project().join(page));
    let explicit = regex_lite::Regex::new(r#"<a id="([^"]+)"></a>"#).expect("a pattern");
    let mut list = BTreeSet::new();
    for found in explicit.captures_iter(&text) {
        assert!(list.insert(found[1].to_owned()), "{}: two anchors {}", page.display(), &found[1]);
    }
    let mut inside = false;
    for line in text.lines() {
        inside ^= line.starts_with("```");
        if !inside && line.starts_with('#') {
            let title = line.trim_start_matches('#').trim().to_lowercase();
            let kept = title.chars().filter(|c| c.is_alphanumeric() || " -_".contains(*c));
            list.insert(kept.map(|c| if c == ' ' { '-' } else { c }).collect());
        }
    }
    list
}

/// A path without `.` and `..`.
fn plain(path: &Path) -> PathBuf {
    let mut list = PathBuf::new();
    for part in path.components() {
        match part {
            std::path::Component::ParentDir => assert!(list.pop(), "{} leaves the project", path.display()),
            std::path::Component::CurDir => {}
            part => list.push(part),
        }
    }
    list
}

/// Every page and anchor that the sources, the cases, the tests and the pages name exists.
#[test]
fn references_to_pages_lead_somewhere() {
    let named = regex_lite::Regex::new(r"\bdocs/[A-Za-z0-9_./-]+\.md(#[A-Za-z0-9_-]+)?").expect("a pattern");
    let link = regex_lite::Regex::new(r"\]\(([^)\s]+)\)").expect("a pattern");
    let mut sources = under("src", ".rs");
    sources.extend(under("tests/suite", ".rs"));
    sources.extend(under("benches", ".rs"));
    sources.extend(under("cases", ".json"));
    let mut pages = under("docs", ".md");
    pages.extend(["README.md", "CONTRIBUTING.md", "CHANGELOG.md", "studies/README.md"].map(PathBuf::from));
    let mut known: BTreeMap<PathBuf, BTreeSet<String>> = BTreeMap::new();
    let (mut wrong, mut count) = (Vec::new(), 0);
    let mut look = |from: &Path, path: PathBuf, anchor: Option<&str>| {
        count += 1;
        let path = plain(&path);
        if !project().join(&path).exists() {
            wrong.push(format!("{}: {} does not exist", from.display(), path.display()));
        } else if let Some(anchor) = anchor {
            let list = known.entry(path.clone()).or_insert_with(|| anchors(&path));
            if !list.contains(anchor) {
                wrong.push(format!("{}: {} has no anchor #{anchor}", from.display(), path.display()));
            }
        }
    };
    for file in sources.iter().chain(&pages) {
        let text = read(project().join(file));
        for found in named.find_iter(&text) {
            let (path, anchor) = split(found.as_str());
            look(file, PathBuf::from(path), anchor);
        }
    }
    for page in &pages {
        let text = read(project().join(page));
        let folder = page.parent().expect("a folder");
        for found in link.captures_iter(&text).filter(|found| !found[1].contains("://")) {
            let (path, anchor) = split(found.get(1).expect("a group").as_str());
            let target = if path.is_empty() { page.clone() } else { folder.join(path) };
            look(page, target, anchor);
        }
    }
    assert!(wrong.is_empty(), "{wrong:#?}");
    assert!(count >= 150, "only {count} references found");
}

fn split(reference: &str) -> (&str, Option<&str>) {
    reference.split_once('#').map_or((reference, None), |(path, anchor)| (path, Some(anchor)))
}

/// The index pages name every page of their folder.
#[test]
fn index_pages_are_complete() {
    for folder in ["docs/theory", "docs/how-to"] {
        let index = read(project().join(folder).join("README.md"));
        for page in files(&project().join(folder)).iter().filter(|name| *name != "README.md") {
            assert!(index.contains(&format!("({page})")), "{folder}/README.md does not name {page}");
        }
    }
}

/// Runs the commands of a page in a folder with the cases and the studies, and compares what it shows; the number of commands.
fn run(page: &str, long: bool) -> usize {
    let folder = workplace();
    let study = folder.path().join("studies/tradeoff");
    std::fs::create_dir_all(&study).expect("a folder");
    for name in files(&project().join("studies/tradeoff")) {
        std::fs::copy(project().join("studies/tradeoff").join(&name), study.join(&name)).expect("a copy");
    }
    let program = Path::new(env!("CARGO_BIN_EXE_rotor")).parent().expect("a folder");
    let others = std::env::var("PATH").unwrap_or_default();
    let search = format!("{}:{others}", program.display());
    let text = read(project().join(page));
    let mut lines = text.lines();
    let mut commands = 0;
    while let Some(line) = lines.next() {
        let Some(mark) = line.strip_prefix("```").filter(|mark| !mark.is_empty()) else { continue };
        let block: Vec<&str> = lines.by_ref().take_while(|line| *line != "```").collect();
        let words: Vec<&str> = mark.split_whitespace().collect();
        match words[..] {
            ["json", name] => {
                let body = block.join("\n") + "\n";
                serde_json::from_str::<Value>(&body).unwrap_or_else(|e| panic!("{page}: {name}: {e}"));
                std::fs::write(folder.path().join(name), body).expect("written");
            }
            ["json", name, "(added)"] => {
                let added: Value =
                    serde_json::from_str(&block.join("\n")).unwrap_or_else(|e| panic!("{page}: {name}: {e}"));
                let path = folder.path().join(name);
                let mut whole: Value = serde_json::from_str(&read(path.clone())).expect("JSON");
                for (key, value) in added.as_object().expect("keys at the top level") {
                    whole[key] = value.clone();
                }
                std::fs::write(&path, whole.to_string()).expect("written");
            }
            ["console"] => commands += console(page, &block, folder.path(), &search),
            ["console", "long"] if long => {
                commands += console(page, &block, folder.path(), &search);
            }
            ["console", "long"] | ["json"] | ["python"] | ["text"] | ["yaml"] => {}
            _ => panic!("{page}: a block marked {mark:?}"),
        }
    }
    commands
}

/// Runs a block of commands; their number.
fn console(page: &str, block: &[&str], folder: &Path, search: &str) -> usize {
    let starts: Vec<usize> = (0..block.len()).filter(|&i| block[i].starts_with("$ ")).collect();
    assert!(starts.first() == Some(&0), "{page}: a block without a command");
    let mut code = None;
    for (k, &start) in starts.iter().enumerate() {
        let end = starts.get(k + 1).copied().unwrap_or(block.len());
        let (command, shown) = (&block[start][2..], &block[start + 1..end]);
        if command == "echo $?" {
            assert_eq!(
                shown,
                [code.expect("a command before")].map(|c: i32| c.to_string()),
                "{page}: {command}"
            );
            continue;
        }
        let got = Command::new("sh").args(["-c", command]).current_dir(folder).env("PATH", search).output();
        let got = got.unwrap_or_else(|e| panic!("{page}: {command}: {e}"));
        let streams = [got.stdout, got.stderr].map(|bytes| String::from_utf8_lossy(&bytes).into_owned());
        let told = streams.concat();
        code = got.status.code();
        let looked_at = end < block.len() && block[end] == "$ echo $?";
        assert!(looked_at || code == Some(0), "{page}: {command} ends with {code:?}:\n{told}");
        // each stream in its own order
        let mut left = streams.each_ref().map(|text| text.lines());
        for line in shown.iter().filter(|line| !["...", ""].contains(&line.trim())) {
            let found = left.iter_mut().any(|lines| {
                let mut ahead = lines.clone();
                let found = ahead.any(|ours| alike(ours, line));
                if found {
                    *lines = ahead;
                }
                found
            });
            if !found && std::env::var_os("ROTOR_WRITE_DOCS").is_some() {
                replace(page, line, &told);
                continue;
            }
            assert!(found, "{page}: {command} does not print (any more)\n{line}\nbut\n{told}");
        }
    }
    starts.len()
}

/// Replaces a line of a page by the line of an output that shares most words with it.
fn replace(page: &str, line: &str, told: &str) {
    let words: BTreeSet<&str> = line.split_whitespace().collect();
    let shared = |ours: &&str| ours.split_whitespace().filter(|word| words.contains(word)).count();
    let ours = told.lines().max_by_key(shared).expect("an output");
    let text = read(project().join(page));
    std::fs::write(project().join(page), text.replace(&format!("\n{line}\n"), &format!("\n{ours}\n")))
        .expect("written");
}

/// Whether two lines have the same words and numbers, spaces aside.
fn alike(ours: &str, shown: &str) -> bool {
    let number = regex_lite::Regex::new(r"-?\d+(\.\d+)?(e[-+]?\d+)?").expect("a pattern");
    let words = |line: &str| {
        number.replace_all(line, " # ").split_whitespace().map(str::to_owned).collect::<Vec<_>>()
    };
    let numbers = |line: &str| {
        let list = number.find_iter(line).map(|m| (m.as_str().to_owned(), unit(m.as_str())));
        list.collect::<Vec<_>>()
    };
    words(ours) == words(shown)
        && numbers(ours).iter().zip(numbers(shown)).all(|((a, _), (b, unit))| {
            let (a, b): (f64, f64) = (a.parse().expect("a number"), b.parse().expect("a number"));
            (a - b).abs() <= 1e-3 * b.abs() + 1.01 * unit
        })
}

/// One unit of the last digit of a number; none of a whole one, which counts something.
fn unit(number: &str) -> f64 {
    let (mantissa, exponent) = number.split_once('e').unwrap_or((number, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, fraction)| fraction.len() as i32);
    let whole = digits == 0 && !number.contains('e');
    if whole { 0.0 } else { 10_f64.powi(exponent.parse::<i32>().expect("a number") - digits) }
}

/// Pages whose commands all take long.
const LONG_PAGES: [&str; 2] = ["docs/contact.md", "docs/tradeoff.md"];

/// Pages with commands, each in a test of its own.
macro_rules! pages {
    ($($name:ident: $page:literal,)*) => {
        const PAGES: &[&str] = &[$($page),*];
        mod commands_run {
            $(#[test]
            fn $name() {
                assert!(super::run($page, false) > 0, "no command");
            })*
        }
    };
}

pages! {
    tutorial: "docs/tutorial.md",
    element_and_mesh: "docs/how-to/element-and-mesh.md",
    bearings_and_supports: "docs/how-to/bearings-and-supports.md",
    disks_and_hubs: "docs/how-to/disks-and-hubs.md",
    loads: "docs/how-to/loads.md",
    critical_speeds_and_stability: "docs/how-to/critical-speeds-and-stability.md",
    run_up_and_rub: "docs/how-to/run-up-and-rub.md",
    unbalance_and_vibration: "docs/how-to/unbalance-and-vibration.md",
    growth_at_speed: "docs/how-to/growth-at-speed.md",
    contact_scenes: "docs/how-to/contact-scenes.md",
    speed_and_accuracy: "docs/how-to/speed-and-accuracy.md",
    compare_with_published_values: "docs/how-to/compare-with-published-values.md",
    read_the_report: "docs/how-to/read-the-report.md",
    scripts_and_ci: "docs/how-to/scripts-and-ci.md",
}

#[test]
#[ignore = "long"]
fn long_commands_run() {
    for page in LONG_PAGES {
        assert!(run(page, true) > 0, "{page}: no command");
    }
}

/// Every page with commands is in the list above; the README's commands are run in `cli.rs`.
#[test]
fn every_page_with_commands_is_run() {
    for page in under("docs", ".md") {
        let name = page.to_str().expect("a name");
        if read(project().join(&page)).contains("```console") {
            assert!(
                PAGES.contains(&name) || LONG_PAGES.contains(&name),
                "{name} has commands that no test runs"
            );
        }
    }
}

/// What looks alike is alike, and a changed number is seen.
#[test]
fn lines_are_compared_by_words_and_numbers() {
    assert!(alike("  1B   68.9037   bending", "1B 68.90 bending"));
    assert!(!alike("  1B   68.9037   bending", "1B 69.10 bending"));
    assert!(!alike("  1B   68.9037   bending", "1B 68.90 torsion"));
    assert!(!alike("13 elements", "12 elements"));
    assert!(alike("largest 2.2656e-6 m", "largest 2.266e-6 m"));
}
