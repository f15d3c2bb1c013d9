//! No figures: the library without its feature `plot`.

/// Makes a module whose figure is none.
macro_rules! none {
    ($($module:ident: $results:ty),*) => {
        $(pub mod $module {
            use crate::error::Result;
            use crate::results::{Figures, Report};

            /// No figures.
            pub fn svg(_: &Report<$results>) -> Result<Figures> {
                Ok(Figures::new())
            }
        })*
    };
}

none!(
    campbell: crate::results::Campbell,
    contact: crate::results::Contact,
    harmonic: crate::results::HarmonicResponse,
    map: crate::results::CriticalMap,
    modes: crate::results::Modes,
    spinup: crate::results::Spinup,
    statics: crate::results::Static,
    tradeoff: crate::results::Tradeoff,
    unbalance: crate::results::UnbalanceResponse
);
