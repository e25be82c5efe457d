//! What an experiment has to say, in words.

use serde::Serialize;

/// One thing that an experiment has to say.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct Finding {
    /// What one may ask.
    pub question: String,
    /// The answer, in a few sentences.
    pub answer: String,
}

impl Finding {
    /// An answer to a question.
    pub fn new(question: &str, answer: impl Into<String>) -> Self {
        Self { question: question.to_owned(), answer: answer.into() }
    }
}
