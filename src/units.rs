//! Quantities as written in case files: plain SI numbers, or strings with a unit ("50 mm" is 0.05).

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::{Deserialize, Deserializer, Serialize, de};
use std::borrow::Cow;
use std::fmt;

/// Units of one dimension with their factor to SI.
type Units = &'static [(&'static str, f64)];

const LENGTH: Units = &[("m", 1.0), ("mm", 1e-3), ("um", 1e-6), ("km", 1e3), ("in", 0.0254)];
const STRESS: Units = &[("Pa", 1.0), ("kPa", 1e3), ("MPa", 1e6), ("GPa", 1e9), ("psi", 6894.757293168361)];
const MASS: Units = &[("kg", 1.0), ("g", 1e-3), ("t", 1e3), ("lb", 0.45359237)];
const FORCE: Units = &[("N", 1.0), ("kN", 1e3)];
const SPEED: Units = &[("rad/s", 1.0), ("rpm", std::f64::consts::PI / 30.0), ("Hz", std::f64::consts::TAU)];
const TIME: Units = &[("s", 1.0), ("ms", 1e-3), ("min", 60.0)];
const DENSITY: Units = &[("kg/m^3", 1.0), ("g/cm^3", 1e3)];
const STIFFNESS: Units = &[("N/m", 1.0), ("N/mm", 1e3)];
const DAMPING: Units = &[("N s/m", 1.0)];
const INERTIA: Units = &[("kg m^2", 1.0)];
const MOMENT: Units = &[("N m", 1.0)];
const ANGLE: Units = &[("rad", 1.0), ("deg", std::f64::consts::PI / 180.0)];
const RATE: Units = &[("1/s", 1.0)];
const ACCELERATION: Units = &[("m/s^2", 1.0)];
const VELOCITY: Units = &[("m/s", 1.0), ("mm/s", 1e-3)];
const RIGIDITY: Units = &[("N m^2", 1.0)];
const LINEAR_DENSITY: Units = &[("kg/m", 1.0)];
const MOMENT_OF_MASS: Units = &[("kg m", 1.0)];
const PENALTY: Units = &[("N/m^3", 1.0), ("MPa/mm", 1e9)];

/// Every dimension by name.
const DIMENSIONS: [(&str, Units); 19] = [
    ("length", LENGTH),
    ("stress", STRESS),
    ("mass", MASS),
    ("force", FORCE),
    ("speed", SPEED),
    ("time", TIME),
    ("density", DENSITY),
    ("stiffness", STIFFNESS),
    ("damping", DAMPING),
    ("inertia", INERTIA),
    ("moment", MOMENT),
    ("angle", ANGLE),
    ("rate", RATE),
    ("acceleration", ACCELERATION),
    ("velocity", VELOCITY),
    ("bending stiffness", RIGIDITY),
    ("mass per length", LINEAR_DENSITY),
    ("inertia per length", MOMENT_OF_MASS),
    ("pressure per penetration", PENALTY),
];

/// Smallest size of a quantity but zero, in SI.
const SMALLEST: f64 = 1e-40;
/// Largest size of a quantity, in SI: products of ten of them are numbers.
const LARGEST: f64 = 1e30;

fn list(units: Units) -> String {
    units.iter().map(|u| u.0).collect::<Vec<_>>().join(", ")
}

/// Reads "12.5 mm" as a quantity of the dimension `name`.
fn parse(text: &str, name: &str, units: Units) -> Result<f64, String> {
    let text = text.trim();
    let hint = format!("write a number in SI or a string with one of: {}", list(units));
    let end = text.find(char::is_whitespace).unwrap_or(text.len());
    let (number, unit) = (&text[..end], text[end..].trim());
    let value: f64 = match number.parse() {
        Ok(value) if number.starts_with(|c: char| c.is_ascii_digit() || "+-.".contains(c)) => value,
        _ => return Err(format!("\"{text}\" does not start with a number; {hint}")),
    };
    if unit.is_empty() {
        return Err(format!("\"{text}\" has no unit; {hint}"));
    }
    if let Some((_, factor)) = units.iter().find(|u| u.0 == unit) {
        let scaled = value * factor;
        return within_range(scaled).map_err(|reason| format!("\"{text}\" {reason}"));
    }
    if let Some((other, _)) = DIMENSIONS.iter().find(|(_, u)| u.iter().any(|u| u.0 == unit)) {
        return Err(format!("\"{unit}\" is a unit of {other}, but a {name} is needed; {hint}"));
    }
    let all = DIMENSIONS.iter().flat_map(|(_, units)| units.iter().map(|u| u.0));
    let near = all
        .map(|u| (strsim::damerau_levenshtein(&u.to_lowercase(), &unit.to_lowercase()), u))
        .min()
        .filter(|(distance, _)| *distance <= 1)
        .map(|(_, u)| format!(", did you mean \"{u}\"?"))
        .unwrap_or_default();
    Err(format!("unknown unit \"{unit}\"{near}; {hint}"))
}

/// Refuses sizes whose products would leave the range of numbers.
fn within_range(value: f64) -> Result<f64, String> {
    if value == 0.0 || (SMALLEST..=LARGEST).contains(&value.abs()) {
        Ok(value)
    } else if !value.is_finite() {
        Err("is not a finite number".to_owned())
    } else {
        Err(format!("is an extreme size: 0 or from {SMALLEST:e} to {LARGEST:e} in SI units"))
    }
}

struct QuantityVisitor {
    name: &'static str,
    units: Units,
}

impl de::Visitor<'_> for QuantityVisitor {
    type Value = f64;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "a {}: a number in SI or a string with one of: {}", self.name, list(self.units))
    }
    fn visit_f64<E: de::Error>(self, value: f64) -> Result<f64, E> {
        within_range(value).map_err(|reason| E::custom(format!("{value:e} {reason}")))
    }
    fn visit_i64<E: de::Error>(self, value: i64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_u64<E: de::Error>(self, value: u64) -> Result<f64, E> {
        Ok(value as f64)
    }
    fn visit_str<E: de::Error>(self, text: &str) -> Result<f64, E> {
        parse(text, self.name, self.units).map_err(E::custom)
    }
}

macro_rules! quantities {
    ($($type:ident $name:literal $units:ident;)*) => {$(
        #[doc = concat!("A ", $name, " in SI.")]
        #[derive(Debug, Clone, Copy, PartialEq, Serialize)]
        pub struct $type(pub f64);

        impl<'de> Deserialize<'de> for $type {
            fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
                d.deserialize_any(QuantityVisitor { name: $name, units: $units }).map($type)
            }
        }

        impl JsonSchema for $type {
            fn schema_name() -> Cow<'static, str> {
                stringify!($type).into()
            }
            fn json_schema(_: &mut SchemaGenerator) -> Schema {
                json_schema!({
                    "type": ["number", "string"],
                    "description": format!("A {} in SI, or a string with one of the units: {}", $name, list($units)),
                })
            }
        }
    )*};
}

quantities! {
    Length "length" LENGTH;
    Stress "stress" STRESS;
    Mass "mass" MASS;
    Force "force" FORCE;
    Speed "speed" SPEED;
    Time "time" TIME;
    Density "density" DENSITY;
    Stiffness "stiffness" STIFFNESS;
    Damping "damping" DAMPING;
    Inertia "inertia" INERTIA;
    Moment "moment" MOMENT;
    Rate "rate" RATE;
    Acceleration "acceleration" ACCELERATION;
    Angle "angle" ANGLE;
    Velocity "velocity" VELOCITY;
    Rigidity "bending stiffness" RIGIDITY;
    LinearDensity "mass per length" LINEAR_DENSITY;
    MomentOfMass "inertia per length" MOMENT_OF_MASS;
    PenaltyModulus "pressure per penetration" PENALTY;
}

#[cfg(test)]
mod tests {
    use super::*;

    fn length(json: &str) -> Result<f64, String> {
        serde_json::from_str::<Length>(json).map(|l| l.0).map_err(|e| e.to_string())
    }

    #[test]
    fn numbers_and_units() {
        for (json, value) in [("0.05", 0.05), ("3", 3.0), ("\"50 mm\"", 0.05), ("\"-2 in\"", -0.0508)] {
            assert!((length(json).unwrap() - value).abs() < 1e-15);
        }
        let speed: Speed = serde_json::from_str("\"15000 rpm\"").unwrap();
        assert!((speed.0 - 1570.7963267948967).abs() < 1e-9);
        let damping: Damping = serde_json::from_str("\"1e3 N s/m\"").unwrap();
        assert_eq!(damping.0, 1000.0);
    }

    #[test]
    fn faults_say_what_is_allowed() {
        for (json, said) in [
            ("\"5 mmm\"", "did you mean \"mm\""),
            ("\"5 parsec\"", "unknown unit"),
            ("\"5 GPa\"", "unit of stress"),
            ("\"5\"", "no unit"),
            ("\"mm\"", "does not start with a number"),
            ("\"NaN mm\"", "does not start with a number"),
            ("\"inf m\"", "does not start with a number"),
            ("\"-inf m\"", "not a finite number"),
            ("\"1e999 m\"", "not a finite number"),
            ("true", "a length"),
        ] {
            let message = length(json).unwrap_err();
            assert!(message.contains(said), "{json}: {message}");
        }
    }
}
