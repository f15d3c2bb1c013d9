//! Bearings, seals and housings: their springs, dampers and masses.

use crate::case;
use crate::check::mesh::Mesh;
use crate::check::{Input, LARGEST_SI};
use crate::error::Result;
use crate::model::{ActsOn, Bearing, BearingTable, Between, Coefficients, Housing, Resists};
use crate::units::Matrix;

/// Farthest that a bearing stands from the undeformed axis, m.
const LARGEST_OFFSET_M: f64 = 1e15;
/// Keys of a bearing besides at and kind.
pub(super) const OF_BEARINGS: [&str; 13] = [
    "offset",
    "stiffness",
    "table",
    "damping",
    "mass",
    "axial_stiffness",
    "axial_damping",
    "tilt_stiffness",
    "tilt_damping",
    "torsional_stiffness",
    "torsional_damping",
    "housing",
    "acts_on",
];

/// Bearings with the housings they stand in.
#[derive(Default)]
pub(super) struct Bearings {
    pub list: Vec<Bearing>,
    pub housings: Vec<Housing>,
    /// Index of each shared housing that a bearing stands in, by its name.
    named: Vec<(String, usize)>,
}

/// What a law is written in: rows over displacements across the axis, or one direction.
type LawMatrix = [[f64; 2]; 2];

/// The numbers of a matrix as written.
macro_rules! numbers {
    ($matrix:expr) => {
        $matrix.as_ref().map(|Matrix(rows)| rows.map(|row| row.map(|v| v.0)))
    };
}

/// One number as the first entry of a law.
macro_rules! first {
    ($value:expr) => {
        $value.as_ref().map(|v| [[v.0, 0.0], [0.0, 0.0]])
    };
}

impl Input<'_> {
    /// No bearings yet; refuses shared housings that no bearing stands in.
    pub(super) fn bearings(&self) -> Result<Bearings> {
        let refers = |name: &str| {
            let housings = self.case.supports.iter().filter_map(|s| s.housing.as_ref());
            housings.filter_map(|h| h.name.as_ref()).any(|n| n == name)
        };
        if let Some(name) = self.case.housings.keys().find(|name| !refers(name)) {
            return self.fault(
                &format!("housings.{name}"),
                "no bearing stands in this housing",
                format!("a bearing with \"housing\": {{ \"ref\": \"{name}\" }}, or no such housing"),
            );
        }
        Ok(Bearings::default())
    }

    /// Adds the springs of a bearing and, where it has one of its own, those of its housing.
    pub(super) fn bearing(
        &self,
        path: &str,
        s: &case::SupportInput,
        (node, acts_on, kind): (usize, ActsOn, case::SupportKindInput),
        bearings: &mut Bearings,
    ) -> Result<()> {
        let seal = kind == case::SupportKindInput::Seal;
        let offset = s.offset.map_or([0.0; 2], |o| o.map(|c| c.0));
        for (c, value) in offset.iter().enumerate() {
            self.within(&format!("{path}.offset.{c}"), value.abs(), 0.0, LARGEST_OFFSET_M)?;
        }
        let add = |resists, between, law: Coefficients, table| {
            let Coefficients { stiffness, damping, mass } = law;
            let path = path.to_owned();
            let offset = if resists == Resists::Lateral { offset } else { [0.0; 2] };
            Bearing { node, between, resists, stiffness, damping, mass, table, offset, acts_on, seal, path }
        };
        let others = [
            (Resists::Axial, "axial_", first!(s.axial_stiffness), first!(s.axial_damping)),
            (Resists::Tilt, "tilt_", numbers!(s.tilt_stiffness), numbers!(s.tilt_damping)),
            (Resists::Torsion, "torsional_", first!(s.torsional_stiffness), first!(s.torsional_damping)),
        ];
        let other = others.iter().any(|o| o.2.is_some() || o.3.is_some());
        if let Some((law, table)) = self.lateral(path, s, other)? {
            let between = match &s.housing {
                None => Between::ShaftAndGround,
                Some(housing) => {
                    self.must_hold(path, &law, table.as_ref())?;
                    let path = format!("{path}.housing");
                    Between::ShaftAndHousing(self.housing(&path, housing, node, bearings)?)
                }
            };
            bearings.list.push(add(Resists::Lateral, between, law, table));
        }
        for (resists, prefix, stiffness, damping) in others {
            if stiffness.is_none() && damping.is_none() {
                continue;
            }
            let (stiffness, damping) = (stiffness.unwrap_or_default(), damping.unwrap_or_default());
            let names = [format!("{prefix}stiffness"), format!("{prefix}damping")];
            self.law_sizes(path, [(&names[0], &stiffness), (&names[1], &damping)])?;
            let law = Coefficients { stiffness, damping, mass: LawMatrix::default() };
            bearings.list.push(add(resists, Between::ShaftAndGround, law, None));
        }
        Ok(())
    }

    /// The law of a bearing across the axis, at standstill and over speed; `None` for one that resists other motions only.
    fn lateral(
        &self,
        path: &str,
        s: &case::SupportInput,
        other: bool,
    ) -> Result<Option<(Coefficients, Option<BearingTable>)>> {
        let given = [
            ("stiffness", s.stiffness.is_some()),
            ("damping", s.damping.is_some()),
            ("mass", s.mass.is_some()),
            ("housing", s.housing.is_some()),
        ];
        if let Some(table) = &s.table {
            if let Some((key, _)) = given[..3].iter().find(|k| k.1) {
                return self.fault(
                    &format!("{path}.{key}"),
                    "a bearing has a table or constant coefficients, not both",
                    "\"table\"; or \"stiffness\", \"damping\" and \"mass\"",
                );
            }
            let path = format!("{path}.table");
            let table = self.bearing_table(&path, table)?;
            for (i, row) in table.rows().iter().enumerate() {
                self.added_mass(&format!("{path}.{i}.mass"), &row.mass)?;
            }
            return Ok(Some((table.at(0.0, 0.0), Some(table))));
        }
        let Some(stiffness) = numbers!(s.stiffness) else {
            if other && given.iter().all(|k| !k.1) {
                return Ok(None);
            }
            return self.fault(
                &format!("{path}.stiffness"),
                "a bearing needs its stiffness",
                "one number (the same in y and z) or [[kyy, kyz], [kzy, kzz]], N/m; or a table",
            );
        };
        let damping = numbers!(s.damping).unwrap_or_default();
        let mass = numbers!(s.mass).unwrap_or_default();
        self.law_sizes(path, [("stiffness", &stiffness), ("damping", &damping)])?;
        self.added_mass(&format!("{path}.mass"), &mass)?;
        Ok(Some((Coefficients { stiffness, damping, mass }, None)))
    }

    /// Refuses springs between shaft and housing that let go of each other at some speed.
    fn must_hold(&self, path: &str, law: &Coefficients, table: Option<&BearingTable>) -> Result<()> {
        let rows = table.map_or(std::slice::from_ref(law), |table| table.rows());
        if rows.iter().all(|row| is_positive(&row.stiffness)) {
            return Ok(());
        }
        let key = if table.is_some() { "table" } else { "stiffness" };
        self.fault(
            &format!("{path}.{key}"),
            "springs between shaft and housing must hold each other",
            "a symmetric part that is positive definite: kyy > 0, kzz > 0, ((kyz + kzy)/2)^2 < kyy kzz",
        )
    }

    /// The index of the housing of a bearing at a node; a new one, or one that is shared.
    fn housing(
        &self,
        path: &str,
        h: &case::HousingInput,
        node: usize,
        bearings: &mut Bearings,
    ) -> Result<usize> {
        let own = [
            ("mass", h.mass.is_some()),
            ("stiffness", h.stiffness.is_some()),
            ("damping", h.damping.is_some()),
        ];
        let Some(name) = &h.name else {
            let (Some(Matrix(mass)), Some(Matrix(stiffness))) = (h.mass, h.stiffness) else {
                let missing = own.iter().find(|k| !k.1).map_or("mass", |k| k.0);
                return self.fault(
                    &format!("{path}.{missing}"),
                    format!("the housing's \"{missing}\" is missing"),
                    "mass and stiffness (and damping), or ref with the name of one in `housings`",
                );
            };
            let law = [stiffness.map(|row| row.map(|k| k.0)), numbers!(h.damping).unwrap_or_default()];
            return self.new_housing(path, (law, mass.map(|row| row.map(|m| m.0))), node, bearings);
        };
        if let Some((key, _)) = own.iter().find(|k| k.1) {
            return self.fault(
                &format!("{path}.{key}"),
                "a housing is given by name or by its own values, not both",
                "ref alone, or mass, stiffness and damping",
            );
        }
        if let Some((_, index)) = bearings.named.iter().find(|(n, _)| n == name) {
            return Ok(*index);
        }
        let names: Vec<String> = self.case.housings.keys().cloned().collect();
        self.named(&format!("{path}.ref"), "housing", name, &names)?;
        let Some(shared) = self.case.housings.get(name) else { return Ok(0) };
        let law = [
            numbers!(Some(shared.stiffness)).unwrap_or_default(),
            numbers!(shared.damping).unwrap_or_default(),
        ];
        let mass = numbers!(Some(shared.mass)).unwrap_or_default();
        let index = self.new_housing(&format!("housings.{name}"), (law, mass), node, bearings)?;
        bearings.named.push((name.clone(), index));
        Ok(index)
    }

    fn new_housing(
        &self,
        path: &str,
        ([stiffness, damping], mass): ([LawMatrix; 2], LawMatrix),
        node: usize,
        bearings: &mut Bearings,
    ) -> Result<usize> {
        self.law_sizes(path, [("stiffness", &stiffness), ("damping", &damping)])?;
        self.added_mass(&format!("{path}.mass"), &mass)?;
        if !is_positive(&mass) {
            return self.fault(
                &format!("{path}.mass"),
                "a housing needs mass in both directions",
                "myy > 0, mzz > 0 and myz^2 < myy mzz; springs in series without a mass between are one spring",
            );
        }
        if !is_positive(&stiffness) {
            return self.fault(
                &format!("{path}.stiffness"),
                "nothing holds the housing",
                "a symmetric part that is positive definite: kyy > 0, kzz > 0, ((kyz + kzy)/2)^2 < kyy kzz",
            );
        }
        bearings.housings.push(Housing { node, path: path.to_owned() });
        let index = bearings.housings.len() - 1;
        bearings.list.push(Bearing {
            node,
            between: Between::HousingAndGround(index),
            resists: Resists::Lateral,
            stiffness,
            damping,
            mass,
            table: None,
            offset: [0.0; 2],
            acts_on: ActsOn::Section,
            seal: false,
            path: path.to_owned(),
        });
        Ok(index)
    }

    /// Adds the springs of the couplings.
    pub(super) fn couplings(&self, mesh: &Mesh, length: f64, bearings: &mut Bearings) -> Result<()> {
        for (i, c) in self.case.couplings.iter().enumerate() {
            let path = format!("couplings.{i}");
            let node = mesh.node_at(c.at.0);
            if !mesh.nodes[node].coupled {
                return self.fault(
                    &format!("{path}.at"),
                    "a coupling joins two parts of the shaft: it can't stand at an end",
                    format!("above 0 and below {length} m, no two at one place"),
                );
            }
            self.nothing_else_at(&path, node, mesh)?;
            let laws = [
                (Resists::Lateral, "", numbers!(Some(c.stiffness)), numbers!(c.damping)),
                (Resists::Axial, "axial_", first!(Some(c.axial_stiffness)), first!(c.axial_damping)),
                (Resists::Tilt, "tilt_", numbers!(Some(c.tilt_stiffness)), numbers!(c.tilt_damping)),
                (
                    Resists::Torsion,
                    "torsional_",
                    first!(Some(c.torsional_stiffness)),
                    first!(c.torsional_damping),
                ),
            ];
            for (resists, prefix, stiffness, damping) in laws {
                let (stiffness, damping) = (stiffness.unwrap_or_default(), damping.unwrap_or_default());
                let names = [format!("{prefix}stiffness"), format!("{prefix}damping")];
                self.law_sizes(&path, [(&names[0], &stiffness), (&names[1], &damping)])?;
                let across = matches!(resists, Resists::Lateral | Resists::Tilt);
                if !(if across { is_positive(&stiffness) } else { stiffness[0][0] > 0.0 }) {
                    return self.fault(
                        &format!("{path}.{}", names[0]),
                        "the coupling lets go of its other half in a direction",
                        "a stiffness above 0 in every direction; a small one where the coupling is soft",
                    );
                }
                bearings.list.push(Bearing {
                    node,
                    between: Between::Halves,
                    resists,
                    stiffness,
                    damping,
                    mass: LawMatrix::default(),
                    table: None,
                    offset: [0.0; 2],
                    acts_on: ActsOn::Section,
                    seal: false,
                    path: path.clone(),
                });
            }
        }
        Ok(())
    }

    /// Refuses what stands at the place of a coupling: it would hold one of the halves.
    fn nothing_else_at(&self, path: &str, node: usize, mesh: &Mesh) -> Result<()> {
        let disks = self.case.disks.iter().map(|d| d.at.0);
        let supports = self.case.supports.iter().map(|s| s.at.0);
        let loads = self.case.loads.iter().filter_map(|l| l.at.map(|at| at.0));
        let mut all = disks.chain(supports).chain(loads);
        if all.any(|x| mesh.node_at(x) == node) {
            return self.fault(
                &format!("{path}.at"),
                "a disk, support or load stands at the coupling: of which half is not said",
                "a place beside it for either",
            );
        }
        let twice = self.case.couplings.iter().filter(|c| mesh.node_at(c.at.0) == node).count() > 1;
        if twice {
            return self.fault(
                &format!("{path}.at"),
                "two couplings stand at one place",
                "one coupling at a place",
            );
        }
        Ok(())
    }

    /// Refuses entries that leave no digits.
    fn law_sizes<'a>(&self, path: &str, laws: [(&'a str, &'a LawMatrix); 2]) -> Result<()> {
        for (key, law) in laws {
            for (place, value) in law.iter().flatten().enumerate() {
                let entry = format!("{path}.{key}.{}.{}", place / 2, place % 2);
                let entry = if self.is_written(&entry) { entry } else { format!("{path}.{key}") };
                self.within(&entry, value.abs(), 0.0, LARGEST_SI)?;
            }
        }
        Ok(())
    }

    /// Refuses a mass that is not symmetric, or negative in a direction.
    fn added_mass(&self, path: &str, [[yy, yz], [zy, zz]]: &LawMatrix) -> Result<()> {
        for value in [yy, yz, zy, zz] {
            self.within(path, value.abs(), 0.0, LARGEST_SI)?;
        }
        if yz != zy || *yy < 0.0 || *zz < 0.0 || yz * zy > yy * zz * (1.0 + 1e-12) {
            return self.fault(
                path,
                "the mass is not symmetric, or negative in a direction",
                "one number of at least 0, or [[myy, myz], [myz, mzz]] with myy >= 0, mzz >= 0 and myz^2 <= myy mzz",
            );
        }
        Ok(())
    }
}

/// True when the symmetric part is positive definite.
fn is_positive([[yy, yz], [zy, zz]]: &LawMatrix) -> bool {
    let off = (yz + zy) / 2.0;
    *yy > 0.0 && *zz > 0.0 && off * off < yy * zz
}
