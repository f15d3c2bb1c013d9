//! Disks, supports and bearings: what may stand where, and what it holds.

use crate::case::{self};
use crate::check::Input;
use crate::check::bearings::{Bearings, OF_BEARINGS};
use crate::check::mesh::Mesh;
use crate::error::Result;
use crate::model::{ActsOn, Disk, Field, Hub, SectionHold, Support, SupportKind};
use crate::section::{Section, Surface};
use std::f64::consts::PI;

impl Input<'_> {
    /// Mass, polar and diametral inertia of a disk, given as such or by its geometry.
    fn disk_inertias(&self, i: usize, d: &case::DiskInput) -> Result<[f64; 3]> {
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
        let allowed = "either mass, polar_inertia, diametral_inertia, or mass alone for a point; or radius (or diameter), thickness, rho (and inner_radius or inner_diameter, thickness_inertia)";
        let first = |keys: &[(&'static str, bool)]| keys.iter().find(|k| k.1).map(|k| k.0);
        match (first(&by_inertia), first(&by_geometry)) {
            (Some(_), Some(key)) => {
                self.fault(&at(key), "a disk is given by inertia or by geometry, not both", allowed)
            }
            (None, None) => self.fault(&format!("disks.{i}"), "the disk has no mass", allowed),
            (Some(_), None) => {
                if let (Some(m), None, None) = (d.mass, d.polar_inertia, d.diametral_inertia) {
                    return Ok([self.positive(&at("mass"), m.0)?, 0.0, 0.0]);
                }
                let (Some(m), Some(p), Some(t)) = (d.mass, d.polar_inertia, d.diametral_inertia) else {
                    let missing = by_inertia.iter().find(|k| !k.1).map_or("mass", |k| k.0);
                    return self.fault(&at(missing), format!("the disk's \"{missing}\" is missing"), allowed);
                };
                Ok([
                    self.positive(&at("mass"), m.0)?,
                    self.not_negative(&at("polar_inertia"), p.0)?,
                    self.not_negative(&at("diametral_inertia"), t.0)?,
                ])
            }
            (None, Some(_)) => {
                let radius = self.radius(&at, ["radius", "diameter"], [d.radius, d.diameter])?;
                let inner =
                    self.radius(&at, ["inner_radius", "inner_diameter"], [d.inner_radius, d.inner_diameter])?;
                let (Some(radius), Some(thickness), Some(rho)) = (radius, d.thickness, d.rho) else {
                    let first = usize::from(radius.is_some());
                    let missing = by_geometry[first..3].iter().find(|k| !k.1).map_or("radius", |k| k.0);
                    return self.fault(&at(missing), format!("the disk's \"{missing}\" is missing"), allowed);
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
                Ok([mass, polar, polar / 2.0 + thick])
            }
        }
    }

    pub(super) fn disks(&self, mesh: &Mesh, sections: &[Section]) -> Result<Vec<Disk>> {
        let mut list: Vec<Disk> = Vec::new();
        for (i, d) in self.case.disks.iter().enumerate() {
            let at = |key: &str| format!("disks.{i}.{key}");
            let [mass, polar, diametral] = self.disk_inertias(i, d)?;
            if diametral < polar / 2.0 * (1.0 - 1e-9) {
                return self.fault(
                    &at("diametral_inertia"),
                    "no body has so small a diametral inertia",
                    format!("at least half the polar inertia, {}", polar / 2.0),
                );
            }
            let node = mesh.node_at(d.at.0);
            let hub = d.hub;
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

    pub(super) fn supports(&self, mesh: &Mesh, sections: &[Section]) -> Result<(Vec<Support>, Bearings)> {
        let (mut supports, mut bearings): (Vec<Support>, Bearings) = (Vec::new(), self.bearings()?);
        for (i, s) in self.case.supports.iter().enumerate() {
            let path = format!("supports.{i}");
            let node = mesh.node_at(s.at.0);
            self.support_keys(&path, s)?;
            let acts_on = self.acts_on(&path, s.acts_on, mesh, sections, node)?;
            if let Some(kind @ (case::SupportKindInput::Bearing | case::SupportKindInput::Seal)) = s.kind {
                self.bearing(&path, s, (node, acts_on, kind), &mut bearings)?;
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
                Some(case::SectionHoldInput::Rigid) => SectionHold::Rigid,
                // the axis of a ring is empty: its section is held in the mean
                _ if s.acts_on.is_none() && !mesh.nodes[node].field.basis.is_ring() => {
                    SectionHold::Plane(ActsOn::Axis)
                }
                _ => SectionHold::Plane(acts_on),
            };
            let driven = s.driven.unwrap_or(true);
            let kind = match (s.kind, &s.fix) {
                (Some(case::SupportKindInput::Clamped), _) => SupportKind::Clamped(hold),
                (Some(case::SupportKindInput::Revolute), _) => SupportKind::Revolute { hold, driven },
                (Some(case::SupportKindInput::Cylindrical), _) => SupportKind::Cylindrical { hold, driven },
                (Some(case::SupportKindInput::Pinned), _) => SupportKind::Pinned(acts_on),
                (Some(case::SupportKindInput::Roller), _) => SupportKind::Roller(acts_on),
                (_, fix) => SupportKind::Fix(self.fix(
                    &path,
                    fix.as_deref().unwrap_or(&[]),
                    &mesh.nodes[node].field,
                )?),
            };
            supports.push(Support { node, kind, path });
        }
        Ok((supports, bearings))
    }

    /// What a support or load at `path` takes hold of: there must be such a thing.
    pub(super) fn acts_on(
        &self,
        path: &str,
        given: Option<ActsOn>,
        mesh: &Mesh,
        sections: &[Section],
        node: usize,
    ) -> Result<ActsOn> {
        let path = format!("{path}.acts_on");
        let acts_on = given.unwrap_or(ActsOn::Section);
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
    pub(super) fn boundary(
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
    pub(super) fn support_keys(&self, path: &str, s: &case::SupportInput) -> Result<()> {
        use case::SupportKindInput::{Bearing, Clamped, Cylindrical, Pinned, Revolute, Roller, Seal};
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
            (Some(Bearing), _) => ("bearing", &OF_BEARINGS),
            (Some(Seal), _) => ("seal", &OF_BEARINGS),
        };
        let given = [
            ("section", s.section.is_some()),
            ("driven", s.driven.is_some()),
            ("acts_on", s.acts_on.is_some()),
            ("stiffness", s.stiffness.is_some()),
            ("damping", s.damping.is_some()),
            ("table", s.table.is_some()),
            ("mass", s.mass.is_some()),
            ("axial_stiffness", s.axial_stiffness.is_some()),
            ("axial_damping", s.axial_damping.is_some()),
            ("tilt_stiffness", s.tilt_stiffness.is_some()),
            ("tilt_damping", s.tilt_damping.is_some()),
            ("torsional_stiffness", s.torsional_stiffness.is_some()),
            ("torsional_damping", s.torsional_damping.is_some()),
            ("housing", s.housing.is_some()),
            ("offset", s.offset.is_some()),
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
            None if s.section == Some(case::SectionHoldInput::Rigid) && s.acts_on.is_some() => self.fault(
                &format!("{path}.acts_on"),
                "a rigid section is held as a whole",
                "\"section\": \"plane\", or no acts_on",
            ),
            None => Ok(()),
        }
    }

    pub(super) fn fix(&self, path: &str, names: &[String], field: &Field) -> Result<Vec<(usize, usize)>> {
        let (vectors, n_vectors) = (field.basis.names(), field.count());
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
}
