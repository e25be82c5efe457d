//! A folder with a PNG for each picture.

use std::path::Path;

use png::{BitDepth, ColorType, Encoder, EncodingError};
use rayon::prelude::*;

use super::error::FilmError;
use super::picture::Picture;
use crate::output::write_file;

/// Writes pictures, the first of which has this number; all numbers have as many digits as `count`.
pub(super) fn write(
    folder: &Path,
    pictures: &[Picture],
    first: usize,
    count: usize,
) -> Result<(), FilmError> {
    let digits = count.to_string().len();
    pictures.par_iter().enumerate().try_for_each(|(i, picture)| {
        let name = format!("frame-{:0digits$}.png", first + i);
        Ok(write_file(&folder.join(name), &png(picture)?)?)
    })
}

/// A picture as PNG.
fn png(picture: &Picture) -> Result<Vec<u8>, EncodingError> {
    let mut bytes = Vec::new();
    let mut encoder =
        Encoder::new(&mut bytes, picture.size.width as u32, picture.size.height as u32);
    encoder.set_color(ColorType::Rgb);
    encoder.set_depth(BitDepth::Eight);
    let mut writer = encoder.write_header()?;
    writer.write_image_data(picture.pixels.as_flattened())?;
    writer.finish()?;
    Ok(bytes)
}
