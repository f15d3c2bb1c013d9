//! From results to files and text: JSON reports, tables for the terminal, Matrix Market.
//! Reports see only results.

pub mod files;
pub mod json;
pub mod matrix_market;
pub mod printable;
pub mod table;
