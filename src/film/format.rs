//! Formats of films.

use std::path::Path;

/// How a film is stored.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FilmFormat {
    /// One palette for all pictures, each of which stores what is new.
    Gif,
    /// Animated PNG, in all colours.
    Png,
    /// A folder with a PNG for each picture.
    Stills,
    /// H.264, by ffmpeg.
    Mp4,
    /// VP9, by ffmpeg.
    WebM,
}

impl FilmFormat {
    /// What names end in.
    pub const ENDINGS: &str =
        ".gif, .apng, .png, .mp4 or .webm, or the name of a folder for a PNG of each frame";

    /// The format that a name asks for: a folder where it ends in `/` or has no ending.
    pub fn of(path: &Path) -> Option<Self> {
        if path.as_os_str().to_string_lossy().ends_with(['/', std::path::MAIN_SEPARATOR]) {
            return Some(Self::Stills);
        }
        let Some(ending) = path.extension() else { return path.file_name().map(|_| Self::Stills) };
        match &*ending.to_str()?.to_ascii_lowercase() {
            "gif" => Some(Self::Gif),
            "apng" | "png" => Some(Self::Png),
            "mp4" => Some(Self::Mp4),
            "webm" => Some(Self::WebM),
            _ => None,
        }
    }

    /// Highest frame rate \[Hz\]: viewers show frames of a GIF that stay for less than 0.02 s much longer.
    pub fn most_per_second(self) -> f64 {
        if self == Self::Gif { 50.0 } else { 240.0 }
    }

    /// The file's ending where ffmpeg writes it.
    pub(super) fn video(self) -> Option<&'static str> {
        match self {
            Self::Mp4 => Some(".mp4"),
            Self::WebM => Some(".webm"),
            Self::Gif | Self::Png | Self::Stills => None,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_tell_formats() {
        let of = |name: &str| FilmFormat::of(Path::new(name));
        assert_eq!(of("a/b.GIF"), Some(FilmFormat::Gif));
        assert_eq!([of("b.png"), of("b.apng")], [Some(FilmFormat::Png); 2]);
        assert_eq!([of("a/frames"), of("a/b.gif/")], [Some(FilmFormat::Stills); 2]);
        assert_eq!([of("a.avi"), of(""), of("..")], [None; 3]);
    }
}
