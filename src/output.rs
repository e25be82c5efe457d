//! Writing files whole or not at all.

#[cfg(feature = "harness")]
use std::collections::HashSet;
use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};
use std::time::Duration;

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

/// Whether [`write_folder`] can write there: the folder around it takes new files, and nothing that is not empty has the name.
#[cfg(any(feature = "cli", feature = "harness"))]
pub(crate) fn check_folder_writable(path: &Path) -> Result<(), FileError> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    match fs::read_dir(path).map(|mut entries| entries.next().is_some()) {
        Ok(true) => Err(error(io::ErrorKind::DirectoryNotEmpty.into())),
        Err(e) if e.kind() != io::ErrorKind::NotFound => Err(error(e)),
        Ok(false) | Err(_) => {
            readable_by_all(0o777).tempdir_in(folder_of(path)).map(drop).map_err(error)
        }
    }
}

/// The folder that a file is in.
pub(crate) fn folder_of(path: &Path) -> &Path {
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

/// Has a program write to a temporary file in the same folder, whose name has the given ending; then does as [`write_file`].
#[cfg(feature = "film")]
pub(crate) fn write_file_by<E: From<FileError>>(
    path: &Path,
    ending: &str,
    write: impl FnOnce(&Path) -> Result<(), E>,
) -> Result<(), E> {
    let error = |source| FileError { action: "write", path: path.to_owned(), source };
    remove_temporary(folder_of(path));
    let mut builder = readable_by_all(0o666);
    let file = builder.suffix(ending).tempfile_in(folder_of(path)).map_err(error)?.into_temp_path();
    write(&file)?;
    fs::File::options().append(true).open(&file).and_then(|file| file.sync_all()).map_err(error)?;
    Ok(file.persist(path).map_err(|e| error(e.error))?)
}

/// Makes a folder and those above it.
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
    // A folder that is replaced may be the one that relative paths start from.
    let whole = if exists { fs::canonicalize(path).map_err(error)? } else { path.to_owned() };
    let around = folder_of(&whole);
    create_folder(around)?;
    remove_temporary(around);
    let folder = readable_by_all(0o777).tempdir_in(around).map_err(error)?;
    fill(folder.path())?;
    if exists {
        fs::remove_dir(&whole).map_err(error)?;
    }
    fs::rename(folder.path(), &whole).map_err(error)?;
    // The temporary name is gone, so there is nothing left to remove.
    let _ = folder.keep();
    Ok(())
}

/// What the names of temporary files begin with, so that remains of a process that was killed can be told from others'.
const TEMPORARY: &str = ".tmp-driftless-";

/// Remains of that age are nobody's: no file takes that long to write.
const OLD: Duration = Duration::from_hours(24);

/// Removes the temporary files and folders that processes that were killed have left in a folder.
pub(crate) fn remove_temporary(folder: &Path) {
    remove_old(folder, |name| name.starts_with(TEMPORARY));
}

/// Removes old files and folders of such names. What cannot be removed harms nobody.
pub(crate) fn remove_old(folder: &Path, is_ours: impl Fn(&str) -> bool) {
    let is_old = |metadata: &fs::Metadata| {
        let age = metadata.modified().ok().and_then(|time| time.elapsed().ok());
        age.is_some_and(|age| age > OLD)
    };
    for entry in fs::read_dir(folder).into_iter().flatten().flatten() {
        let is_ours = entry.file_name().to_str().is_some_and(&is_ours);
        let Some(found) = entry.metadata().ok().filter(|found| is_ours && is_old(found)) else {
            continue;
        };
        let path = entry.path();
        let _ = if found.is_dir() { fs::remove_dir_all(path) } else { fs::remove_file(path) };
    }
}

/// What is temporary is private by default; a result is for everybody whom the umask lets read.
#[cfg_attr(not(unix), expect(unused_variables, reason = "modes are Unix's"))]
fn readable_by_all(mode: u32) -> tempfile::Builder<'static, 'static> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(TEMPORARY);
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
