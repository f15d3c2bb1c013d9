//! The one error type. Every variant carries the values a user needs to mend the input:
//! where it is, what was found, what is allowed. `exit_code` is the contract of the command line.

use std::fmt::{Display, Formatter};
use std::io::ErrorKind;
use std::path::{Path, PathBuf};

/// Anything that stops an analysis.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum Error {
    /// The case (or a `--set`) does something wrong.
    #[error("{0}")]
    Refused(Refusal),
    /// The file is not JSON.
    #[error("{file}:{line}:{column}: not valid JSON: {message}")]
    Syntax {
        /// Case file as given on the command line.
        file: String,
        /// Line of the fault, from 1.
        line: usize,
        /// Column of the fault, from 1.
        column: usize,
        /// What the parser said.
        message: String,
    },
    /// A file or folder can't be read or written.
    #[error("{}: cannot {action}: {message}\n  remedy:  {remedy}", path.display())]
    Io {
        /// The file or folder.
        path: PathBuf,
        /// "read", "write", ...
        action: &'static str,
        /// What the operating system said.
        message: String,
        /// What the user can do.
        remedy: String,
    },
    /// Text for the terminal was lost.
    #[error(
        "{stream} cannot be written: {message}\n  remedy:  the reports are written; give room or another place to it, or --quiet"
    )]
    Lost {
        /// "standard output" or "standard error".
        stream: &'static str,
        /// What the operating system said.
        message: String,
    },
    /// The command line asks for something that does not exist.
    #[error("{0}")]
    Usage(String),
    /// The input is fine but the computation did not succeed.
    #[error("{what}\n  tried:   {tried}\n  remedy:  {remedy}")]
    Analysis {
        /// What failed.
        what: String,
        /// What was tried.
        tried: String,
        /// What the user can change.
        remedy: String,
    },
}

/// What a case does wrong, whether it shows when the case is read, checked or run.
///
/// Whoever finds it knows the path, the problem and the remedy. The file and the value found there are filled in by
/// [`crate::case::LoadedCase::locate`].
#[derive(Debug, Clone, PartialEq)]
pub struct Refusal {
    /// Case file as given on the command line.
    pub file: Option<String>,
    /// JSON path of the value, e.g. `shaft.segments.0.length`.
    pub path: String,
    /// The offending value as written (shortened).
    pub found: Option<String>,
    /// What is wrong with it, in one sentence.
    pub problem: String,
    /// What is allowed there, or how to mend it.
    pub allowed: String,
}

impl Refusal {
    /// A refusal of the value at a path of the case.
    pub fn at(path: impl Into<String>, problem: impl Into<String>, allowed: impl Into<String>) -> Self {
        let (path, problem, allowed) = (path.into(), problem.into(), allowed.into());
        Self { file: None, path, found: None, problem, allowed }
    }
}

impl Display for Refusal {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        if let Some(file) = &self.file {
            write!(f, "{file}: ")?;
        }
        write!(f, "at `{}`: {}", self.path, self.problem)?;
        if let Some(found) = &self.found {
            write!(f, "\n  found:   {found}")?;
        }
        write!(f, "\n  allowed: {}", self.allowed)
    }
}

impl From<Refusal> for Error {
    fn from(refusal: Refusal) -> Self {
        Error::Refused(refusal)
    }
}

/// `std::result::Result` with [`Error`].
pub type Result<T> = std::result::Result<T, Error>;

impl Error {
    /// 2 for bad input or usage, 1 for an analysis that did not succeed or output that was lost.
    pub fn exit_code(&self) -> u8 {
        match self {
            Error::Analysis { .. } | Error::Lost { .. } => 1,
            _ => 2,
        }
    }

    /// An [`Error::Io`] from the operating system's error.
    pub fn io(path: &Path, action: &'static str, error: &std::io::Error) -> Self {
        let remedy = match error.kind() {
            ErrorKind::NotFound => "check the spelling, and the folder that it is seen from",
            ErrorKind::PermissionDenied => "take a place that you may use, or change its permissions",
            ErrorKind::ReadOnlyFilesystem => "take a place that can be written to: --out",
            ErrorKind::StorageFull | ErrorKind::QuotaExceeded | ErrorKind::FileTooLarge => {
                "free some space there, or write elsewhere with --out"
            }
            ErrorKind::IsADirectory => "name a file: this is a folder",
            ErrorKind::NotADirectory => "name a folder: a part of this path is a file",
            ErrorKind::InvalidData => "a text file in UTF-8",
            ErrorKind::InvalidFilename => "a shorter or simpler name",
            _ => "check that the place exists, is reachable and may be used",
        };
        Error::Io { path: path.to_owned(), action, message: error.to_string(), remedy: remedy.to_owned() }
    }

    /// An [`Error::Lost`] from the operating system's error.
    pub fn lost(stream: &'static str, error: &std::io::Error) -> Self {
        Error::Lost { stream, message: error.to_string() }
    }

    /// An [`Error::Analysis`] of a run that needs more memory than there is.
    pub fn memory(what: &str) -> Self {
        Error::analysis(
            format!("there is not enough memory for {what}"),
            "the memory of this machine, or what it allows this process",
            "fewer elements, a lower order, fewer speeds, outputs or probe points (`rotor check` estimates the need); or a \
             larger machine",
        )
    }

    /// An [`Error::Analysis`] from what failed, what was tried, and what the user can change.
    pub fn analysis(what: impl Into<String>, tried: impl Into<String>, remedy: impl Into<String>) -> Self {
        Error::Analysis { what: what.into(), tried: tried.into(), remedy: remedy.into() }
    }
}
