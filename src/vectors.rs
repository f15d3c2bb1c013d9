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
