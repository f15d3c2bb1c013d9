//! Settings of the nonlinear analyses: quadrature, static, spinup.

use crate::case;
use crate::check::Input;
use crate::check::mesh::Mesh;
use crate::error::Result;
use crate::model::{Frame, Integrator, Phase, Quadrature, SpinupSettings, StaticSettings, Stator};
use crate::section::Section;

/// Longest simulation, s.
const LONGEST_RUN_S: f64 = 1e9;
/// Fastest drive, rad/s.
const FASTEST_DRIVE_RAD_S: f64 = 1e12;
/// Largest torque of a drive, N m.
const STRONGEST: f64 = 1e30;

impl Input<'_> {
    pub(super) fn quadrature(&self) -> Result<Quadrature> {
        let path = "shaft.quadrature";
        let written = self.case.shaft.as_ref().map_or_else(Default::default, |s| s.quadrature);
        let rule = match written {
            case::QuadratureInput::Named(case::QuadratureName::Exact) => Quadrature::EXACT,
            case::QuadratureInput::Named(case::QuadratureName::Reduced) => {
                Quadrature { axial: Some(5), section: None }
            }
            case::QuadratureInput::Points(p) => Quadrature { axial: p.axial, section: p.section },
        };
        for (key, points) in [("axial", rule.axial), ("section", rule.section)] {
            if points.is_some_and(|n| !(2..=20).contains(&n)) {
                return self.fault(&format!("{path}.{key}"), "no such number of Gauss points", "2 to 20");
            }
        }
        Ok(rule)
    }

    pub(super) fn statics(&self) -> Result<StaticSettings> {
        let s = &self.case.statics;
        if !(1..=10_000).contains(&s.load_steps) {
            return self.fault("static.load_steps", "no such number of load steps", "1 to 10000");
        }
        if !(1..=1000).contains(&s.max_iterations) {
            return self.fault("static.max_iterations", "no such number of iterations", "1 to 1000");
        }
        if !(s.tolerance > 1e-32 && s.tolerance < 1e-2) {
            return self.fault(
                "static.tolerance",
                "the relative energy of the last correction is out of range",
                "between 1e-32 and 1e-2, e.g. 1e-20 (ten digits of the displacement)",
            );
        }
        let (load_steps, max_iterations) = (s.load_steps as usize, s.max_iterations as usize);
        Ok(StaticSettings { load_steps, max_iterations, tolerance: s.tolerance })
    }

    /// The phases of the drive.
    fn phases(&self, s: &case::SpinupInput) -> Result<Vec<Phase>> {
        let (mut drive, mut before) = (Vec::new(), 0.0);
        for (i, phase) in s.drive.iter().enumerate() {
            let (path, until) = (format!("spinup.drive.{i}.until"), phase.until.0);
            if !(until > before) {
                let problem = if i == 0 { "the phase has no duration" } else { "the phases do not ascend" };
                return self.fault(&path, problem, format!("a time above {before} s"));
            }
            self.within(&path, until, 1e-12, LONGEST_RUN_S)?;
            let speed = phase.speed.0;
            self.within(&format!("spinup.drive.{i}.speed"), speed.abs(), 0.0, FASTEST_DRIVE_RAD_S)?;
            drive.push(Phase { until, speed, shape: phase.shape });
            before = until;
        }
        Ok(drive)
    }

    /// The method of integration and its spectral radius at infinite frequency.
    fn integrator(&self, s: &case::SpinupInput, fixed: bool) -> Result<(Integrator, f64)> {
        let at = |key: &str| format!("spinup.{key}");
        let integrator = match s.integrator {
            case::IntegratorInput::Implicit | case::IntegratorInput::Esdirk => Integrator::Esdirk,
            case::IntegratorInput::GeneralizedAlpha => Integrator::GeneralizedAlpha,
            case::IntegratorInput::Adams => Integrator::Adams,
        };
        if integrator == Integrator::Adams && fixed {
            let allowed = "rtol and atol with \"adams\", or an implicit integrator with a fixed step";
            return self.fault(&at("step"), "adams chooses its steps by their error", allowed);
        }
        if s.rho_infinity.is_some() && integrator != Integrator::GeneralizedAlpha {
            let allowed = "only with \"integrator\": \"generalized-alpha\"";
            return self.fault(&at("rho_infinity"), "the integrator has no such parameter", allowed);
        }
        let rho_infinity = s.rho_infinity.unwrap_or(0.9);
        if !(0.0..=1.0).contains(&rho_infinity) {
            return self.fault(&at("rho_infinity"), "no such spectral radius", "0 to 1");
        }
        Ok((integrator, rho_infinity))
    }

    pub(super) fn spinup(&self, mesh: &Mesh, sections: &[Section]) -> Result<Option<SpinupSettings>> {
        let Some(s) = &self.case.spinup else { return Ok(None) };
        let at = |key: &str| format!("spinup.{key}");
        let start_speed = s.start_speed.map_or(0.0, |w| w.0);
        self.within(&at("start_speed"), start_speed.abs(), 0.0, FASTEST_DRIVE_RAD_S)?;
        if start_speed != 0.0 && s.frame == Frame::Inertial {
            let allowed = "\"frame\": \"rotating\", or a start from rest";
            return self.fault(&at("start_speed"), "the inertial frame starts from rest", allowed);
        }
        let torque = self.torque(s)?;
        if s.drive.is_empty() && torque.is_empty() {
            return self.fault(
                &at("drive"),
                "the drive has no phase",
                r#"a list such as [ { "until": 1.0, "speed": "15000 rpm" } ]"#,
            );
        }
        let drive = self.phases(s)?;
        let before = drive.last().map_or(0.0, |phase| phase.until);
        let driven_node = self.driven_node(s, mesh)?;
        if driven_node.is_none() && (start_speed != 0.0 || !torque.is_empty() || turns_at_all(&drive)) {
            self.turning()?;
        }
        if !torque.is_empty() && s.until.is_none() {
            return self.fault(
                &at("torque"),
                "a torque has no end of its own",
                "\"until\": the end of the simulation",
            );
        }
        let until = self.positive(&at("until"), s.until.map_or(before, |t| t.0))?;
        self.within(&at("until"), until, 1e-12, LONGEST_RUN_S)?;
        for (key, tolerance) in [("rtol", s.rtol), ("atol", s.atol)] {
            if !(tolerance > 0.0 && tolerance <= 0.1) {
                return self.fault(&at(key), "no such tolerance", "above 0, at most 0.1");
            }
        }
        let step = s.step.map(|step| step.0);
        if step.is_some_and(|step| !(step > 0.0 && step <= until)) {
            return self.fault(&at("step"), "no such step", format!("above 0, at most {until} s"));
        }
        let (integrator, rho_infinity) = self.integrator(s, step.is_some())?;
        if !(2..=1_000_000).contains(&s.output) {
            return self.fault(&at("output"), "no such number of output times", "2 to 1000000");
        }
        if s.max_steps == 0 {
            return self.fault(&at("max_steps"), "no steps are allowed", "at least 1");
        }
        Ok(Some(SpinupSettings {
            start_speed,
            drive,
            torque,
            until,
            frame: s.frame,
            integrator,
            rtol: s.rtol,
            atol: s.atol,
            rho_infinity,
            step,
            max_steps: s.max_steps as usize,
            output: s.output as usize,
            steady: s.steady,
            driven_node,
            stators: self.stators(s, mesh, sections)?,
        }))
    }

    /// The torque of the drive over speed.
    fn torque(&self, s: &case::SpinupInput) -> Result<Vec<[f64; 2]>> {
        if !s.torque.is_empty() && !s.drive.is_empty() {
            let allowed = "\"drive\" for a speed over time, or \"torque\" for a torque over speed";
            return self.fault("spinup.torque", "the drive has a speed and a torque", allowed);
        }
        for (key, wrong) in [
            ("steady", s.steady),
            ("frame", s.frame == Frame::Inertial),
            ("integrator", s.integrator == case::IntegratorInput::Adams),
        ] {
            if wrong && !s.torque.is_empty() {
                return self.fault(
                    &format!("spinup.{key}"),
                    "a drive by its torque runs over time, in the rotating frame, with an implicit integrator",
                    "\"steady\": false, \"frame\": \"rotating\", \"integrator\": \"implicit\"; or a drive by speeds",
                );
            }
        }
        let mut points: Vec<[f64; 2]> = Vec::new();
        for (i, point) in s.torque.iter().enumerate() {
            let at = |key: &str| format!("spinup.torque.{i}.{key}");
            let (speed, torque) = (point.speed.0, point.torque.0);
            self.within(&at("speed"), speed.abs(), 0.0, FASTEST_DRIVE_RAD_S)?;
            self.within(&at("torque"), torque.abs(), 0.0, STRONGEST)?;
            if let Some([before, _]) = points.last().filter(|before| before[0] >= speed) {
                let allowed = format!("above {before} rad/s");
                return self.fault(&at("speed"), "the speeds of the torque do not ascend", allowed);
            }
            points.push([speed, torque]);
        }
        Ok(points)
    }

    /// The node whose section the drive turns; it was given an element end.
    fn driven_node(&self, s: &case::SpinupInput, mesh: &Mesh) -> Result<Option<usize>> {
        let Some(at) = s.driven_at else { return Ok(None) };
        let holds = |s: &case::SupportInput| turns(s) || s.kind == Some(case::SupportKindInput::Clamped);
        if let Some(i) = self.case.supports.iter().position(holds) {
            return self.fault(
                "spinup.driven_at",
                format!("supports.{i} turns the shaft already, or keeps it from turning"),
                "one drive: \"driven\": false on revolute and cylindrical supports, or no driven_at",
            );
        }
        Ok(Some(mesh.node_at(at.0)))
    }

    fn stators(&self, s: &case::SpinupInput, mesh: &Mesh, sections: &[Section]) -> Result<Vec<Stator>> {
        /// Most friction: steel that seizes stays below.
        const SEIZED: f64 = 10.0;
        if s.steady && !s.stators.is_empty() {
            let allowed = "the transient (\"steady\": false), or no stators";
            return self.fault("spinup.stators", "the steady state knows no contact", allowed);
        }
        let length: f64 = mesh.elements.iter().map(|e| e.length).sum();
        let mut list: Vec<Stator> = Vec::new();
        for (i, stator) in s.stators.iter().enumerate() {
            let path = format!("spinup.stators.{i}");
            let at = |key: &str| format!("{path}.{key}");
            let x = stator.at.0;
            self.on_shaft(&at("at"), x, length)?;
            let node = mesh.node_at(x);
            let end = mesh.nodes[node].x;
            if (end - x).abs() > 1e-9 * length {
                return self.fault(
                    &at("at"),
                    "no element ends there, and a ring does not change the mesh",
                    format!("the nearest element end, {end:.6e} m; or other numbers of elements"),
                );
            }
            let here: Vec<Section> = mesh.sections_at(node).map(|k| sections[k]).collect();
            if !here.iter().all(Section::is_axisymmetric) {
                let allowed = "a place where circles or tubes meet";
                return self.fault(&at("at"), "the gap of a ring is that of a round section", allowed);
            }
            let friction = self.not_negative(&at("friction"), stator.friction)?;
            self.within(&at("friction"), friction, 0.0, SEIZED)?;
            list.push(Stator {
                node,
                at: x,
                clearance: self.length(&at("clearance"), stator.clearance.0)?,
                stiffness: self.positive(&at("stiffness"), stator.stiffness.0)?,
                friction,
                radius: here.iter().map(Section::outer_size).fold(0.0, f64::max),
                path,
            });
        }
        Ok(list)
    }

    /// A drive with speed needs an end that it turns, and none that stands still.
    fn turning(&self) -> Result<()> {
        let still = self.case.supports.iter().position(|s| s.kind == Some(case::SupportKindInput::Clamped));
        if let Some(i) = still {
            return self.fault(
                &format!("supports.{i}.kind"),
                "a clamped section does not turn with the drive",
                "\"revolute\" or \"cylindrical\", which turn with it",
            );
        }
        if self.case.supports.iter().any(turns) {
            return Ok(());
        }
        self.fault(
            "spinup.drive",
            "no support turns the shaft: the drive has a speed but no driven end",
            "\"driven_at\": the position of a section that the drive turns and holds in no other way, as a coupling turns a \
             rotor on bearings; or a revolute or cylindrical end that is driven; or speed 0",
        )
    }
}

/// True when a drive by speeds turns the shaft at some time.
fn turns_at_all(drive: &[Phase]) -> bool {
    drive.iter().any(|p| p.speed != 0.0)
}

/// Whether the rotation of a support's section follows the drive.
fn turns(support: &case::SupportInput) -> bool {
    match support.kind {
        Some(case::SupportKindInput::Revolute | case::SupportKindInput::Cylindrical) => {
            support.driven != Some(false)
        }
        Some(_) => false,
        // fixed components turn with the drive when they hold the rotation
        None => {
            let names = support.fix.iter().flatten();
            names.into_iter().any(|name| matches!(name.as_str(), "all" | "y" | "z" | "y.z" | "z.y"))
        }
    }
}
