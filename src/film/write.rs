//! From pictures, drawn side by side, to a file.

use std::path::Path;

use rayon::prelude::*;

use super::animated_png::PngFile;
use super::error::FilmError;
use super::ffmpeg::{self, Video};
use super::format::FilmFormat;
use super::gif::GifFile;
use super::picture::{Picture, Size};
use super::stills;
use crate::output::{write_file, write_file_by, write_folder};

/// Pictures that a palette is made from.
const SAMPLES: usize = 12;

/// How much longer the last picture stays where a film begins again by itself \[s\].
const HOLD: f64 = 1.0;

/// Pictures that are there at a time, for each worker thread, as long as they take no more than so many bytes.
const AT_A_TIME: usize = 2;
const MOST_BYTES: usize = 1 << 29;

/// What a film is made of.
#[derive(Debug, Clone, Copy)]
pub struct Film {
    /// How large its pictures are.
    pub size: Size,
    /// How many there are.
    pub count: usize,
    /// How many are shown per second.
    pub per_second: f64,
}

/// Writes a film, whole or not at all. `draw` makes the picture of an index, `go_on` says after each picture whether to go on, and
/// `done` is called when one of the film's pictures is drawn.
pub fn write_film(
    path: &Path,
    format: FilmFormat,
    film: Film,
    draw: &(dyn Fn(usize) -> Picture + Sync),
    go_on: &(dyn Fn() -> bool + Sync),
    done: &(dyn Fn() + Sync),
) -> Result<(), FilmError> {
    let Film { size, count, per_second } = film;
    let film = Drawn { film, draw, go_on, done };
    match format {
        FilmFormat::Gif => {
            let mut file = GifFile::new(size, &film.samples()?)?;
            let delays = film.delays(100.0);
            film.each(|first, pictures| file.push(&pictures, &delays[first..]))?;
            Ok(write_file(path, &file.finish()?)?)
        }
        FilmFormat::Png => {
            let mut bytes = Vec::new();
            let mut file = PngFile::new(&mut bytes, size, count)?;
            let delays = film.delays(1000.0);
            film.each(|first, pictures| file.push(pictures, &delays[first..], go_on))?;
            file.finish()?;
            Ok(write_file(path, &bytes)?)
        }
        FilmFormat::Stills => write_folder(path, |folder| {
            film.each(|first, pictures| stills::write(folder, &pictures, first + 1, count))
        }),
        FilmFormat::Mp4 | FilmFormat::WebM => {
            let ending = format.video().unwrap_or(".mp4");
            write_file_by(path, ending, |file| {
                let mut video = Video::new(file, size, per_second, ending)?;
                match film.each(|_, pictures| video.push(&pictures)) {
                    Ok(()) => video.finish(&go_on),
                    Err(error) => Err(video.give_up(error)),
                }
            })
        }
    }
}

impl Film {
    /// How long it takes to show once \[s\].
    pub fn seconds(&self, format: FilmFormat) -> f64 {
        let hold = if matches!(format, FilmFormat::Gif | FilmFormat::Png) { HOLD } else { 0.0 };
        self.count as f64 / self.per_second + hold
    }
}

impl FilmFormat {
    /// Looks for the program that it takes before any work is done.
    pub fn check(self) -> Result<(), FilmError> {
        self.video().map_or(Ok(()), ffmpeg::check)
    }
}

/// A film, and how it is drawn.
struct Drawn<'a> {
    film: Film,
    draw: &'a (dyn Fn(usize) -> Picture + Sync),
    go_on: &'a (dyn Fn() -> bool + Sync),
    done: &'a (dyn Fn() + Sync),
}

impl Drawn<'_> {
    /// Draws all pictures, some at a time; `take` is told the index of the first of them.
    fn each(
        &self,
        mut take: impl FnMut(usize, Vec<Picture>) -> Result<(), FilmError>,
    ) -> Result<(), FilmError> {
        let Size { width, height } = self.film.size;
        let affordable = MOST_BYTES / (3 * width * height).max(1);
        let step = (AT_A_TIME * rayon::current_num_threads()).min(affordable).max(1);
        for first in (0..self.film.count).step_by(step) {
            let all: Vec<usize> = (first..self.film.count.min(first + step)).collect();
            take(first, self.drawn(&all, self.done)?)?;
        }
        Ok(())
    }

    fn drawn(&self, places: &[usize], done: &(dyn Fn() + Sync)) -> Result<Vec<Picture>, FilmError> {
        let picture = |place: &usize| {
            let picture = (self.draw)(*place);
            if picture.size != self.film.size {
                let (found, expected) = (picture.size, self.film.size);
                let reason = format!("found a picture of {found} pixels, expected {expected}");
                return Err(FilmError::Encode { format: "the film", reason });
            }
            done();
            if (self.go_on)() { Ok(picture) } else { Err(FilmError::Interrupted) }
        };
        places.par_iter().map(picture).collect()
    }

    /// Pictures from all along the film.
    fn samples(&self) -> Result<Vec<Picture>, FilmError> {
        let count = SAMPLES.min(self.film.count);
        let last = self.film.count.saturating_sub(1);
        let places: Vec<usize> =
            (0..count).map(|k| k * last / count.saturating_sub(1).max(1)).collect();
        self.drawn(&places, &|| ())
    }

    /// How long each picture stays, in whole parts of a second: the end of each is where it should be, to half a part.
    fn delays(&self, parts: f64) -> Vec<u16> {
        let end = |i: usize| (parts * i as f64 / self.film.per_second).round();
        let delay = |i: usize| {
            let hold = if i + 1 == self.film.count { HOLD * parts } else { 0.0 };
            (end(i + 1) - end(i) + hold) as u16
        };
        (0..self.film.count).map(delay).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::fs;
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    const SIZE: Size = Size { width: 70, height: 64 };

    /// A dot that moves.
    fn dot(i: usize) -> Picture {
        let mut picture = Picture::white(SIZE);
        picture.pixels[70 * 7 + 3 * i] = [200, 0, 0];
        picture
    }

    fn film(count: usize) -> Film {
        Film { size: SIZE, count, per_second: 30.0 }
    }

    fn written(name: &str, count: usize) -> Vec<u8> {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join(name);
        let format = FilmFormat::of(&path).unwrap();
        write_film(&path, format, film(count), &dot, &|| true, &|| ()).unwrap();
        fs::read(path).unwrap()
    }

    /// As the gif crate reads it: so many frames, a third of a tenth of a second each in the mean, and every pixel as drawn.
    #[test]
    fn a_gif_has_all_pictures() {
        let bytes = written("a.gif", 19);
        assert_eq!(bytes, written("a.gif", 19));
        let mut options = gif::DecodeOptions::new();
        options.set_color_output(gif::ColorOutput::RGBA);
        let mut decoder = options.read_info(&bytes[..]).unwrap();
        let mut canvas = vec![[0; 4]; 70 * 64];
        let (mut count, mut hundredths) = (0, 0);
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            let (left, top) = (usize::from(frame.left), usize::from(frame.top));
            for (i, pixel) in frame.buffer.as_chunks::<4>().0.iter().enumerate() {
                let (x, y) = (i % usize::from(frame.width), i / usize::from(frame.width));
                if pixel[3] > 0 {
                    canvas[(top + y) * 70 + left + x] = *pixel;
                }
            }
            for (found, drawn) in canvas.iter().zip(dot(count).pixels) {
                assert_eq!(found[..3], drawn);
            }
            hundredths += frame.delay;
            count += 1;
        }
        // 19 / 30 s, and a second at the end.
        assert_eq!((count, hundredths), (19, 63 + 100));
    }

    /// As the png crate reads it.
    #[test]
    fn an_animated_png_has_all_pictures() {
        let bytes = written("a.png", 5);
        let mut reader = png::Decoder::new(&bytes[..]).read_info().unwrap();
        assert_eq!(reader.info().animation_control().unwrap().num_frames, 5);
        let mut buffer = vec![0; reader.output_buffer_size()];
        let mut found = Vec::new();
        for _ in 0..5 {
            reader.next_frame(&mut buffer).unwrap();
            let control = reader.info().frame_control().unwrap();
            found.push((control.width, control.height, control.delay_num));
        }
        assert_eq!(found, [(70, 64, 33), (4, 1, 34), (4, 1, 33), (4, 1, 33), (4, 1, 1034)]);
    }

    #[test]
    fn a_folder_has_a_picture_each() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("frames");
        write_film(&path, FilmFormat::Stills, film(12), &dot, &|| true, &|| ()).unwrap();
        let mut names: Vec<_> =
            fs::read_dir(&path).unwrap().map(|e| e.unwrap().file_name()).collect();
        names.sort();
        assert_eq!(
            (names.len(), names[0].to_str(), names[11].to_str()),
            (12, Some("frame-01.png"), Some("frame-12.png"))
        );
    }

    /// Nothing is left of a film that was not to go on.
    #[test]
    fn an_interrupted_film_is_not_written() {
        for name in ["a.gif", "a.apng", "frames"] {
            let folder = tempfile::tempdir().unwrap();
            let path = folder.path().join(name);
            let told = AtomicUsize::new(0);
            let go_on = || told.fetch_add(1, Ordering::Relaxed) < 8;
            let format = FilmFormat::of(&path).unwrap();
            let outcome = write_film(&path, format, film(20), &dot, &go_on, &|| ());
            assert!(matches!(outcome, Err(FilmError::Interrupted)), "{outcome:?}");
            assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 0);
        }
    }
}
