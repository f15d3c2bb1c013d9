//! Critical speeds of a rotor over the stiffness of its bearings.

use rotor::Rotor;
use rotor::results::CriticalSpeed;

/// A disk of 20 kg on a shaft between two bearings.
pub fn shaft() -> rotor::Result<Rotor> {
    let mut shaft = Rotor::builder("a disk between two bearings")
        .material("steel", 210e9, 0.3, 7850.0)
        .circle("round", 0.03)
        .segment(1.0, 8, "round", "steel")
        .disk(0.4, 20.0, 0.25, 0.13)
        .speeds(0.0, 1000.0, 21);
    for at in [0.0, 1.0] {
        shaft = shaft.bearing(at, [[1e6, 0.0], [0.0, 1e6]]);
    }
    shaft.build()
}

/// Its critical speeds with another stiffness of both bearings, N/m.
pub fn critical_speeds(shaft: &Rotor, stiffness: f64) -> rotor::Result<Vec<CriticalSpeed>> {
    let bearing = vec![vec![stiffness, 0.0], vec![0.0, stiffness]];
    let other = shaft.with("supports.0.stiffness", bearing.clone())?.with("supports.1.stiffness", bearing)?;
    Ok(other.campbell()?.results.critical_speeds)
}

/// Sweeps and prints.
pub fn main() -> rotor::Result<()> {
    let shaft = shaft()?;
    for stiffness in [1e6, 3e6, 1e7, 3e7, 1e8] {
        let found = critical_speeds(&shaft, stiffness)?;
        let rpm: Vec<String> = found.iter().map(|c| format!("{:.0}", c.speed_rpm)).collect();
        println!("{stiffness:.0e} N/m: {} rpm", rpm.join(", "));
    }
    Ok(())
}
