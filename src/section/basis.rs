//! The vectors of a node: which derivatives of the position there are, in which order, by which names.

/// Exponents `(a, b)` of the section monomials up to total degree `order`, in the order of the
/// vectors of an element: r, y, z, yz, yy, zz, yyz, yzz, yyy, zzz, yyyz, ...: within each degree the
/// mixed monomials by falling power of y, then the pure powers. Lower orders are prefixes of higher ones.
pub fn exponents(order: usize) -> Vec<(usize, usize)> {
    let mut list = vec![(0, 0)];
    for degree in 1..=order {
        list.extend((1..degree).rev().map(|a| (a, degree - a)));
        list.extend([(degree, 0), (0, degree)]);
    }
    list
}

/// Name of a vector: "r" for the position, else the derivative directions ("y", "yz", "yyz", ..).
pub fn vector_name((a, b): (usize, usize)) -> String {
    if a + b == 0 { "r".to_owned() } else { "y".repeat(a) + &"z".repeat(b) }
}

/// The functions of the section that the vectors of a node multiply: data, not code.
///
/// Whatever the basis, the first three are 1, y/R and z/R (R the reference length of the shaft): rigid motions, hubs
/// and the undeformed state look alike in all of them. Source: docs/theory/elements.md#kinematics and
/// docs/theory/rings.md#functions.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum SectionBasis {
    /// Monomials `y^a z^b / (a! b!)` up to a total degree n: 34Xn.
    Monomials(usize),
    /// `P_a(s) cos(m theta)`, `P_a(s) sin(m theta)` with Legendre's P_a in the wall coordinate s, -1 on the bore and 1
    /// on the outer surface: 34Rdh. `P_0 cos(theta)`, `P_0 sin(theta)` are replaced by y and z, of the same span.
    Ring {
        /// Largest a, d >= 1.
        degree: usize,
        /// Largest m, h >= 1.
        harmonics: usize,
    },
}

/// A function `P_a(s) cos(m theta)` or `P_a(s) sin(m theta)` of a ring.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct RingFunction {
    /// Radial factor; `None` for the radius itself (the functions y and z).
    pub degree: Option<usize>,
    /// Waves m around the axis.
    pub waves: usize,
    /// Sine instead of cosine.
    pub sine: bool,
}

/// The functions of a ring in the order of a node's vectors: r, y, z; P_1 .. P_d; `P_a cos, P_a sin` for
/// a = 1 .. d with one wave; then for a = 0 .. d with 2 .. h waves. `(d + 1)(2 h + 1)` in all.
pub fn ring_functions(degree: usize, harmonics: usize) -> Vec<RingFunction> {
    let of = |degree, waves, sine| RingFunction { degree, waves, sine };
    let mut list = vec![of(Some(0), 0, false), of(None, 1, false), of(None, 1, true)];
    list.extend((1..=degree).map(|a| of(Some(a), 0, false)));
    for m in 1..=harmonics {
        for a in usize::from(m == 1)..=degree {
            list.extend([of(Some(a), m, false), of(Some(a), m, true)]);
        }
    }
    list
}

impl SectionBasis {
    /// Number of functions, hence of vectors at a node.
    pub fn count(self) -> usize {
        match self {
            Self::Monomials(n) => (n + 1) * (n + 2) / 2,
            Self::Ring { degree, harmonics } => (degree + 1) * (2 * harmonics + 1),
        }
    }

    /// True for the functions of a ring, which do not reach the axis.
    pub fn is_ring(self) -> bool {
        matches!(self, Self::Ring { .. })
    }

    /// Name of the member 34Xn or 34Rdh.
    pub fn member(self) -> String {
        match self {
            Self::Monomials(n) => format!("34X{n}"),
            Self::Ring { degree, harmonics } => format!("34R{degree}{harmonics}"),
        }
    }

    /// Name of every vector: "r", "y", "yz" for derivatives of the position; "P1", "P0cos2", "P1sin2" for what
    /// multiplies the function of a ring.
    pub fn names(self) -> Vec<String> {
        match self {
            Self::Monomials(n) => exponents(n).into_iter().map(vector_name).collect(),
            Self::Ring { degree, harmonics } => ring_functions(degree, harmonics)
                .into_iter()
                .map(|f| match (f.degree, f.waves, f.sine) {
                    (None, _, false) => "y".to_owned(),
                    (None, _, true) => "z".to_owned(),
                    (Some(0), 0, _) => "r".to_owned(),
                    (Some(a), 0, _) => format!("P{a}"),
                    (Some(a), m, sine) => format!("P{a}{}{m}", if sine { "sin" } else { "cos" }),
                })
                .collect(),
        }
    }

    /// For every function whether it changes its sign under y -> -y and under z -> -z.
    pub fn odd(self) -> Vec<[bool; 2]> {
        match self {
            Self::Monomials(n) => exponents(n).into_iter().map(|(a, b)| [a % 2 == 1, b % 2 == 1]).collect(),
            Self::Ring { degree, harmonics } => ring_functions(degree, harmonics)
                .into_iter()
                .map(|f| [(f.waves + usize::from(f.sine)) % 2 == 1, f.sine])
                .collect(),
        }
    }

    /// For every vector the power k of the reference length in its unknown `R^k r_,(k)`.
    pub fn scales(self) -> Vec<i32> {
        match self {
            Self::Monomials(n) => exponents(n).into_iter().map(|(a, b)| (a + b) as i32).collect(),
            Self::Ring { .. } => (0..self.count()).map(|k| i32::from(k == 1 || k == 2)).collect(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn vectors_come_in_the_published_order() {
        let names: Vec<_> = exponents(4).into_iter().map(vector_name).collect();
        let expected = "r y z yz yy zz yyz yzz yyy zzz yyyz yyzz yzzz yyyy zzzz";
        assert_eq!(names.join(" "), expected);
        for order in 1..6 {
            assert_eq!(exponents(order).len(), (order + 1) * (order + 2) / 2);
        }
    }
}
