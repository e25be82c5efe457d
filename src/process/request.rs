//! What a process says.

use serde::Deserialize;
use serde::de::DeserializeOwned;

use super::numbers::Coordinates;
use crate::search::Failure;

/// A message of a process; what else it has is ignored.
#[derive(Debug, Deserialize)]
struct Message {
    #[serde(default)]
    id: Option<serde_json::Value>,
    #[serde(default)]
    x: Option<Coordinates>,
    #[serde(default)]
    linearise: Option<Coordinates>,
    #[serde(default)]
    subgradient: Option<Coordinates>,
    #[serde(default)]
    done: Option<bool>,
}

/// Longest id, which comes back with each answer \[byte\].
const LONGEST_ID: usize = 1000;

/// What a process asks for.
#[derive(Debug)]
pub(super) enum Request {
    /// Costs.
    Costs(Option<serde_json::Value>, Coordinates),
    /// A cost as a sum of terms.
    Terms(Option<serde_json::Value>, Coordinates),
    /// A cost with a subgradient.
    Slopes(Option<serde_json::Value>, Coordinates),
    /// Nothing more.
    Done,
}

impl Request {
    /// From a line.
    pub(super) fn read(line: &str) -> Result<Self, Failure> {
        let message: Message = parsed(line)?;
        let Message { id, x, linearise, subgradient, done } = message;
        let is_name = |id: &serde_json::Value| id.is_number() || id.is_string();
        if let Some(id) = id.as_ref().filter(|id| !is_name(id)) {
            return Err(format!("sent the id {id}, expected a number or a text").into());
        }
        if line.len() > LONGEST_ID
            && id.as_ref().is_some_and(|id| id.to_string().len() > LONGEST_ID)
        {
            return Err(format!("sent an id of more than {LONGEST_ID} characters").into());
        }
        let mut asked = Vec::new();
        asked.extend(x.map(|x| Self::Costs(id.clone(), x)));
        asked.extend(linearise.map(|x| Self::Terms(id.clone(), x)));
        asked.extend(subgradient.map(|x| Self::Slopes(id.clone(), x)));
        asked.extend(done.filter(|done| *done).map(|_| Self::Done));
        match (asked.pop(), asked.is_empty()) {
            (Some(request), true) => Ok(request),
            _ => Err(format!(
                "sent `{}`, expected one of `x`, `linearise`, `subgradient` and `done`",
                shortened(line)
            )
            .into()),
        }
    }
}

/// A line as JSON.
pub(super) fn parsed<T: DeserializeOwned>(line: &str) -> Result<T, Failure> {
    serde_json::from_str(line).map_err(|error| unreadable(line, &error))
}

fn unreadable(line: &str, error: &serde_json::Error) -> Failure {
    let hint = if ["NaN", "Infinity"].iter().any(|word| line.contains(word)) {
        "; what is not finite is written \"nan\", \"inf\" or \"-inf\""
    } else if line.trim_start().starts_with("{'") {
        "; JSON has double quotes"
    } else {
        ""
    };
    format!("sent a line that cannot be read: {error}{hint}: `{}`", shortened(line)).into()
}

/// The beginning of a line.
pub(super) fn shortened(line: &str) -> String {
    const LONGEST: usize = 120;
    let line = line.trim_end();
    let start: String = line.chars().take(LONGEST).collect();
    if start.len() < line.len() { start + "…" } else { start }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn asked(line: &str) -> (Option<serde_json::Value>, Coordinates) {
        match Request::read(line).unwrap() {
            Request::Costs(id, x) => (id, x),
            other => panic!("{other:?}"),
        }
    }

    #[test]
    fn one_point_or_many() {
        let (id, x) = asked(r#"{"id": 7, "x": [1, -2.5, "nan"]}"#);
        assert_eq!((id, x.is_single, x.len()), (Some(7.into()), true, 1));
        assert!(x.points(3).unwrap()[0][2].is_nan());
        let (id, x) = asked(r#"{"x": [[1, 2], [3, "-inf"]]}"#);
        assert_eq!((id, x.is_single, x.len()), (None, false, 2));
        assert_eq!(x.points(2).unwrap()[1], [3.0, f64::NEG_INFINITY]);
        assert_eq!(asked(r#"{"x": []}"#).1.len(), 0);
    }

    /// Every bit of a number that was written with as many digits as it takes.
    #[test]
    fn numbers_keep_their_bits() {
        let numbers = [0.1 + 0.2, 1.0 / 3.0, 5e-324, 1.797_693_134_862_315_7e308, -0.0];
        let written = serde_json::to_string(&numbers).unwrap();
        let (_, x) = asked(&format!("{{\"x\": {written}}}"));
        let bits = |numbers: &[f64]| numbers.iter().map(|x| x.to_bits()).collect::<Vec<_>>();
        assert_eq!(bits(x.single().unwrap()), bits(&numbers));
    }

    #[test]
    fn what_is_wrong_is_said() {
        let wrong = |line: &str| Request::read(line).unwrap_err().to_string();
        assert!(wrong(r#"{"x": [NaN]}"#).contains(r#"written "nan""#));
        assert!(
            wrong(r#"{"linearize": [1]}"#)
                .starts_with("sent `{\"linearize\": [1]}`, expected one of")
        );
        assert!(wrong(r#"{"x": [1], "done": true}"#).contains("expected one of"));
        assert!(wrong(r#"{"x": [1, [2]]}"#).contains("numbers beside points"));
        assert!(wrong(r#"{"x": [[[2]]]}"#).contains("lists of points"));
        assert!(wrong(r#"{"id": [], "x": [1]}"#).contains("the id []"));
        assert!(wrong(r#"{"x": "#).contains("cannot be read"));
        let (_, x) = asked(r#"{"x": [[1, 2], [3]]}"#);
        let error = x.points(2).unwrap_err();
        assert_eq!(error.to_string(), "sent a point with 1 variable, expected 2");
    }
}
