//! Writing files whole or not at all: everything is computed first, written to temporary names in the
//! target folder, and renamed only when all of it is on disk.

use crate::error::{Error, Result};
use std::fs::{self, File};
use std::io::Write;
use std::path::{Path, PathBuf};

/// Refuses an output folder that can't be one, before any work is done.
///
/// # Errors
/// When the path, or a part of it, exists and is not a folder.
pub fn check_folder(folder: &Path) -> Result<()> {
    let existing = folder.ancestors().find(|p| p.as_os_str().is_empty() || p.symlink_metadata().is_ok());
    match existing {
        Some(p) if !p.as_os_str().is_empty() && !p.is_dir() => Err(Error::Io {
            path: folder.to_owned(),
            action: "write reports to this folder",
            message: format!("{} is not a folder; give another one with --out", p.display()),
        }),
        _ => Ok(()),
    }
}

/// Writes `(name, content)` pairs to `folder`, creating it; returns the paths.
///
/// # Errors
/// When a file can't be written; files already there are then left as they were.
pub fn write_all(folder: &Path, files: &[(String, String)]) -> Result<Vec<PathBuf>> {
    fs::create_dir_all(folder).map_err(|e| Error::io(folder, "create this folder", &e))?;
    let mut pending: Vec<(PathBuf, PathBuf)> = Vec::new();
    for (name, content) in files {
        let path = folder.join(name);
        let temporary = folder.join(format!(".{name}.{}.tmp", std::process::id()));
        let written = File::create(&temporary)
            .and_then(|mut file| file.write_all(content.as_bytes()).and_then(|()| file.sync_all()));
        pending.push((temporary, path));
        if let Err(e) = written {
            discard(&pending);
            return Err(Error::io(&folder.join(name), "write", &e));
        }
    }
    for (at, (temporary, path)) in pending.iter().enumerate() {
        if let Err(e) = fs::rename(temporary, path) {
            discard(&pending[at..]);
            return Err(Error::io(path, "replace", &e));
        }
    }
    Ok(pending.into_iter().map(|(_, path)| path).collect())
}

fn discard(pending: &[(PathBuf, PathBuf)]) {
    for (temporary, _) in pending {
        // nothing better can be done about a temporary file that can't be removed either
        let _ = fs::remove_file(temporary);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_failed_write_leaves_old_files_whole() {
        let folder = tempfile::tempdir().unwrap();
        let old = [("a.json".to_owned(), "old".to_owned())];
        write_all(folder.path(), &old).unwrap();
        let bad = [("a.json".to_owned(), "new".to_owned()), ("no/such/folder".to_owned(), String::new())];
        assert!(write_all(folder.path(), &bad).is_err());
        assert_eq!(fs::read_to_string(folder.path().join("a.json")).unwrap(), "old");
        assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
    }

    #[test]
    fn a_file_is_not_a_folder() {
        let folder = tempfile::tempdir().unwrap();
        let file = folder.path().join("file");
        fs::write(&file, "").unwrap();
        assert!(check_folder(&file.join("deeper")).is_err());
        assert!(check_folder(&folder.path().join("new/deeper")).is_ok());
    }
}
