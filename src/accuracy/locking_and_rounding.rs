//! What a model's members lock and what rounding takes from it, estimated before any run.
//!
//! Locking: a long body bends or twists uniformly; its section deforms as far as the functions of the member let it,
//! and what it can't follow is stiffness in excess. Rounding: the static shape x of a smooth load f has the energy
//! `x^T f`, of which `eps |x|^T |K| |x|` is rounding. Source: docs/theory/estimates.md#before-a-run.

use crate::accuracy::thin_wall::ovalling_error;
use crate::element::basis::SectionProducts;
use crate::element::continuum::lame;
use crate::error::{Error, Result};
use crate::linalg::dense::self_adjoint;
use crate::linalg::sparse::{Sparse, multiply};
use crate::model::{Law, Material, Model};
use crate::results::Diagnostic;
use crate::section::Section;
use crate::section::basis::SectionBasis;
use crate::shaft::assembly::Assembly;
use crate::shaft::spectrum::Flexibility;
use faer::Mat;
use nalgebra::{DMatrix, DVector};
use std::f64::consts::TAU;

/// Excess of a stiffness from which a warning is due.
const LOCKED_EXCESS: f64 = 0.02;
/// Share of the energy that may be rounding without a warning; the frequency loses half of it.
const ROUNDED_ENERGY_SHARE: f64 = 2e-6;
/// Independence of the section functions below which nothing can be computed, and below which a warning is due.
const LEAST_INDEPENDENCE: [f64; 2] = [1e-14, 1e-12];
/// Order of the polynomials that count as exact for the warping of a solid section.
const FINE_WARPING: usize = 8;
/// Unknowns up to which `check` factorises the stiffness: about a second.
const MOST_UNKNOWNS: usize = 50_000;
/// Element length over half height from which one or two elements are too few.
const LONG: f64 = 4.0;
/// Bore over rim below which the digits of ring forces are told, and the share that is lost at a ratio k: this / k^2.
const SMALL_BORE: (f64, f64) = (1.5e-3, 2e-14);
/// Share of rounding in those forces from which nothing nonlinear is computed.
const TINY_BORE: f64 = 1e-5;
/// Share of rounding in the growth of a slow shaft from which a warning is due.
const ROUNDED_GROWTH_SHARE: f64 = 1e-4;
/// Poisson's ratio below which G/E, above five, makes the missing warping of a quadratic section felt.
const AUXETIC: f64 = -0.9;
/// Error of the ovalling of a ring member from which a warning is due.
const POOR_OVALLING: f64 = 0.02;

/// `b^T K^-1 b` for a symmetric positive definite K, each unknown in its own measure.
fn relieved(k: &DMatrix<f64>, b: &DVector<f64>) -> Option<f64> {
    let scale = k.diagonal().map(|d| 1.0 / d.sqrt());
    let scaled = DMatrix::from_fn(k.nrows(), k.nrows(), |i, j| k[(i, j)] * scale[i] * scale[j]);
    let b = b.component_mul(&scale);
    Some(b.dot(&scaled.cholesky()?.solve(&b)))
}

/// Excess of the bending stiffness of a long body over `E I`: the larger of bending about z and y. `None` where the
/// functions are dependent to rounding.
pub fn bending_excess(section: &Section, material: &Material, basis: SectionBasis) -> Option<f64> {
    let (lambda, mu) = lame(material);
    let products = SectionProducts::new(basis, section, section.outer_size());
    let n = basis.count();
    let mut k = DMatrix::from_fn(2 * n, 2 * n, |i, j| products.plane_stiffness((lambda, mu), i, j));
    // translations and the rotation carry no load
    for at in [0, 1, 3] {
        k[(at, at)] += material.youngs_modulus;
    }
    // the first three functions are 1, y/R, z/R in every member
    let excess = |vector: usize| {
        let b = DVector::from_fn(2 * n, |i, _| lambda * products.gradient(0, i % 2 + 1)[(vector, i / 2)]);
        let second = products.plain()[(vector, vector)];
        let stiffness = (lambda + 2.0 * mu) * second - relieved(&k, &b)?;
        Some(stiffness / (material.youngs_modulus * second) - 1.0)
    };
    Some(excess(1)?.max(excess(2)?))
}

/// `G J / G` of a long body in m^4, its warping within the functions of a basis.
fn torsion_constant(section: &Section, basis: SectionBasis) -> Option<f64> {
    let products = SectionProducts::new(basis, section, section.outer_size());
    let n = basis.count();
    let mut k =
        DMatrix::from_fn(n, n, |i, j| products.gradient(1, 1)[(i, j)] + products.gradient(2, 2)[(i, j)]);
    k[(0, 0)] += 1.0;
    let b = DVector::from_fn(n, |i, _| products.rotation[(0, i)]);
    Some(section.moment(2, 0) + section.moment(0, 2) - relieved(&k, &b)?)
}

/// Excess of the torsional stiffness of a solid section whose warping the functions of a basis can't follow.
pub fn torsion_excess(section: &Section, basis: SectionBasis) -> Option<f64> {
    if section.is_axisymmetric() || section.is_hollow() {
        return Some(0.0);
    }
    Some(
        torsion_constant(section, basis)? / torsion_constant(section, SectionBasis::Monomials(FINE_WARPING))?
            - 1.0,
    )
}

/// Independence of the functions of a basis over a section: the least eigenvalue of their products, scaled to a
/// diagonal of ones. At 1e-16 the last function is a combination of the others to rounding.
pub fn independence(section: &Section, basis: SectionBasis) -> f64 {
    let products = SectionProducts::new(basis, section, section.outer_size());
    let gram = products.plain();
    let n = basis.count();
    let scaled = Mat::from_fn(n, n, |i, j| gram[(i, j)] / (gram[(i, i)] * gram[(j, j)]).sqrt());
    self_adjoint(scaled.as_ref()).ok().and_then(|(values, _)| values.first().copied()).unwrap_or(0.0)
}

/// Sections and members of a model, each pair once, with the material.
fn fields(model: &Model) -> Vec<(&Section, &Material, SectionBasis, String)> {
    // a taper has one name for all its sections
    let mut seen: Vec<(&str, usize, SectionBasis)> = Vec::new();
    let mut list = Vec::new();
    for e in model.elements.iter().filter(|e| e.kind.law == Law::Continuum) {
        let key = (&model.names.sections[e.section][..], e.material, e.kind.basis);
        if !seen.contains(&key) {
            seen.push(key);
            list.push((
                &model.sections[e.section],
                &model.materials[e.material],
                e.kind.basis,
                e.kind.name(),
            ));
        }
    }
    list
}

fn size(section: &Section) -> String {
    let [a, b] = section.outer;
    if section.is_hollow() { format!("{a}/{}", section.inner[0]) } else { format!("{a} x {b}") }
}

/// Refuses a polynomial basis whose functions are dependent over a wall: its matrices are singular to rounding.
///
/// # Errors
/// With the section and the members that fit it.
pub fn refuse_dependent(model: &Model) -> Result<()> {
    for (section, _, basis, name) in fields(model) {
        if section.is_hollow() && !basis.is_ring() && independence(section, basis) < LEAST_INDEPENDENCE[0] {
            return Err(Error::analysis(
                format!(
                    "{name} can't be computed on the wall {}: its functions are dependent to rounding",
                    size(section)
                ),
                format!("independence {:.0e} of 1", independence(section, basis).max(0.0)),
                "34R23 or \"element\": \"auto\"; or a lower order (34X3)",
            ));
        }
    }
    Ok(())
}

/// Refuses bores so small that rounding swallows the nonlinear forces of a ring: Newton's method would not settle.
///
/// # Errors
/// With the section and what to take instead.
pub fn refuse_tiny_bore(model: &Model) -> Result<()> {
    for (section, _, basis, name) in fields(model) {
        let k = section.inner[0] / section.outer[0];
        if basis.is_ring() && SMALL_BORE.1 / (k * k) > TINY_BORE {
            return Err(Error::analysis(
                format!(
                    "the bore of the section {} is too small for the nonlinear forces of {name}",
                    size(section)
                ),
                format!("about {:.0e} of them would be rounding", (SMALL_BORE.1 / (k * k)).min(1.0)),
                "a solid section with 34X3: so small a bore changes nothing but the stress at its edge",
            ));
        }
    }
    Ok(())
}

/// Speeds so low that the growth they cause is near the rounding of positions: `eps E / (rho W^2 R^2)` is lost of it.
pub fn slow_remark(model: &Model, speed: f64, diagnostics: &mut Vec<Diagnostic>) {
    if speed == 0.0 {
        return;
    }
    let strain = |(section, m, _, _): (&Section, &Material, SectionBasis, String)| {
        m.density * (speed * section.outer_size()).powi(2) / m.youngs_modulus
    };
    let least = fields(model).into_iter().map(strain).fold(f64::INFINITY, f64::min);
    let lost = f64::EPSILON / least;
    if least.is_finite() && lost > ROUNDED_GROWTH_SHARE {
        diagnostics.push(Diagnostic::warning(
            "slow-spin",
            format!(
                "at {speed:.3e} rad/s the shaft stretches by about {least:.0e}: {:.0e} of its growth and stress may be rounding",
                lost.min(1.0)
            ),
        ));
    }
}

/// Members that lock, functions that are nearly dependent, digits that rounding takes, one or two
/// long elements.
pub fn estimates(model: &Model, assembly: &Assembly<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut warn = |code, text: String| diagnostics.push(Diagnostic::warning(code, text));
    for (section, material, basis, name) in fields(model) {
        // all but solid: nothing locks, and a thousand points across the wall would take their time
        if basis.is_ring() && section.inner[0] < SMALL_BORE.0 * section.outer[0] {
            continue;
        }
        let at = size(section);
        if let Some(excess) = bending_excess(section, material, basis).filter(|e| *e > LOCKED_EXCESS) {
            warn(
                "bending-locks",
                format!(
                    "{name} bends a long shaft of section {at} with {:.1} % too much stiffness (frequencies {:.1} % too high): its \
                     section can't deform as Poisson's ratio {} asks; 34X2 or more, rings with h 2 or more",
                    100.0 * excess,
                    100.0 * ((1.0 + excess).sqrt() - 1.0),
                    material.poisson_ratio
                ),
            );
        }
        if basis == SectionBasis::Monomials(2) && material.poisson_ratio < AUXETIC {
            warn(
                "auxetic",
                format!(
                    "{name} has no cubic warping: at Poisson's ratio {} bending is too stiff by a share that grows with (r/L)^2 G/E; \
                     34X3 or more",
                    material.poisson_ratio
                ),
            );
        }
        if let Some(excess) = torsion_excess(section, basis).filter(|e| *e > LOCKED_EXCESS) {
            warn(
                "torsion-locks",
                format!(
                    "{name} twists the section {at} with {:.1} % too much stiffness (frequencies {:.1} % too high): its functions can't \
                     follow the warping; 34X4 for rectangles",
                    100.0 * excess,
                    100.0 * ((1.0 + excess).sqrt() - 1.0)
                ),
            );
        }
        if let SectionBasis::Ring { harmonics: 3.., .. } = basis
            && let Some(error) = ovalling_error(section, material, basis).filter(|e| *e > POOR_OVALLING)
        {
            warn(
                "ring-ovals",
                format!(
                    "{name} puts the ovalling of the wall {at} {:.0} % too high; 34R23 or more",
                    100.0 * error
                ),
            );
        }
        if section.is_hollow() && !basis.is_ring() {
            let left = independence(section, basis);
            if left < LEAST_INDEPENDENCE[0] {
                warn(
                    "section-basis",
                    format!(
                        "{name} can't be computed on the wall {at}: its functions are dependent to rounding; take 34R23"
                    ),
                );
            } else if left < LEAST_INDEPENDENCE[1] {
                warn(
                    "section-basis",
                    format!(
                        "the functions of {name} on the wall {at} are dependent but for {left:.0e}: few digits are safe; take 34R23"
                    ),
                );
            }
        }
    }
    mesh_and_rounding(model, assembly, diagnostics);
}

/// Estimates of what few elements miss and what rounding takes.
fn mesh_and_rounding(model: &Model, assembly: &Assembly<'_>, diagnostics: &mut Vec<Diagnostic>) {
    let mut warn = |code, text: String| diagnostics.push(Diagnostic::warning(code, text));
    if model.elements.len() <= 2
        && model
            .elements
            .iter()
            // an element of exactly that length is not long, whatever rounding says
            .any(|e| e.length > LONG * (1.0 + 1e-9) * model.sections[e.section].outer_size())
    {
        warn(
            "coarse-mesh",
            "one or two long elements: bending frequencies may be too high by tenths (one element between pins: 11 %); take \
             four or more"
                .to_owned(),
        );
    }
    if assembly.size() > MOST_UNKNOWNS {
        diagnostics.push(Diagnostic::info(
            "rounding-unknown",
            format!("the share of rounding is estimated up to {MOST_UNKNOWNS} unknowns; so many elements lose digits"),
        ));
    } else if let Some(share) = rounded_energy(assembly).filter(|s| *s > ROUNDED_ENERGY_SHARE) {
        warn(
            "rounding",
            format!(
                "up to {:.0e} of a bending frequency may be rounding: the shaft is so slender or so softly held that its stiffness \
                 is a small difference of large numbers; fewer elements lose less",
                share / 2.0
            ),
        );
    }
}

/// Small bores of ring members: nonlinear forces lose digits there.
pub fn bore_remarks(model: &Model, diagnostics: &mut Vec<Diagnostic>) {
    for (section, _, basis, name) in fields(model) {
        let k = section.inner[0] / section.outer[0];
        if basis.is_ring() && k < SMALL_BORE.0 {
            diagnostics.push(Diagnostic::warning(
                "small-bore",
                format!(
                    "{name} on so small a bore ({}): about {:.0e} of its nonlinear forces may be rounding; a solid section with \
                     34X3 differs by less than the bore's share of the area, {:.0e}",
                    size(section),
                    (SMALL_BORE.1 / (k * k)).min(1.0),
                    k * k
                ),
            ));
        }
    }
}

/// Share of rounding in the elastic energy of the shape that a smooth lateral load bends the shaft to:
/// `eps |x|^T |K| |x| / x^T f` with `K x = f`. `None` where the stiffness can't be factorised.
pub fn rounded_energy(assembly: &Assembly<'_>) -> Option<f64> {
    let model = assembly.model;
    let (mass, stiffness) = (assembly.mass(), assembly.stiffness());
    let mut q = vec![0.0; assembly.numbering.len()];
    for (node, place) in model.nodes.iter().enumerate() {
        // uniform, and a wave that is in balance on a free shaft
        q[assembly.numbering.of_node(node).start + 1] = 1.0 + 1.3 * (TAU * place.x / model.length).cos();
    }
    let pattern = assembly.restrict(&q);
    let load = multiply(&mass, Mat::from_fn(pattern.len(), 1, |i, _| pattern[i]).as_ref());
    let flexibility = Flexibility::at_rest(assembly, &stiffness, &mass).ok()?;
    // beside what soft bearings answer, which is rigid
    let load = match flexibility.soft_motions() {
        Some(soft) => &load - multiply(&mass, soft) * (soft.transpose() * &load),
        None => load,
    };
    let x = flexibility.solve(load.clone());
    let energy: f64 = x.col(0).transpose() * load.col(0);
    let share = f64::EPSILON * absolute_energy(&stiffness, &x) / energy.abs();
    share.is_finite().then_some(share)
}

/// Energy of x with the absolute values of all terms, `|x|^T |K| |x|`: rounding errors of the energy are eps
/// times it.
fn absolute_energy(k: &Sparse, x: &Mat<f64>) -> f64 {
    let mut sum = 0.0;
    for j in 0..k.ncols() {
        for (&i, value) in k.row_idx_of_col_raw(j).iter().zip(k.val_of_col(j)) {
            sum += (value * x[(i, 0)] * x[(j, 0)]).abs();
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    fn material(nu: f64) -> Material {
        Material {
            youngs_modulus: 2.1e11,
            poisson_ratio: nu,
            density: 7800.0,
            stiffness_damping: 0.0,
            loss_factor: 0.0,
            mass_damping: 0.0,
        }
    }

    /// A section that can't contract has the modulus `E (1 - nu) / ((1 + nu)(1 - 2 nu))`.
    #[test]
    fn the_linear_section_locks_by_the_oedometer_modulus() {
        for nu in [-0.5, 0.0, 0.3, 0.49] {
            let exact = (1.0 - nu) / ((1.0 + nu) * (1.0 - 2.0 * nu)) - 1.0;
            let ours =
                bending_excess(&Section::circle(0.1), &material(nu), SectionBasis::Monomials(1)).unwrap();
            assert!((ours - exact).abs() < 1e-9 * (1.0 + exact), "{nu}: {ours} {exact}");
            let free =
                bending_excess(&Section::circle(0.1), &material(nu), SectionBasis::Monomials(2)).unwrap();
            assert!(free.abs() < 1e-9, "{nu}: {free}");
        }
    }

    /// Square: `J = 0.1406 a^4` against `a^4 / 6` where nothing warps (Timoshenko and Goodier).
    #[test]
    fn a_square_twists_too_stiffly_below_order_four() {
        let square = Section::rectangle(1.0, 1.0);
        let excess = |order| torsion_excess(&square, SectionBasis::Monomials(order)).unwrap();
        assert!((excess(3) - (1.0 / 6.0 / 0.140577 - 1.0)).abs() < 1e-3, "{}", excess(3));
        assert!(excess(4) < 0.01 && excess(4) >= 0.0, "{}", excess(4));
        assert!(
            torsion_excess(&Section::ellipse(0.1, 0.2), SectionBasis::Monomials(2)).unwrap().abs() < 1e-9
        );
    }

    #[test]
    fn functions_on_a_thin_wall_are_dependent() {
        let left =
            |wall: f64, order| independence(&Section::tube(1.0, 1.0 - wall), SectionBasis::Monomials(order));
        assert!(left(1e-4, 5) < LEAST_INDEPENDENCE[0] && left(1e-4, 3) > LEAST_INDEPENDENCE[1]);
    }
}
