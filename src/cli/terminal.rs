//! Standard output and standard error: nothing that steers a terminal goes there, and text that is lost is a fault.

use crate::error::{Error, Result};
use crate::report::printable;
use std::io::{ErrorKind, Write};

/// Results, to standard output.
///
/// # Errors
/// When they can't be written; a reader that closed early (`rotor ... | head`) is no fault of the run.
pub(super) fn print(text: &str) -> Result<()> {
    let mut out = std::io::stdout().lock();
    written("standard output", out.write_all(printable::lines(text).as_bytes()).and_then(|()| out.flush()))
}

/// A line of notes or errors, to standard error.
///
/// # Errors
/// As [`print()`].
pub(super) fn say(text: &str) -> Result<()> {
    let text = printable::lines(text) + "\n";
    written("standard error", std::io::stderr().lock().write_all(text.as_bytes()))
}

/// What a write to a stream of the process says of the run.
///
/// # Errors
/// When something was lost that somebody waits for.
pub(super) fn written(stream: &'static str, result: std::io::Result<()>) -> Result<()> {
    match result {
        Err(e) if e.kind() != ErrorKind::BrokenPipe => Err(Error::lost(stream, &e)),
        _ => Ok(()),
    }
}
