//! Tests that make documents: tables and figures of docs/, which they hold and, with `ROTOR_WRITE_DOCS=1`, write.

mod contact_segments;
mod convergence;
mod convergence_figure;
mod limits;
