//! Animated PNG: all colours, and of each picture what differs from the one before.

use png::{BitDepth, BlendOp, ColorType, Compression, Encoder, EncodingError, Writer};

use super::difference::Part;
use super::error::FilmError;
use super::picture::{Picture, Size};

/// An animated PNG in the making.
pub(super) struct PngFile<'a> {
    writer: Writer<&'a mut Vec<u8>>,
    size: Size,
    before: Option<Picture>,
}

impl<'a> PngFile<'a> {
    /// Of so many pictures.
    pub(super) fn new(
        bytes: &'a mut Vec<u8>,
        size: Size,
        pictures: usize,
    ) -> Result<Self, FilmError> {
        let mut encoder = Encoder::new(bytes, size.width as u32, size.height as u32);
        encoder.set_color(ColorType::Rgba);
        encoder.set_depth(BitDepth::Eight);
        encoder.set_compression(Compression::Default);
        encoder.set_animated(pictures as u32, 0)?;
        Ok(Self { writer: encoder.write_header()?, size, before: None })
    }

    /// Goes on with pictures, each of which stays for some milliseconds.
    pub(super) fn push(
        &mut self,
        pictures: Vec<Picture>,
        delays: &[u16],
        go_on: &dyn Fn() -> bool,
    ) -> Result<(), FilmError> {
        for (picture, delay) in pictures.into_iter().zip(delays) {
            if !go_on() {
                return Err(FilmError::Interrupted);
            }
            self.add(&picture, *delay)?;
            self.before = Some(picture);
        }
        Ok(())
    }

    fn add(&mut self, picture: &Picture, delay: u16) -> Result<(), EncodingError> {
        let (writer, width) = (&mut self.writer, self.size.width);
        writer.set_frame_delay(delay, 1000)?;
        let opaque = |[r, g, b]: [u8; 3]| [r, g, b, 255];
        let Some(before) = &self.before else {
            let pixels: Vec<u8> = picture.pixels.iter().flat_map(|pixel| opaque(*pixel)).collect();
            return writer.write_image_data(&pixels);
        };
        let part = Part::changed(&before.pixels, &picture.pixels, width);
        writer.set_blend_op(BlendOp::Over)?;
        writer.reset_frame_position()?;
        writer.set_frame_dimension(part.width as u32, part.height as u32)?;
        writer.set_frame_position(part.left as u32, part.top as u32)?;
        let pixel = |place: usize| {
            let (before, now) = (before.pixels[place], picture.pixels[place]);
            if before == now { [0; 4] } else { opaque(now) }
        };
        let pixels: Vec<u8> = part.places(width).flat_map(pixel).collect();
        writer.write_image_data(&pixels)
    }

    /// Ends the file.
    pub(super) fn finish(self) -> Result<(), FilmError> {
        Ok(self.writer.finish()?)
    }
}
