//! Contact scenes: bodies and the settings of their contact.

use crate::case::{self, LoadedCase};
use crate::check::memory::scene_point;
use crate::check::{Input, LARGEST_MEMORY_BYTES};
use crate::error::{Error, Refusal, Result};
use crate::model::scene::{Beam, Body, ContactSettings, Enforcement, PlanarSection, Scene, Stepping, Unused};
use crate::model::{Material, Model};
use crate::section::{Section, Shape};
use crate::units::Length;
use nalgebra::{Matrix3, Vector3};
use serde_json::{Value, json};

/// Share of its height that two self-contacting faces may penetrate, and of an element that a place may miss a node by.
const SAME_PLACE_SHARE: f64 = 1e-6;
/// Most elements of a scene.
const MOST_ELEMENTS: usize = 20_000;
/// The same of spatial elements, of thirty times as many unknowns.
const MOST_SPATIAL_ELEMENTS: usize = 4000;
/// Most integration segments of a scene, each of which may need memory for its points.
const MOST_SEGMENTS: usize = 1_000_000;
/// Blocks of a shaft case that mean nothing in a scene.
const SHAFT_BLOCKS: [&str; 8] =
    ["disks", "supports", "loads", "probes", "modes", "campbell", "static", "spinup"];
/// Most steps of a motion.
const MOST_STEPS: f64 = 1e8;

impl Scene {
    /// Checks the bodies of a case and their contact.
    ///
    /// # Errors
    /// The first rule that the case breaks, with file, path, value and remedy.
    pub fn new(loaded: &LoadedCase) -> Result<Self> {
        let input = Input { loaded, case: &loaded.case };
        input.scene()
    }
}

/// What a planar body is made of, with its height, width and modulus.
type Planar = (PlanarSection, [f64; 3]);

impl Input<'_> {
    fn scene(&self) -> Result<Scene> {
        let case = self.case;
        if case.shaft.is_some() && case.bodies.is_empty() {
            return self.fault(
                "bodies",
                "the case is a shaft: it has no bodies that could meet",
                "`rotor check`, `modes`, `campbell`, `static` or `spinup` for a shaft (rub: spinup.stators); a case with \
                 \"bodies\" for `rotor contact`",
            );
        }
        if case.shaft.is_some() {
            return self.fault("bodies", "a case has either a shaft or bodies", "one of them");
        }
        if case.bodies.is_empty() {
            return self.fault(
                "bodies",
                "a contact scene needs bodies",
                r#"for example "bodies": [ { "name": "beam", "length": 1, "elements": 8, "section": "bar", "material": "steel", "start": [0, 0] } ]"#,
            );
        }
        if let Some(key) = SHAFT_BLOCKS.into_iter().find(|key| self.is_written(key)) {
            return self.fault(
                key,
                format!("\"{key}\" belongs to a shaft: a contact scene does not use it"),
                "bodies (each with its own supports and loads), gravity, contact, expected",
            );
        }
        let (materials, material_names) = self.materials()?;
        let (sections, section_names) = self.sections()?;
        let mut bodies: Vec<Body> = Vec::with_capacity(case.bodies.len());
        for (i, body) in case.bodies.iter().enumerate() {
            let path = format!("bodies.{i}");
            if bodies.iter().any(|b| b.name == body.name) {
                return self.fault(&format!("{path}.name"), "two bodies have this name", "a name of its own");
            }
            let pair = match (&body.section, &body.material) {
                (Some(section), Some(material)) => Some((
                    self.named(&format!("{path}.section"), "section", section, &section_names)?,
                    self.named(&format!("{path}.material"), "material", material, &material_names)?,
                )),
                _ => None,
            };
            let pair = pair.map(|(s, m)| (&sections[s], &materials[m]));
            bodies.push(self.body(&path, body, pair)?);
        }
        let planar = bodies.iter().filter(|b| matches!(b.beam, Beam::Planar(_))).count();
        if planar != 0 && planar != bodies.len() {
            return self.fault(
                "bodies",
                "planar and spatial bodies don't meet in one scene",
                "all 2322s, or all 3333s and 34X3",
            );
        }
        let count: usize = bodies.iter().map(|b| b.elements).sum();
        let most = if planar == 0 { MOST_SPATIAL_ELEMENTS } else { MOST_ELEMENTS };
        if count > most {
            return self.fault(
                "bodies",
                format!("the scene is too large: {count} elements"),
                format!("at most {most}"),
            );
        }
        let gravity = Vector3::from(self.gravity()?);
        if planar != 0 && gravity.z != 0.0 {
            return self.fault("gravity.2", "planar bodies move in the plane of x and y", "0");
        }
        let contact = self.contact(&bodies, planar != 0)?;
        self.expected()?;
        let unused = self.unused(&contact, planar != 0);
        Ok(Scene { bodies, gravity, contact, unused })
    }

    /// True when a key of the case is there and not empty.
    pub(super) fn is_written(&self, path: &str) -> bool {
        let pointer = format!("/{}", path.replace('.', "/"));
        self.loaded.value.pointer(&pointer).is_some_and(|value| match value {
            Value::Null => false,
            Value::Array(list) => !list.is_empty(),
            Value::Object(map) => !map.is_empty(),
            _ => true,
        })
    }

    /// Written keys that the analysis has no use for, with the reason.
    fn unused(&self, contact: &ContactSettings, planar: bool) -> Vec<Unused> {
        let mut list = Vec::new();
        let mut note = |reason: &'static str, keys: &[&str]| {
            let paths: Vec<String> =
                keys.iter().filter(|key| self.is_written(key)).map(|key| (*key).to_owned()).collect();
            if !paths.is_empty() {
                list.push(Unused { paths, reason });
            }
        };
        if contact.until.is_some() {
            note("a motion has no load steps", &["contact.load_steps"]);
        } else {
            let settings = ["step", "integrator", "output", "snapshots"].map(|key| format!("contact.{key}"));
            let of_bodies = self.case.bodies.iter().enumerate().flat_map(|(i, body)| {
                let until = (0..body.loads.len()).map(move |k| format!("bodies.{i}.loads.{k}.until"));
                until.chain([format!("bodies.{i}.velocity")])
            });
            let keys: Vec<String> = settings.into_iter().chain(of_bodies).collect();
            let keys: Vec<&str> = keys.iter().map(String::as_str).collect();
            note("an equilibrium has no time (contact.until is missing)", &keys);
        }
        match contact.method {
            Enforcement::Lcp | Enforcement::LcpSingle => note(
                "impulses act at nodes and corners, without springs",
                &["contact.penalty", "contact.point_penalty", "contact.segments", "contact.cut"],
            ),
            Enforcement::ActiveSet => {
                note("the constraints act at nodes and corners", &["contact.segments", "contact.cut"]);
            }
            Enforcement::Penalty if !planar => {
                note("segments of spatial bodies are never cut", &["contact.cut"]);
            }
            Enforcement::Penalty | Enforcement::None => {}
        }
        list
    }

    /// Two numbers in the plane or three in space.
    pub(super) fn place(&self, path: &str, list: &[f64], planar: bool) -> Result<Vector3<f64>> {
        let (allowed, fits) = if planar {
            ("two numbers [x, y]", list.len() == 2)
        } else {
            ("three numbers [x, y, z]", list.len() == 3)
        };
        if !fits {
            return self.fault(path, "a body needs as many components as its space has", allowed);
        }
        for (i, value) in list.iter().enumerate() {
            self.within(&format!("{path}.{i}"), value.abs(), 0.0, 1e15)?;
        }
        Ok(Vector3::new(list[0], list[1], list.get(2).copied().unwrap_or(0.0)))
    }

    fn body(&self, path: &str, body: &case::BodyInput, pair: Option<(&Section, &Material)>) -> Result<Body> {
        let at = |key: &str| format!("{path}.{key}");
        let length = self.length(&at("length"), body.length.0)?;
        if body.elements == 0 || body.elements > MOST_ELEMENTS as u64 {
            let problem = if body.elements == 0 { "a body needs elements" } else { "too many elements" };
            return self.fault(&at("elements"), problem, format!("1 to {MOST_ELEMENTS}"));
        }
        let planar = match body.element.as_str() {
            "2322s" => true,
            "3333s" | "34X3" => false,
            _ => return self.fault(&at("element"), "contact knows no such element", "2322s, 3333s or 34X3"),
        };
        let elements = body.elements as usize;
        let (beam, [height, width, modulus]) = if planar {
            let (section, sizes) = self.planar(path, body, pair)?;
            (Beam::Planar(section), sizes)
        } else {
            self.spatial(path, body, pair)?
        };
        if length < height {
            return self.fault(
                &at("length"),
                "a beam that is shorter than high is none, and could slip through others end on",
                format!("at least its height, {height} m"),
            );
        }
        let list = |lengths: &[Length]| lengths.iter().map(|l| l.0).collect::<Vec<_>>();
        let start = self.place(&at("start"), &list(&body.start), planar)?;
        let velocity = match &body.velocity {
            Some(v) => self.place(&at("velocity"), &v.iter().map(|v| v.0).collect::<Vec<_>>(), planar)?,
            None => Vector3::zeros(),
        };
        let frame = match body.direction {
            Some(_) if planar => {
                return self.fault(&at("direction"), "a planar body has an angle", "angle");
            }
            Some(_) if body.angle.0 != 0.0 => {
                return self.fault(&at("angle"), "angle and direction say the same", "one of both");
            }
            Some(direction) => self.frame_along(&at("direction"), direction)?,
            None => {
                let (sin, cos) = body.angle.0.sin_cos();
                Matrix3::new(cos, -sin, 0.0, sin, cos, 0.0, 0.0, 0.0, 1.0)
            }
        };
        let degree = match &beam {
            Beam::Planar(_) => 2,
            Beam::Spatial(model) => model.elements.first().map_or(3, |e| e.kind.axial_degree),
        };
        let nodes = degree * elements;
        let node = |key: String, x: f64| {
            if !(0.0..=length).contains(&x) {
                return self.fault(&key, "this place is off the body", format!("0 to {length} m"));
            }
            let share = x / length * nodes as f64;
            if (share - share.round()).abs() > SAME_PLACE_SHARE * nodes as f64 {
                let spacing = length / nodes as f64;
                return self.fault(&key, "there is no node", format!("a multiple of {spacing} m"));
            }
            Ok(share.round() as usize)
        };
        let supports = self.body_supports(path, body, &node)?;
        let loads = self.body_loads(path, body, planar, &node)?;
        Ok(Body {
            name: body.name.clone(),
            element: body.element.clone(),
            beam,
            length,
            elements,
            height,
            width,
            modulus,
            start,
            frame,
            velocity,
            gravity: body.gravity,
            supports,
            loads,
        })
    }

    fn planar(
        &self,
        path: &str,
        body: &case::BodyInput,
        pair: Option<(&Section, &Material)>,
    ) -> Result<Planar> {
        let at = |key: &str| format!("{path}.{key}");
        if let Some(s) = &body.structural {
            if body.section.is_some() || body.material.is_some() {
                return self.fault(&at("structural"), "section and material say the same", "one of both");
            }
            let positive = |key: &str, value: f64| self.positive(&format!("{path}.structural.{key}"), value);
            let height = self.length(&at("structural.height"), s.height.0)?;
            let width = match s.width {
                Some(width) => self.length(&at("structural.width"), width.0)?,
                None => 1.0,
            };
            let section = PlanarSection {
                axial: positive("EA", s.axial.0)?,
                shear: positive("GA", s.shear.0)?,
                bending: positive("EI", s.bending.0)?,
                thickness: positive("EA_t", s.thickness.0)?,
                mass: positive("rho_A", s.mass.0)?,
                inertia: positive("rho_I", s.inertia.0)?,
            };
            return Ok((section, [height, width, section.axial / (height * width)]));
        }
        let Some((section, material)) = pair else {
            return self.fault(path, "the body has no stiffness", "section and material, or structural");
        };
        if section.shape != Shape::Rectangle || section.is_hollow() {
            return self.fault(&at("section"), "2322s is a beam of rectangular section", "shape rectangle");
        }
        let (area, inertia) = (section.area(), section.moment(2, 0));
        let moves = self.case.contact.as_ref().is_some_and(|c| c.until.is_some());
        if moves && (material.stiffness_damping != 0.0 || material.mass_damping != 0.0) {
            return self.fault(&at("material"), "2322s has no damping", "a material without damping");
        }
        let e = material.youngs_modulus;
        let shear = e / (2.0 * (1.0 + material.poisson_ratio));
        let planar = PlanarSection {
            axial: e * area,
            shear: section.shear_correction(material.poisson_ratio) * shear * area,
            bending: e * inertia,
            thickness: e * area,
            mass: material.density * area,
            inertia: material.density * inertia,
        };
        Ok((planar, [2.0 * section.outer[0], 2.0 * section.outer[1], e]))
    }

    /// The body as a shaft of its own.
    fn spatial(
        &self,
        path: &str,
        body: &case::BodyInput,
        pair: Option<(&Section, &Material)>,
    ) -> Result<(Beam, [f64; 3])> {
        let at = |key: &str| format!("{path}.{key}");
        if body.structural.is_some() {
            return self.fault(&at("structural"), "only 2322s takes numbers of its own", "section, material");
        }
        let Some((section, material)) = pair else {
            return self.fault(path, "the body has no stiffness", "section and material");
        };
        if !section.is_axisymmetric() || section.is_hollow() {
            return self.fault(
                &at("section"),
                "the lateral surface of a spatial body is that of a solid circle",
                "shape circle",
            );
        }
        let held = |s: &case::BodySupport| json!({ "at": s.at, "kind": "clamped", "section": "rigid" });
        if let Some(k) = body.supports.iter().position(|s| s.kind != case::BodySupportKind::Clamped) {
            return self.fault(&at(&format!("supports.{k}.kind")), "spatial bodies are clamped", "clamped");
        }
        let value = json!({
            "title": body.name,
            "materials": self.case.materials,
            "sections": self.case.sections,
            "shaft": {
                "element": body.element,
                "segments": [{
                    "length": body.length, "elements": body.elements, "section": body.section, "material": body.material,
                }],
            },
            "supports": body.supports.iter().map(held).collect::<Vec<_>>(),
        });
        let model = LoadedCase::from_value(&self.loaded.file, value)
            .and_then(|shaft| Model::new(&shaft))
            .map_err(|error| self.of_body(path, error))?;
        if model.elements.len() as u64 != body.elements {
            return self.fault(&at("supports"), "a support stands within an element", "an element end");
        }
        let diameter = 2.0 * section.outer[0];
        Ok((Beam::Spatial(Box::new(model)), [diameter, diameter, material.youngs_modulus]))
    }

    /// What is wrong with a body as a shaft of its own, said of the body.
    fn of_body(&self, path: &str, error: Error) -> Error {
        let Error::Refused(Refusal { path: place, problem, allowed, .. }) = error else { return error };
        let place = match place.strip_prefix("shaft.segments.0.").or_else(|| place.strip_prefix("shaft.")) {
            Some(key) => format!("{path}.{key}"),
            None if place.starts_with("supports") => format!("{path}.{place}"),
            None => place,
        };
        self.loaded.fault(&place, problem, allowed.replace("shaft", "body"))
    }

    /// Axes of a body along a direction: y as upright as it can be.
    fn frame_along(&self, path: &str, direction: [f64; 3]) -> Result<Matrix3<f64>> {
        let x = Vector3::from(direction);
        let length = x.norm();
        if !(length > 0.0 && length.is_finite()) {
            return self.fault(path, "no direction", "three numbers, not all zero");
        }
        let x = x / length;
        let up = if x.y.abs() < 0.9 { Vector3::y() } else { -Vector3::x() };
        let y = (up - x * x.dot(&up)).normalize();
        Ok(Matrix3::from_columns(&[x, y, x.cross(&y)]))
    }

    /// Whether a method fits an equilibrium or a motion of these bodies.
    fn method_fits(&self, method: Enforcement, until: Option<f64>, planar: bool) -> Result<()> {
        match (method, until) {
            (Enforcement::ActiveSet, Some(_)) => {
                return self.fault(
                    "contact.method",
                    "the active set finds equilibria",
                    "penalty or lcp for a motion; no contact.until for an equilibrium",
                );
            }
            (Enforcement::Lcp | Enforcement::LcpSingle, None) => {
                return self.fault(
                    "contact.method",
                    "impulses belong to a motion",
                    "penalty or active-set for an equilibrium; contact.until for a motion",
                );
            }
            (_, Some(_)) if !planar => {
                return self.fault(
                    "contact.until",
                    "spatial bodies are brought into equilibrium only",
                    "no contact.until; or bodies of 2322s",
                );
            }
            (_, None) if !planar && method != Enforcement::Penalty => {
                return self.fault("contact.method", "spatial bodies meet by penalty", "penalty");
            }
            _ => {}
        }
        Ok(())
    }

    /// Whether every body can touch itself.
    fn self_contact(&self, bodies: &[Body], planar: bool) -> Result<()> {
        if !planar {
            return self.fault("contact.self", "spatial bodies meet each other only", "false");
        }
        // elements nearer along the body than it can bend are left out; less than that leaves nothing
        if let Some(b) = bodies.iter().find(|b| b.elements < 4 || b.length < 6.0 * b.height) {
            return self.fault(
                "contact.self",
                format!(
                    "`{}` can't touch itself: it has {} elements and is {:.3} heights long",
                    b.name,
                    b.elements,
                    b.length / b.height
                ),
                "false; or at least 4 elements and 6 heights of length for every body",
            );
        }
        Ok(())
    }

    /// Whether the points of contact and of the history fit into memory.
    fn scene_fits(&self, bodies: &[Body], segments: usize, output: usize) -> Result<()> {
        let elements: usize = bodies.iter().map(|b| b.elements).sum();
        if segments * elements > MOST_SEGMENTS {
            return self.fault(
                "contact.segments",
                format!("too many segments for {elements} elements"),
                format!("1 to {}", MOST_SEGMENTS / elements),
            );
        }
        let point = scene_point(bodies.len());
        if output as f64 * point > LARGEST_MEMORY_BYTES {
            return self.fault(
                "contact.output",
                format!(
                    "too many points for {} bodies: they need about {:.0} GB of memory",
                    bodies.len(),
                    output as f64 * point / 1e9
                ),
                format!("2 to {:.0}", (LARGEST_MEMORY_BYTES / point).floor()),
            );
        }
        Ok(())
    }

    fn contact(&self, bodies: &[Body], planar: bool) -> Result<ContactSettings> {
        let Some(contact) = &self.case.contact else {
            return self.fault(
                "contact",
                "the case has no `contact` block",
                r#"for example "contact": { "method": "penalty", "until": 1.0, "step": 1e-3 }"#,
            );
        };
        let method = match contact.method {
            case::ContactMethod::Penalty => Enforcement::Penalty,
            case::ContactMethod::Lcp => Enforcement::Lcp,
            case::ContactMethod::LcpSingle => Enforcement::LcpSingle,
            case::ContactMethod::ActiveSet => Enforcement::ActiveSet,
            case::ContactMethod::None => Enforcement::None,
        };
        let until = contact.until.map(|v| self.positive("contact.until", v.0)).transpose()?;
        let impulses = matches!(method, Enforcement::Lcp | Enforcement::LcpSingle);
        self.method_fits(method, until, planar)?;
        let stepping = match contact.integrator {
            Some(case::SceneIntegrator::EnergyConsistent) => Stepping::EnergyConsistent,
            Some(case::SceneIntegrator::SemiImplicitEuler) => Stepping::SemiImplicit,
            None if impulses => Stepping::SemiImplicit,
            None => Stepping::EnergyConsistent,
        };
        if impulses && stepping == Stepping::EnergyConsistent {
            return self.fault(
                "contact.integrator",
                "impulses go with the semi-implicit step",
                "semi-implicit-euler; or the method penalty",
            );
        }
        let penalty = contact.penalty.map(|v| self.positive("contact.penalty", v.0)).transpose()?;
        let point_penalty =
            contact.point_penalty.map(|v| self.positive("contact.point_penalty", v.0)).transpose()?;
        let step = self.positive("contact.step", contact.step.map_or(1e-4, |s| s.0))?;
        if let Some(until) = until.filter(|t| !(t / step <= MOST_STEPS && step <= *t)) {
            return self.fault(
                "contact.step",
                "the step does not fit the motion",
                format!("{:e} s to {until:e} s", until / MOST_STEPS),
            );
        }
        let whole = |key: &str, value: u32, least: u32, most: u32| {
            if (least..=most).contains(&value) {
                return Ok(value as usize);
            }
            self.fault(&format!("contact.{key}"), "out of range", format!("{least} to {most}"))
        };
        if contact.with_itself {
            self.self_contact(bodies, planar)?;
        }
        let segments = whole("segments", contact.segments, 1, 1000)?;
        let output = whole("output", contact.output, 2, 1_000_000)?;
        self.scene_fits(bodies, segments, output)?;
        let corner_angle = contact.corner_angle.map_or(10.0_f64.to_radians(), |a| a.0);
        if !(0.0..=std::f64::consts::FRAC_PI_2).contains(&corner_angle) {
            return self.fault("contact.corner_angle", "out of range", "0 to 90 deg");
        }
        Ok(ContactSettings {
            method,
            penalty,
            point_penalty,
            segments,
            cut: contact.cut,
            until,
            step,
            stepping,
            with_itself: contact.with_itself,
            output,
            snapshots: whole("snapshots", contact.snapshots, 1, 12)?,
            load_steps: whole("load_steps", contact.load_steps, 1, 100_000)?,
            corner_angle,
        })
    }
}
