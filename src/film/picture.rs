//! A picture and its size.

use std::fmt;
use std::str::FromStr;

/// How large a picture is \[pixels\].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Size {
    /// Across.
    pub(crate) width: usize,
    /// Down.
    pub(crate) height: usize,
}

impl Size {
    /// 1080p.
    pub const FULL_HD: Self = Self { width: 1920, height: 1080 };

    /// The smallest and largest width and height.
    const RANGE: std::ops::RangeInclusive<usize> = 64..=7680;

    /// Of this width and height, where both are from 64 to 7680.
    pub fn new(width: usize, height: usize) -> Option<Self> {
        let is_in_range = [width, height].iter().all(|length| Self::RANGE.contains(length));
        is_in_range.then_some(Self { width, height })
    }
}

impl fmt::Display for Size {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}x{}", self.width, self.height)
    }
}

/// `1920x1080`.
impl FromStr for Size {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let lengths = text.split_once(['x', '×']);
        let size = lengths.and_then(|(w, h)| Self::new(w.parse().ok()?, h.parse().ok()?));
        size.ok_or_else(|| {
            let (least, most) = (Self::RANGE.start(), Self::RANGE.end());
            format!("expected a width and a height of {least} to {most} pixels: 1920x1080")
        })
    }
}

/// A picture, row by row.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Picture {
    /// How large it is.
    pub size: Size,
    /// Red, green and blue of each pixel.
    pub pixels: Vec<[u8; 3]>,
}

impl Picture {
    /// All white.
    pub(super) fn white(size: Size) -> Self {
        Self { size, pixels: vec![[255; 3]; size.width * size.height] }
    }

    /// Covers a share of a pixel; what lies outside the picture is left out.
    pub(super) fn cover(&mut self, [x, y]: [i64; 2], colour: [u8; 3], share: f32) {
        let (Ok(x), Ok(y)) = (usize::try_from(x), usize::try_from(y)) else { return };
        if x >= self.size.width || y >= self.size.height {
            return;
        }
        let pixel = &mut self.pixels[y * self.size.width + x];
        for (under, over) in pixel.iter_mut().zip(colour) {
            let mixed = f32::from(*under) + share * (f32::from(over) - f32::from(*under));
            *under = mixed.round() as u8;
        }
    }
}
