//! Quantities as written in case files: plain SI numbers, or strings with a unit ("50 mm" is 0.05).

use schemars::{JsonSchema, Schema, SchemaGenerator, json_schema};
use serde::de::IntoDeserializer;
use serde::{Deserialize, Deserializer, Serialize, de};
use std::borrow::Cow;
use std::fmt;
use std::marker::PhantomData;

/// Units of one dimension with their factor to SI.
type Units = &'static [(&'static str, f64)];

const INCH: f64 = 0.0254;
const POUND: f64 = 0.45359237;
const POUND_FORCE: f64 = POUND * 9.80665;
const PSI: f64 = POUND_FORCE / (INCH * INCH);

const LENGTH: Units = &[
    ("m", 1.0),
    ("mm", 1e-3),
    ("um", 1e-6),
    ("km", 1e3),
    ("in", INCH),
    ("inch", INCH),
    ("cm", 1e-2),
    ("mil", 1e-3 * INCH),
];
const STRESS: Units = &[
    ("Pa", 1.0),
    ("kPa", 1e3),
    ("MPa", 1e6),
    ("GPa", 1e9),
    ("psi", PSI),
    ("ksi", 1e3 * PSI),
    ("bar", 1e5),
    ("N/mm^2", 1e6),
];
const MASS: Units =
    &[("kg", 1.0), ("g", 1e-3), ("t", 1e3), ("lb", POUND), ("lbf s^2/in", POUND_FORCE / INCH)];
const FORCE: Units = &[("N", 1.0), ("kN", 1e3), ("MN", 1e6), ("lbf", POUND_FORCE)];
const SPEED: Units = &[
    ("rad/s", 1.0),
    ("rpm", std::f64::consts::PI / 30.0),
    ("Hz", std::f64::consts::TAU),
    ("1/min", std::f64::consts::PI / 30.0),
];
const TIME: Units = &[("s", 1.0), ("ms", 1e-3), ("min", 60.0), ("us", 1e-6)];
const DENSITY: Units = &[("kg/m^3", 1.0), ("g/cm^3", 1e3), ("lb/in^3", POUND / (INCH * INCH * INCH))];
const STIFFNESS: Units = &[
    ("N/m", 1.0),
    ("N/mm", 1e3),
    ("N/um", 1e6),
    ("kN/m", 1e3),
    ("kN/mm", 1e6),
    ("MN/m", 1e6),
    ("lbf/in", POUND_FORCE / INCH),
];
const DAMPING: Units =
    &[("N s/m", 1.0), ("N s/mm", 1e3), ("kN s/m", 1e3), ("kN s/mm", 1e6), ("lbf s/in", POUND_FORCE / INCH)];
const INERTIA: Units = &[
    ("kg m^2", 1.0),
    ("kg mm^2", 1e-6),
    ("g mm^2", 1e-9),
    ("kg cm^2", 1e-4),
    ("lb in^2", POUND * INCH * INCH),
];
const MOMENT: Units = &[("N m", 1.0), ("N mm", 1e-3), ("kN m", 1e3), ("lbf in", POUND_FORCE * INCH)];
const ANGLE: Units = &[("rad", 1.0), ("deg", std::f64::consts::PI / 180.0), ("um/m", 1e-6), ("mm/m", 1e-3)];
const RATE: Units = &[("1/s", 1.0)];
const ACCELERATION: Units = &[("m/s^2", 1.0), ("mm/s^2", 1e-3)];
const VELOCITY: Units = &[("m/s", 1.0), ("mm/s", 1e-3)];
const RIGIDITY: Units = &[("N m^2", 1.0), ("N mm^2", 1e-6)];
const LINEAR_DENSITY: Units = &[("kg/m", 1.0), ("g/mm", 1.0)];
const MOMENT_OF_MASS: Units = &[("kg m", 1.0), ("kg mm", 1e-3), ("g mm", 1e-6)];
const TILT_STIFFNESS: Units = &[
    ("N m/rad", 1.0),
    ("N m", 1.0),
    ("kN m/rad", 1e3),
    ("N mm/rad", 1e-3),
    ("lbf in/rad", POUND_FORCE * INCH),
];
const TILT_DAMPING: Units =
    &[("N m s/rad", 1.0), ("N m s", 1.0), ("N mm s/rad", 1e-3), ("lbf in s/rad", POUND_FORCE * INCH)];
const PENALTY: Units = &[("N/m^3", 1.0), ("MPa/mm", 1e9)];

/// Every dimension by name.
const DIMENSIONS: [(&str, Units); 21] = [
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
    ("stiffness against turning", TILT_STIFFNESS),
    ("damping against turning", TILT_DAMPING),
];

/// Smallest size of a quantity but zero, in SI.
const SMALLEST_SI: f64 = 1e-40;
/// Largest size of a quantity, in SI: products of ten of them are numbers.
const LARGEST_SI: f64 = 1e30;

fn list(units: Units) -> String {
    units.iter().map(|u| u.0).collect::<Vec<_>>().join(", ")
}

/// Length of the number that a text begins with: sign, digits with a point, and an exponent.
fn number_length(text: &str) -> usize {
    let bytes = text.as_bytes();
    let digits = |from: usize| bytes[from..].iter().take_while(|b| b.is_ascii_digit()).count();
    let sign = |at: usize| usize::from(matches!(bytes.get(at), Some(b'+' | b'-')));
    let mut end = sign(0);
    let whole = digits(end);
    end += whole;
    let mut decimals = 0;
    if bytes.get(end) == Some(&b'.') {
        decimals = digits(end + 1);
        end += 1 + decimals;
    }
    if whole + decimals == 0 {
        return 0;
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let first = end + 1 + sign(end + 1);
        // "3 e" is no exponent
        if first < bytes.len() && digits(first) > 0 {
            end = first + digits(first);
        }
    }
    end
}

/// A unit as it is compared: "N*s/m", "N s/m" and "Ns/m" are one.
fn plain_unit(text: &str) -> String {
    let mut plain = String::new();
    for c in text.chars() {
        match c {
            c if c.is_whitespace() || matches!(c, '*' | '\u{b7}' | '\u{22c5}') => {}
            '\u{b5}' | '\u{3bc}' => plain.push('u'),
            '\u{b2}' => plain.push_str("^2"),
            '\u{b3}' => plain.push_str("^3"),
            c => plain.push(c),
        }
    }
    plain
}

/// Reads "12.5 mm" as a quantity of the dimension `name`; a number alone is in SI.
fn parse(text: &str, name: &str, units: Units) -> Result<f64, String> {
    let text = text.trim();
    let hint = format!("write a number in SI or a string with one of: {}", list(units));
    let (number, unit) = text.split_at(number_length(text));
    let Ok(value) = number.parse::<f64>() else {
        return Err(format!("\"{text}\" does not start with a number; {hint}"));
    };
    let unit = unit.trim();
    if unit.starts_with(',') {
        return Err(format!(
            "\"{text}\" has a decimal comma; write a point: \"{}\"",
            text.replacen(',', ".", 1)
        ));
    }
    let plain = plain_unit(unit);
    let same = |known: &str| plain_unit(known) == plain;
    let factor = if unit.is_empty() { Some(1.0) } else { units.iter().find(|u| same(u.0)).map(|u| u.1) };
    if let Some(factor) = factor {
        return within_range(value * factor).map_err(|reason| format!("\"{text}\" {reason}"));
    }
    if let Some((other, _)) = DIMENSIONS.iter().find(|(_, u)| u.iter().any(|u| same(u.0))) {
        return Err(format!("\"{unit}\" is a unit of {other}, but a {name} is needed; {hint}"));
    }
    // units that fit here go before others
    let all = DIMENSIONS.iter().flat_map(|(_, units)| units.iter());
    let near = units
        .iter()
        .chain(all)
        .map(|u| u.0)
        .find(|u| strsim::damerau_levenshtein(&plain_unit(u).to_lowercase(), &plain.to_lowercase()) <= 1)
        .map(|u| format!(", did you mean \"{u}\"?"))
        .unwrap_or_default();
    Err(format!("unknown unit \"{unit}\"{near}; {hint}"))
}

/// SI over a unit of a named dimension, such as 1e3 for "kN" of "force".
///
/// # Errors
/// A unit that is unknown or of another dimension, in words that list those of this one.
pub(crate) fn unit_factor(unit: &str, dimension: &str) -> Result<f64, String> {
    match DIMENSIONS.iter().find(|(name, _)| *name == dimension) {
        Some((name, units)) => parse(&format!("1 {unit}"), name, units),
        None => Err(format!("there is no dimension \"{dimension}\"")),
    }
}

/// What a text with a unit looks like, as a regular expression of JSON Schema.
fn pattern(units: Units) -> String {
    const PRODUCT: &str = "[ *\u{b7}\u{22c5}]*";
    let unit = |name: &str| {
        let mut out = String::new();
        for c in name.chars() {
            match c {
                ' ' => out += PRODUCT,
                'u' => out += "[u\u{b5}\u{3bc}]",
                '^' => out += "\\^",
                c => out.push(c),
            }
        }
        // a raised digit is written in either way
        out.replace("\\^2", "(\\^2|\u{b2})").replace("\\^3", "(\\^3|\u{b3})")
    };
    let all = units.iter().map(|u| unit(u.0)).collect::<Vec<_>>().join("|");
    format!("^\\s*[+-]?([0-9]+\\.?[0-9]*|\\.[0-9]+)([eE][+-]?[0-9]+)?\\s*({all})?\\s*$")
}

/// Refuses sizes whose products would leave the range of numbers.
pub(crate) fn within_range(value: f64) -> Result<f64, String> {
    if value == 0.0 || (SMALLEST_SI..=LARGEST_SI).contains(&value.abs()) {
        Ok(value)
    } else if !value.is_finite() {
        Err("is not a finite number".to_owned())
    } else {
        Err(format!("is an extreme size: 0 or from {SMALLEST_SI:e} to {LARGEST_SI:e} in SI units"))
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
                    "pattern": pattern($units),
                    "minimum": -LARGEST_SI,
                    "maximum": LARGEST_SI,
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
    TiltStiffness "stiffness against turning" TILT_STIFFNESS;
    TiltDamping "damping against turning" TILT_DAMPING;
}

/// A matrix across the axis, [[yy, yz], [zy, zz]]; one number stands for the same in both directions.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Matrix<T>(pub [[T; 2]; 2]);

fn isotropic<T: Zero>(value: T) -> Matrix<T> {
    Matrix([[value, T::ZERO], [T::ZERO, value]])
}

/// A quantity that can be nothing.
trait Zero: Copy {
    const ZERO: Self;
}

impl Zero for Stiffness {
    const ZERO: Self = Self(0.0);
}

impl Zero for Damping {
    const ZERO: Self = Self(0.0);
}

impl Zero for Mass {
    const ZERO: Self = Self(0.0);
}

impl Zero for TiltStiffness {
    const ZERO: Self = Self(0.0);
}

impl Zero for TiltDamping {
    const ZERO: Self = Self(0.0);
}

impl<'de, T: Zero + Deserialize<'de>> Deserialize<'de> for Matrix<T> {
    fn deserialize<D: Deserializer<'de>>(d: D) -> Result<Self, D::Error> {
        d.deserialize_any(MatrixVisitor(PhantomData))
    }
}

struct MatrixVisitor<T>(PhantomData<T>);

impl<'de, T: Zero + Deserialize<'de>> de::Visitor<'de> for MatrixVisitor<T> {
    type Value = Matrix<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a number or a matrix [[yy, yz], [zy, zz]]")
    }
    fn visit_f64<E: de::Error>(self, value: f64) -> Result<Matrix<T>, E> {
        T::deserialize(value.into_deserializer()).map(isotropic)
    }
    fn visit_i64<E: de::Error>(self, value: i64) -> Result<Matrix<T>, E> {
        T::deserialize(value.into_deserializer()).map(isotropic)
    }
    fn visit_u64<E: de::Error>(self, value: u64) -> Result<Matrix<T>, E> {
        T::deserialize(value.into_deserializer()).map(isotropic)
    }
    fn visit_str<E: de::Error>(self, value: &str) -> Result<Matrix<T>, E> {
        T::deserialize(value.into_deserializer()).map(isotropic)
    }
    fn visit_seq<A: de::SeqAccess<'de>>(self, mut rows: A) -> Result<Matrix<T>, A::Error> {
        let mut list = Vec::new();
        while let Some(row) = rows.next_element::<[T; 2]>()? {
            list.push(row);
        }
        let count = list.len();
        <[[T; 2]; 2]>::try_from(list).map(Matrix).map_err(|_| de::Error::invalid_length(count, &self))
    }
}

impl<T: JsonSchema> JsonSchema for Matrix<T> {
    fn schema_name() -> Cow<'static, str> {
        format!("MatrixOf{}", T::schema_name()).into()
    }
    fn json_schema(generator: &mut SchemaGenerator) -> Schema {
        let one = generator.subschema_for::<T>();
        let all = generator.subschema_for::<[[T; 2]; 2]>();
        json_schema!({ "anyOf": [one, all] })
    }
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

    fn same<T: serde::de::DeserializeOwned>(read: impl Fn(T) -> f64, table: &[(&str, f64)]) {
        for (text, value) in table {
            let json = serde_json::Value::from(*text);
            let got = read(serde_json::from_value(json).unwrap_or_else(|e| panic!("{text}: {e}")));
            assert!((got - value).abs() <= 1e-12 * value.abs(), "{text}: {got} for {value}");
        }
    }

    /// Factors from their definitions: the inch is 25.4 mm, the pound 0.45359237 kg, standard gravity 9.80665 m/s^2.
    #[test]
    fn units_as_engineers_write_them() {
        same(
            |l: Length| l.0,
            &[
                ("5mm", 0.005),
                ("1e7", 1e7),
                ("5 inch", 0.127),
                ("3e-3m", 0.003),
                (" 2.5e1\u{3bc}m ", 25e-6),
                (".5 in", 0.0127),
            ],
        );
        same(
            |k: Stiffness| k.0,
            &[("2kN/mm", 2e6), ("3 N/um", 3e6), ("1 lbf/in", 175.12683524647636), ("5 N/\u{b5}m", 5e6)],
        );
        same(
            |c: Damping| c.0,
            &[("4 N*s/m", 4.0), ("4Ns/m", 4.0), ("4 N\u{b7}s/m", 4.0), ("1 N s/mm", 1000.0)],
        );
        same(|i: Inertia| i.0, &[("7 kg mm^2", 7e-6), ("7 kg\u{b7}m\u{b2}", 7.0), ("7 kgm^2", 7.0)]);
        same(|m: MomentOfMass| m.0, &[("200 g mm", 2e-4), ("3 kg mm", 3e-3)]);
        same(|a: Angle| a.0, &[("20 um/m", 2e-5)]);
        same(|s: Speed| s.0, &[("3000 1/min", 314.1592653589793)]);
        same(|s: Stress| s.0, &[("1 psi", 6894.757293168361), ("210 N/mm^2", 2.1e8)]);
    }

    /// One number is the same in y and z; errors within a matrix name the place.
    #[test]
    fn a_number_is_an_isotropic_matrix() {
        let matrix =
            |json: &str| serde_json::from_str::<Matrix<Stiffness>>(json).map(|m| m.0.map(|r| r.map(|k| k.0)));
        for json in ["5e6", "5000000", "\"5 kN/mm\"", "[[5e6, 0], [0, \"5 N/um\"]]"] {
            assert_eq!(matrix(json).unwrap(), [[5e6, 0.0], [0.0, 5e6]], "{json}");
        }
        assert_eq!(matrix("[[1, 2], [-2, 3]]").unwrap(), [[1.0, 2.0], [-2.0, 3.0]]);
        for json in ["[1, 2]", "[[1, 2]]", "[[1, 2], [3, 4], [5, 6]]", "null", "{}", "\"5 m\""] {
            assert!(matrix(json).is_err(), "{json}");
        }
    }

    #[test]
    fn faults_say_what_is_allowed() {
        for (json, said) in [
            ("\"5 mmm\"", "did you mean \"mm\""),
            ("\"5 parsec\"", "unknown unit"),
            ("\"5 GPa\"", "unit of stress"),
            ("\"0,05 m\"", "decimal comma"),
            ("\"5 e\"", "unknown unit"),
            ("\"+ mm\"", "does not start with a number"),
            ("\".mm\"", "does not start with a number"),
            ("\"mm\"", "does not start with a number"),
            ("\"NaN mm\"", "does not start with a number"),
            ("\"inf m\"", "does not start with a number"),
            ("\"-inf m\"", "does not start with a number"),
            ("\"1e999 m\"", "not a finite number"),
            ("true", "a length"),
        ] {
            let message = length(json).unwrap_err();
            assert!(message.contains(said), "{json}: {message}");
        }
    }
}
