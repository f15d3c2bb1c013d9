//! Rotordynamics on the higher-order ANCF beam element 34X3.
//!
//! Data flows one way; each module uses only what stands before it (a test reads the `use` lines):
//!
//! | module | what it holds |
//! |---|---|
//! | [`error`], [`units`], [`instructions`] | errors with place and remedy, units, vector instructions |
//! | [`section`] | shapes of sections and the functions on them |
//! | [`results`] | what analyses return: plain data |
//! | [`case`] | the case file as written |
//! | [`linalg`] | sparse and dense solvers |
//! | [`model`] | the checked model: what a case means |
//! | [`check`] | from a case to a model: every rule, with its remedy |
//! | [`element`] | forces, tangents and mass of the elements |
//! | [`shaft`] | a shaft with what is attached to it, its loads, drive and equations of motion |
//! | [`integrate`] | integration in time |
//! | [`scene`] | bodies in contact |
//! | [`accuracy`] | what members lock or miss, and what rounding takes |
//! | [`analysis`] | the analyses |
//! | [`draw`] | what figures are drawn with, as SVG |
//! | [`plot`], [`report`] | figures, tables and files |
//! | [`run`], [`validate`], [`study`], [`cli`] | a whole run, expected values, trade-off studies, the command line |
//!
//! ```
//! use rotor::{analysis::modes::modes, case::LoadedCase, model::Model};
//!
//! let case = serde_json::json!({
//!     "title": "free bar",
//!     "materials": { "steel": { "E": "210 GPa", "nu": 0.3, "rho": 7850 } },
//!     "sections": { "round": { "shape": "circle", "radius": "50 mm" } },
//!     "shaft": { "segments": [{ "length": 1.0, "elements": 4, "section": "round", "material": "steel" }] }
//! });
//! let model = Model::new(&LoadedCase::from_value("free bar", case)?)?;
//! let found = modes(&model)?.results;
//! assert_eq!(found.rigid_modes, 6);
//! # Ok::<(), rotor::error::Error>(())
//! ```

pub mod accuracy;
pub mod analysis;
pub mod case;
pub mod check;
pub mod cli;
pub mod draw;
pub mod element;
pub mod error;
pub mod instructions;
pub mod integrate;
pub mod linalg;
pub mod model;
pub mod plot;
pub mod report;
pub mod results;
pub mod run;
pub mod scene;
pub mod section;
pub mod shaft;
pub mod study;
pub mod units;
pub mod validate;
