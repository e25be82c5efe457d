//! The names of batches.

use std::time::SystemTime;

use crate::digest::digest;

/// What the name of a batch of several runs begins with.
const SEVERAL: &str = "batch-";

/// The key of the only run, or a name of its own.
pub(super) fn batch_name(keys: &[&str]) -> String {
    match keys {
        [key] => (*key).to_owned(),
        _ => format!("{SEVERAL}{}", digest(&keys.join(" "))),
    }
}

/// A name that no other process gives, nor this one another time: one may remove what another writes.
pub(super) fn new_name(keys: &[String]) -> String {
    let now = SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).unwrap_or_default();
    let unique = format!("{} {} {}", std::process::id(), now.as_nanos(), keys.join(" "));
    format!("{SEVERAL}{}", digest(&unique))
}

/// Whether a batch of this name is one run.
pub(super) fn is_key(batch: &str) -> bool {
    !batch.starts_with(SEVERAL)
}

/// Whether a file's name is that of a batch; others are none of ours.
pub(super) fn is_batch(name: &str) -> bool {
    let digits = name.strip_prefix(SEVERAL).unwrap_or(name);
    digits.len() == 16 && digits.bytes().all(|byte| byte.is_ascii_hexdigit())
}
