//! Units in the names of columns.

/// The order that stands for derivatives which are not read, and for what else tables have of joints.
pub(super) const UNREAD: usize = 3;

/// In what a table has the angles of joints that turn.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AngleUnit {
    /// Radians.
    Rad,
    /// Degrees.
    Deg,
}

/// What a unit measures.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Measure {
    Angle(AngleUnit),
    Metres,
    /// Of time, in seconds.
    Time(f64),
}

/// A name without its unit, the unit, and the derivative that it is of.
pub(super) fn split_unit(name: &str) -> (&str, Option<Measure>, Option<usize>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((stem, unit)) = name.strip_suffix(close).and_then(|name| name.rsplit_once(open))
            && let Some((unit, order)) = measure(unit)
        {
            return (stem.trim_end().trim_end_matches('_'), Some(unit), order);
        }
    }
    // From the longest: `_deg_s2` ends in `_s2` too.
    for (at, _) in name.match_indices('_') {
        // `_m` and `_s` may be anything's ends; units of length and of rates of lengths stand in brackets.
        let text = &name[at + 1..];
        match measure(text) {
            Some((Measure::Metres, _)) | None => {}
            Some((unit, order)) => return (&name[..at], Some(unit), order),
        }
    }
    (name, None, None)
}

/// What a unit measures, and of which derivative it is if it says so.
fn measure(unit: &str) -> Option<(Measure, Option<usize>)> {
    const PER: [(&[&str], usize); 3] = [
        (&["/s", "_s", "/sec", "_per_s", "ps"], 1),
        (&["/s^2", "/s²", "/s2", "_s2", "/s/s", "_per_s2"], 2),
        (&["/s^3", "/s³", "/s3", "_s3", "_per_s3"], UNREAD),
    ];
    let unit = unit.trim().to_lowercase();
    let seconds = match &*unit {
        "s" | "sec" | "secs" | "second" | "seconds" => Some(1.0),
        "ms" | "msec" | "milliseconds" => Some(1e-3),
        "us" | "µs" | "microseconds" => Some(1e-6),
        "ns" | "nsec" | "nanoseconds" => Some(1e-9),
        _ => None,
    };
    if let Some(seconds) = seconds {
        return Some((Measure::Time(seconds), None));
    }
    let bases = [
        ("radians", Measure::Angle(AngleUnit::Rad)),
        ("rad", Measure::Angle(AngleUnit::Rad)),
        ("degrees", Measure::Angle(AngleUnit::Deg)),
        ("deg", Measure::Angle(AngleUnit::Deg)),
        ("°", Measure::Angle(AngleUnit::Deg)),
        ("m", Measure::Metres),
    ];
    bases.iter().find_map(|(base, measure)| {
        let per = unit.strip_prefix(base)?;
        if per.is_empty() {
            return Some((*measure, None));
        }
        let (_, order) = PER.iter().find(|(texts, _)| texts.contains(&per))?;
        Some((*measure, Some(*order)))
    })
}
