//! A bar on a terminal, plain lines elsewhere.

use std::io::IsTerminal as _;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::{Builder, JoinHandle, park_timeout};
use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};

use crate::search::Watch;

/// Time between plain lines.
const BETWEEN_LINES: Duration = Duration::from_secs(10);

/// Shows how much of all is done, until dropped.
pub(super) struct Bar {
    display: ProgressBar,
    done: Arc<AtomicBool>,
    painter: Option<JoinHandle<()>>,
}

impl Bar {
    /// Of evaluations.
    pub(super) fn new(evaluations: u64, watch: Arc<Watch>) -> Self {
        Self::counting(evaluations, "evaluations", move || watch.evaluations())
    }

    /// Of so many things; `count` says how many are done.
    pub(super) fn counting(
        all: u64,
        things: &'static str,
        count: impl Fn() -> u64 + Send + 'static,
    ) -> Self {
        let bar = ProgressBar::new(all);
        let template = format!(
            "{{bar:40}} {{percent:>3}} %  {{human_pos}} of {{human_len}} {things}, {{eta}} left {{msg}}"
        );
        if let Ok(style) = ProgressStyle::with_template(&template) {
            bar.set_style(style);
        }
        let done = Arc::new(AtomicBool::new(false));
        let on_terminal = std::io::stderr().is_terminal();
        let painter = {
            let (bar, done) = (bar.clone(), done.clone());
            let paint = move || {
                let mut said = Instant::now();
                let mut shown = 0;
                while !done.load(Ordering::Relaxed) {
                    let made = count();
                    bar.set_position(made);
                    if !on_terminal && said.elapsed() >= BETWEEN_LINES && made != shown {
                        (said, shown) = (Instant::now(), made);
                        note!("{made} of {all} {things}");
                    }
                    park_timeout(Duration::from_millis(100));
                }
            };
            // Where there are no more threads to be had, the work matters more than its bar.
            Builder::new().spawn(paint).ok()
        };
        Self { display: bar, done, painter }
    }

    /// Shows a line: above the bar on a terminal, by itself elsewhere.
    #[cfg(feature = "harness")]
    pub(super) fn line(&self, line: &str) {
        if std::io::stderr().is_terminal() {
            self.display.println(super::plain(line));
        } else {
            note!("{line}");
        }
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.done.store(true, Ordering::Relaxed);
        if let Some(painter) = self.painter.take() {
            painter.thread().unpark();
            // A painter that panicked has nothing more to paint.
            let _ = painter.join();
        }
        self.display.finish_and_clear();
    }
}
