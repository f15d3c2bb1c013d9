//! All tests, by kind, in one program: linking the library once is most of what they cost.

mod analytical;
mod attachments;
mod cli;
mod common;
mod contact;
mod convergence;
mod convergence_figure;
mod detect;
mod element;
mod frames;
mod golden;
mod identities;
mod input;
mod integrators;
mod interrupted;
mod lcp;
mod limits;
mod mutations;
mod nonlinear;
mod plots;
mod published;
mod ring;
mod scale;
mod spinup;
mod structural;
mod tradeoff;
