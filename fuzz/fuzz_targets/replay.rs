//! Replay files: read or refused; what is read is assessed under every reading and sampled.
#![no_main]

use driftless::reorientation::ReplayFile;
use driftless_fuzz::{check_told, document};
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let Some(document) = document("replay.toml", bytes) else { return };
    let Some(file) = check_told(ReplayFile::read(&document)) else { return };
    let Some(published) = check_told(file.build(&document)) else { return };
    if published.coefficients.len() > 200 {
        return;
    }
    for (_, motion) in published.readings() {
        let _ = (motion.residual(), motion.penalty());
    }
    let _ = published.problem.sample(&published.coefficients, published.duration, 20).base_zyx();
});
