//! From a case as written to a checked [`Model`]: every rule of the case format, with its remedy.

mod attachments;
mod bearing_table;
mod bearings;
mod body;
mod campbell;
pub mod element_choice;
mod loads;
pub mod memory;
mod mesh;
mod response;
mod scene;
mod section;
mod segments;
mod spinup;
pub mod steps;

use crate::case::{Case, LoadedCase, nearest};
use crate::check::memory::{memory, mesh_memory, tapered_memory};
use crate::check::mesh::{Mesh, SegmentPlan};
use crate::check::response::Attached;
use crate::check::steps::FINEST;
use crate::error::Result;
use crate::instructions::Instructions;
use crate::model::{Element, ElementKind, Hub, Law, Material, Model, Names};
use crate::section::Section;
use crate::section::basis::SectionBasis;

/// Most memory a model may need, bytes.
const LARGEST_MEMORY_BYTES: f64 = 12e9;
/// Largest value of any quantity, SI.
const LARGEST_SI: f64 = 1e30;

impl Model {
    /// Checks a case and builds its mesh.
    ///
    /// # Errors
    /// The first rule that the case breaks, with file, path, value and remedy.
    pub fn new(loaded: &LoadedCase) -> Result<Self> {
        let input = Input { loaded, case: &loaded.case };
        let (materials, material_names) = input.materials()?;
        let (sections, section_names) = input.sections()?;
        let (mut plans, choices) =
            input.segments((&sections, &section_names), (&materials, &material_names))?;
        let kept = used(plans.iter_mut().flat_map(|p| [&mut p.section, &mut p.to_section]).collect());
        let names_of = |all: &[String], kept: &[usize]| kept.iter().map(|&i| all[i].clone()).collect();
        let mut names = Names { sections: names_of(&section_names, &kept), ..Names::default() };
        let sections: Vec<Section> = kept.into_iter().map(|i| sections[i]).collect();
        let kept = used(plans.iter_mut().map(|p| &mut p.material).collect());
        names.materials = names_of(&material_names, &kept);
        let materials: Vec<Material> = kept.into_iter().map(|i| materials[i]).collect();
        let length: f64 = plans.iter().map(|p| p.length).sum();
        let places = input.fixed_positions(length)?;
        let mesh = input.mesh(&plans, &sections, &places, length)?;
        let ends = |[a, b]: &[usize; 2]| format!("{} to {}", names.sections[*a], names.sections[*b]);
        let between: Vec<String> = mesh.between.iter().map(ends).collect();
        names.sections.extend(between);
        let sections = mesh.sections.clone();
        let disks = input.disks(&mesh, &sections)?;
        let (supports, mut bearings) = input.supports(&mesh, &sections)?;
        input.couplings(&mesh, length, &mut bearings)?;
        let (loads, tractions) = input.loads(&mesh, &sections)?;
        let probes = input.probes(&mesh, length, &sections)?;
        input.expected()?;
        let operating_speed = input.operating_speed()?;
        let weighed = |e: &Element| element_mass(&materials, &sections, e);
        let attached = Attached {
            length,
            mass: mesh.elements.iter().map(weighed).sum::<f64>() + disks.iter().map(|d| d.mass).sum::<f64>(),
            nodes: &mesh.nodes,
            disks: &disks,
            bearings: &bearings.list,
        };
        let unbalance = input.unbalance(&attached, operating_speed)?;
        let harmonic = input.harmonic(&attached)?;
        let model = Self {
            operating_speed,
            clearances: input.clearances(length)?,
            unbalance,
            spinning_masses: Vec::new(),
            harmonic,
            map: input.map(length, operating_speed)?,
            reference_length: sections.iter().map(Section::outer_size).fold(0.0, f64::max),
            length,
            gravity: input.gravity()?,
            loads,
            tractions,
            quadrature: input.quadrature()?,
            instructions: Instructions::Widest,
            statics: input.statics()?,
            spinup: input.spinup(&mesh, &sections)?,
            modes: input.modes()?,
            campbell: input.campbell(sections.iter().all(Section::is_axisymmetric))?,
            materials,
            sections,
            names,
            initial_stress: input.initial_stress(),
            choices,
            snapped: snapped(&mesh, &places, length),
            elements: mesh.elements,
            nodes: mesh.nodes,
            disks,
            bearings: bearings.list,
            housings: bearings.housings,
            supports,
            probes,
        };
        input.memory(&model)?;
        Ok(model)
    }
}

struct Input<'a> {
    loaded: &'a LoadedCase,
    case: &'a Case,
}

type Named<T> = (Vec<T>, Vec<String>);

/// What "element" says; `None` where the program chooses.
#[derive(Debug, Clone, Copy)]
struct Asked {
    kind: Option<ElementKind>,
    effort: Option<usize>,
}

impl Input<'_> {
    fn fault<T>(&self, path: &str, problem: impl Into<String>, allowed: impl Into<String>) -> Result<T> {
        Err(self.loaded.fault(path, problem, allowed))
    }

    /// Positive, and within the sixty decades that squares and products survive as numbers.
    fn positive(&self, path: &str, value: f64) -> Result<f64> {
        if !(value > 0.0) {
            return self.fault(path, "must be positive", "a finite value above 0");
        }
        self.within(path, value, 1e-30, LARGEST_SI)
    }

    fn not_negative(&self, path: &str, value: f64) -> Result<f64> {
        if !(value >= 0.0) {
            return self.fault(path, "must not be negative", "0 or more");
        }
        self.within(path, value, 0.0, LARGEST_SI)
    }

    fn length(&self, path: &str, value: f64) -> Result<f64> {
        self.positive(path, value)?;
        self.within(path, value, 1e-15, 1e15)
    }

    fn within(&self, path: &str, value: f64, least: f64, most: f64) -> Result<f64> {
        if value >= least && value <= most {
            return Ok(value);
        }
        self.fault(
            path,
            "so extreme a value leaves no digits to compute with",
            format!("{least:e} to {most:e} (SI)"),
        )
    }

    fn named(&self, path: &str, what: &str, name: &str, names: &[String]) -> Result<usize> {
        if let Some(at) = names.iter().position(|n| n == name) {
            return Ok(at);
        }
        let known: Vec<&str> = names.iter().map(String::as_str).collect();
        let near = nearest(name, &known).map(|n| format!(", did you mean \"{n}\"?")).unwrap_or_default();
        self.fault(path, format!("there is no {what} \"{name}\"{near}"), known.join(", "))
    }

    /// A member of the family and the effort at steps ("34X3k2": 2), each `None` for the program's own choice.
    fn element(&self, path: &str, name: &str) -> Result<Asked> {
        let Some((member, digits)) = name.split_once('k') else {
            let kind = self.member(path, name)?;
            return Ok(Asked { kind, effort: kind.is_some().then_some(0) });
        };
        let kind = self.member(path, member)?;
        match digits.parse::<usize>() {
            Ok(effort @ 0..=FINEST) if digits.len() == 1 && kind.is_none_or(|k| k.law == Law::Continuum) => {
                Ok(Asked { kind, effort: Some(effort) })
            }
            _ => self.fault(
                path,
                format!("\"{name}\" names no effort at steps"),
                format!(
                    "34X1 .. 34X5, 34Rdh or auto with k0 (none) to k{FINEST} (finest), e.g. 34X3k3; \"auto\" chooses both"
                ),
            ),
        }
    }

    /// A member of the family; `None` for the program's own choice.
    fn member(&self, path: &str, name: &str) -> Result<Option<ElementKind>> {
        let kind = |axial_degree, basis, law| Ok(Some(ElementKind { axial_degree, basis, law }));
        let known = [
            "34X1", "34X2", "34X3", "34X4", "34X5", "34R12", "34R13", "34R23", "34R33", "34R34", "auto",
            "3333c", "3333s",
        ];
        let digits = |text: &str| text.chars().map(|c| c.to_digit(10).map(|d| d as usize)).collect();
        let numbers: Option<Vec<usize>> =
            name.strip_prefix("34X").or(name.strip_prefix("34R")).and_then(digits);
        match (name, numbers.as_deref()) {
            ("auto", _) => Ok(None),
            ("3333c", _) => kind(2, SectionBasis::Monomials(1), Law::Split),
            ("3333s", _) => kind(2, SectionBasis::Monomials(1), Law::Structural),
            (_, Some(&[order @ 1..=5])) if name.starts_with("34X") => {
                kind(3, SectionBasis::Monomials(order), Law::Continuum)
            }
            (_, Some(&[degree @ 1..=9, harmonics @ 1..=9])) if name.starts_with("34R") => {
                kind(3, SectionBasis::Ring { degree, harmonics }, Law::Continuum)
            }
            _ if name.starts_with("34R") => self.fault(
                path,
                "a ring member 34Rdh has a radial degree d from 1 to 9 and harmonics up to h from 1 to 9",
                "e.g. 34R12, 34R13, 34R23, 34R33, 34R34 (h 3 or more lets a wall ovalise); or 34X1 .. 34X5",
            ),
            _ => {
                let near =
                    nearest(name, &known).map(|n| format!(", did you mean \"{n}\"?")).unwrap_or_default();
                self.fault(path, format!("this version has no element \"{name}\"{near}"), known.join(", "))
            }
        }
    }

    /// Positions that force element ends, with their paths.
    fn fixed_positions(&self, length: f64) -> Result<Vec<(String, f64)>> {
        let disks = self.case.disks.iter().enumerate().map(|(i, d)| (format!("disks.{i}.at"), d.at.0));
        let supports =
            self.case.supports.iter().enumerate().map(|(i, s)| (format!("supports.{i}.at"), s.at.0));
        let loads = self.case.loads.iter().enumerate();
        let loads = loads.filter_map(|(i, l)| l.at.map(|at| (format!("loads.{i}.at"), at.0)));
        let couplings = self.case.couplings.iter().enumerate();
        let couplings = couplings.map(|(i, c)| (format!("couplings.{i}.at"), c.at.0));
        let driven = self.case.spinup.iter().filter_map(|s| s.driven_at);
        let driven = driven.map(|at| ("spinup.driven_at".to_owned(), at.0));
        // where a run-up may find them in its mass matrix
        let masses = self.case.unbalance.iter().filter(|_| self.case.spinup.is_some());
        let masses = masses.flat_map(|u| u.masses.iter().enumerate());
        let masses = masses.map(|(i, m)| (format!("unbalance.masses.{i}.at"), m.at.0));
        let mut list = Vec::new();
        for (path, at) in disks.chain(supports).chain(loads).chain(couplings).chain(driven).chain(masses) {
            self.on_shaft(&path, at, length)?;
            list.push((path, at));
        }
        Ok(list)
    }

    fn on_shaft(&self, path: &str, at: f64, length: f64) -> Result<()> {
        if at >= -1e-9 * length && at <= length * (1.0 + 1e-9) {
            return Ok(());
        }
        self.fault(path, "this place is off the shaft", format!("0 to {length} m"))
    }

    fn mesh(
        &self,
        plans: &[SegmentPlan],
        sections: &[Section],
        places: &[(String, f64)],
        length: f64,
    ) -> Result<Mesh> {
        let positions: Vec<f64> = places.iter().map(|place| place.1).collect();
        let mut memory = 0.0;
        for (i, plan) in plans.iter().enumerate() {
            let pieces = plan.elements as f64 + positions.len() as f64;
            let per_node = 3.0 * plan.kind.n_vectors() as f64;
            let unknowns = pieces * plan.kind.axial_degree as f64 * per_node;
            memory += mesh_memory(unknowns, per_node);
            if plan.section != plan.to_section {
                memory += pieces * tapered_memory(per_node);
            }
            if memory > LARGEST_MEMORY_BYTES {
                return self.fault(
                    &format!("shaft.segments.{i}.elements"),
                    format!("so many elements need about {:.0} GB of memory", memory / 1e9),
                    format!(
                        "fewer elements: at most {:.0} GB for the whole shaft",
                        LARGEST_MEMORY_BYTES / 1e9
                    ),
                );
            }
        }
        // a grip that has no limit as sections deform more freely
        let disks = self.case.disks.iter().filter(|d| d.hub != Hub::Rigid);
        let mut plain: Vec<f64> = disks.map(|d| d.at.0).collect();
        // a thin face keeps both sides plane
        let mut start = 0.0;
        for plan in plans {
            plain.extend(plan.face.then_some(start));
            start += plan.length;
        }
        let coupled: Vec<f64> = self.case.couplings.iter().map(|c| c.at.0).collect();
        plain.extend(&coupled);
        Ok(Mesh::new(plans, sections, (&positions, &plain, &coupled), length))
    }

    /// Refuses a model whose matrices, sweep and histories together need too much memory.
    fn memory(&self, model: &Model) -> Result<()> {
        let shares = memory(model);
        let total: f64 = shares.iter().map(|share| share.bytes).sum();
        let largest = shares.iter().max_by(|a, b| a.bytes.total_cmp(&b.bytes));
        match largest {
            Some(share) if !(total <= LARGEST_MEMORY_BYTES) => {
                let parts: Vec<String> =
                    shares.iter().map(|s| format!("{} {:.1} GB", s.what, s.bytes / 1e9)).collect();
                self.fault(
                    share.path,
                    format!(
                        "the analyses of the case need about {:.0} GB of memory: {}",
                        total / 1e9,
                        parts.join(", ")
                    ),
                    format!("less: at most {:.0} GB altogether", LARGEST_MEMORY_BYTES / 1e9),
                )
            }
            _ => Ok(()),
        }
    }

    fn expected(&self) -> Result<()> {
        for (i, e) in self.case.expected.iter().enumerate() {
            let at = |key: &str| format!("expected.{i}.{key}");
            let numbers = match &e.value {
                serde_json::Value::Array(list) => !list.is_empty() && list.iter().all(|v| v.is_number()),
                value => value.is_number(),
            };
            if !numbers {
                return self.fault(
                    &at("value"),
                    "the expected value is no number",
                    "a number or a list of numbers",
                );
            }
            // overrides must fit the case, or the check would not be of what it says
            if let Some(Err(error)) = e.set.as_ref().map(|set| self.loaded.with(set)) {
                return self.fault(&at("set"), "these overrides do not fit the case", error.to_string());
            }
            let tolerances = [("rtol", e.rtol), ("atol", e.atol)];
            for (key, tolerance) in tolerances {
                self.not_negative(&at(key), tolerance.unwrap_or(0.0))?;
            }
            if tolerances.iter().all(|(_, t)| t.is_none()) {
                return self.fault(
                    &format!("expected.{i}"),
                    "the expected value has no tolerance",
                    "rtol or atol",
                );
            }
        }
        Ok(())
    }
}

/// Places that were moved onto an element end by more than the rounding of sums, in words.
fn snapped(mesh: &Mesh, places: &[(String, f64)], length: f64) -> Vec<String> {
    let moved = |(path, at): &(String, f64)| {
        let end = mesh.nodes[mesh.node_at(*at)].x;
        ((end - at).abs() > 1e-12 * length).then(|| {
            // without the rounding of sums
            let written = format!("{end:.11e}").parse().unwrap_or(end);
            format!(
                "{path}: {at} m is taken for {written} m, the element end {:.1e} m beside it",
                (end - at).abs()
            )
        })
    };
    places.iter().filter_map(moved).collect()
}

/// Mass of an element, kg; areas change as the square of the position, which Simpson's rule integrates exactly.
fn element_mass(materials: &[Material], sections: &[Section], element: &Element) -> f64 {
    let [left, right] = element.faces.map(|face| sections[face].area());
    let area = (left + 4.0 * sections[element.section].area() + right) / 6.0;
    (materials[element.material].density * area + element.carried.added_mass) * element.length
}

/// What is referred to, in order of first use; the references are renumbered to that order.
fn used(references: Vec<&mut usize>) -> Vec<usize> {
    let mut kept: Vec<usize> = Vec::new();
    for reference in references {
        let at = kept.iter().position(|k| k == reference).unwrap_or_else(|| {
            kept.push(*reference);
            kept.len() - 1
        });
        *reference = at;
    }
    kept
}
