//! `driftless man`.

use std::path::{Path, PathBuf};

use clap::{Args, Command, CommandFactory as _};

use super::{Cli, CliError};
use crate::output::{FileError, create_folder, write_file};

/// Write man pages
#[derive(Debug, Args)]
pub(super) struct Man {
    /// Folder to write a page for `driftless` and one for each verb into, created if necessary; without it, the page of
    /// `driftless` is printed
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
}

impl Man {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let mut command = Cli::command().disable_help_subcommand(true);
        // Names subcommands after their parents: `driftless-robot-convert`.
        command.build();
        match self.out {
            None => {
                let path = Path::new("standard output");
                say!("{}", String::from_utf8_lossy(&page(&command, path)?).trim_end());
                Ok(())
            }
            Some(folder) => {
                create_folder(&folder)?;
                write(&command, &folder)
            }
        }
    }
}

/// Writes the page of a command and those of its subcommands.
fn write(command: &Command, folder: &Path) -> Result<(), CliError> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name());
    let path = folder.join(format!("{name}.1"));
    write_file(&path, &page(command, &path)?)?;
    command.get_subcommands().try_for_each(|verb| write(verb, folder))
}

fn page(command: &Command, path: &Path) -> Result<Vec<u8>, FileError> {
    let mut page = Vec::new();
    let rendered = clap_mangen::Man::new(command.clone()).render(&mut page);
    let failed = |source| FileError { action: "write", path: path.to_owned(), source };
    rendered.map(|()| page).map_err(failed)
}
