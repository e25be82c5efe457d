//! `driftless robot`.

use std::path::{Path, PathBuf};

use clap::{Args, Subcommand, ValueEnum};

use super::{CliError, read_robot_or, warn_of};
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
    /// Turn URDF into a robot file, or a robot file into URDF for simulators and other planners
    Convert(Convert),
}

#[derive(Debug, Args)]
struct Convert {
    /// A robot file, a URDF or the name of a robot that comes with the program
    #[arg(value_name = "ROBOT")]
    robot: PathBuf,
    /// Format to write [default: that of --out, or else the other one]
    #[arg(long, value_enum)]
    to: Option<Format>,
    /// File to write instead of standard output
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
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
        let document = read_robot_or(&self.robot)?;
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
        match &self.out {
            None => say!("{}", text.trim_end()),
            Some(path) => write_file(path, text.as_bytes())?,
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
