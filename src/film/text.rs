//! Text in a picture.

use std::sync::LazyLock;

use ab_glyph::{Font as _, FontRef, PxScale, ScaleFont as _, point};

use super::picture::Picture;

/// The embedded font. Its bytes are a font; if they were not, pictures would have no text.
static FONT: LazyLock<Option<FontRef<'static>>> =
    LazyLock::new(|| FontRef::try_from_slice(notosans::REGULAR_TTF).ok());

/// How wide a text is \[pixels\], at so many pixels an em.
pub(super) fn width(text: &str, em: f64) -> f64 {
    let Some(font) = &*FONT else { return 0.0 };
    let font = font.as_scaled(scale(font, em));
    text.chars().map(|letter| f64::from(font.h_advance(font.glyph_id(letter)))).sum()
}

/// Writes a text from a place on its base line on.
pub(super) fn write(picture: &mut Picture, text: &str, at: [f64; 2], em: f64, colour: [u8; 3]) {
    let Some(font) = &*FONT else { return };
    let scale = scale(font, em);
    let scaled = font.as_scaled(scale);
    let mut x = at[0] as f32;
    for letter in text.chars().filter(|letter| !letter.is_control()) {
        let glyph = font.glyph_id(letter);
        let placed = glyph.with_scale_and_position(scale, point(x, at[1] as f32));
        if let Some(outline) = font.outline_glyph(placed) {
            let corner = outline.px_bounds().min;
            outline.draw(|right, down, share| {
                let pixel = [corner.x as i64 + i64::from(right), corner.y as i64 + i64::from(down)];
                picture.cover(pixel, colour, share.clamp(0.0, 1.0));
            });
        }
        x += scaled.h_advance(glyph);
    }
}

/// The font's own measure is the height from its lowest to its highest point.
fn scale(font: &FontRef<'_>, em: f64) -> PxScale {
    font.units_per_em().map_or(em as f32, |units| em as f32 * font.height_unscaled() / units).into()
}
