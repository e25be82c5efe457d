//! The colours of a GIF.

use std::collections::BTreeMap;

use super::picture::Picture;

/// Colours of a palette beside the one that stands for what stays as it was.
const MOST_COLOURS: usize = 255;

/// The index of what stays as it was.
pub(super) const SAME: u8 = 255;

/// Bits of red, green and blue that tell colours apart.
const BITS: u32 = 5;

/// The most frequent colours of some pictures.
pub(super) struct Palette {
    colours: Vec<[u8; 3]>,
    /// For every colour, rounded, the nearest of the palette.
    nearest: Vec<u8>,
}

impl Palette {
    /// Colours that are alike in their first bits count as one, which is the most frequent of them.
    pub(super) fn of(pictures: &[Picture]) -> Self {
        let mut counts: BTreeMap<[u8; 3], usize> = BTreeMap::new();
        for picture in pictures {
            for run in picture.pixels.chunk_by(|a, b| a == b) {
                *counts.entry(run[0]).or_default() += run.len();
            }
        }
        // For all that are alike: how frequent they are, and which of them is the most frequent.
        let mut alike: BTreeMap<usize, (usize, usize, [u8; 3])> = BTreeMap::new();
        for (colour, count) in counts {
            let (all, most, own) = alike.entry(rounded(colour)).or_default();
            *all += count;
            if count > *most {
                (*most, *own) = (count, colour);
            }
        }
        let mut found: Vec<(usize, [u8; 3])> =
            alike.into_values().map(|(all, _, colour)| (all, colour)).collect();
        found.sort_by(|a, b| b.0.cmp(&a.0).then(a.1.cmp(&b.1)));
        let mut colours: Vec<[u8; 3]> = found.iter().map(|(_, colour)| *colour).collect();
        colours.truncate(MOST_COLOURS);
        let nearest = (0..1 << (3 * BITS)).map(|bin| nearest(&colours, middle(bin))).collect();
        Self { colours, nearest }
    }

    /// Red, green and blue of all 256.
    pub(super) fn bytes(&self) -> Vec<u8> {
        let mut bytes: Vec<u8> = self.colours.concat();
        bytes.resize(3 * 256, 0);
        bytes
    }

    /// The index of each pixel's colour.
    pub(super) fn indices(&self, picture: &Picture) -> Vec<u8> {
        picture.pixels.iter().map(|pixel| self.nearest[rounded(*pixel)]).collect()
    }
}

/// The first bits of a colour, as a number.
fn rounded(colour: [u8; 3]) -> usize {
    colour.iter().fold(0, |number, part| (number << BITS) | usize::from(part >> (8 - BITS)))
}

/// The middle of the colours with these first bits.
fn middle(bin: usize) -> [i32; 3] {
    let part = |k: u32| (((bin >> (k * BITS)) & ((1 << BITS) - 1)) << (8 - BITS)) as i32;
    [part(2), part(1), part(0)].map(|part| part + (1 << (7 - BITS)))
}

fn nearest(colours: &[[u8; 3]], to: [i32; 3]) -> u8 {
    let distance = |colour: &[u8; 3]| -> i32 {
        colour.iter().zip(to).map(|(part, to)| (i32::from(*part) - to).pow(2)).sum()
    };
    let nearest = colours.iter().enumerate().min_by_key(|(_, colour)| distance(colour));
    nearest.map_or(0, |(index, _)| index as u8)
}

#[cfg(test)]
mod tests {
    use super::super::picture::Size;
    use super::*;

    #[test]
    fn frequent_colours_are_kept_as_they_are() {
        let size = Size { width: 64, height: 64 };
        let mut picture = Picture::white(size);
        picture.pixels[..100].fill([10, 20, 30]);
        picture.pixels[100] = [11, 21, 31];
        let palette = Palette::of(std::slice::from_ref(&picture));
        let bytes = palette.bytes();
        let colour = |index: u8| &bytes[3 * usize::from(index)..3 * usize::from(index) + 3];
        let indices = palette.indices(&picture);
        assert_eq!(colour(indices[0]), [10, 20, 30]);
        assert_eq!(indices[100], indices[0]);
        assert_eq!(colour(indices[200]), [255; 3]);
        assert_eq!(bytes.len(), 768);
    }
}
