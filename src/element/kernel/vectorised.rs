//! Elements whose forces are computed with vector instructions: what those over section polynomials and those of rings share.

use crate::element::Kernel;
use crate::element::kernel::pair_stiffness::Expansion;
use crate::element::kernel::simd::Scratch;
use pulp::{Arch, Simd, WithSimd};

/// An element whose stations lie side by side in the registers.
///
/// Implementations of the two kernels are `#[inline(always)]`: so they become part of the code of one set of instructions.
pub trait Vectorised: Send + Sync {
    /// Vector instructions that the kernels use.
    fn arch(&self) -> Arch;

    /// Kelvin-Voigt factor, s.
    fn viscosity(&self) -> f64;

    /// From moments at the stations to the tangent.
    fn expansion(&self) -> &Expansion;

    /// Writes the force; returns the energy, 0 with velocities.
    fn force<S: Simd>(
        &self,
        simd: S,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64;

    /// The stiffness of all pairs of vectors into the working memory; without `geometric` the part that stems from the law alone.
    fn stiffness<S: Simd>(&self, simd: S, q: &[f64], geometric: bool, scratch: &mut Scratch);
}

/// [`Vectorised::force`] for the instructions that the processor has.
struct Force<'a, E> {
    element: &'a E,
    q: &'a [f64],
    velocity: Option<&'a [f64]>,
    force: &'a mut [f64],
    scratch: &'a mut Scratch,
}

impl<E: Vectorised> WithSimd for Force<'_, E> {
    type Output = f64;

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) -> f64 {
        self.element.force(simd, self.q, self.velocity, self.force, self.scratch)
    }
}

/// [`Vectorised::stiffness`] for the instructions that the processor has.
struct Stiffness<'a, E> {
    element: &'a E,
    q: &'a [f64],
    geometric: bool,
    scratch: &'a mut Scratch,
}

impl<E: Vectorised> WithSimd for Stiffness<'_, E> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        self.element.stiffness(simd, self.q, self.geometric, self.scratch);
    }
}

impl<E: Vectorised> Kernel for E {
    fn size(&self) -> usize {
        self.expansion().size()
    }

    fn internal_force(
        &self,
        q: &[f64],
        velocity: Option<&[f64]>,
        force: &mut [f64],
        scratch: &mut Scratch,
    ) -> f64 {
        let velocity = velocity.filter(|_| self.viscosity() != 0.0);
        self.arch().dispatch(Force { element: self, q, velocity, force, scratch })
    }

    fn tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        self.arch().dispatch(Stiffness { element: self, q, geometric: true, scratch });
        self.expansion().write(scratch, tangent);
    }

    // the part of the tangent that stems from the law alone, without stress, times beta
    fn viscous_tangent(&self, q: &[f64], tangent: &mut [f64], scratch: &mut Scratch) {
        self.arch().dispatch(Stiffness { element: self, q, geometric: false, scratch });
        self.expansion().write(scratch, tangent);
        tangent.iter_mut().for_each(|v| *v *= self.viscosity());
    }
}
