//! Writing files whole or not at all.

#[cfg(feature = "harness")]
use std::collections::HashSet;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

/// A file or folder that the system would not let us have.
#[derive(Debug, thiserror::Error)]
#[error("cannot {action} {}", .path.display())]
pub struct FileError {
    /// What was tried.
    pub action: &'static str,
    /// With which path.
    pub path: PathBuf,
    /// What came of it.
    pub source: io::Error,
}

/// Whether [`write_file`] can write there: the folder takes new files, and no folder has the name.
#[cfg(any(feature = "cli", feature = "harness"))]
pub(crate) fn check_writable(path: &Path) -> Result<(), FileError> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    if path.is_dir() {
        return Err(error(io::ErrorKind::IsADirectory.into()));
    }
    fs::metadata(folder_of(path)).map_err(error)?;
    readable_by_all(0o666).tempfile_in(folder_of(path)).map(drop).map_err(error)
}

fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Writes to a temporary file in the same folder, flushes it to the disk and renames it.
pub(crate) fn write_file(path: &Path, bytes: &[u8]) -> Result<(), FileError> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    let mut file = readable_by_all(0o666).tempfile_in(folder_of(path)).map_err(error)?;
    file.write_all(bytes).and_then(|()| file.as_file().sync_all()).map_err(error)?;
    file.persist(path).map_err(|e| error(e.error))?;
    Ok(())
}

/// Makes a folder and those above it.
#[cfg(feature = "harness")]
pub(crate) fn create_folder(path: &Path) -> Result<(), FileError> {
    fs::create_dir_all(path).map_err(|source| FileError {
        action: "create",
        path: path.to_owned(),
        source,
    })
}

/// Waits until what was renamed into a folder is on the disk under its new name.
#[cfg(feature = "harness")]
pub(crate) fn sync_folder(path: &Path) -> Result<(), FileError> {
    let error = |source| FileError { action: "flush", path: path.to_owned(), source };
    // Elsewhere a folder is nothing that can be opened.
    if cfg!(unix) {
        fs::File::open(path).and_then(|folder| folder.sync_all()).map_err(error)
    } else {
        Ok(())
    }
}

/// Has a folder filled under a temporary name beside its own, then renames it. Nothing that is there
/// is touched: the folder may exist, but only empty.
#[cfg(feature = "harness")]
pub(crate) fn write_folder<E: From<FileError>>(
    path: &Path,
    fill: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    let exists = match fs::read_dir(path).map(|mut entries| entries.next().is_some()) {
        Ok(true) => return Err(error(io::ErrorKind::DirectoryNotEmpty.into()).into()),
        Ok(false) => true,
        Err(e) if e.kind() == io::ErrorKind::NotFound => false,
        Err(e) => return Err(error(e).into()),
    };
    create_folder(folder_of(path))?;
    let folder = readable_by_all(0o777).tempdir_in(folder_of(path)).map_err(error)?;
    fill(folder.path())?;
    if exists {
        fs::remove_dir(path).map_err(error)?;
    }
    fs::rename(folder.path(), path).map_err(error)?;
    // The temporary name is gone, so there is nothing left to remove.
    let _ = folder.keep();
    Ok(())
}

/// What is temporary is private by default; a result is for everybody whom the umask lets read.
#[cfg_attr(not(unix), expect(unused_variables, unused_mut, reason = "modes are Unix's"))]
fn readable_by_all(mode: u32) -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt as _;
        builder.permissions(fs::Permissions::from_mode(mode));
    }
    builder
}

/// A name, with a number where it is taken. Some file systems take capitals and small letters for the same.
#[cfg(feature = "harness")]
pub(crate) fn unlike(plain: &str, taken: &mut HashSet<String>) -> String {
    let mut name = plain.to_owned();
    for n in 2.. {
        if taken.insert(name.to_lowercase()) {
            break;
        }
        name = format!("{plain}-{n}");
    }
    name
}

/// A label as part of a file's name on any system: letters, digits, `-` and `_`, a hundred at most.
#[cfg(feature = "harness")]
pub(crate) fn file_name(label: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c } else { '_' };
    label.trim().chars().map(plain).take(100).collect()
}
