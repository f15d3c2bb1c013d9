//! How the first bending frequency of a shaft in two pins settles as the mesh is refined, and at which rate.

use rotor::Rotor;

/// First bending frequency, Hz, with a number of elements.
pub fn first_bending(elements: usize) -> rotor::Result<f64> {
    let shaft = Rotor::builder("a shaft in two pins")
        .material("steel", 210e9, 0.3, 7850.0)
        .circle("round", 0.05)
        .segment(2.0, elements, "round", "steel")
        .support(0.0, "pinned")
        .support(2.0, "roller")
        .build()?;
    let modes = shaft.modes()?.results.modes;
    let bending = modes.iter().find(|mode| mode.kind == rotor::results::ModeKind::Bending);
    Ok(bending.map_or(f64::NAN, |mode| mode.frequency_hz))
}

fn main() -> rotor::Result<()> {
    let finest = first_bending(32)?;
    let mut before: Option<f64> = None;
    for elements in [1, 2, 4, 8] {
        let frequency = first_bending(elements)?;
        let error = (frequency / finest - 1.0).abs();
        let order = before.map_or("-".to_owned(), |before| format!("{:.1}", (before / error).log2()));
        println!("{elements:3} elements: {frequency:.6} Hz, {error:.1e} above 32 elements, order {order}");
        before = Some(error);
    }
    Ok(())
}
