//! Rotordynamics on the higher-order ANCF beam element 34X3.
//!
//! A [`Rotor`] is read from a case file or built in Rust. Its analyses check it, compute, and return typed results:
//!
//! | method | what it finds | results |
//! |---|---|---|
//! | [`Rotor::check`] | size, mass and inertia, what will be modelled | [`results::Check`] |
//! | [`Rotor::modes`] | natural frequencies and mode shapes at rest | [`results::Modes`] |
//! | [`Rotor::campbell`] | whirl frequencies over speed, critical speeds | [`results::Campbell`] |
//! | [`Rotor::statics`] | equilibrium under loads | [`results::Static`] |
//! | [`Rotor::spinup`] | a run up to speed, or the steady state there | [`results::Spinup`] |
//! | [`Rotor::contact`] | beams in contact, at rest or in motion | [`results::Contact`] |
//! | [`Rotor::report`] | report, table and figures, as the command line writes them | [`run::Finished`] |
//!
//! An [`Outcome`] holds the results, what was modelled and left out, and remarks on accuracy. An [`Error`] says what is wrong, where,
//! and what would be right. [`Rotor::with`] changes one value, which makes a sweep a loop:
//!
//! ```
//! let rotor = rotor::Rotor::from_file("cases/jeffcott.json")?;
//! for elements in [2, 4, 8] {
//!     let finer = rotor.with("shaft.segments.0.elements", elements)?;
//!     for critical in finer.campbell()?.results.critical_speeds {
//!         println!("{elements} elements: {:.1} rpm, {:?}", critical.speed_rpm, critical.whirl);
//!     }
//! }
//! # Ok::<(), rotor::Error>(())
//! ```
//!
//! The features `cli` (the program, with its arguments and progress) and `plot` (figures) are on by default; without them the library
//! computes and reports alone.
//!
//! The folder `examples` holds more. The case format is that of the program: `rotor schema` prints it.
//!
//! # Inside
//!
//! The other modules are public for the program's own tests and benches, and may change with every version; they are left out of
//! this documentation. Data flows one way; each module uses only what stands before it (a test reads the `use` lines):
//!
//! | module | what it holds |
//! |---|---|
//! | `error`, `units`, `instructions` | errors with place and remedy, units, vector instructions |
//! | `section` | shapes of sections and the functions on them |
//! | `results` | what analyses return: plain data |
//! | `case` | the case file as written |
//! | `linalg` | sparse and dense solvers |
//! | `model` | the checked model: what a case means |
//! | `check` | from a case to a model: every rule, with its remedy |
//! | `element` | forces, tangents and mass of the elements |
//! | `shaft` | a shaft with what is attached to it, its loads, drive and equations of motion |
//! | `integrate` | integration in time |
//! | `scene` | bodies in contact |
//! | `accuracy` | what members lock or miss, and what rounding takes |
//! | `analysis` | the analyses |
//! | `draw` | what figures are drawn with, as SVG |
//! | `plot`, `report` | figures, tables and files |
//! | `run` | a whole run of one analysis, and what the program knows of each |
//! | `rotor` | the face of the library |
//! | `validate`, `study`, `cli` | expected values, trade-off studies, the command line |

#[doc(hidden)]
pub mod accuracy;
#[doc(hidden)]
pub mod analysis;
#[doc(hidden)]
pub mod case;
#[doc(hidden)]
pub mod check;
#[cfg(feature = "cli")]
#[doc(hidden)]
pub mod cli;
#[cfg(feature = "plot")]
#[doc(hidden)]
pub mod draw;
#[doc(hidden)]
pub mod element;
pub mod error;
#[doc(hidden)]
pub mod instructions;
#[doc(hidden)]
pub mod integrate;
#[doc(hidden)]
pub mod linalg;
#[doc(hidden)]
pub mod model;
#[cfg(feature = "plot")]
#[doc(hidden)]
pub mod plot;
#[cfg(not(feature = "plot"))]
#[path = "plot/none.rs"]
mod plot;
#[doc(hidden)]
pub mod report;
pub mod results;
mod rotor;
pub mod run;
#[doc(hidden)]
pub mod scene;
#[doc(hidden)]
pub mod section;
#[doc(hidden)]
pub mod shaft;
#[doc(hidden)]
pub mod study;
#[doc(hidden)]
pub mod units;
#[doc(hidden)]
pub mod validate;

pub use analysis::Outcome;
pub use case::Analysis;
pub use error::{Error, Refusal, Result};
pub use rotor::{Rotor, RotorBuilder};
