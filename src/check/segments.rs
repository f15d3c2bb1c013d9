//! Segments of the shaft: sections of their ends, members, what they carry and how they meet.

use crate::case;
use crate::check::element_choice::{Choice, Demands, choose, choose_taper, level};
use crate::check::mesh::{SHORTEST_SEGMENT_PER_LENGTH, SegmentPlan};
use crate::check::{Input, LARGEST_SI, steps};
use crate::error::Result;
use crate::model::{Carried, ElementChoice, ElementKind, Law, Material};
use crate::section::basis::SectionBasis;
use crate::section::{Section, Shape};

/// Member and effort at steps of a segment.
#[derive(Debug, Clone, Copy)]
struct Taken {
    kind: ElementKind,
    effort: usize,
}

impl Input<'_> {
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
    ) -> Result<(Vec<Taken>, Vec<ElementChoice>)> {
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
            let faces = self.faces(i, segment, (shapes, sections))?;
            let [shape, end] = faces.map(|face| &shapes[face]);
            let asked = named(&at("element"), &segment.element)?.or(default);
            let solid = !shape.is_hollow() && !end.is_hollow();
            let unasked = || solid.then_some(continuum(SectionBasis::Monomials(3)));
            let (asked, effort) =
                asked.map_or_else(|| (unasked(), Some(0)), |asked| (asked.kind, asked.effort));
            let material = self.named(&at("material"), "material", &segment.material, material_names)?;
            let demands = Demands { poisson_ratio: materials[material].poisson_ratio, ..demands };
            let choice = || match faces[0] == faces[1] {
                true => choose(shape, demands),
                false => choose_taper([shape, end], demands),
            };
            chosen.push(asked.is_none().then(|| (choice(), *shape, demands.poisson_ratio)));
            fixed.push((asked, effort, [*shape, *end], segment.length.0));
        }
        let ends: Vec<_> = fixed.iter().map(|f| (f.1, f.2, f.3)).collect();
        let wanted = steps::efforts(&ends);
        level(&mut chosen);
        let mut taken = Vec::new();
        for (i, (asked, effort, ..)) in fixed.iter().enumerate() {
            let basis = chosen[i].as_ref().map(|(c, ..)| match c.basis {
                // what a step bends has no quadratic sections
                SectionBasis::Monomials(2) if wanted[i] > 0 => SectionBasis::Monomials(3),
                basis => basis,
            });
            let kind = asked.or(basis.map(continuum)).unwrap_or(continuum(SectionBasis::Monomials(3)));
            let most = steps::most(kind.basis);
            if effort.is_some_and(|effort| effort > most) {
                return self.fault(
                    &format!("shaft.segments.{i}.element"),
                    format!("{} has too high a radial degree for kinks of this effort", kind.name()),
                    format!("k0 to k{most}, or a radial degree up to 5; \"auto\" chooses both"),
                );
            }
            taken.push(Taken { kind, effort: wanted[i].min(most) });
        }
        let efforts: Vec<usize> = taken.iter().map(|t| t.effort).collect();
        let mut choices = Vec::new();
        for (i, choice) in chosen.iter().enumerate() {
            let Some((Choice { reason, estimate, .. }, ..)) = choice else { continue };
            let (name, segment) = (taken[i].kind.name(), &shaft.segments[i]);
            let end = segment.to_section.iter().map(|end| format!(" to \"{end}\"")).collect::<String>();
            let section = format!("\"{}\"{end}", segment.section);
            let mut text = format!(
                "{name} for section {section}: {reason}; estimated error of its functions {estimate:.0e}"
            );
            let mut estimated_error = *estimate;
            if efforts[i] > 0 {
                let left = steps::estimate(&ends, &efforts, i);
                let by = if ends[i].0.is_none() { "chosen" } else { "asked" };
                text +=
                    &format!("; kinks of effort {} ({by}) at its steps leave about {left:.0e}", efforts[i]);
                estimated_error = estimated_error.max(left);
            }
            choices.push(ElementChoice { text, segment: i, estimated_error });
        }
        Ok((taken, choices))
    }

    /// The shaft of a case that has nothing but one.
    pub(super) fn shaft(&self) -> Result<&case::Shaft> {
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
        Ok(shaft)
    }

    /// The sections of the ends of a segment.
    fn faces(
        &self,
        i: usize,
        segment: &case::Segment,
        (shapes, sections): (&[Section], &[String]),
    ) -> Result<[usize; 2]> {
        let at = |key: &str| format!("shaft.segments.{i}.{key}");
        let section = self.named(&at("section"), "section", &segment.section, sections)?;
        let Some(name) = &segment.to_section else { return Ok([section; 2]) };
        let to_section = self.named(&at("to_section"), "section", name, sections)?;
        if shapes[section].shape != shapes[to_section].shape {
            return self.fault(
                &at("to_section"),
                "a taper has one shape from end to end",
                "a section of the shape of \"section\": round (circle, tube, ellipse) or rectangle",
            );
        }
        Ok(if shapes[section] == shapes[to_section] { [section; 2] } else { [section, to_section] })
    }

    /// Added mass and initial stress of a segment.
    fn carried(&self, i: usize, segment: &case::Segment, faces: [&Section; 2]) -> Result<Carried> {
        let at = |key: &str| format!("shaft.segments.{i}.{key}");
        let carried = Carried {
            added_mass: segment.added_mass_per_length.map_or(0.0, |m| m.0),
            axial_force: segment.axial_force.map_or(0.0, |f| f.0),
            torque: segment.torque.map_or(0.0, |t| t.0),
        };
        self.not_negative(&at("added_mass_per_length"), carried.added_mass)?;
        self.within(&at("axial_force"), carried.axial_force.abs(), 0.0, LARGEST_SI)?;
        self.within(&at("torque"), carried.torque.abs(), 0.0, LARGEST_SI)?;
        if carried.torque != 0.0 && !faces.iter().all(|face| face.is_axisymmetric()) {
            return self.fault(
                &at("torque"),
                "the initial shear of a torque is that of round sections",
                "circles or tubes on this segment; or no torque",
            );
        }
        Ok(carried)
    }

    /// Path of the first axial force or torque.
    pub(super) fn initial_stress(&self) -> Option<String> {
        let segments = self.case.shaft.iter().flat_map(|s| &s.segments).enumerate();
        let of = |(i, s): (usize, &case::Segment)| {
            let keys = [
                ("axial_force", s.axial_force.is_some_and(|f| f.0 != 0.0)),
                ("torque", s.torque.is_some_and(|t| t.0 != 0.0)),
            ];
            let key = keys.iter().find(|key| key.1)?.0;
            Some(format!("shaft.segments.{i}.{key}"))
        };
        segments.filter_map(of).next()
    }

    /// Refuses a member that does not suit the sections of a segment's ends.
    fn suits(&self, i: usize, kind: ElementKind, [shape, end]: [&Section; 2]) -> Result<()> {
        let at = |key: &str| format!("shaft.segments.{i}.{key}");
        if shape != end && (kind.basis.is_ring() || kind.law != Law::Continuum) {
            return self.fault(
                &at("to_section"),
                format!("{} has functions or constants of one section and takes no taper", kind.name()),
                "\"element\" 34X1 .. 34X5 on this segment; or no to_section",
            );
        }
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
        Ok(())
    }

    /// Segments and the members that were chosen for them.
    pub(super) fn segments(
        &self,
        (shapes, sections): (&[Section], &[String]),
        (stuffs, materials): (&[Material], &[String]),
    ) -> Result<(Vec<SegmentPlan>, Vec<ElementChoice>)> {
        let shaft = self.shaft()?;
        let (kinds, choices) = self.kinds(shaft, (shapes, sections), (stuffs, materials))?;
        let mut plans = Vec::new();
        for (i, (segment, Taken { kind, effort })) in shaft.segments.iter().zip(kinds).enumerate() {
            let at = |key: &str| format!("shaft.segments.{i}.{key}");
            if segment.elements == 0 {
                return self.fault(&at("elements"), "a segment needs elements", "at least 1");
            }
            let faces = self.faces(i, segment, (shapes, sections))?;
            self.suits(i, kind, faces.map(|face| &shapes[face]))?;
            if i == 0 && segment.joint.is_some() {
                return self.fault(
                    &at("joint"),
                    "the first segment has none before it to be joined to",
                    "\"joint\" on the segment on the right of the joint",
                );
            }
            plans.push(SegmentPlan {
                face: segment.joint == Some(case::JointInput::Face),
                carried: self.carried(i, segment, faces.map(|face| &shapes[face]))?,
                length: self.length(&at("length"), segment.length.0)?,
                elements: segment.elements,
                kind,
                effort,
                section: faces[0],
                to_section: faces[1],
                material: self.named(&at("material"), "material", &segment.material, materials)?,
            });
        }
        let total: f64 = plans.iter().map(|p| p.length).sum();
        // a sum beyond all numbers is refused here, too
        if let Some(i) = plans.iter().position(|p| !(p.length >= SHORTEST_SEGMENT_PER_LENGTH * total)) {
            return self.fault(
                &format!("shaft.segments.{i}.length"),
                format!("this segment vanishes beside the shaft's length of {total:e} m"),
                format!("at least {SHORTEST_SEGMENT_PER_LENGTH:e} of the shaft"),
            );
        }
        for (i, pair) in plans.windows(2).enumerate().filter(|(_, pair)| !pair[1].face) {
            if shapes[pair[0].to_section].common(&shapes[pair[1].section]).is_none() {
                return self.fault(
                    &format!("shaft.segments.{}.section", i + 1),
                    "this section has nothing in common with the one before it",
                    "neighbouring sections whose walls overlap; or \"joint\": \"face\" on this segment (a rigid thin face)",
                );
            }
        }
        Ok((plans, choices))
    }
}
