//! From a case as written to a checked [`Model`]: every rule of the case format, with its remedy.

pub mod element_choice;
mod loads;
pub mod memory;
mod mesh;
mod scene;
mod section;
mod spinup;

use crate::case::{self, Case, LoadedCase, nearest};
use crate::check::element_choice::{Choice, Demands, choose, level};
use crate::check::memory::{memory, mesh_memory};
use crate::check::mesh::{Mesh, SHORTEST, SegmentPlan};
use crate::error::Result;
use crate::instructions::Instructions;
use crate::model::ElementChoice;
use crate::model::{
    ActsOn, Bearing, CampbellSettings, Disk, ElementKind, Form, Gyroscopic, Hub, Law, Material, Model, Names,
    SectionHold, Support, SupportKind, WhirlFrame,
};
use crate::section::basis::SectionBasis;
use crate::section::{Section, Shape, Surface};
use std::f64::consts::PI;

/// Most memory a model may need, bytes.
const MEMORY_LIMIT: f64 = 12e9;
/// Largest value of any quantity, SI.
const LARGEST: f64 = 1e30;

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
        let kept = used(plans.iter_mut().map(|p| &mut p.section).collect());
        let names_of = |all: &[String], kept: &[usize]| kept.iter().map(|&i| all[i].clone()).collect();
        let mut names = Names { sections: names_of(&section_names, &kept), ..Names::default() };
        let sections: Vec<Section> = kept.into_iter().map(|i| sections[i]).collect();
        let kept = used(plans.iter_mut().map(|p| &mut p.material).collect());
        names.materials = names_of(&material_names, &kept);
        let materials = kept.into_iter().map(|i| materials[i]).collect();
        let length: f64 = plans.iter().map(|p| p.length).sum();
        let places = input.fixed_positions(length)?;
        let mesh = input.mesh(&plans, &sections, &places, length)?;
        let disks = input.disks(&mesh, &sections)?;
        let (supports, bearings) = input.supports(&mesh, &sections)?;
        let (loads, tractions) = input.loads(&mesh, &sections)?;
        let probes = input.probes(&mesh, length, &sections)?;
        input.expected()?;
        let model = Self {
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
            choices,
            snapped: snapped(&mesh, &places, length),
            elements: mesh.elements,
            nodes: mesh.nodes,
            disks,
            bearings,
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

impl Input<'_> {
    fn fault<T>(&self, path: &str, problem: impl Into<String>, allowed: impl Into<String>) -> Result<T> {
        Err(self.loaded.fault(path, problem, allowed))
    }

    /// Positive, and within the sixty decades that squares and products survive as numbers.
    fn positive(&self, path: &str, value: f64) -> Result<f64> {
        if !(value > 0.0) {
            return self.fault(path, "must be positive", "a finite value above 0");
        }
        self.within(path, value, 1e-30, LARGEST)
    }

    fn not_negative(&self, path: &str, value: f64) -> Result<f64> {
        if !(value >= 0.0) {
            return self.fault(path, "must not be negative", "0 or more");
        }
        self.within(path, value, 0.0, LARGEST)
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

    /// A member of the family; `None` for the program's own choice.
    fn element(&self, path: &str, name: &str) -> Result<Option<ElementKind>> {
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

    /// What bears upon automatic choices: half of the whirl branches is one direction's bending.
    fn demands(&self) -> Demands {
        /// Bending modes that count where no diagram is asked for.
        const MODES: f64 = 3.0;
        let case = self.case;
        Demands {
            length: case.shaft.iter().flat_map(|s| &s.segments).map(|s| s.length.0).sum(),
            half_waves: case.campbell.as_ref().map_or(MODES, |c| (f64::from(c.modes) / 2.0).max(1.0)),
            spins_up: case.spinup.is_some(),
            poisson_ratio: 0.0,
        }
    }

    /// The member of every segment, and what was chosen by the program: where "auto" is asked for, and on hollow sections
    /// where nothing is.
    fn kinds(
        &self,
        shaft: &case::Shaft,
        (shapes, sections): (&[Section], &[String]),
        (materials, material_names): (&[Material], &[String]),
    ) -> Result<(Vec<ElementKind>, Vec<ElementChoice>)> {
        let named = |path: &str, name: &Option<String>| match name {
            Some(name) => self.element(path, name).map(Some),
            None => Ok(None),
        };
        let default = named("shaft.element", &shaft.element)?;
        let continuum = |basis| ElementKind { axial_degree: 3, basis, law: Law::Continuum };
        let demands = self.demands();
        let (mut fixed, mut chosen) = (Vec::new(), Vec::new());
        for (i, segment) in shaft.segments.iter().enumerate() {
            let at = |key: &str| format!("shaft.segments.{i}.{key}");
            let shape = &shapes[self.named(&at("section"), "section", &segment.section, sections)?];
            let asked = named(&at("element"), &segment.element)?.or(default);
            let asked =
                asked.unwrap_or((!shape.is_hollow()).then_some(continuum(SectionBasis::Monomials(3))));
            let material = self.named(&at("material"), "material", &segment.material, material_names)?;
            let demands = Demands { poisson_ratio: materials[material].poisson_ratio, ..demands };
            chosen.push(asked.is_none().then(|| (choose(shape, demands), *shape, demands.poisson_ratio)));
            fixed.push(asked);
        }
        level(&mut chosen);
        let mut choices = Vec::new();
        let mut kinds = Vec::new();
        for (i, (asked, choice)) in fixed.into_iter().zip(chosen).enumerate() {
            if let Some((Choice { basis, reason, estimate }, ..)) = &choice {
                let (name, section) = (basis.member(), &shaft.segments[i].section);
                let text = format!(
                    "{name} for section \"{section}\": {reason}; estimated error of its functions {estimate:.0e}"
                );
                choices.push(ElementChoice { text, segment: i, estimated_error: *estimate });
            }
            let basis = choice.map(|(c, ..)| continuum(c.basis));
            kinds.push(asked.or(basis).unwrap_or(continuum(SectionBasis::Monomials(3))));
        }
        Ok((kinds, choices))
    }

    fn segments(
        &self,
        (shapes, sections): (&[Section], &[String]),
        (stuffs, materials): (&[Material], &[String]),
    ) -> Result<(Vec<SegmentPlan>, Vec<ElementChoice>)> {
        let Some(shaft) = &self.case.shaft else {
            return match self.case.bodies.is_empty() {
                true => self.fault(
                    "(top level)",
                    "the key \"shaft\" is missing",
                    "add \"shaft\" (see `rotor schema`)",
                ),
                false => self.fault(
                    "bodies",
                    "the case is a contact scene: it has no shaft",
                    "`rotor contact` or `rotor check` for a scene; a case with \"shaft\" for this analysis",
                ),
            };
        };
        if !self.case.bodies.is_empty() {
            return self.fault("bodies", "a case has either a shaft or bodies", "one of them");
        }
        if self.case.contact.is_some() {
            return self.fault(
                "contact",
                "contact is between bodies: a shaft has none",
                "bodies; or spinup.stators",
            );
        }
        if shaft.segments.is_empty() {
            return self.fault("shaft.segments", "the shaft has no segments", "at least one segment");
        }
        let (kinds, choices) = self.kinds(shaft, (shapes, sections), (stuffs, materials))?;
        let mut plans = Vec::new();
        for (i, (segment, kind)) in shaft.segments.iter().zip(kinds).enumerate() {
            let at = |key: &str| format!("shaft.segments.{i}.{key}");
            if segment.elements == 0 {
                return self.fault(&at("elements"), "a segment needs elements", "at least 1");
            }
            let section = self.named(&at("section"), "section", &segment.section, sections)?;
            let shape = &shapes[section];
            if kind.basis.is_ring() && !shape.is_ring() {
                let name = kind.name();
                let (problem, remedy) = if !shape.is_hollow() {
                    (
                        format!("{name} is an element for a wall, and this section is solid"),
                        "a tube or hollow ellipse with a bore above 0; or the element 34X3 (\"auto\" chooses)",
                    )
                } else {
                    (
                        format!("{name} needs an elliptic wall whose bore is similar to its outline"),
                        "inner_semi_axis_y / semi_axis_y equal to inner_semi_axis_z / semi_axis_z; or 34X5",
                    )
                };
                return self.fault(&at("section"), problem, remedy);
            }
            let round = shape.is_axisymmetric();
            let fits = match kind.law {
                Law::Continuum => true,
                Law::Split => !shape.is_hollow() && (round || shape.shape == Shape::Rectangle),
                Law::Structural => !shape.is_hollow() && round,
            };
            if !fits {
                return self.fault(
                    &at("section"),
                    "the comparison element has no shear correction and torsion constant for this section",
                    "3333c: solid circle or rectangle; 3333s: solid circle; else an element 34X1 .. 34X5",
                );
            }
            plans.push(SegmentPlan {
                length: self.length(&at("length"), segment.length.0)?,
                elements: segment.elements,
                kind,
                section,
                material: self.named(&at("material"), "material", &segment.material, materials)?,
            });
        }
        let total: f64 = plans.iter().map(|p| p.length).sum();
        // a sum beyond all numbers is refused here, too
        if let Some(i) = plans.iter().position(|p| !(p.length >= SHORTEST * total)) {
            return self.fault(
                &format!("shaft.segments.{i}.length"),
                format!("this segment vanishes beside the shaft's length of {total:e} m"),
                format!("at least {SHORTEST:e} of the shaft"),
            );
        }
        for (i, pair) in plans.windows(2).enumerate() {
            if shapes[pair[0].section].common(&shapes[pair[1].section]).is_none() {
                return self.fault(
                    &format!("shaft.segments.{}.section", i + 1),
                    "this section has nothing in common with the one before it",
                    "neighbouring sections whose walls overlap",
                );
            }
        }
        Ok((plans, choices))
    }

    /// Positions that force element ends, with their paths.
    fn fixed_positions(&self, length: f64) -> Result<Vec<(String, f64)>> {
        let disks = self.case.disks.iter().enumerate().map(|(i, d)| (format!("disks.{i}.at"), d.at.0));
        let supports =
            self.case.supports.iter().enumerate().map(|(i, s)| (format!("supports.{i}.at"), s.at.0));
        let loads = self.case.loads.iter().enumerate();
        let loads = loads.filter_map(|(i, l)| l.at.map(|at| (format!("loads.{i}.at"), at.0)));
        let driven = self.case.spinup.iter().filter_map(|s| s.driven_at);
        let driven = driven.map(|at| ("spinup.driven_at".to_owned(), at.0));
        let mut list = Vec::new();
        for (path, at) in disks.chain(supports).chain(loads).chain(driven) {
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
            if memory > MEMORY_LIMIT {
                return self.fault(
                    &format!("shaft.segments.{i}.elements"),
                    format!("so many elements need about {:.0} GB of memory", memory / 1e9),
                    format!("fewer elements: at most {:.0} GB for the whole shaft", MEMORY_LIMIT / 1e9),
                );
            }
        }
        Ok(Mesh::new(plans, sections, &positions, length))
    }

    /// Refuses a model whose matrices, sweep and histories together need too much memory.
    fn memory(&self, model: &Model) -> Result<()> {
        let shares = memory(model);
        let total: f64 = shares.iter().map(|share| share.bytes).sum();
        let largest = shares.iter().max_by(|a, b| a.bytes.total_cmp(&b.bytes));
        match largest {
            Some(share) if !(total <= MEMORY_LIMIT) => {
                let parts: Vec<String> =
                    shares.iter().map(|s| format!("{} {:.1} GB", s.what, s.bytes / 1e9)).collect();
                self.fault(
                    share.path,
                    format!(
                        "the analyses of the case need about {:.0} GB of memory: {}",
                        total / 1e9,
                        parts.join(", ")
                    ),
                    format!("less: at most {:.0} GB altogether", MEMORY_LIMIT / 1e9),
                )
            }
            _ => Ok(()),
        }
    }

    fn disks(&self, mesh: &Mesh, sections: &[Section]) -> Result<Vec<Disk>> {
        let mut list: Vec<Disk> = Vec::new();
        for (i, d) in self.case.disks.iter().enumerate() {
            let at = |key: &str| format!("disks.{i}.{key}");
            let by_inertia = [
                ("mass", d.mass.is_some()),
                ("polar_inertia", d.polar_inertia.is_some()),
                ("diametral_inertia", d.diametral_inertia.is_some()),
            ];
            let by_geometry = [
                ("radius", d.radius.is_some()),
                ("thickness", d.thickness.is_some()),
                ("rho", d.rho.is_some()),
                ("diameter", d.diameter.is_some()),
                ("inner_radius", d.inner_radius.is_some()),
                ("inner_diameter", d.inner_diameter.is_some()),
                ("thickness_inertia", d.thickness_inertia.is_some()),
            ];
            let allowed = "either mass, polar_inertia, diametral_inertia; or radius (or diameter), thickness, rho (and inner_radius or inner_diameter, thickness_inertia)";
            let first = |keys: &[(&'static str, bool)]| keys.iter().find(|k| k.1).map(|k| k.0);
            let (mass, polar, diametral) = match (first(&by_inertia), first(&by_geometry)) {
                (Some(_), Some(key)) => {
                    return self.fault(
                        &at(key),
                        "a disk is given by inertia or by geometry, not both",
                        allowed,
                    );
                }
                (None, None) => return self.fault(&format!("disks.{i}"), "the disk has no mass", allowed),
                (Some(_), None) => {
                    let (Some(m), Some(p), Some(t)) = (d.mass, d.polar_inertia, d.diametral_inertia) else {
                        let missing = by_inertia.iter().find(|k| !k.1).map_or("mass", |k| k.0);
                        return self.fault(
                            &at(missing),
                            format!("the disk's \"{missing}\" is missing"),
                            allowed,
                        );
                    };
                    (
                        self.positive(&at("mass"), m.0)?,
                        self.not_negative(&at("polar_inertia"), p.0)?,
                        self.not_negative(&at("diametral_inertia"), t.0)?,
                    )
                }
                (None, Some(_)) => {
                    let radius = self.radius(&at, ["radius", "diameter"], [d.radius, d.diameter])?;
                    let inner = self.radius(
                        &at,
                        ["inner_radius", "inner_diameter"],
                        [d.inner_radius, d.inner_diameter],
                    )?;
                    let (Some(radius), Some(thickness), Some(rho)) = (radius, d.thickness, d.rho) else {
                        let first = usize::from(radius.is_some());
                        let missing = by_geometry[first..3].iter().find(|k| !k.1).map_or("radius", |k| k.0);
                        return self.fault(
                            &at(missing),
                            format!("the disk's \"{missing}\" is missing"),
                            allowed,
                        );
                    };
                    let outer = self.length(&at("radius"), radius.0)?;
                    let bore = self.not_negative(&at("inner_radius"), inner.map_or(0.0, |r| r.0))?;
                    let (t, rho) =
                        (self.length(&at("thickness"), thickness.0)?, self.positive(&at("rho"), rho.0)?);
                    if bore >= outer {
                        return self.fault(
                            &at("inner_radius"),
                            "the bore is not smaller than the disk",
                            format!("below {outer}"),
                        );
                    }
                    let mass = rho * PI * (outer + bore) * (outer - bore) * t;
                    let polar = mass * (outer * outer + bore * bore) / 2.0;
                    let thick = if d.thickness_inertia.unwrap_or(true) { mass * t * t / 12.0 } else { 0.0 };
                    (mass, polar, polar / 2.0 + thick)
                }
            };
            if diametral < polar / 2.0 * (1.0 - 1e-9) {
                return self.fault(
                    &at("diametral_inertia"),
                    "no body has so small a diametral inertia",
                    format!("at least half the polar inertia, {}", polar / 2.0),
                );
            }
            let node = mesh.node_at(d.at.0);
            let hub = match d.hub {
                case::Hub::Rigid => Hub::Rigid,
                case::Hub::Soft => Hub::Soft,
                case::Hub::Bore => Hub::Bore,
                case::Hub::Rim => Hub::Rim,
            };
            self.boundary(&at("hub"), hub.acts_on(), "rigid", mesh, sections, node)?;
            if hub == Hub::Soft && mesh.nodes[node].field.basis.is_ring() {
                return self.fault(
                    &at("hub"),
                    "a soft hub acts on the vectors of the axis, which is empty in a ring section",
                    "\"rigid\", \"rim\" or \"bore\"; or an element 34X1 .. 34X5 there",
                );
            }
            let offset = d.offset.map_or([0.0; 2], |o| o.map(|c| c.0));
            list.push(Disk { node, mass, polar_inertia: polar, diametral_inertia: diametral, offset, hub });
        }
        Ok(list)
    }

    fn supports(&self, mesh: &Mesh, sections: &[Section]) -> Result<(Vec<Support>, Vec<Bearing>)> {
        let (mut supports, mut bearings): (Vec<Support>, Vec<Bearing>) = (Vec::new(), Vec::new());
        for (i, s) in self.case.supports.iter().enumerate() {
            let path = format!("supports.{i}");
            let node = mesh.node_at(s.at.0);
            self.support_keys(&path, s)?;
            let acts_on = self.acts_on(&path, s.acts_on, mesh, sections, node)?;
            if s.kind == Some(case::SupportKind::Bearing) {
                bearings.push(self.bearing(&path, s, node, acts_on)?);
                continue;
            }
            if let Some(other) = supports.iter().find(|other| other.node == node) {
                return self.fault(
                    &path,
                    format!("contradicts `{}`, which holds the same section", other.path),
                    "one kinematic support at a place; bearings may be added to it",
                );
            }
            let hold = match s.section {
                Some(case::SectionHold::Rigid) => SectionHold::Rigid,
                // the axis of a ring is empty: its section is held in the mean
                _ if s.acts_on.is_none() && !mesh.nodes[node].field.basis.is_ring() => {
                    SectionHold::Plane(ActsOn::Axis)
                }
                _ => SectionHold::Plane(acts_on),
            };
            let driven = s.driven.unwrap_or(true);
            let kind = match (s.kind, &s.fix) {
                (Some(case::SupportKind::Clamped), _) => SupportKind::Clamped(hold),
                (Some(case::SupportKind::Revolute), _) => SupportKind::Revolute { hold, driven },
                (Some(case::SupportKind::Cylindrical), _) => SupportKind::Cylindrical { hold, driven },
                (Some(case::SupportKind::Pinned), _) => SupportKind::Pinned(acts_on),
                (Some(case::SupportKind::Roller), _) => SupportKind::Roller(acts_on),
                (_, fix) => SupportKind::Fix(self.fix(
                    &path,
                    fix.as_deref().unwrap_or(&[]),
                    mesh.nodes[node].field.basis,
                )?),
            };
            supports.push(Support { node, kind, path });
        }
        Ok((supports, bearings))
    }

    /// What a support or load at `path` takes hold of: there must be such a thing.
    fn acts_on(
        &self,
        path: &str,
        given: Option<case::ActsOn>,
        mesh: &Mesh,
        sections: &[Section],
        node: usize,
    ) -> Result<ActsOn> {
        let path = format!("{path}.acts_on");
        let acts_on = match given {
            Some(case::ActsOn::Axis) => ActsOn::Axis,
            Some(case::ActsOn::Bore) => ActsOn::Bore,
            Some(case::ActsOn::Rim) => ActsOn::Rim,
            Some(case::ActsOn::Section) | None => ActsOn::Section,
        };
        if acts_on == ActsOn::Axis && mesh.nodes[node].field.basis.is_ring() {
            return self.fault(
                &path,
                "the axis is empty in a ring section",
                "\"section\" (the whole wall, the default), \"bore\" or \"rim\"; or an element 34X1 .. 34X5 there",
            );
        }
        self.boundary(&path, acts_on, "section", mesh, sections, node)?;
        Ok(acts_on)
    }

    /// Refuses a boundary that the section common to both sides of a node does not have.
    fn boundary(
        &self,
        path: &str,
        acts_on: ActsOn,
        instead: &str,
        mesh: &Mesh,
        sections: &[Section],
        node: usize,
    ) -> Result<()> {
        let Some(surface) = acts_on.surface() else { return Ok(()) };
        let here: Vec<Section> = mesh.sections_at(node).map(|s| sections[s]).collect();
        if here.iter().any(|s| s.shape != here[0].shape) {
            return self.fault(
                path,
                "sections of different shape meet there: they share no boundary",
                format!("\"{instead}\""),
            );
        }
        if surface == Surface::Bore && !here.iter().any(Section::is_hollow) {
            return self.fault(
                path,
                "the section there is solid and has no bore",
                format!("\"{instead}\" or \"rim\" (the outer surface)"),
            );
        }
        Ok(())
    }

    /// Refuses keys that do not belong to the kind of support.
    fn support_keys(&self, path: &str, s: &case::Support) -> Result<()> {
        use case::SupportKind::{Bearing, Clamped, Cylindrical, Pinned, Revolute, Roller};
        let (name, allowed): (&str, &[&str]) = match (s.kind, &s.fix) {
            (Some(_), Some(_)) => {
                return self.fault(
                    &format!("{path}.fix"),
                    "a support has a kind or fixes components, not both",
                    "kind or fix",
                );
            }
            (None, None) => {
                return self.fault(
                    path,
                    "the support holds nothing",
                    "a kind, or fix with a list of components",
                );
            }
            (None, Some(_)) => ("fix", &[]),
            (Some(Clamped), _) => ("clamped", &["section", "acts_on"]),
            (Some(Revolute | Cylindrical), _) => {
                ("revolute or cylindrical", &["section", "driven", "acts_on"])
            }
            (Some(Pinned | Roller), _) => ("pinned or roller", &["acts_on"]),
            (Some(Bearing), _) => ("bearing", &["stiffness", "damping", "acts_on"]),
        };
        let given = [
            ("section", s.section.is_some()),
            ("driven", s.driven.is_some()),
            ("acts_on", s.acts_on.is_some()),
            ("stiffness", s.stiffness.is_some()),
            ("damping", s.damping.is_some()),
        ];
        match given.iter().find(|(key, present)| *present && !allowed.contains(key)) {
            Some((key, _)) => self.fault(
                &format!("{path}.{key}"),
                format!("a {name} support has no \"{key}\""),
                if allowed.is_empty() {
                    "at and fix only".to_owned()
                } else {
                    format!("besides at and kind: {}", allowed.join(", "))
                },
            ),
            None if s.section == Some(case::SectionHold::Rigid) && s.acts_on.is_some() => self.fault(
                &format!("{path}.acts_on"),
                "a rigid section is held as a whole",
                "\"section\": \"plane\", or no acts_on",
            ),
            None => Ok(()),
        }
    }

    fn bearing(&self, path: &str, s: &case::Support, node: usize, acts_on: ActsOn) -> Result<Bearing> {
        let Some(stiffness) = s.stiffness else {
            return self.fault(
                &format!("{path}.stiffness"),
                "a bearing needs its stiffness",
                "one number (the same in y and z) or [[kyy, kyz], [kzy, kzz]], N/m",
            );
        };
        let stiffness = stiffness.0.map(|row| row.map(|k| k.0));
        let damping = s.damping.map_or([[0.0; 2]; 2], |c| c.0.map(|row| row.map(|c| c.0)));
        for (key, law) in [("stiffness", &stiffness), ("damping", &damping)] {
            for (place, value) in law.iter().flatten().enumerate() {
                let entry = format!("{path}.{key}.{}.{}", place / 2, place % 2);
                let entry = if self.is_written(&entry) { entry } else { format!("{path}.{key}") };
                self.within(&entry, value.abs(), 0.0, LARGEST)?;
            }
        }
        let off = (stiffness[0][1] + stiffness[1][0]) / 2.0;
        let (a, b) = (stiffness[0][0], stiffness[1][1]);
        if a < 0.0 || b < 0.0 || off * off > a * b * (1.0 + 1e-12) {
            return self.fault(
                &format!("{path}.stiffness"),
                "the symmetric part of the bearing's stiffness is not positive: the shaft would be statically unstable",
                "kyy >= 0, kzz >= 0 and ((kyz + kzy)/2)^2 <= kyy kzz",
            );
        }
        Ok(Bearing { node, stiffness, damping, acts_on, path: path.to_owned() })
    }

    fn fix(&self, path: &str, names: &[String], basis: SectionBasis) -> Result<Vec<(usize, usize)>> {
        let (vectors, n_vectors) = (basis.names(), basis.count());
        let mut list = Vec::new();
        if names.is_empty() {
            return self.fault(&format!("{path}.fix"), "nothing is fixed", "a list of vectors or components");
        }
        for (i, name) in names.iter().enumerate() {
            let (vector, component) = match name.split_once('.') {
                Some((vector, component)) => (vector, ["x", "y", "z"].iter().position(|c| *c == component)),
                None => (name.as_str(), None),
            };
            let known = vectors.iter().position(|v| v == vector);
            let add: Vec<(usize, usize)> = match (known, component, name.contains('.')) {
                (None, None, false) if vector == "all" => {
                    (0..n_vectors).flat_map(|k| [0, 1, 2].map(|c| (k, c))).collect()
                }
                (Some(k), Some(c), true) => vec![(k, c)],
                (Some(k), None, false) => [0, 1, 2].map(|c| (k, c)).to_vec(),
                _ => {
                    return self.fault(
                        &format!("{path}.fix.{i}"),
                        format!("\"{name}\" is no vector or component of the node there"),
                        format!("all, {}; or one component of them, e.g. y.x", vectors.join(", ")),
                    );
                }
            };
            if add.iter().any(|a| list.contains(a)) {
                return self.fault(
                    &format!("{path}.fix.{i}"),
                    format!("\"{name}\" is fixed twice"),
                    "each component once",
                );
            }
            list.extend(add);
        }
        Ok(list)
    }

    fn modes(&self) -> Result<usize> {
        match self.case.modes.count {
            count @ 1..=2000 => Ok(count as usize),
            _ => self.fault("modes.count", "no such number of modes", "1 to 2000"),
        }
    }

    /// The sweep, of a rotor whose sections are all `round` or not.
    fn campbell(&self, round: bool) -> Result<Option<CampbellSettings>> {
        let Some(c) = &self.case.campbell else { return Ok(None) };
        let (from, to) = (self.not_negative("campbell.speeds.from", c.speeds.from.0)?, c.speeds.to.0);
        if !(to > 0.0 && to.is_finite()) {
            return self.fault("campbell.speeds.to", "the sweep has no positive speed", "a speed above 0");
        }
        let count = c.speeds.count;
        if !(1..=100_000).contains(&count) {
            return self.fault("campbell.speeds.count", "no such number of speeds", "1 to 100000");
        }
        if (count > 1 && from >= to) || (count == 1 && from != to) {
            return self.fault(
                "campbell.speeds.from",
                "the sweep does not rise",
                format!("below {to} rad/s (equal to it for a count of 1)"),
            );
        }
        let modes = c.modes as usize;
        if !(1..=1000).contains(&modes) {
            return self.fault("campbell.modes", "no such number of branches", "1 to 1000");
        }
        if c.form == Some(case::Form::Classical) && c.frame == Some(case::Frame::Rotating) {
            return self.fault(
                "campbell.frame",
                "the classical form exists in the stationary frame only: without centrifugal stiffening a spinning disk would not stay upright in the rotating frame",
                "\"frame\": \"stationary\"",
            );
        }
        let form = match c.form {
            Some(case::Form::Classical) => Form::Classical,
            Some(case::Form::Consistent) | None => Form::Consistent,
        };
        let frame = match c.frame {
            Some(case::Frame::Rotating) => WhirlFrame::Rotating,
            Some(case::Frame::Stationary) => WhirlFrame::Stationary,
            None if round || form == Form::Classical => WhirlFrame::Stationary,
            None => WhirlFrame::Rotating,
        };
        if form == Form::Consistent && c.gyroscopic != case::Gyroscopic::All {
            return self.fault(
                "campbell.gyroscopic",
                "gyroscopic terms can be left out in the classical form only: in the consistent form they belong together with the centrifugal terms",
                "\"all\", or \"form\": \"classical\"",
            );
        }
        let reduction = match c.reduction {
            case::ReductionSize::None => None,
            case::ReductionSize::Basis(n) if n as usize >= modes + 8 && n <= 5000 => Some(n as usize),
            case::ReductionSize::Basis(_) => {
                return self.fault(
                    "campbell.reduction",
                    "the basis does not fit the number of branches",
                    format!("{} (modes + 8) to 5000, or \"none\"", modes + 8),
                );
            }
        };
        for (i, order) in c.orders.iter().enumerate() {
            self.positive(&format!("campbell.orders.{i}"), *order)?;
        }
        let step = |k: u32| if count > 1 { f64::from(k) / f64::from(count - 1) } else { 1.0 };
        Ok(Some(CampbellSettings {
            speeds: (0..count).map(|k| from + (to - from) * step(k)).collect(),
            modes,
            frame,
            form,
            reduction,
            gyroscopic: match c.gyroscopic {
                case::Gyroscopic::All => Gyroscopic::All,
                case::Gyroscopic::Disks => Gyroscopic::Disks,
                case::Gyroscopic::None => Gyroscopic::None,
            },
            orders: c.orders.clone(),
        }))
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
