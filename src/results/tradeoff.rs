//! Results of a study of cost and error.

use serde::Serialize;
use serde_json::{Map, Value};

/// Cost and error over a grid of settings.
#[derive(Debug, Clone, Serialize)]
pub struct Tradeoff {
    /// Analysis that was run.
    pub analysis: &'static str,
    /// The number that counts, by its place in the report.
    pub quantity: String,
    /// Where the times were taken.
    pub machine: Machine,
    /// Runs of a point whose median counts.
    pub repeats: u32,
    /// Points at a time; more than one disturb each other's times.
    pub points_at_a_time: usize,
    /// What the quantity is compared with.
    pub reference: TradeoffReference,
    /// Largest relative error allowed, when one was asked for.
    pub target_error: Option<f64>,
    /// Every point, in the order of the grid.
    pub points: Vec<TradeoffPoint>,
    /// The Pareto front: indices of the points that no other point beats in both time and error, by rising time.
    pub front: Vec<usize>,
    /// The cheapest point within the error asked for.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub choice: Option<TradeoffChoice>,
}

/// The computer that the times belong to.
#[derive(Debug, Clone, Default, Serialize)]
pub struct Machine {
    /// Processor, as the operating system names it.
    pub processor: String,
    /// Number of logical cores.
    pub cores: usize,
}

/// What the quantity is compared with.
#[derive(Debug, Clone, Serialize)]
pub struct TradeoffReference {
    /// Its value, in the unit of the quantity; none when no point could give it.
    pub value: Option<f64>,
    /// "number", "expected" or "finest".
    pub kind: &'static str,
    /// Where a number of the case comes from.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub source: Option<String>,
    /// Index of the finest point, which is no part of the comparison.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub point: Option<usize>,
    /// Settings of the finest point.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub settings: Option<Map<String, Value>>,
    /// Relative error of the finest point itself, judged by the next coarser point along every setting that refines; null
    /// for a number from elsewhere, or where nothing coarser stands beside it.
    pub error: Option<f64>,
    /// What was refined towards it.
    pub refined: Vec<&'static str>,
}

/// One combination of settings.
#[derive(Debug, Clone, Serialize)]
pub struct TradeoffPoint {
    /// What sets it apart, in words.
    pub name: String,
    /// Its settings by path.
    pub settings: Map<String, Value>,
    /// Value of the quantity at this point.
    pub value: Option<f64>,
    /// |value - reference| / |reference|, but no less than the reference's own error; none for the finest point that is
    /// the reference.
    pub error: Option<f64>,
    /// Wall time of the analysis, median.
    pub wall_s: Option<f64>,
    /// Runs that the time is the median of.
    pub runs: usize,
    /// Peak memory of the process.
    pub peak_memory_mb: Option<f64>,
    /// Unknowns after constraints.
    pub degrees_of_freedom: Option<u64>,
    /// Steps of a transient.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub steps: Option<u64>,
    /// Estimate of the error that the section functions leave, where the program chose them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub estimated_error: Option<f64>,
    /// Whether it belongs to the front.
    pub pareto: bool,
    /// Whether a finer point has a clearly larger error, so that this one may be small by luck.
    pub finer_is_worse: bool,
    /// Warnings of its run that touch accuracy, `code: message`.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// Why it has no value.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub failed: Option<String>,
}

/// The cheapest point within the error asked for.
#[derive(Debug, Clone, Serialize)]
pub struct TradeoffChoice {
    /// Index of the chosen point.
    pub point: usize,
    /// Its settings by path.
    pub settings: Map<String, Value>,
    /// Relative error of the chosen point.
    pub error: f64,
    /// Time of the chosen point.
    pub wall_s: f64,
    /// What finer points say about it.
    pub trust: Trust,
    /// Indices of the finer points: all else equal, more elements or points, richer sections, smaller tolerances.
    pub finer: Vec<usize>,
    /// What these refine.
    pub refined: Vec<&'static str>,
    /// What could be refined and is not.
    pub not_refined: Vec<&'static str>,
}

/// What finer points say about the error of a point.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Trust {
    /// All of them keep to the target too.
    Confirmed,
    /// There are none.
    Unconfirmed,
    /// One of them misses the target: its error is small by luck.
    Refuted,
    /// Its run warned of its accuracy.
    Warned,
}
