//! `rotor validate`: runs what a case expects and compares.

use crate::case::{Expected, Filter, LoadedCase};
use crate::error::Result;
use crate::run::{Analysis, Host, run};
use serde_json::Value;

/// One compared number.
#[derive(Debug, Clone)]
pub struct Comparison {
    /// Case file that the value belongs to.
    pub file: String,
    /// Analysis it comes from.
    pub analysis: &'static str,
    /// Where in the report.
    pub path: String,
    /// Our value; `None` when the report has no number there.
    pub ours: Option<f64>,
    /// Value that ours is compared with.
    pub reference: f64,
    /// Value printed in the source, when it differs in kind from the reference.
    pub published: Option<f64>,
    /// Allowed `|ours - reference|`.
    pub tolerance: f64,
    /// Where the reference comes from.
    pub source: String,
}

impl Comparison {
    /// True when ours is within the tolerance.
    pub fn holds(&self) -> bool {
        self.ours.is_some_and(|ours| (ours - self.reference).abs() <= self.tolerance)
    }

    /// Relative error, or absolute for a reference of zero.
    pub fn error(&self) -> Option<f64> {
        let scale = if self.reference == 0.0 { 1.0 } else { self.reference.abs() };
        self.ours.map(|ours| (ours - self.reference) / scale)
    }
}

/// Runs each distinct analysis that `expected` of the case names, once, and compares every value.
///
/// # Errors
/// Bad input, or an analysis that does not succeed.
pub fn validate(loaded: &LoadedCase) -> Result<Vec<Comparison>> {
    validate_with(loaded, |case, analysis| Ok(run(case, analysis, &Host::silent())?.json))
}

/// [`validate`] with another source of the reports: whoever has one need not run the case again.
///
/// # Errors
/// Bad input, or a report that can't be had.
pub fn validate_with(
    loaded: &LoadedCase,
    report: impl Fn(&LoadedCase, Analysis) -> Result<Value>,
) -> Result<Vec<Comparison>> {
    let mut reports: Vec<(Analysis, Option<Value>, Value)> = Vec::new();
    let mut result = Vec::new();
    for expected in &loaded.case.expected {
        let analysis = expected.analysis.unwrap_or_else(|| loaded.case.default_analysis());
        let set = expected.set.as_ref().map(|s| serde_json::json!(s));
        let known = reports.iter().position(|(a, s, _)| *a == analysis && *s == set);
        let at = match known {
            Some(at) => at,
            None => {
                let changed = match &expected.set {
                    Some(set) => loaded.with(set)?,
                    None => loaded.clone(),
                };
                reports.push((analysis, set, report(&changed, analysis)?));
                reports.len() - 1
            }
        };
        let found = lookup(&reports[at].2, &expected.path, expected.filter.as_ref());
        let references = numbers(&expected.value);
        let published = expected.published.as_ref().map(optional_numbers).unwrap_or_default();
        for (i, reference) in references.iter().enumerate() {
            result.push(Comparison {
                file: loaded.file.clone(),
                analysis: analysis.name(),
                path: expected.path.replacen('*', &entry_name(expected, i), 1),
                ours: found.get(i).copied().flatten(),
                reference: *reference,
                published: published.get(i).copied().flatten(),
                tolerance: expected.atol.unwrap_or(0.0) + expected.rtol.unwrap_or(0.0) * reference.abs(),
                source: expected.source.clone(),
            });
        }
    }
    Ok(result)
}

/// "bending 1" for the entry that `where` picks, else its place in the list.
fn entry_name(expected: &Expected, index: usize) -> String {
    expected.filter.as_ref().map_or(index.to_string(), |filter| filter_name(filter, index))
}

/// A filter in words: "[bending 1]".
pub fn filter_name(filter: &Filter, index: usize) -> String {
    let words = filter.fields.values().map(|v| v.as_str().map_or_else(|| v.to_string(), str::to_owned));
    let number = filter.n.unwrap_or(index + 1).to_string();
    format!("[{}]", words.chain([number]).collect::<Vec<_>>().join(" "))
}

fn numbers(value: &Value) -> Vec<f64> {
    optional_numbers(value).into_iter().flatten().collect()
}

fn optional_numbers(value: &Value) -> Vec<Option<f64>> {
    match value {
        Value::Array(list) => list.iter().map(Value::as_f64).collect(),
        other => vec![other.as_f64()],
    }
}

/// Numbers of a report at a path; `*` stands for the entries of a list, filtered by `where` (and its n-th match).
pub fn lookup(report: &Value, path: &str, filter: Option<&Filter>) -> Vec<Option<f64>> {
    let mut values = vec![report];
    for step in path.split('.') {
        values = values
            .into_iter()
            .flat_map(|value| match (value, step) {
                (Value::Array(list), "*") => matching(list, filter),
                (Value::Array(list), _) => {
                    step.parse::<usize>().ok().and_then(|i| list.get(i)).into_iter().collect()
                }
                (Value::Object(map), _) => map.get(step).into_iter().collect(),
                _ => Vec::new(),
            })
            .collect();
    }
    values.into_iter().map(Value::as_f64).collect()
}

fn matching<'a>(list: &'a [Value], filter: Option<&Filter>) -> Vec<&'a Value> {
    let Some(filter) = filter else { return list.iter().collect() };
    let fits = |value: &&Value| filter.fields.iter().all(|(key, wanted)| value.get(key) == Some(wanted));
    let all = list.iter().filter(fits);
    match filter.n {
        Some(n) => all.skip(n.saturating_sub(1)).take(1).collect(),
        None => all.collect(),
    }
}
