//! GIF: one palette for all, and of each picture what differs from the one before.

use gif::{DisposalMethod, Encoder, Frame, Repeat};
use rayon::prelude::*;

use super::difference::Part;
use super::error::FilmError;
use super::palette::{Palette, SAME};
use super::picture::{Picture, Size};

/// A GIF in the making.
pub(super) struct GifFile {
    encoder: Encoder<Vec<u8>>,
    size: Size,
    palette: Palette,
    before: Option<Vec<u8>>,
}

impl GifFile {
    /// With the palette of some of its pictures.
    pub(super) fn new(size: Size, samples: &[Picture]) -> Result<Self, FilmError> {
        let palette = Palette::of(samples);
        let (width, height) = (size.width as u16, size.height as u16);
        let mut encoder = Encoder::new(Vec::new(), width, height, &palette.bytes())?;
        encoder.set_repeat(Repeat::Infinite)?;
        Ok(Self { encoder, size, palette, before: None })
    }

    /// Goes on with pictures, each of which stays for some hundredths of a second.
    pub(super) fn push(&mut self, pictures: &[Picture], delays: &[u16]) -> Result<(), FilmError> {
        let mut all: Vec<Vec<u8>> = self.before.take().into_iter().collect();
        let kept = all.len();
        let indices = pictures.par_iter().map(|picture| self.palette.indices(picture));
        all.extend(indices.collect::<Vec<_>>());
        let width = self.size.width;
        let frames: Vec<Frame<'static>> = (0..pictures.len())
            .into_par_iter()
            .map(|i| {
                let at = i + kept;
                frame(at.checked_sub(1).map(|before| &*all[before]), &all[at], width, delays[i])
            })
            .collect();
        for frame in &frames {
            self.encoder.write_lzw_pre_encoded_frame(frame)?;
        }
        self.before = all.pop();
        Ok(())
    }

    /// The whole file.
    pub(super) fn finish(self) -> Result<Vec<u8>, FilmError> {
        Ok(self.encoder.into_inner()?)
    }
}

fn frame(before: Option<&[u8]>, now: &[u8], width: usize, delay: u16) -> Frame<'static> {
    let whole = Part { left: 0, top: 0, width, height: now.len() / width };
    let part = before.map_or(whole, |before| Part::changed(before, now, width));
    let pixel = |place: usize| match before {
        Some(before) if before[place] == now[place] => SAME,
        _ => now[place],
    };
    let mut frame = Frame {
        delay,
        dispose: DisposalMethod::Keep,
        transparent: before.map(|_| SAME),
        left: part.left as u16,
        top: part.top as u16,
        width: part.width as u16,
        height: part.height as u16,
        buffer: part.places(width).map(pixel).collect::<Vec<u8>>().into(),
        ..Frame::default()
    };
    frame.make_lzw_pre_encoded();
    frame
}
