//! The face of the library: a [`Rotor`] read from a case or built in Rust, and its analyses with typed results.

use crate::analysis::{self, Outcome};
use crate::case::{Case, LoadedCase};
use crate::error::Result;
use crate::model::Model;
use crate::results::{Campbell, Check, Contact, Modes, Spinup, Static};
use crate::run::{self, Analysis, Finished, Host};
use serde_json::{Map, Value, json};
use std::path::Path;

/// A rotor, or a scene of beams in contact, with what to compute of it.
///
/// It holds the same case that a case file holds, so everything of the case format can be said of it: lengths in m, or texts with a
/// unit such as `"50 mm"`. A `Rotor` does not change; [`Self::with`] makes another one.
///
/// Analyses check the case before they compute. What they return are the results of the report as types, in SI units.
#[derive(Debug, Clone)]
pub struct Rotor {
    loaded: LoadedCase,
}

impl Rotor {
    /// Reads a case file.
    ///
    /// # Errors
    /// A file that can't be read, is no JSON, or has unknown keys or wrong types.
    ///
    /// ```
    /// let rotor = rotor::Rotor::from_file("cases/jeffcott.json")?;
    /// assert_eq!(rotor.case()["title"], "Jeffcott rotor");
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn from_file(path: impl AsRef<Path>) -> Result<Self> {
        Ok(Self { loaded: Case::load(path.as_ref(), &[])? })
    }

    /// A case from JSON in memory; `name` stands for the file in messages and reports.
    ///
    /// # Errors
    /// Unknown keys or wrong types.
    ///
    /// ```
    /// let bar = serde_json::json!({
    ///     "title": "free bar",
    ///     "materials": { "steel": { "E": "210 GPa", "nu": 0.3, "rho": 7850 } },
    ///     "sections": { "round": { "shape": "circle", "radius": "50 mm" } },
    ///     "shaft": { "segments": [{ "length": 1.0, "elements": 4, "section": "round", "material": "steel" }] }
    /// });
    /// assert_eq!(rotor::Rotor::from_json("free bar", bar)?.modes()?.results.rigid_modes, 6);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn from_json(name: &str, case: Value) -> Result<Self> {
        Ok(Self { loaded: LoadedCase::from_value(name, case)? })
    }

    /// Begins a rotor in Rust.
    ///
    /// ```
    /// let shaft = rotor::Rotor::builder("a shaft in two bearings")
    ///     .material("steel", 210e9, 0.3, 7850.0)
    ///     .circle("round", 0.02)
    ///     .segment(1.0, 8, "round", "steel")
    ///     .bearing(0.0, [[1e8, 0.0], [0.0, 1e8]])
    ///     .bearing(1.0, [[1e8, 0.0], [0.0, 1e8]])
    ///     .build()?;
    /// let found = shaft.modes()?.results;
    /// // it slides and turns in its bearings; of the others the first is bending at 81 Hz
    /// assert_eq!(found.rigid_modes, 2);
    /// assert!((found.modes[2].frequency_hz - 81.0).abs() < 1.0);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn builder(title: &str) -> RotorBuilder {
        RotorBuilder { case: json!({ "title": title, "shaft": { "segments": [] } }) }
    }

    /// The same rotor with another value at a path of its case.
    ///
    /// # Errors
    /// A path that the case does not have, or a value of the wrong type.
    ///
    /// ```
    /// let rotor = rotor::Rotor::from_file("cases/bauchau.json")?;
    /// let finer = rotor.with("shaft.segments.0.elements", 32)?;
    /// assert_eq!(finer.check()?.model.elements, 32);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn with(&self, path: &str, value: impl Into<Value>) -> Result<Self> {
        let set = Map::from_iter([(path.to_owned(), value.into())]);
        Ok(Self { loaded: self.loaded.with(&set)? })
    }

    /// The case as JSON.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("empty").build()?;
    /// assert_eq!(rotor.case()["title"], "empty");
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn case(&self) -> &Value {
        &self.loaded.value
    }

    /// Size, mass and inertia, and what each analysis will model.
    ///
    /// # Errors
    /// A case that breaks a rule.
    ///
    /// ```
    /// let found = rotor::Rotor::from_file("cases/jeffcott.json")?.check()?;
    /// assert!(found.results.disk_mass_kg > 0.0);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn check(&self) -> Result<Outcome<Check>> {
        // it tells the memory that the other analyses need
        self.of_model(Model::new, analysis::check::check)
    }

    /// Natural frequencies and mode shapes at rest.
    ///
    /// # Errors
    /// A case that breaks a rule, or an eigenvalue solver that does not converge.
    ///
    /// ```
    /// let found = rotor::Rotor::from_file("cases/table3-tube.json")?.modes()?;
    /// assert!(found.results.modes.iter().any(|mode| mode.frequency_hz > 0.0));
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn modes(&self) -> Result<Outcome<Modes>> {
        self.of_model(run::affordable, analysis::modes::modes)
    }

    /// Whirl frequencies over speed and critical speeds; needs the block `campbell`.
    ///
    /// # Errors
    /// A case that breaks a rule or has no such block, a rotor that the frame or form does not fit, or a solver that does not
    /// converge.
    ///
    /// ```
    /// let found = rotor::Rotor::from_file("cases/jeffcott.json")?.campbell()?;
    /// assert!(!found.results.critical_speeds.is_empty());
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn campbell(&self) -> Result<Outcome<Campbell>> {
        self.of_model(run::affordable, |model| {
            let settings = run::needed(model.campbell.as_ref(), run::entry(Analysis::Campbell))?;
            analysis::campbell::campbell(model, settings, Host::silent().progress)
        })
    }

    /// Equilibrium under loads and gravity, with finite displacements.
    ///
    /// # Errors
    /// A case that breaks a rule, or loads that nothing resists.
    ///
    /// ```
    /// let found = rotor::Rotor::from_file("cases/table5-cantilever.json")?.statics()?;
    /// assert!(found.results.converged);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn statics(&self) -> Result<Outcome<Static>> {
        self.of_model(run::affordable, analysis::statics::statics)
    }

    /// Run up to speed, or the steady state at speed; needs the block `spinup`.
    ///
    /// # Errors
    /// A case that breaks a rule or has no such block, a shaft that bursts, or an integration that fails.
    ///
    /// ```
    /// let tube = rotor::Rotor::from_file("cases/tube-growth.json")?;
    /// assert!(tube.spinup()?.results.last.growth_m[0] > 0.0);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn spinup(&self) -> Result<Outcome<Spinup>> {
        self.of_model(run::affordable, |model| {
            let settings = run::needed(model.spinup.as_ref(), run::entry(Analysis::Spinup))?;
            analysis::spinup::spinup(model, settings, Host::silent().watch)
        })
    }

    /// Equilibrium or motion of beams in contact; needs `bodies`.
    ///
    /// # Errors
    /// A case that breaks a rule or is a shaft, bodies that overlap, or a step that fails.
    ///
    /// ```
    /// let scene = rotor::Rotor::from_file("cases/double-cantilever.json")?;
    /// assert!(scene.contact()?.results.converged);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn contact(&self) -> Result<Outcome<Contact>> {
        let found = run::scene_without_overlap(&self.loaded)
            .and_then(|scene| analysis::contact::contact(&scene, Host::silent().watch));
        found.map_err(|error| self.loaded.locate(error))
    }

    /// Runs an analysis to its report, table and figures, as the command line does.
    ///
    /// # Errors
    /// As of the analysis.
    ///
    /// ```
    /// use rotor::{Analysis, Rotor};
    ///
    /// let finished = Rotor::from_file("cases/jeffcott.json")?.report(Analysis::Check, false)?;
    /// assert_eq!(finished.json["case"]["file"], "jeffcott.json");
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn report(&self, analysis: Analysis, figures: bool) -> Result<Finished> {
        run::run(&self.loaded, analysis, &Host { plots: figures, ..Host::silent() })
    }

    /// An analysis of the checked model, with doubts about the values of the case.
    fn of_model<R>(
        &self,
        model: fn(&LoadedCase) -> Result<Model>,
        analysis: impl FnOnce(&Model) -> Result<Outcome<R>>,
    ) -> Result<Outcome<R>> {
        let found = model(&self.loaded).and_then(|model| Ok(run::doubted(&model, analysis(&model)?)));
        found.map_err(|error| self.loaded.locate(error))
    }
}

/// A rotor that is being built in Rust. All numbers are SI.
///
/// Methods take the common parts; [`Self::set`] and [`Self::add`] take everything else that a case may hold.
#[derive(Debug, Clone)]
pub struct RotorBuilder {
    case: Value,
}

impl RotorBuilder {
    /// An isotropic material: Young's modulus (Pa), Poisson's ratio, density (kg/m^3).
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").material("steel", 210e9, 0.3, 7850.0).build()?;
    /// assert!(rotor.case()["materials"]["steel"]["rho"] == 7850.0);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn material(self, name: &str, youngs_modulus: f64, poisson_ratio: f64, density: f64) -> Self {
        self.named("materials", name, json!({ "E": youngs_modulus, "nu": poisson_ratio, "rho": density }))
    }

    /// A solid circle of that radius, m.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").circle("round", 0.02).build()?;
    /// assert!(rotor.case()["sections"]["round"]["radius"] == 0.02);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn circle(self, name: &str, radius: f64) -> Self {
        self.named("sections", name, json!({ "shape": "circle", "radius": radius }))
    }

    /// A tube of those radii, m.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").tube("wall", 0.1, 0.06).build()?;
    /// assert!(rotor.case()["sections"]["wall"]["inner_radius"] == 0.06);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn tube(self, name: &str, outer_radius: f64, inner_radius: f64) -> Self {
        let section = json!({ "shape": "tube", "outer_radius": outer_radius, "inner_radius": inner_radius });
        self.named("sections", name, section)
    }

    /// The next segment of the shaft: its length (m), number of elements, section and material by name.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").segment(1.0, 8, "round", "steel").build()?;
    /// assert!(rotor.case()["shaft"]["segments"][0]["elements"] == 8);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn segment(self, length: f64, elements: usize, section: &str, material: &str) -> Self {
        let segment =
            json!({ "length": length, "elements": elements, "section": section, "material": material });
        self.add("shaft.segments", segment)
    }

    /// A rigid disk at a place (m): its mass (kg), polar and diametral inertia (kg m^2).
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").disk(0.4, 20.0, 0.25, 0.13).build()?;
    /// assert!(rotor.case()["disks"][0]["polar_inertia"] == 0.25);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn disk(self, at: f64, mass: f64, polar_inertia: f64, diametral_inertia: f64) -> Self {
        let inertias = json!({
            "at": at, "mass": mass, "polar_inertia": polar_inertia, "diametral_inertia": diametral_inertia
        });
        self.add("disks", inertias)
    }

    /// A bearing at a place (m): its stiffness `[[kyy, kyz], [kzy, kzz]]`, N/m.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").bearing(0.0, [[1e6, 0.0], [0.0, 2e6]]).build()?;
    /// assert!(rotor.case()["supports"][0]["stiffness"][1][1] == 2e6);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn bearing(self, at: f64, stiffness: [[f64; 2]; 2]) -> Self {
        self.add("supports", json!({ "at": at, "kind": "bearing", "stiffness": stiffness }))
    }

    /// A support of a kind ("pinned", "roller", "clamped", "revolute", "cylindrical") at a place, m.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").support(0.0, "pinned").build()?;
    /// assert!(rotor.case()["supports"][0]["kind"] == "pinned");
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn support(self, at: f64, kind: &str) -> Self {
        self.add("supports", json!({ "at": at, "kind": kind }))
    }

    /// The speeds of the Campbell diagram: equal steps between two speeds, rad/s.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").speeds(0.0, 1000.0, 21).build()?;
    /// assert!(rotor.case()["campbell"]["speeds"]["count"] == 21);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn speeds(self, from: f64, to: f64, count: usize) -> Self {
        self.set("campbell.speeds", json!({ "from": from, "to": to, "count": count }))
    }

    /// Writes a value at a path of the case, e.g. `"gravity"` or `"campbell.modes"`; what is missing on the way is made.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").set("modes.count", 12).build()?;
    /// assert!(rotor.case()["modes"]["count"] == 12);
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn set(mut self, path: &str, value: impl Into<Value>) -> Self {
        *self.place(path) = value.into();
        self
    }

    /// Adds an entry to a list of the case, e.g. `"loads"` or `"probes"`; the list is made if it is missing.
    ///
    /// ```
    /// let rotor = rotor::Rotor::builder("example").add("probes", serde_json::json!({ "name": "rim", "at": 0.5, "y": 0.02, "z": 0 })).build()?;
    /// assert!(rotor.case()["probes"][0]["name"] == "rim");
    /// # Ok::<(), rotor::Error>(())
    /// ```
    pub fn add(mut self, path: &str, entry: impl Into<Value>) -> Self {
        match self.place(path) {
            Value::Array(list) => list.push(entry.into()),
            place => *place = json!([entry.into()]),
        }
        self
    }

    /// The rotor.
    ///
    /// # Errors
    /// Unknown keys or wrong types; rules between values are checked by the analyses.
    ///
    /// ```
    /// let error = rotor::Rotor::builder("slip").set("disks", 3).build().unwrap_err();
    /// assert!(error.to_string().contains("disks"));
    /// ```
    pub fn build(self) -> Result<Rotor> {
        let name = self.case["title"].as_str().unwrap_or_default().to_owned();
        Rotor::from_json(&name, self.case)
    }

    /// A named part of the case.
    fn named(mut self, group: &str, name: &str, part: Value) -> Self {
        // names may hold dots: they are no path
        self.place(group)[name] = part;
        self
    }

    /// The place of a path, with objects made on the way.
    fn place(&mut self, path: &str) -> &mut Value {
        path.split('.').fold(&mut self.case, |at, key| {
            match key.parse::<usize>() {
                Ok(index) if at.get(index).is_some() => return &mut at[index],
                _ => {}
            }
            if !at.is_object() {
                *at = json!({});
            }
            &mut at[key]
        })
    }
}
