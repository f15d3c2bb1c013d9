//! Settings of steady vibration: unbalance, harmonic excitation, operating speeds, clearances.

use crate::case;
use crate::check::Input;
use crate::error::Result;
use crate::model::{
    Bearing, Clearance, CrossCoupling, Disk, Excitation, Form, HarmonicSettings, MapSettings, Node,
    OperatingSpeed, Resists, Station, Unbalance, UnbalanceSettings,
};

/// What stations and masses may refer to.
pub(super) struct Attached<'a> {
    pub length: f64,
    /// Mass of shaft and disks, kg.
    pub mass: f64,
    pub nodes: &'a [Node],
    pub disks: &'a [Disk],
    pub bearings: &'a [Bearing],
}

impl Input<'_> {
    pub(super) fn operating_speed(&self) -> Result<Option<OperatingSpeed>> {
        let Some(o) = &self.case.operating_speed else { return Ok(None) };
        let minimum = self.positive("operating_speed.minimum", o.minimum.0)?;
        let maximum = o.maximum.map_or(minimum, |s| s.0);
        let in_order = |key: &str, speed: f64, least: f64, name: &str| {
            if speed >= least && speed.is_finite() {
                return Ok(());
            }
            self.fault(
                &format!("operating_speed.{key}"),
                format!("the speeds are in the wrong order: it is below the {name} of {least} rad/s"),
                "minimum <= maximum <= trip",
            )
        };
        in_order("maximum", maximum, minimum, "minimum")?;
        if let Some(trip) = o.trip {
            in_order("trip", trip.0, maximum, "maximum")?;
        }
        Ok(Some(OperatingSpeed { minimum, maximum, trip: o.trip.map(|s| s.0) }))
    }

    pub(super) fn clearances(&self, length: f64) -> Result<Vec<Clearance>> {
        let one = |(i, c): (usize, &case::ClearanceInput)| {
            self.on_shaft(&format!("clearances.{i}.at"), c.at.0, length)?;
            let gap = self.positive(&format!("clearances.{i}.gap"), c.gap.0)?;
            Ok(Clearance { name: c.name.clone(), x: c.at.0.clamp(0.0, length), gap })
        };
        self.case.clearances.iter().enumerate().map(one).collect()
    }

    /// Ascending speeds or frequencies at a path.
    pub(super) fn range(&self, path: &str, range: &case::SpeedRange) -> Result<Vec<f64>> {
        let (from, to) = (self.not_negative(&format!("{path}.from"), range.from.0)?, range.to.0);
        if !(to > 0.0 && to.is_finite()) {
            return self.fault(&format!("{path}.to"), "the sweep has no positive end", "a value above 0");
        }
        let count = range.count;
        if !(1..=100_000).contains(&count) {
            return self.fault(&format!("{path}.count"), "no such number of values", "1 to 100000");
        }
        if (count > 1 && from >= to) || (count == 1 && from != to) {
            return self.fault(
                &format!("{path}.from"),
                "the sweep does not rise",
                format!("below {to} rad/s (equal to it for a count of 1)"),
            );
        }
        let step = |k: u32| if count > 1 { f64::from(k) / f64::from(count - 1) } else { 1.0 };
        Ok((0..count).map(|k| from + (to - from) * step(k)).collect())
    }

    /// Speeds or frequencies as a range or a list.
    fn ascending(&self, path: &str, values: &case::FrequenciesInput) -> Result<Vec<f64>> {
        let list = match values {
            case::FrequenciesInput::Range(range) => return self.range(path, range),
            case::FrequenciesInput::List(list) => list,
        };
        if list.is_empty() {
            return self.fault(path, "the list is empty", "at least one value");
        }
        for (i, value) in list.iter().enumerate() {
            self.not_negative(&format!("{path}.{i}"), value.0)?;
        }
        match (1..list.len()).find(|&i| list[i].0 <= list[i - 1].0) {
            Some(i) => self.fault(&format!("{path}.{i}"), "the values do not rise", "ascending values"),
            None => Ok(list.iter().map(|value| value.0).collect()),
        }
    }

    /// The map of critical speeds.
    pub(super) fn map(&self, length: f64, operating: Option<OperatingSpeed>) -> Result<Option<MapSettings>> {
        let Some(m) = &self.case.map else { return Ok(None) };
        let from = self.positive("map.stiffness.from", m.stiffness.from.0)?;
        let to = self.positive("map.stiffness.to", m.stiffness.to.0)?;
        if !(2..=10_000).contains(&m.stiffness.count) {
            return self.fault("map.stiffness.count", "no such number of stiffnesses", "2 to 10000");
        }
        if from >= to {
            return self.fault(
                "map.stiffness.from",
                "the stiffnesses do not rise",
                format!("below {to} N/m"),
            );
        }
        let is_bearing = |s: &case::SupportInput| {
            s.kind == Some(case::SupportKindInput::Bearing) && (s.stiffness.is_some() || s.table.is_some())
        };
        let supports = &self.case.supports;
        let chosen = match &m.bearings {
            Some(list) => {
                for (i, number) in list.iter().enumerate() {
                    if !supports.get(*number as usize).is_some_and(is_bearing) {
                        return self.fault(
                            &format!("map.bearings.{i}"),
                            "this is not the number of a bearing with lateral springs",
                            "numbers of entries of supports with \"kind\": \"bearing\", from 0",
                        );
                    }
                }
                list.iter().map(|n| *n as usize).collect()
            }
            None => (0..supports.len()).filter(|&i| is_bearing(&supports[i])).collect::<Vec<_>>(),
        };
        if chosen.is_empty() {
            return self.fault(
                "map",
                "the rotor has no bearing whose stiffness could change",
                "a support of kind bearing",
            );
        }
        if !(1..=50).contains(&m.modes) {
            return self.fault("map.modes", "no such number of curves", "1 to 50");
        }
        let cross_coupling = match &m.cross_coupling {
            None => None,
            Some(q) => {
                let x = q.at.map_or(length / 2.0, |x| x.0);
                self.on_shaft("map.cross_coupling.at", x, length)?;
                let Some(speed) = q.speed.map(|s| s.0).or(operating.map(|o| o.maximum)) else {
                    return self.fault(
                        "map.cross_coupling.speed",
                        "the decay needs a speed of the rotor",
                        "a speed, or operating_speed at the top of the case",
                    );
                };
                let largest = self.positive("map.cross_coupling.to", q.to.0)?;
                if !(2..=10_000).contains(&q.count) {
                    return self.fault("map.cross_coupling.count", "no such number of values", "2 to 10000");
                }
                let share = |k: u32| f64::from(k) / f64::from(q.count - 1);
                let speed = self.not_negative("map.cross_coupling.speed", speed)?;
                Some(CrossCoupling {
                    x,
                    speed,
                    stiffness: (0..q.count).map(|k| largest * share(k)).collect(),
                })
            }
        };
        let share = |k: u32| f64::from(k) / f64::from(m.stiffness.count - 1);
        Ok(Some(MapSettings {
            stiffness: (0..m.stiffness.count).map(|k| from * (to / from).powf(share(k))).collect(),
            bearings: chosen.into_iter().map(|i| format!("supports.{i}")).collect(),
            curves: m.modes as usize,
            cross_coupling,
        }))
    }

    /// The stations asked for, or every disk and bearing.
    fn stations(&self, path: &str, asked: &[case::StationInput], on: &Attached<'_>) -> Result<Vec<Station>> {
        let one = |(i, s): (usize, &case::StationInput)| {
            self.on_shaft(&format!("{path}.{i}.at"), s.at.0, on.length)?;
            let name = s.name.clone().unwrap_or_else(|| format!("{} m", s.at.0));
            Ok(Station { name, x: s.at.0.clamp(0.0, on.length), angle: s.angle.map(|a| a.0) })
        };
        if !asked.is_empty() {
            return asked.iter().enumerate().map(one).collect();
        }
        let station = |name: String, node: usize| Station { name, x: on.nodes[node].x, angle: None };
        let disks = on.disks.iter().enumerate().map(|(i, d)| station(format!("disks.{i}"), d.node));
        let lateral = on.bearings.iter().filter(|b| b.holds_shaft() && b.resists == Resists::Lateral);
        let mut list: Vec<Station> = disks.chain(lateral.map(|b| station(b.path.clone(), b.node))).collect();
        if list.is_empty() {
            list.push(Station { name: "middle".to_owned(), x: on.length / 2.0, angle: None });
        }
        Ok(list)
    }

    pub(super) fn unbalance(
        &self,
        on: &Attached<'_>,
        operating: Option<OperatingSpeed>,
    ) -> Result<Option<UnbalanceSettings>> {
        let Some(u) = &self.case.unbalance else { return Ok(None) };
        let speeds = match &u.speeds {
            Some(speeds) => self.ascending("unbalance.speeds", speeds)?,
            None => Vec::new(),
        };
        let mut masses = Vec::new();
        for (i, m) in u.masses.iter().enumerate() {
            masses.push(self.unbalance_mass(&format!("unbalance.masses.{i}"), m, on.length)?);
        }
        for (i, disk) in on.disks.iter().enumerate().filter(|(_, d)| d.offset != [0.0; 2]) {
            let [y, z] = disk.offset;
            masses.push(Unbalance {
                x: on.nodes[disk.node].x,
                moment: disk.mass * y.hypot(z),
                angle: z.atan2(y),
                path: format!("disks.{i}.offset"),
                of_disk: true,
            });
        }
        if let Some(grade) = &u.grade {
            let fastest = operating.map(|o| o.maximum).or(speeds.last().copied());
            masses.extend(self.graded(grade, fastest, u.distribution, on)?);
        } else if u.distribution != case::Distribution::InPhase {
            return self.fault(
                "unbalance.distribution",
                "no grade is spread",
                "\"grade\" beside it, or no distribution",
            );
        }
        for (i, s) in u.shapes.iter().enumerate() {
            self.positive(&format!("unbalance.shapes.{i}"), s.0)?;
        }
        Ok(Some(UnbalanceSettings {
            stations: self.stations("unbalance.stations", &u.stations, on)?,
            amplitude: u.amplitude.into(),
            shapes: u.shapes.iter().map(|s| s.0).collect(),
            form: u.form.unwrap_or(Form::Consistent),
            speeds,
            masses,
        }))
    }

    fn unbalance_mass(&self, path: &str, m: &case::UnbalanceMassInput, length: f64) -> Result<Unbalance> {
        let at = |key: &str| format!("{path}.{key}");
        self.on_shaft(&at("at"), m.at.0, length)?;
        let allowed = "moment; or mass and radius";
        let moment = match (m.moment, m.mass, m.radius) {
            (Some(moment), None, None) => self.not_negative(&at("moment"), moment.0)?,
            (None, Some(mass), Some(radius)) => {
                self.not_negative(&at("mass"), mass.0)? * self.not_negative(&at("radius"), radius.0)?
            }
            (Some(_), ..) => {
                let key = if m.mass.is_some() { "mass" } else { "radius" };
                return self.fault(
                    &at(key),
                    "an unbalance is given by its moment or by mass and radius, not both",
                    allowed,
                );
            }
            (None, mass, _) => {
                let missing = if mass.is_none() { "mass" } else { "radius" };
                let missing = if m.mass.is_none() && m.radius.is_none() { "moment" } else { missing };
                return self.fault(
                    &at(missing),
                    format!("the unbalance's \"{missing}\" is missing"),
                    allowed,
                );
            }
        };
        let angle = m.angle.map_or(0.0, |a| a.0);
        Ok(Unbalance { x: m.at.0.clamp(0.0, length), moment, angle, path: path.to_owned(), of_disk: false })
    }

    /// What a grade leaves: `U = G m / Omega`, over the disks by their masses, or at mid-length.
    fn graded(
        &self,
        grade: &str,
        fastest: Option<f64>,
        distribution: case::Distribution,
        on: &Attached<'_>,
    ) -> Result<Vec<Unbalance>> {
        let path = "unbalance.grade";
        let number = grade.trim().strip_prefix(['G', 'g']).map(str::trim);
        let millimetres =
            number.and_then(|text| text.parse::<f64>().ok()).filter(|g| *g > 0.0 && *g <= 4000.0);
        let Some(millimetres) = millimetres else {
            return self.fault(
                path,
                "this is no balance grade",
                "\"G0.4\" to \"G4000\": G and millimetres a second",
            );
        };
        let Some(fastest) = fastest.filter(|s| *s > 0.0) else {
            return self.fault(
                path,
                "a grade needs the speed at which it holds",
                "operating_speed with its maximum, or unbalance.speeds",
            );
        };
        let total = millimetres * 1e-3 * on.mass / fastest;
        let one = |x: f64, share: f64, k: usize| {
            let opposed = distribution == case::Distribution::Alternating && k % 2 == 1;
            let angle = if opposed { std::f64::consts::PI } else { 0.0 };
            Unbalance { x, moment: total * share, angle, path: path.to_owned(), of_disk: false }
        };
        let mut order: Vec<&Disk> = on.disks.iter().filter(|d| d.mass > 0.0).collect();
        order.sort_by(|a, b| on.nodes[a.node].x.total_cmp(&on.nodes[b.node].x));
        let sum: f64 = order.iter().map(|d| d.mass).sum();
        if order.is_empty() {
            return Ok(vec![one(on.length / 2.0, 1.0, 0)]);
        }
        Ok(order.iter().enumerate().map(|(k, d)| one(on.nodes[d.node].x, d.mass / sum, k)).collect())
    }

    pub(super) fn harmonic(&self, on: &Attached<'_>) -> Result<Option<HarmonicSettings>> {
        let Some(h) = &self.case.harmonic else { return Ok(None) };
        let frequencies = self.ascending("harmonic.frequencies", &h.frequencies)?;
        if h.excitations.is_empty() {
            return self.fault(
                "harmonic.excitations",
                "nothing excites",
                "a force, a moment or a base motion",
            );
        }
        let mut excitations = Vec::new();
        for (i, e) in h.excitations.iter().enumerate() {
            let excitation = self.excitation(&format!("harmonic.excitations.{i}"), e, on.length)?;
            excitations.push((excitation, e.phase.map_or(0.0, |a| a.0)));
        }
        Ok(Some(HarmonicSettings {
            spin_speed: self.not_negative("harmonic.spin_speed", h.spin_speed.map_or(0.0, |s| s.0))?,
            frequencies,
            excitations,
            stations: self.stations("harmonic.stations", &h.stations, on)?,
            amplitude: h.amplitude.into(),
            form: h.form.unwrap_or(Form::Consistent),
        }))
    }

    fn excitation(&self, path: &str, e: &case::ExcitationInput, length: f64) -> Result<Excitation> {
        let allowed = "at with force or moment; or base with displacement or acceleration";
        let at = |key: &str| format!("{path}.{key}");
        match (e.force, e.moment, &e.base, e.at) {
            (Some(force), None, None, Some(x)) => {
                self.on_shaft(&at("at"), x.0, length)?;
                Ok(Excitation::Force(force.map(|f| f.0), x.0.clamp(0.0, length)))
            }
            (None, Some(moment), None, Some(x)) => {
                self.on_shaft(&at("at"), x.0, length)?;
                Ok(Excitation::Moment(moment.map(|m| m.0), x.0.clamp(0.0, length)))
            }
            (None, None, Some(base), None) => match (base.displacement, base.acceleration) {
                (Some(d), None) => Ok(Excitation::BaseDisplacement(d.map(|d| d.0))),
                (None, Some(a)) => Ok(Excitation::BaseAcceleration(a.map(|a| a.0))),
                _ => self.fault(
                    &at("base"),
                    "the ground moves by a displacement or an acceleration",
                    "one of them: [along y, along z]",
                ),
            },
            (None, None, Some(_), Some(_)) => {
                self.fault(&at("at"), "the ground moves under all supports", "base without at")
            }
            (Some(_), None, None, None) | (None, Some(_), None, None) => {
                self.fault(&at("at"), "a force or moment needs its place", "a position along the shaft")
            }
            _ => self.fault(path, "an excitation is one thing", allowed),
        }
    }
}
