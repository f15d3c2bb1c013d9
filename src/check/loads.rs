//! Loads and probes.

use crate::case;
use crate::check::Input;
use crate::check::mesh::Mesh;
use crate::error::Result;
use crate::model::{Load, LoadKind, Probe, Reading, SurfaceLoad, Traction};
use crate::section::{Section, Shape, Surface};

/// Largest component of a force, moment, traction or acceleration, SI.
const LARGEST_SI: f64 = 1e30;

impl Input<'_> {
    pub(super) fn gravity(&self) -> Result<[f64; 3]> {
        let gravity = self.case.gravity.map_or([0.0; 3], |g| g.map(|c| c.0));
        self.bounded("gravity", gravity)?;
        Ok(gravity)
    }

    fn bounded(&self, path: &str, vector: [f64; 3]) -> Result<()> {
        for (i, component) in vector.into_iter().enumerate() {
            self.within(&format!("{path}.{i}"), component.abs(), 0.0, LARGEST_SI)?;
        }
        Ok(())
    }

    pub(super) fn loads(&self, mesh: &Mesh, sections: &[Section]) -> Result<(Vec<Load>, Vec<Traction>)> {
        let length: f64 = mesh.elements.iter().map(|e| e.length).sum();
        let (mut loads, mut tractions) = (Vec::new(), Vec::new());
        for (i, load) in self.case.loads.iter().enumerate() {
            let path = format!("loads.{i}");
            let local = load.force.is_some() || load.moment.is_some();
            let spread = load.surface.is_some() && (load.traction.is_some() != load.pressure.is_some());
            let surface_keys = load.surface.is_some() || load.traction.is_some() || load.pressure.is_some();
            let allowed = "at with force or moment; or surface with traction or pressure";
            if local == spread || (local && surface_keys) || (spread && load.acts_on.is_some()) {
                return self.fault(&path, "the load is incomplete or mixed", allowed);
            }
            let reading = self.reading(&path, load)?;
            match load.at {
                Some(at) if local => self.on_shaft(&format!("{path}.at"), at.0, length)?,
                None if spread => {}
                _ => {
                    return self.fault(
                        &format!("{path}.at"),
                        "a force or moment acts at a place, a traction or pressure on a surface",
                        allowed,
                    );
                }
            }
            let node = mesh.node_at(load.at.map_or(0.0, |at| at.0));
            let acts_on = self.acts_on(&path, load.acts_on, mesh, sections, node)?;
            if let Some(force) = load.force.map(|f| f.map(|c| c.0)) {
                self.bounded(&format!("{path}.force"), force)?;
                let (kind, path) = (LoadKind::Force(force), path.clone());
                loads.push(Load { node, kind, acts_on, reading, path });
            }
            if let Some(moment) = load.moment.map(|m| m.map(|c| c.0)) {
                self.bounded(&format!("{path}.moment"), moment)?;
                let (kind, path) = (LoadKind::Moment(moment), path.clone());
                loads.push(Load { node, kind, acts_on, reading, path });
            }
            let Some(surface) = load.surface else { continue };
            if mesh.elements.iter().any(|e| e.is_tapered()) {
                return self.fault(
                    &format!("{path}.surface"),
                    "loads on the surface of a shaft with tapered segments are not in this version",
                    "forces and moments \"at\" a place; or a shaft without to_section",
                );
            }
            if surface == Surface::Bore && !mesh.elements.iter().any(|e| sections[e.section].is_hollow()) {
                return self.fault(
                    &format!("{path}.surface"),
                    "no section of the shaft has a bore",
                    "top, bottom or rim",
                );
            }
            if let Some(traction) = load.traction.map(|t| t.map(|c| c.0)) {
                self.bounded(&format!("{path}.traction"), traction)?;
                let (load, path) = (SurfaceLoad::Traction(traction), path.clone());
                tractions.push(Traction { surface, load, reading, path });
            }
            if let Some(pressure) = load.pressure {
                self.within(&format!("{path}.pressure"), pressure.0.abs(), 0.0, LARGEST_SI)?;
                let (load, path) = (SurfaceLoad::Pressure(pressure.0), path.clone());
                tractions.push(Traction { surface, load, reading, path });
            }
        }
        Ok((loads, tractions))
    }

    /// How a load moves.
    fn reading(&self, path: &str, load: &case::LoadInput) -> Result<Reading> {
        let (follows, dead) = (load.follower == Some(true), load.dead == Some(true));
        if dead && (load.force.is_some() || load.traction.is_some() || follows) {
            return self.fault(
                &format!("{path}.dead"),
                "only a moment or a pressure that does not follow can be read as dead: forces and tractions keep their \
                 direction anyway",
                "no \"dead\", or a load of its own for the moment or pressure",
            );
        }
        if load.pressure.is_some() && load.follower == Some(false) && !dead {
            return self.fault(
                &format!("{path}.follower"),
                "a pressure acts on the surface as it is now",
                "\"dead\": true for the tractions that it is on the undeformed surface; or leave this out",
            );
        }
        Ok(match (dead, follows || load.pressure.is_some()) {
            (true, _) => Reading::Dead,
            (false, true) => Reading::Following,
            (false, false) => Reading::FixedInSpace,
        })
    }

    pub(super) fn probes(&self, mesh: &Mesh, length: f64, sections: &[Section]) -> Result<Vec<Probe>> {
        let mut list: Vec<Probe> = Vec::new();
        for (i, probe) in self.case.probes.iter().enumerate() {
            let at = |key: &str| format!("probes.{i}.{key}");
            self.on_shaft(&at("at"), probe.at.0, length)?;
            if list.iter().any(|p| p.name == probe.name) {
                return self.fault(
                    &at("name"),
                    "two probes have this name",
                    "a name of its own for each probe",
                );
            }
            let element = mesh.element_at(probe.at.0);
            let section = element.map_or(sections[0], |e| {
                let [left, right] = e.faces.map(|face| &sections[face]);
                left.between(right, ((probe.at.0 - e.x) / e.length).clamp(0.0, 1.0))
            });
            let Section { shape, outer: [cy, cz], inner } = section;
            // the functions of a ring mean nothing in the bore
            let ring = element.is_some_and(|e| e.kind.basis.is_ring());
            let points = match (probe.line, probe.points) {
                (None, None) => {
                    let point = [probe.y.map_or(0.0, |y| y.0), probe.z.map_or(0.0, |z| z.0)];
                    let [y, z] = [point[0] / cy, point[1] / cz];
                    let size = if shape == Shape::Ellipse { y.hypot(z) } else { y.abs().max(z.abs()) };
                    if size > 1.0 + 1e-9 {
                        let key = if probe.y.is_some() { "y" } else { "z" };
                        return self.fault(
                            &at(key),
                            "the probe lies outside the section",
                            format!("within half extents {cy} (y) and {cz} (z)"),
                        );
                    }
                    let bore = (point[0] / inner[0]).hypot(point[1] / inner[1]);
                    if ring && bore < 1.0 - 1e-9 {
                        return self.fault(
                            &at(if probe.z.is_some() && probe.y.is_none() { "z" } else { "y" }),
                            "the probe lies in the bore, where a ring section has no material",
                            format!(
                                "a point of the wall: y from {} to {cy} or z from {} to {cz}",
                                inner[0], inner[1]
                            ),
                        );
                    }
                    vec![point]
                }
                (Some(line), points) if probe.y.is_none() && probe.z.is_none() => {
                    let count = points.unwrap_or(9);
                    if !(2..=10_000).contains(&count) {
                        return self.fault(&at("points"), "a line needs points", "2 to 10000");
                    }
                    let step = |k: u32| f64::from(k) / f64::from(count - 1);
                    let from = if ring { inner } else { [0.0; 2] };
                    let along =
                        |axis: usize, k: u32| from[axis] + (section.outer[axis] - from[axis]) * step(k);
                    (0..count)
                        .map(|k| match line {
                            case::Line::Y => [along(0, k), 0.0],
                            case::Line::Z => [0.0, along(1, k)],
                        })
                        .collect()
                }
                _ => {
                    return self.fault(
                        &format!("probes.{i}"),
                        "a probe is a point or a line",
                        "y and z; or line and points",
                    );
                }
            };
            list.push(Probe { name: probe.name.clone(), x: probe.at.0, points });
        }
        Ok(list)
    }
}
