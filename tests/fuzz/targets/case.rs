//! Case files as bytes: read, checked, and what `rotor check` says of them; see CONTRIBUTING.md.
#![no_main]

use libfuzzer_sys::fuzz_target;
use rotor::analysis::check::check;
use rotor::case::Case;
use rotor::model::Model;

fuzz_target!(|text: &[u8]| {
    let text = String::from_utf8_lossy(text);
    let checked =
        Case::parse("fuzzed.json", &text, &[]).and_then(|loaded| check(&Model::new(&loaded)?).map(drop));
    if let Err(error) = checked {
        assert_eq!(error.exit_code(), 2, "{error}");
    }
});
