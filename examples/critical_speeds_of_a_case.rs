//! Reads a case file and prints its critical speeds, with what the program remarks.
//!
//! `cargo run --release --example critical_speeds_of_a_case -- cases/bauchau.json`

use rotor::{Rotor, results::CriticalSpeed};

/// Critical speeds of a case file, after its remarks.
pub fn critical_speeds(file: &str) -> rotor::Result<Vec<CriticalSpeed>> {
    let found = Rotor::from_file(file)?.campbell()?;
    for remark in &found.diagnostics {
        println!("{}: {}", remark.code, remark.message);
    }
    Ok(found.results.critical_speeds)
}

fn main() -> rotor::Result<()> {
    let file = std::env::args().nth(1).unwrap_or_else(|| "cases/jeffcott.json".to_owned());
    for c in critical_speeds(&file)? {
        println!("{:9.1} rpm  {:?} {:?}", c.speed_rpm, c.whirl, c.kind);
    }
    Ok(())
}
