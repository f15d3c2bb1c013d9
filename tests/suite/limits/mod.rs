//! Extremes of geometry, material, mesh, supports, speed, tolerance and time: every cell is within its bound or says so.

mod cell;
mod linear;

use cell::Cell;

fn print(list: &[Cell]) {
    for c in list {
        println!(
            "{:26} {:22} {:40} err {:9.1e} noise {:9.1e} {:8} {:?} {:?}",
            c.family, c.name, c.quantity, c.error.unwrap_or(f64::NAN), c.noise.unwrap_or(f64::NAN), c.verdict(), c.said, c.refused
        );
    }
}

#[test]
fn slenderness() {
    print(&linear::slenderness());
}
#[test]
fn walls() {
    print(&linear::walls());
}
#[test]
fn poisson() {
    print(&linear::poisson());
}
#[test]
fn units() {
    print(&linear::units());
}
#[test]
fn meshes() {
    print(&linear::meshes());
}
#[test]
fn bearings() {
    print(&linear::bearings());
}
