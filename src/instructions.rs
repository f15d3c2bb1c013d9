//! Vector instructions of the force kernels: the widest that the processor has, or narrower ones on request.
//!
//! Kernels sum in another order with each width, so that results differ by rounding. Choosing the width makes one
//! processor stand in for another.

use pulp::Arch;
use std::sync::OnceLock;

/// What [`Instructions::Widest`] stands for in this process, when it was narrowed.
static NARROWED: OnceLock<Instructions> = OnceLock::new();

/// A set of vector instructions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Instructions {
    /// The widest of the processor.
    #[default]
    Widest,
    /// AVX-512: eight numbers at a time.
    Avx512,
    /// AVX2 with fused multiply-add.
    Avx2,
    /// No vector instructions: one number at a time.
    Scalar,
}

impl Instructions {
    /// All that can be asked for by name.
    pub const NAMED: [Self; 4] = [Self::Widest, Self::Avx512, Self::Avx2, Self::Scalar];

    /// Name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Widest => "widest",
            Self::Avx512 => "avx512",
            Self::Avx2 => "avx2",
            Self::Scalar => "none",
        }
    }

    /// The set of that name.
    pub fn from_name(name: &str) -> Option<Self> {
        Self::NAMED.into_iter().find(|set| set.name() == name)
    }

    /// True when this processor has them.
    pub fn are_available(self) -> bool {
        self.arch().is_some()
    }

    /// Makes these the widest that this process uses. Only the first call counts.
    pub fn narrow_process(self) {
        // a second call leaves the first one's choice, as documented
        let _ = NARROWED.set(self);
    }

    /// The dispatcher; `None` on a processor without them.
    pub fn arch(self) -> Option<Arch> {
        match self {
            Self::Widest => match NARROWED.get().filter(|set| **set != Self::Widest) {
                Some(narrowed) => narrowed.arch(),
                None => Some(Arch::new()),
            },
            #[cfg(target_arch = "x86_64")]
            Self::Avx512 => pulp::x86::V4::try_new().map(Arch::V4),
            #[cfg(target_arch = "x86_64")]
            Self::Avx2 => pulp::x86::V3::try_new().map(Arch::V3),
            Self::Scalar => Some(Arch::Scalar),
            #[cfg(not(target_arch = "x86_64"))]
            Self::Avx512 | Self::Avx2 => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sets_have_names_and_every_processor_does_without() {
        for set in Instructions::NAMED {
            assert_eq!(Instructions::from_name(set.name()), Some(set));
        }
        assert!(Instructions::Scalar.are_available() && Instructions::Widest.are_available());
        assert_eq!(Instructions::from_name("sse"), None);
    }
}
