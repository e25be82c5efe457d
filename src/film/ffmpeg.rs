//! Videos, by the program ffmpeg.

use std::fs;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};

use super::error::FilmError;
use super::picture::{Picture, Size};
use crate::output::{FileError, write_file};

const PROGRAM: &str = "ffmpeg";

/// Whether there is an ffmpeg.
pub(super) fn check(ending: &'static str) -> Result<(), FilmError> {
    let mut command = Command::new(PROGRAM);
    command.arg("-version").stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
    command.status().map(drop).map_err(|source| FilmError::NoFfmpeg { ending, source })
}

/// A video in the making.
pub(super) struct Video {
    child: Child,
    /// What the program says.
    said: JoinHandle<String>,
    /// Where it writes.
    folder: tempfile::TempDir,
    file: PathBuf,
}

impl Video {
    /// With so many pictures per second.
    pub(super) fn new(size: Size, fps: f64, ending: &'static str) -> Result<Self, FilmError> {
        let place = |source| FileError { action: "write to", path: std::env::temp_dir(), source };
        let folder = tempfile::tempdir().map_err(place)?;
        let file = folder.path().join(format!("film{ending}"));
        let codec: &[&str] = if ending == ".mp4" {
            &["-c:v", "libx264", "-crf", "18", "-preset", "medium", "-movflags", "+faststart"]
        } else {
            &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1"]
        };
        let mut command = Command::new(PROGRAM);
        command.args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"]);
        command.args(["-video_size", &size.to_string(), "-framerate", &fps.to_string(), "-i", "-"]);
        // Their usual pixels are told in squares of two.
        command.args(["-vf", "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white", "-pix_fmt", "yuv420p"]);
        command.args(codec).args(["-fflags", "+bitexact", "-flags:v", "+bitexact"]).arg(&file);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        let mut child = command.spawn().map_err(|source| FilmError::NoFfmpeg { ending, source })?;
        let words = child.stderr.take();
        let said = thread::spawn(move || {
            let mut said = Vec::new();
            // What can no longer be read was not said.
            let _ = words.map(|mut words| words.read_to_end(&mut said));
            String::from_utf8_lossy(&said).trim().to_owned()
        });
        Ok(Self { child, said, folder, file })
    }

    /// Goes on with pictures. Whether the program takes more; if not, [`finish`](Self::finish) says why.
    pub(super) fn push(&mut self, pictures: &[Picture]) -> bool {
        let Some(input) = &mut self.child.stdin else { return false };
        pictures.iter().all(|picture| input.write_all(picture.pixels.as_flattened()).is_ok())
    }

    /// Writes the file, when the program has ended.
    pub(super) fn finish(mut self, path: &Path) -> Result<(), FilmError> {
        drop(self.child.stdin.take());
        let status = self.child.wait().map_err(|e| FilmError::Ffmpeg(e.to_string()))?;
        let said = self.said.join().unwrap_or_default();
        if !status.success() {
            let reason = if said.is_empty() { status.to_string() } else { said };
            return Err(FilmError::Ffmpeg(reason));
        }
        let bytes = fs::read(&self.file).map_err(|e| FilmError::Ffmpeg(e.to_string()))?;
        drop(self.folder);
        Ok(write_file(path, &bytes)?)
    }

    /// Ends the program before its time.
    pub(super) fn give_up(mut self) {
        // One that has ended already cannot be ended again.
        let _ = self.child.kill();
        let _ = self.child.wait();
    }
}
