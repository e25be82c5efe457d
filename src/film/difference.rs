//! What changes from one picture to the next.

/// A rectangle of pixels.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Part {
    pub(super) left: usize,
    pub(super) top: usize,
    pub(super) width: usize,
    pub(super) height: usize,
}

impl Part {
    /// The smallest rectangle that holds all that differs between two pictures of that width; one pixel where nothing does.
    pub(super) fn changed<T: PartialEq>(before: &[T], after: &[T], width: usize) -> Self {
        let rows = before.chunks_exact(width).zip(after.chunks_exact(width)).enumerate();
        let mut ends: Option<[usize; 4]> = None;
        for (y, (before, after)) in rows {
            let differs = |x: &usize| before[*x] != after[*x];
            let (Some(left), Some(right)) = ((0..width).find(differs), (0..width).rfind(differs))
            else {
                continue;
            };
            let [l, r, t, _] = ends.unwrap_or([left, right, y, y]);
            ends = Some([l.min(left), r.max(right), t, y]);
        }
        let [left, right, top, bottom] = ends.unwrap_or_default();
        Self { left, top, width: right - left + 1, height: bottom - top + 1 }
    }

    /// The pixels within, of a picture of that width, by their places.
    pub(super) fn places(self, width: usize) -> impl Iterator<Item = usize> {
        let Self { left, top, width: own, height } = self;
        (top..top + height).flat_map(move |y| y * width + left..y * width + left + own)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_differs_is_within() {
        let before = [0; 20];
        let mut after = before;
        (after[6], after[13]) = (1, 1);
        let part = Part::changed(&before, &after, 5);
        assert_eq!(part, Part { left: 1, top: 1, width: 3, height: 2 });
        assert_eq!(part.places(5).collect::<Vec<_>>(), [6, 7, 8, 11, 12, 13]);
        let same = Part::changed(&before, &before, 5);
        assert_eq!((same.width, same.height), (1, 1));
    }
}
