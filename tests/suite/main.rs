//! All tests, by kind, in one program: linking the library once is most of what they cost.

mod analytical;
mod attachments;
mod cli;
mod common;
mod convergence;
mod convergence_figure;
mod element;
mod frames;
mod golden;
mod identities;
mod input;
mod integrators;
mod interrupted;
mod limits;
mod mutations;
mod nonlinear;
mod plots;
mod published;
mod ring;
mod rub;
mod scale;
mod spinup;
mod structural;
mod tradeoff;
