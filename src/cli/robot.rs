//! `driftless robot`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};
use serde_json::json;

use super::kind::{self, Kind, shipped};
use super::{CliError, say_json, warn_of};
use crate::input::Document;
use crate::output::write_file;
use crate::robot::RobotFile;

/// Convert robot files
#[derive(Debug, Args)]
pub(super) struct RobotVerb {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Convert a URDF to a robot file, or a robot file to URDF for simulators and other planners
    Convert(Convert),
}

#[derive(Debug, Args)]
struct Convert {
    /// Robot file, URDF or name of a shipped robot
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Format to write [default: by the extension of --out, otherwise the one that the input is not in]
    #[arg(long, value_enum)]
    to: Option<Format>,
    /// File to write [default: standard output]
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Format {
    /// Robot file
    Toml,
    /// URDF, with all frames, inertias and shapes
    Urdf,
}

impl Format {
    fn of(path: &Path) -> Option<Self> {
        match path.extension()?.to_str()? {
            "toml" => Some(Self::Toml),
            "urdf" | "xml" => Some(Self::Urdf),
            _ => None,
        }
    }
}

impl RobotVerb {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let Verb::Convert(convert) = self.verb;
        convert.execute()
    }
}

impl Convert {
    fn execute(self) -> Result<(), CliError> {
        let document = match shipped(&self.robot) {
            Some((_, document)) => document,
            None => kind::read(&self.robot, Kind::Robot)?,
        };
        let format = self.format(&document)?;
        let file = RobotFile::read(&document)?;
        let text = match format {
            Format::Toml => toml::to_string(&file)?,
            Format::Urdf => {
                let robot = file.build(&document)?;
                warn_of(&robot);
                robot.to_urdf()
            }
        };
        if let Some(path) = &self.out {
            write_file(path, text.as_bytes())?;
        }
        if self.json {
            return say_json(&json!({
                "robot": self.robot.display().to_string(),
                "format": if format == Format::Toml { "toml" } else { "urdf" },
                "file": self.out.as_ref().map(|path| path.display().to_string()),
                "text": self.out.is_none().then_some(text),
            }));
        }
        if self.out.is_none() {
            say!("{}", text.trim_end());
        }
        Ok(())
    }

    fn format(&self, document: &Document) -> Result<Format, CliError> {
        let named = self.out.as_deref().map(|path| (path, Format::of(path)));
        match (self.to, named) {
            (Some(format), None | Some((_, None))) => Ok(format),
            (asked, Some((_, Some(format)))) if asked.is_none_or(|asked| asked == format) => {
                Ok(format)
            }
            (None, None) if document.is_xml() => Ok(Format::Toml),
            (None, None) => Ok(Format::Urdf),
            (asked, Some((path, _))) => Err(CliError::Usage {
                message: match asked {
                    None => format!("{} ends in neither .toml nor .urdf", path.display()),
                    Some(_) => format!("--to asks for another format than {}", path.display()),
                },
                help: None,
            }),
        }
    }
}
