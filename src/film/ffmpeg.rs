//! Videos, by the program ffmpeg.

use std::io::{Read as _, Write as _};
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread::{self, JoinHandle};
use std::time::Duration;

use super::error::FilmError;
use super::picture::{Picture, Size};

const PROGRAM: &str = "ffmpeg";

/// How often to ask whether the program has ended, and whether it is to go on.
const PAUSE: Duration = Duration::from_millis(20);

/// Widths and heights are made even, as pixels of videos share their colour with their neighbours; colours are those of HD.
const FILTER: &str =
    "pad=ceil(iw/2)*2:ceil(ih/2)*2:color=white,scale=out_color_matrix=bt709:out_range=tv";
const COLOURS: [&str; 10] = [
    "-pix_fmt",
    "yuv420p",
    "-colorspace",
    "bt709",
    "-color_primaries",
    "bt709",
    "-color_trc",
    "bt709",
    "-color_range",
    "tv",
];

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
}

impl Video {
    /// Into a file, with so many pictures per second.
    pub(super) fn new(
        file: &Path,
        size: Size,
        fps: f64,
        ending: &'static str,
    ) -> Result<Self, FilmError> {
        let codec: &[&str] = if ending == ".mp4" {
            &["-c:v", "libx264", "-crf", "18", "-preset", "medium", "-movflags", "+faststart"]
        } else {
            &["-c:v", "libvpx-vp9", "-crf", "24", "-b:v", "0", "-row-mt", "1"]
        };
        let mut command = Command::new(PROGRAM);
        command.args(["-loglevel", "error", "-y", "-f", "rawvideo", "-pixel_format", "rgb24"]);
        command.args(["-video_size", &size.to_string(), "-framerate", &fps.to_string(), "-i", "-"]);
        command.args(["-vf", FILTER]).args(COLOURS).args(codec);
        command.args(["-fflags", "+bitexact", "-flags:v", "+bitexact"]).arg(file);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        // Ctrl-C is for this program, which then ends the other.
        #[cfg(unix)]
        std::os::unix::process::CommandExt::process_group(&mut command, 0);
        let mut child = command.spawn().map_err(|source| FilmError::NoFfmpeg { ending, source })?;
        let words = child.stderr.take();
        let said = thread::Builder::new().spawn(move || {
            let mut said = Vec::new();
            // What can no longer be read was not said.
            let _ = words.map(|mut words| words.read_to_end(&mut said));
            String::from_utf8_lossy(&said).trim().to_owned()
        });
        match said {
            Ok(said) => Ok(Self { child, said }),
            Err(error) => {
                end(&mut child);
                Err(FilmError::Ffmpeg(format!("cannot start a thread: {error}")))
            }
        }
    }

    /// Goes on with pictures.
    pub(super) fn push(&mut self, pictures: &[Picture]) -> Result<(), FilmError> {
        let Some(input) = &mut self.child.stdin else { return Ok(()) };
        let mut write = |picture: &Picture| input.write_all(picture.pixels.as_flattened());
        let ended = "it ended before it had all pictures";
        pictures.iter().try_for_each(&mut write).map_err(|_| FilmError::Ffmpeg(ended.to_owned()))
    }

    /// Waits until the program has written its file, as long as it is to go on.
    pub(super) fn finish(mut self, go_on: &dyn Fn() -> bool) -> Result<(), FilmError> {
        drop(self.child.stdin.take());
        let status = loop {
            match self.child.try_wait().map_err(|e| FilmError::Ffmpeg(e.to_string()))? {
                Some(status) => break status,
                None if go_on() => thread::sleep(PAUSE),
                None => {
                    end(&mut self.child);
                    return Err(FilmError::Interrupted);
                }
            }
        };
        if status.success() { Ok(()) } else { Err(self.failure(status.to_string())) }
    }

    /// Ends the program, which is not to go on after this error; what it says of it, if anything.
    pub(super) fn give_up(mut self, error: FilmError) -> FilmError {
        drop(self.child.stdin.take());
        match error {
            // It has closed its input and ends by itself.
            FilmError::Ffmpeg(reason) => {
                let _ = self.child.wait();
                self.failure(reason)
            }
            error => {
                end(&mut self.child);
                error
            }
        }
    }

    fn failure(self, otherwise: String) -> FilmError {
        let said = self.said.join().unwrap_or_default();
        FilmError::Ffmpeg(if said.is_empty() { otherwise } else { said })
    }
}

/// One that has ended already cannot be ended again.
fn end(child: &mut Child) {
    let _ = child.kill();
    let _ = child.wait();
}
