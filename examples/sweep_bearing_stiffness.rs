//! Critical speeds of a rotor over the stiffness of its bearings.

use rotor::Rotor;

/// Sweeps and prints.
pub fn main() -> rotor::Result<()> {
    let mut shaft = Rotor::builder("a disk between two bearings")
        .material("steel", 210e9, 0.3, 7850.0)
        .circle("round", 0.03)
        .segment(1.0, 8, "round", "steel")
        .disk(0.4, 20.0, 0.25, 0.13)
        .speeds(0.0, 1000.0, 21);
    for at in [0.0, 1.0] {
        shaft = shaft.bearing(at, [[1e6, 0.0], [0.0, 1e6]]);
    }
    let shaft = shaft.build()?;
    for k in [1e6, 3e6, 1e7, 3e7, 1e8] {
        let bearing = vec![vec![k, 0.0], vec![0.0, k]];
        let stiffer =
            shaft.with("supports.0.stiffness", bearing.clone())?.with("supports.1.stiffness", bearing)?;
        let criticals = stiffer.campbell()?.results.critical_speeds;
        let rpm: Vec<String> = criticals.iter().map(|c| format!("{:.0}", c.speed_rpm)).collect();
        println!("{k:.0e} N/m: {} rpm", rpm.join(", "));
    }
    Ok(())
}
