//! The order of the modules: data flows one way, and each file uses only what stands before it.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// The modules in the order in which data flows through them.
const ORDER: [&str; 23] = [
    "error",
    "units",
    "instructions",
    "section",
    "results",
    "case",
    "linalg",
    "model",
    "check",
    "element",
    "shaft",
    "integrate",
    "scene",
    "accuracy",
    "analysis",
    "draw",
    "plot",
    "report",
    "run",
    "rotor",
    "validate",
    "study",
    "cli",
];

/// The sources under a folder, with the path of their module.
fn sources(folder: &Path, module: &str, list: &mut Vec<(String, PathBuf)>) {
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        let name = path.file_stem().and_then(|n| n.to_str()).expect("a name").to_owned();
        let inside = if module.is_empty() { name.clone() } else { format!("{module}::{name}") };
        if path.is_dir() {
            sources(&path, &inside, list);
        } else if path.extension().is_some_and(|e| e == "rs") && !["lib", "main"].contains(&name.as_str()) {
            list.push((if name == "mod" { module.to_owned() } else { inside }, path));
        }
    }
}

/// Paths that a source takes from the crate, from its root; tests left aside.
fn imports(module: &str, path: &Path) -> Vec<String> {
    let text = std::fs::read_to_string(path).expect("a source");
    let (code, tests) = text.split_once("#[cfg(test)]").unwrap_or((&text, "\nmod tests {"));
    assert!(tests.starts_with("\nmod tests {"), "{}: code after a test", path.display());
    let lines = code.lines().filter(|l| !l.trim_start().starts_with("//"));
    let code = lines.collect::<Vec<_>>().join("\n");
    let mut list = Vec::new();
    let steps =
        regex_lite::Regex::new(r"\b(?:crate::|(?:super::)+)([A-Za-z_0-9:]*)(\{[^;]*)?").expect("a pattern");
    for found in steps.captures_iter(&code) {
        let whole = found.get(0).expect("a match").as_str();
        let up = whole.matches("super::").count();
        let mut base: Vec<&str> = module.split("::").collect();
        base.truncate(if up == 0 { 0 } else { base.len() - up });
        let base = base.into_iter().chain(found.get(1).map(|m| m.as_str())).collect::<Vec<_>>().join("::");
        // what stands first in each place of a group
        let inside = found.get(2).map_or("", |m| m.as_str());
        let mut depth = 0;
        let mut item = String::new();
        for c in inside.chars() {
            match c {
                '{' => depth += 1,
                '}' => depth -= 1,
                ',' if depth == 1 => {
                    list.push(format!("{base}{}", item.trim()));
                    item.clear();
                }
                _ if depth == 1 => item.push(c),
                _ => {}
            }
            if depth == 0 {
                break;
            }
        }
        list.push(format!("{base}{}", item.trim()));
    }
    list
}

#[test]
fn every_file_uses_only_what_stands_before_it() {
    let mut list = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut list);
    let place = |module: &str| ORDER.iter().position(|m| *m == module);
    let mut found = BTreeSet::new();
    for (module, path) in &list {
        let own = module.split("::").next().expect("a module");
        found.insert(own.to_owned());
        let at = place(own).unwrap_or_else(|| panic!("{own} has no place in the order"));
        for import in imports(module, path) {
            let other = import.split("::").next().expect("a module");
            let before = place(other).unwrap_or_else(|| panic!("{} uses {import}", path.display()));
            assert!(before <= at, "{} uses {import}, which stands after {own}", path.display());
        }
    }
    assert_eq!(found, ORDER.iter().map(|m| (*m).to_owned()).collect());
}

/// Within a module, its parts use one another in one direction.
#[test]
fn parts_of_a_module_stand_in_an_order() {
    let mut list = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut list);
    let part = |path: &str| -> Option<[String; 2]> {
        let mut names = path.split("::").map(str::to_owned);
        Some([names.next()?, names.next()?])
    };
    let known: BTreeSet<[String; 2]> = list.iter().filter_map(|(module, _)| part(module)).collect();
    let mut uses: BTreeMap<[String; 2], BTreeSet<[String; 2]>> = BTreeMap::new();
    for (module, path) in &list {
        let Some(own) = part(module) else { continue };
        for other in imports(module, path).iter().filter_map(|import| part(import)) {
            if other != own && other[0] == own[0] && known.contains(&other) {
                uses.entry(own.clone()).or_default().insert(other);
            }
        }
    }
    // takes away, one after the other, what uses nothing that is left
    let mut left = known;
    while !left.is_empty() {
        let free = |m: &&[String; 2]| uses.get(*m).is_none_or(|others| others.is_disjoint(&left));
        let ready: Vec<[String; 2]> = left.iter().filter(free).cloned().collect();
        assert!(!ready.is_empty(), "in a circle: {left:?}");
        left.retain(|m| !ready.contains(m));
    }
}

/// Files beside each other in a folder of a module stand in an order, too; their `mod.rs` puts them together and is left aside.
#[test]
fn files_of_a_folder_stand_in_an_order() {
    let mut list = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut list);
    let file = |path: &str| -> Option<String> {
        let names: Vec<&str> = path.split("::").take(3).collect();
        (names.len() == 3).then(|| names.join("::"))
    };
    let known: BTreeSet<String> = list.iter().filter_map(|(module, _)| file(module)).collect();
    let mut uses: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
    for (module, path) in &list {
        let Some(own) = file(module) else { continue };
        let folder = own.rsplit_once("::").expect("a folder").0.to_owned() + "::";
        for other in imports(module, path).iter().filter_map(|import| file(import)) {
            if other != own && other.starts_with(&folder) && known.contains(&other) {
                uses.entry(own.clone()).or_default().insert(other);
            }
        }
    }
    let mut left = known;
    while !left.is_empty() {
        let free = |m: &&String| uses.get(*m).is_none_or(|others| others.is_disjoint(&left));
        let ready: Vec<String> = left.iter().filter(free).cloned().collect();
        assert!(!ready.is_empty(), "in a circle: {left:?}");
        left.retain(|m| !ready.contains(m));
    }
}

/// Figures, tables and files see results, never a model or an analysis.
#[test]
fn reports_and_figures_see_results_alone() {
    let mut list = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut list);
    for (module, path) in &list {
        let own = module.split("::").next().unwrap_or_default();
        if !["draw", "plot", "report"].contains(&own) {
            continue;
        }
        for import in imports(module, path) {
            let head = import.split("::").next().unwrap_or_default().to_owned();
            assert!(
                ["draw", "error", "plot", "report", "results"].contains(&head.as_str()),
                "{module} uses {import}"
            );
        }
    }
}

/// Files stay within 600 lines, functions within 80.
#[test]
fn files_and_functions_stay_short() {
    let mut list = Vec::new();
    sources(&Path::new(env!("CARGO_MANIFEST_DIR")).join("src"), "", &mut list);
    let head = regex_lite::Regex::new(r"^( *)(?:pub(?:\([a-z]+\))? )?(?:const )?fn ([a-z_0-9]+)")
        .expect("a pattern");
    for (module, path) in &list {
        let text = std::fs::read_to_string(path).expect("a source");
        assert!(text.lines().count() <= 600, "{module}: {} lines", text.lines().count());
        let mut open: Option<(String, String, usize)> = None;
        for (number, line) in text.lines().enumerate() {
            match (&open, head.captures(line)) {
                (None, Some(found)) => {
                    let part = |k| found.get(k).map_or(String::new(), |m| m.as_str().to_owned());
                    open = Some((part(1) + "}", part(2), number));
                }
                (Some((end, name, start)), _) if line == end => {
                    assert!(number - start < 80, "{module}::{name}: {} lines", number - start + 1);
                    open = None;
                }
                _ => {}
            }
            if open.as_ref().is_some_and(|(.., start)| *start == number)
                && line.trim_end().ends_with(['}', ';'])
            {
                open = None;
            }
        }
    }
}
