//! Signals that ask the program to end.

use std::fs;

use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::{register, register_conditional_shutdown};

use crate::search::Watch;

/// The number of SIGHUP on every Unix; Windows has none.
const SIGHUP: i32 = 1;

/// Has the first signal interrupt the watch and the second end the program at once: what is being written is in a temporary
/// file. A signal that was ignored when the program began, as `nohup` has it, stays ignored.
pub(super) fn interrupt_on_signals(watch: &Watch) {
    let ignored = ignored();
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        if ignored & mask(signal) == 0 {
            let flag = watch.flag();
            // Without a handler the signal still ends the program, only less gracefully.
            let _ = register_conditional_shutdown(signal, 130, flag.clone());
            let _ = register(signal, flag);
        }
    }
}

/// The signals that are ignored, one bit each. Where that cannot be told SIGHUP may be one, and is left alone.
fn ignored() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let found = line.and_then(|digits| u64::from_str_radix(digits.trim(), 16).ok());
    found.unwrap_or(mask(SIGHUP))
}

fn mask(signal: i32) -> u64 {
    1 << (signal - 1)
}
