//! `docs/reference/commands.md` beside what the command says of itself.

use std::fs;

use clap_markdown::{MarkdownOptions, help_markdown_custom};

use super::Cli;

const FILE: &str = "docs/reference/commands.md";

/// `INSTA_UPDATE=always` writes it anew, as it does for snapshots.
#[test]
fn the_reference_lists_every_verb_and_option() {
    let options = MarkdownOptions::new()
        .title("Commands".to_owned())
        .show_footer(false)
        .show_table_of_contents(true);
    let text = help_markdown_custom::<Cli>(&options);
    let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
    let text = lines.join("\n").trim_end().to_owned() + "\n";
    if std::env::var_os("INSTA_UPDATE").is_some_and(|update| update == "always") {
        fs::write(FILE, &text).unwrap();
    }
    let stored = fs::read_to_string(FILE).unwrap_or_default();
    assert!(stored == text, "{FILE} is out of date; `just accept` writes it anew");
}
