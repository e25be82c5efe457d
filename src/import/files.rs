//! The files of a folder of data.

use std::fs::{self, File};
use std::path::{Component, Path, PathBuf};

use super::error::ImportError;

/// Folders within folders that are looked into.
const DEEPEST: usize = 16;

/// Most files that are looked at.
const MOST_FILES: usize = 1_000_000;

/// The files of a folder and of those in it whose names begin and end like that, sorted; or the file itself. Links to folders
/// are not followed. None is an error, which says what was expected.
pub(super) fn files(
    data: &Path,
    [prefix, extension]: [&str; 2],
    expected: &str,
) -> Result<Vec<PathBuf>, ImportError> {
    if fs::metadata(data).map_err(|source| ImportError::unreadable(data, source))?.is_file() {
        return Ok(vec![data.to_owned()]);
    }
    let fits = |path: &Path| {
        let name = path.file_name().and_then(|name| name.to_str());
        name.is_some_and(|name| name.starts_with(prefix))
            && path.extension().is_some_and(|own| own == extension)
    };
    let mut found = Vec::new();
    let (mut folders, mut seen) = (vec![(data.to_owned(), 0)], 0_usize);
    while let Some((folder, depth)) = folders.pop() {
        let unreadable = |source| ImportError::unreadable(&folder, source);
        for entry in fs::read_dir(&folder).map_err(unreadable)? {
            let entry = entry.map_err(unreadable)?;
            let (path, kind) = (entry.path(), entry.file_type().map_err(unreadable)?);
            seen += 1;
            if kind.is_dir() && depth < DEEPEST {
                folders.push((path, depth + 1));
            } else if !kind.is_dir() && fits(&path) {
                found.push(path);
            }
        }
        if seen > MOST_FILES {
            let message = format!("found more than {MOST_FILES} files, expected the data alone");
            return Err(ImportError::of(data, message));
        }
    }
    if found.is_empty() {
        return Err(ImportError::of(data, format!("found no such file, expected {expected}")));
    }
    found.sort();
    Ok(found)
}

/// A file that an index names, in the index's folder or below it.
pub(super) fn beside(index: &Path, line: u64, name: &str) -> Result<PathBuf, ImportError> {
    // Some loggers write for Windows.
    let name = PathBuf::from(name.replace('\\', "/"));
    let is_below = |part: Component<'_>| matches!(part, Component::Normal(_) | Component::CurDir);
    if name.as_os_str().is_empty() || !name.components().all(is_below) {
        let message =
            format!("found the path `{}`, expected one below this file's folder", name.display());
        return Err(ImportError::at(index, line, message));
    }
    Ok(index.parent().map_or_else(|| name.clone(), |folder| folder.join(&name)))
}

/// Opens a file to be read; what is no file, such as a pipe, is an error.
pub(super) fn open(path: &Path) -> Result<File, ImportError> {
    let unreadable = |source| ImportError::unreadable(path, source);
    if !fs::metadata(path).map_err(unreadable)?.is_file() {
        return Err(ImportError::of(path, "found no file, expected one"));
    }
    File::open(path).map_err(unreadable)
}

/// What data are called: the last part of their path.
pub(super) fn name_of(data: &Path) -> String {
    let whole = data.canonicalize().unwrap_or_else(|_| data.to_owned());
    whole.file_name().map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
