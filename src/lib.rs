//! Rotordynamics on the higher-order ANCF beam element 34X3.
//!
//! Data flows one way; each module uses only what stands before it:
//! `units, error, json, vectors, instructions -> case -> model -> element -> assembly, forces, rub, acting, dynamics, contact -> integrate ->
//! analysis -> results -> plot, report -> study -> cli`.
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

pub mod acting;
pub mod analysis;
pub mod assembly;
pub mod case;
pub mod cli;
pub mod contact;
pub mod drive;
pub mod dynamics;
pub mod element;
pub mod error;
pub mod forces;
pub mod instructions;
pub mod integrate;
pub mod json;
pub mod linalg;
pub mod loads;
pub mod model;
pub mod plot;
pub mod report;
pub mod results;
pub mod rub;
pub mod run;
pub mod section;
pub mod study;
pub mod support;
pub mod units;
pub mod validate;
pub mod vectors;
