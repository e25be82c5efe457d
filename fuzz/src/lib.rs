//! What the targets share: texts from bytes, and a slow planner's physics that has nothing in common with the crate's.

pub mod reference;

use driftless::input::{Document, InputError};

/// A document of what a fuzzer made; none of bytes that are no text.
pub fn document(name: &str, bytes: &[u8]) -> Option<Document> {
    Some(Document::embedded(name, std::str::from_utf8(bytes).ok()?))
}

/// Mistakes are told in few words, whatever the input.
pub fn check_told<T>(outcome: Result<T, InputError>) -> Option<T> {
    match outcome {
        Ok(value) => Some(value),
        Err(error) => {
            let told = error.to_string();
            assert!(!told.is_empty() && told.len() < 8000, "{} bytes: {told:.400}", told.len());
            None
        }
    }
}
