//! Materials and sections.

use crate::case;
use crate::check::{Input, Named};
use crate::error::Result;
use crate::model::Material;
use crate::section::{Section, Shape};
use crate::units::Length;
use std::collections::BTreeMap;

impl Input<'_> {
    pub(super) fn materials(&self) -> Result<Named<Material>> {
        let (mut list, mut names) = (Vec::new(), Vec::new());
        for (name, m) in &self.case.materials {
            let at = |key: &str| format!("materials.{name}.{key}");
            if !(m.nu > -1.0 && m.nu < 0.5) {
                return self.fault(
                    &at("nu"),
                    "Poisson's ratio is out of range",
                    "above -1 and below 0.5 (0.5 itself is incompressible: use 0.4999)",
                );
            }
            list.push(Material {
                youngs_modulus: self.positive(&at("E"), m.youngs_modulus.0)?,
                poisson_ratio: m.nu,
                density: self.positive(&at("rho"), m.rho.0)?,
                loss_factor: self.within(&at("damping.loss_factor"), m.damping.loss_factor, 0.0, 1.0)?,
                stiffness_damping: self.not_negative(&at("damping.stiffness"), m.damping.stiffness.0)?,
                mass_damping: self.not_negative(&at("damping.mass"), m.damping.mass.0)?,
            });
            names.push(name.clone());
        }
        Ok((list, names))
    }

    pub(super) fn sections(&self) -> Result<Named<Section>> {
        let (mut list, mut names) = (Vec::new(), Vec::new());
        for (name, section) in &self.case.sections {
            list.push(self.section(name, section)?);
            names.push(name.clone());
        }
        Ok((list, names))
    }

    /// A radius given by itself or by its diameter.
    pub(super) fn radius(
        &self,
        at: &dyn Fn(&str) -> String,
        [radius, diameter]: [&str; 2],
        given: [Option<Length>; 2],
    ) -> Result<Option<Length>> {
        match given {
            [Some(_), Some(_)] => self.fault(
                &at(diameter),
                format!("\"{radius}\" and \"{diameter}\" say the same"),
                "one of both",
            ),
            [None, Some(d)] if !(d.0 >= 0.0) => {
                self.fault(&at(diameter), "must not be negative", "0 or more")
            }
            [None, Some(d)] => Ok(Some(Length(d.0 / 2.0))),
            [radius, None] => Ok(radius),
        }
    }

    fn section(&self, name: &str, s: &case::SectionInput) -> Result<Section> {
        let at = |key: &str| format!("sections.{name}.{key}");
        let given = [
            ("radius", self.radius(&at, ["radius", "diameter"], [s.radius, s.diameter])?),
            (
                "outer_radius",
                self.radius(&at, ["outer_radius", "outer_diameter"], [s.outer_radius, s.outer_diameter])?,
            ),
            (
                "inner_radius",
                self.radius(&at, ["inner_radius", "inner_diameter"], [s.inner_radius, s.inner_diameter])?,
            ),
            ("semi_axis_y", s.semi_axis_y),
            ("semi_axis_z", s.semi_axis_z),
            ("inner_semi_axis_y", s.inner_semi_axis_y),
            ("inner_semi_axis_z", s.inner_semi_axis_z),
            ("height", s.height),
            ("width", s.width),
        ];
        let (shape, required, optional): (_, &[&str], &[&str]) = match s.shape {
            case::SectionShape::Circle => ("circle", &["radius"], &[]),
            case::SectionShape::Tube => ("tube", &["outer_radius", "inner_radius"], &[]),
            case::SectionShape::Ellipse => {
                ("ellipse", &["semi_axis_y", "semi_axis_z"], &["inner_semi_axis_y", "inner_semi_axis_z"])
            }
            case::SectionShape::Rectangle => ("rectangle", &["height", "width"], &[]),
        };
        let keys = [required, optional].concat();
        let takes = format!(
            "a {shape} takes {}{}",
            keys.join(", "),
            if shape == "circle" || shape == "tube" { " (or the diameters)" } else { "" }
        );
        let mut value = BTreeMap::new();
        for (key, length) in given {
            // a radius that was written as a diameter is complained of as that
            let written = key.replace("radius", "diameter");
            let is_diameter = self.is_written(&at(&written));
            let path = if is_diameter && written != key { at(&written) } else { at(key) };
            match length {
                Some(_) if !keys.contains(&key) => {
                    return self.fault(&path, format!("a {shape} has no \"{key}\""), takes);
                }
                Some(length) if key.starts_with("inner") => {
                    value.insert(key, self.not_negative(&path, length.0)?);
                }
                Some(length) => {
                    value.insert(key, self.length(&path, length.0)?);
                }
                None if required.contains(&key) => {
                    return self.fault(&path, format!("a {shape} needs \"{key}\""), takes);
                }
                None => {}
            }
        }
        self.outline(name, s.shape, &value)
    }

    /// The section of checked sizes by key.
    fn outline(&self, name: &str, shape: case::SectionShape, value: &BTreeMap<&str, f64>) -> Result<Section> {
        let at = |key: &str| format!("sections.{name}.{key}");
        let get = |key: &str| value.get(key).copied().unwrap_or(0.0);
        let [ky, kz] = match shape {
            case::SectionShape::Tube => ["inner_radius", "inner_radius"],
            _ => ["inner_semi_axis_y", "inner_semi_axis_z"],
        };
        let (shape, outer) = match shape {
            case::SectionShape::Circle => (Shape::Ellipse, [get("radius"); 2]),
            case::SectionShape::Tube => (Shape::Ellipse, [get("outer_radius"); 2]),
            case::SectionShape::Ellipse => (Shape::Ellipse, [get("semi_axis_y"), get("semi_axis_z")]),
            case::SectionShape::Rectangle => (Shape::Rectangle, [get("height") / 2.0, get("width") / 2.0]),
        };
        let inner = [get(ky), get(kz)];
        for (key, i) in [(ky, 0), (kz, 1)] {
            if inner[i] >= outer[i] {
                let written = key.replace("radius", "diameter");
                let path = if self.is_written(&at(&written)) { at(&written) } else { at(key) };
                return self.fault(
                    &path,
                    "the bore is not smaller than the outside",
                    format!("below {} m in radius", outer[i]),
                );
            }
        }
        if (inner[0] == 0.0) != (inner[1] == 0.0) {
            return self.fault(
                &format!("sections.{name}"),
                "a bore needs both semi-axes",
                "both above 0, or neither",
            );
        }
        Ok(Section { shape, outer, inner })
    }
}
