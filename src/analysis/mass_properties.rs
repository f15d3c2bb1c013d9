//! Mass, centre of mass and inertia of a rotor.

use crate::element::quadrature::gauss;
use crate::element::taper;
use crate::model::Model;

/// Mass properties of the undeformed rotor.
#[derive(Debug, Clone, Copy, Default)]
pub struct Properties {
    /// Mass of the shaft, kg.
    pub shaft: f64,
    /// Mass of the disks, kg.
    pub disks: f64,
    /// Centre of mass, m.
    pub center: [f64; 3],
    /// Polar inertia about the shaft axis, kg m^2.
    pub polar: f64,
    /// Inertia about y and z axes through the centre of mass, kg m^2.
    pub diametral: [f64; 2],
}

impl Properties {
    /// Total mass, kg.
    pub fn mass(&self) -> f64 {
        self.shaft + self.disks
    }
}

/// Mass, centre of mass and inertia from the closed forms of sections and disks.
pub fn properties(model: &Model) -> Properties {
    let mut p = Properties::default();
    // first moments, and second moments about the left end of the axis
    let (mut first, mut xx, mut yy, mut zz) = ([0.0; 3], 0.0, 0.0, 0.0);
    for element in &model.elements {
        let (section, density) =
            (&model.sections[element.section], model.materials[element.material].density);
        let (a, b) = (element.x, element.x + element.length);
        if element.carried.added_mass != 0.0 {
            let mass = element.carried.added_mass * element.length;
            p.shaft += mass;
            first[0] += mass * (a + b) / 2.0;
            xx += mass * (a * a + a * b + b * b) / 3.0;
        }
        if element.is_tapered() {
            // moments of the fourth degree in x
            for (xi, weight) in gauss(3) {
                let section = taper::at(model.faces(element), xi);
                let share = density * weight * element.length / 2.0;
                let (x, mass) = ((a + b + (b - a) * xi) / 2.0, share * section.area());
                p.shaft += mass;
                first[0] += mass * x;
                xx += mass * x * x;
                yy += share * section.moment(2, 0);
                zz += share * section.moment(0, 2);
            }
            continue;
        }
        let mass = density * section.area() * element.length;
        p.shaft += mass;
        first[0] += mass * (a + b) / 2.0;
        xx += mass * (a * a + a * b + b * b) / 3.0;
        yy += density * section.moment(2, 0) * element.length;
        zz += density * section.moment(0, 2) * element.length;
    }
    for disk in &model.disks {
        let x = model.nodes[disk.node].x;
        let [dy, dz] = disk.offset;
        p.disks += disk.mass;
        for (sum, at) in first.iter_mut().zip([x, dy, dz]) {
            *sum += disk.mass * at;
        }
        xx += disk.mass * x * x + disk.diametral_inertia - disk.polar_inertia / 2.0;
        yy += disk.mass * dy * dy + disk.polar_inertia / 2.0;
        zz += disk.mass * dz * dz + disk.polar_inertia / 2.0;
    }
    let mass = p.mass();
    p.center = first.map(|s| s / mass);
    let [cx, cy, cz] = p.center;
    p.polar = yy + zz;
    p.diametral = [xx + zz - mass * (cx * cx + cz * cz), xx + yy - mass * (cx * cx + cy * cy)];
    p
}
