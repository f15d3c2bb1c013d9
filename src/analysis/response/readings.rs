//! What is read from a steady vibration: orbits of stations, forces of bearings, stresses at the surface.

use crate::analysis::probes::{axial_stress_rows, in_rigid_hub};
use crate::analysis::response::orbit::Orbit;
use crate::analysis::response::vibration::{ReducedRow, Vibration};
use crate::model::{Bearing, Coefficients, Resists, Station};
use crate::results::{ForceResponse, StationResponse, Whirl};
use crate::shaft::attachments::{bearing_rows, place_rows};
use faer::c64;

/// Minor over major axis below which a whirl has no sense.
const LEAST_CIRCULARITY: f64 = 0.01;

/// Rows of the basis for a place: displacement along y and z.
type Place = [ReducedRow; 2];

/// What is read, as rows on the basis.
pub struct Readings<'m> {
    /// Each with its displacement and, outside rigid hubs, the stress at its surface.
    stations: Vec<(&'m Station, Place, Option<Place>)>,
    /// Each with its position, m.
    bearings: Vec<(&'m Bearing, f64, Place)>,
    shape: Vec<(f64, Place)>,
}

fn dot(row: &[f64], q: &[c64]) -> c64 {
    row.iter().zip(q).map(|(w, q)| q * w).sum()
}

fn orbit([y, z]: &Place, q: &[c64]) -> Orbit {
    Orbit { y: dot(y, q), z: dot(z, q) }
}

impl<'m> Readings<'m> {
    /// The rows of stations, lateral bearings and element ends.
    pub fn new(vibration: &Vibration<'m>, stations: &'m [Station]) -> Self {
        let model = vibration.assembly.model;
        let numbering = &vibration.assembly.numbering;
        let place = |x: f64| -> Place {
            let [_, y, z, ..] = place_rows(model, numbering, x);
            [vibration.row(&y), vibration.row(&z)]
        };
        let stress = |x: f64| -> Option<Place> {
            let rows = (!in_rigid_hub(model, x)).then(|| axial_stress_rows(vibration.assembly, x));
            rows.map(|rows| rows.map(|row| vibration.row(&row)))
        };
        let lateral = model.bearings.iter().filter(|b| b.resists == Resists::Lateral);
        let ends = model.elements.iter().map(|e| e.x).chain([model.length]);
        Self {
            stations: stations.iter().map(|s| (s, place(s.x), stress(s.x))).collect(),
            bearings: lateral
                .map(|b| {
                    let rows = bearing_rows(model, numbering, b).map(|row| vibration.row(&row));
                    (b, model.nodes[b.node].x, rows)
                })
                .collect(),
            shape: ends.map(|x| (x, place(x))).collect(),
        }
    }

    /// Orbit of a station.
    pub fn orbit(&self, station: usize, q: &[c64]) -> Orbit {
        orbit(&self.stations[station].1, q)
    }

    /// Complex amplitude that a station tells: along its sensor; else the major semi-axis with the phase of the forward circle.
    pub fn told(&self, station: usize, q: &[c64]) -> c64 {
        let orbit = self.orbit(station, q);
        match self.stations[station].0.angle {
            Some(angle) => orbit.along(angle),
            None => c64::from_polar(orbit.major(), orbit.forward().arg()),
        }
    }

    /// Orbits of the element ends.
    pub fn shape(&self, q: &[c64]) -> Vec<(f64, Orbit)> {
        self.shape.iter().map(|(x, place)| (*x, orbit(place, q))).collect()
    }

    /// Responses of the first `count` stations, displacements times `factor`, for displacements on the basis at each speed or frequency, to each of
    /// which a motion of the ground is added.
    pub fn stations(
        &self,
        count: usize,
        all: &[Vec<c64>],
        ground: &[[c64; 2]],
        factor: f64,
        in_step: bool,
    ) -> Vec<StationResponse> {
        let one = |(i, (station, _, stress)): (usize, &(&Station, Place, Option<Place>))| {
            let mut response = StationResponse {
                name: station.name.clone(),
                at: station.x,
                angle_rad: station.angle,
                ..StationResponse::default()
            };
            for (k, q) in all.iter().enumerate() {
                let mut seen = self.orbit(i, q);
                if let Some([y, z]) = ground.get(k) {
                    (seen.y, seen.z) = (seen.y + y, seen.z + z);
                }
                let told = match station.angle {
                    Some(angle) => seen.along(angle),
                    None => c64::from_polar(seen.major(), seen.forward().arg()),
                };
                response.amplitude_m.push(factor * told.norm());
                response.phase_rad.push(if told.norm() > 0.0 { told.arg() } else { 0.0 });
                response.major_axis_m.push(factor * seen.major());
                response.minor_axis_m.push(factor * seen.minor());
                response.inclination_rad.push(seen.inclination());
                response.whirl.push(sense(&seen));
                let stress = stress.as_ref().map(|place| orbit(place, q));
                response.bending_stress_pa.push(stress.map(|s| s.major()));
                if in_step {
                    response.alternating_stress_pa.push(stress.map(|s| s.backward().norm()));
                }
            }
            response
        };
        self.stations.iter().take(count).enumerate().map(one).collect()
    }

    /// Forces that the shaft exerts on bearings, and bearings on housings and housings on the ground: `(K + i w C - w^2 M) u` at each
    /// (speed, frequency).
    pub fn forces(&self, all: &[Vec<c64>], at: &[(f64, f64)]) -> Vec<(String, ForceResponse)> {
        let one = |(bearing, x, place): &(&Bearing, f64, Place)| {
            let mut response = ForceResponse { at: *x, ..ForceResponse::default() };
            for (q, &(speed, frequency)) in all.iter().zip(at) {
                let law =
                    bearing.table.as_ref().map_or_else(|| bearing.at_rest(), |t| t.at(speed, frequency));
                let Coefficients { stiffness, damping, mass } = law;
                let u = orbit(place, q);
                let entry = |k: usize, l: usize| {
                    // the mass of a housing is its own, not part of what its springs carry to the ground
                    let inertia =
                        if bearing.holds_shaft() { frequency * frequency * mass[k][l] } else { 0.0 };
                    c64::new(stiffness[k][l] - inertia, frequency * damping[k][l])
                };
                let [y, z] = [0, 1].map(|k| entry(k, 0) * u.y + entry(k, 1) * u.z);
                response.y_n.push(y.norm());
                response.y_phase_rad.push(y.arg());
                response.z_n.push(z.norm());
                response.z_phase_rad.push(z.arg());
                response.major_n.push(Orbit { y, z }.major());
            }
            (bearing.path.clone(), response)
        };
        self.bearings.iter().map(one).collect()
    }
}

/// Sense of an orbit.
fn sense(orbit: &Orbit) -> Whirl {
    let (major, minor) = (orbit.major(), orbit.minor());
    if !(major > 0.0) {
        Whirl::None
    } else if minor > LEAST_CIRCULARITY * major {
        Whirl::Forward
    } else if minor < -LEAST_CIRCULARITY * major {
        Whirl::Backward
    } else {
        Whirl::Mixed
    }
}
