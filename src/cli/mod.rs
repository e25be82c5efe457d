//! The command line, one file per verb.

/// Prints a line to standard output; unlike `println!` it fails with an error, not a panic.
macro_rules! say {
    ($($argument:tt)*) => {
        $crate::cli::say(format_args!($($argument)*))?
    };
}

/// Prints a line to standard error. Where that cannot be written, what it would have said is of no use to
/// anybody, and no reason to give up.
macro_rules! note {
    ($($argument:tt)*) => {
        $crate::cli::note(format_args!($($argument)*))
    };
}

#[cfg(feature = "film")]
mod animate;
mod check;
#[cfg(feature = "harness")]
mod chosen;
#[cfg(feature = "harness")]
mod compact;
mod completions;
#[cfg(feature = "harness")]
mod export;
mod family;
mod found;
#[cfg(feature = "harness")]
mod import;
mod kind;
mod list;
mod man;
mod motion;
mod plan;
mod progress;
#[cfg(all(test, feature = "harness"))]
mod reference;
mod replay;
mod replayed;
#[cfg(feature = "harness")]
mod report;
#[cfg(feature = "harness")]
mod results;
mod robot;
#[cfg(feature = "harness")]
mod run;
mod sampling;
#[cfg(feature = "harness")]
mod serve;
mod signals;
#[cfg(feature = "harness")]
mod status;
#[cfg(feature = "harness")]
mod submit;
#[cfg(feature = "harness")]
mod trust;
#[cfg(feature = "harness")]
mod warnings;

use std::collections::BTreeSet;
use std::error::Error as _;
use std::ffi::OsString;
use std::fmt::{self, Write as _};
use std::io::{self, Write as _};
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::{Arc, LazyLock, Mutex};

use clap::{Parser, Subcommand};
use miette::{Diagnostic, MietteHandlerOpts, NamedSource, Report, SourceSpan};
use serde::Serialize;
use thiserror::Error;

use crate::input::InputError;
use crate::output::FileError;
use crate::reorientation::{ExportError, PlanError, TrajectoryError};
use crate::robot::Robot;
use crate::search::Watch;

/// Plan and benchmark the motion of free-floating space robots.
///
/// A robot arm on a satellite turns the satellite as it moves. The motions planned here bring the
/// arm where it should be and turn the base to where it should point, without fuel, as fast as the
/// joints' limits on rate, acceleration and jerk allow.
#[derive(Debug, Parser)]
#[command(name = "driftless", version, max_term_width = 100)]
struct Cli {
    #[command(subcommand)]
    verb: Verb,
}

#[derive(Debug, Subcommand)]
enum Verb {
    /// Run an experiment: every optimiser on every instance for every seed
    #[cfg(feature = "harness")]
    Run(run::Run),
    /// Print the job script that runs an experiment on a scheduler; with --go, submit it
    #[cfg(feature = "harness")]
    Submit(submit::Submit),
    /// Show which runs of an experiment are done, failed or missing
    #[cfg(feature = "harness")]
    Status(status::Status),
    /// Write tables, figures and an HTML page from stored results
    #[cfg(feature = "harness")]
    Report(report::Report),
    /// Merge many small result files into a few; other processes may run and read meanwhile
    #[cfg(feature = "harness")]
    Compact(compact::Compact),
    /// Export the runs of an experiment for other benchmarking tools, or its best motions
    #[cfg(feature = "harness")]
    Export(export::Export),
    /// Import runs of other programs as a folder of results, to be reported beside others
    #[cfg(feature = "harness")]
    Import(import::Import),
    /// Find the best motion for one task
    Plan(plan::Plan),
    /// Serve a task to an external optimiser, which asks for costs
    #[cfg(feature = "harness")]
    Serve(serve::Serve),
    /// Evaluate a given motion; without a file, the one published by Xiao et al. (2023)
    ///
    /// A trajectory of another program is checked against a task: the final attitude of the base, peaks, limits and joint ranges,
    /// whether it starts and ends at rest, and whether it jumps. It is interpolated as ROS 2's joint trajectory controller does it:
    /// linearly between points with positions only, by cubics with velocities, by quintics with accelerations.
    Replay(replay::Replay),
    /// Draw a motion as a film
    ///
    /// The robot is drawn with the shapes that its file states or, without any, with those that follow from its masses and joints; with
    /// the base's axes, the base at its goal, dashed, the way of the tool, and what the robot has to keep out of.
    #[cfg(feature = "film")]
    Animate(animate::Animate),
    /// List optimisers with their settings, problems and robots
    List(list::List),
    /// Convert robot files to and from URDF
    Robot(robot::RobotVerb),
    /// Validate an input file and print it with every default filled in
    Check(check::Check),
    /// Print a completion script for a shell
    Completions(completions::Completions),
    /// Write man pages
    Man(man::Man),
}

/// Why a command did not do what it was asked to.
#[derive(Debug, Error, Diagnostic)]
enum CliError {
    /// A file that cannot be read.
    #[error("cannot read {}", .path.display())]
    Unreadable { path: PathBuf, source: io::Error },
    /// A file that is not what was expected.
    #[error("{message}")]
    Input {
        message: String,
        #[source_code]
        text: Arc<NamedSource<String>>,
        #[label("here")]
        span: SourceSpan,
        #[help]
        help: Option<String>,
    },
    /// An argument that cannot be used.
    #[error("{message}")]
    Usage {
        message: String,
        #[help]
        help: Option<String>,
    },
    /// The system gives no more threads.
    #[error("cannot start worker threads: {0}")]
    Threads(String),
    /// The user wanted the command to end.
    #[error("interrupted: {0}")]
    Interrupted(String),
    /// A motion is not what the user requires.
    #[error("not as required: the motion {0}")]
    Required(String),
    /// A search could not begin or go on.
    #[error("the search failed")]
    Search(#[from] crate::search::Failure),
    /// A report of more runs was not replaced.
    #[cfg(feature = "harness")]
    #[error("{0}")]
    #[diagnostic(help("`--replace` replaces it; `--out DIR` puts the report elsewhere"))]
    Kept(String),
    /// A scheduler did not take a job, or did not do it.
    #[cfg(feature = "harness")]
    #[error("the job was shown and not done: {0}")]
    Job(String),
    /// No motion came of it.
    #[error("no motion found: no evaluation gave a finite cost")]
    #[diagnostic(help("are all limits, lengths, masses and boxes of a sensible size?"))]
    NoMotion,
    /// A motion could not be written.
    #[error(transparent)]
    Export(#[from] ExportError),
    /// A film could not be drawn or written.
    #[cfg(feature = "film")]
    #[error(transparent)]
    Film(crate::film::FilmError),
    /// A figure could not be drawn or written.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Plot(#[from] crate::figure::FigureError),
    /// A run could not be done or stored.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Run(#[from] crate::experiment::RunError),
    /// It is not known which part of an experiment is meant.
    #[cfg(feature = "harness")]
    #[error("{error}")]
    Shard {
        error: crate::experiment::ShardError,
        #[help]
        help: &'static str,
    },
    /// A stored result could not be read.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Store(#[from] crate::experiment::StoreError),
    /// Stored results could not be exported.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Suite(#[from] crate::export::SuiteError),
    /// Data of other programs could not be imported.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Import(#[from] crate::import::ImportError),
    /// A report could not be made.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Report(#[from] crate::report::ReportError),
    /// A table could not be made.
    #[cfg(feature = "harness")]
    #[error(transparent)]
    Table(#[from] polars::error::PolarsError),
    /// A file could not be put into words.
    #[error("cannot write what was resolved: {0}")]
    Resolved(String),
    /// A file could not be written.
    #[error(transparent)]
    File(#[from] FileError),
}

#[cfg(feature = "harness")]
impl From<crate::experiment::FolderError> for CliError {
    fn from(error: crate::experiment::FolderError) -> Self {
        use crate::experiment::FolderError;
        match error {
            FolderError::Input(error) => error.into(),
            FolderError::Store(error) => Self::Store(error),
            FolderError::File(error) => Self::File(error),
            FolderError::NoResults(_) => {
                Self::Usage { message: error.to_string(), help: Some(results::HELP.to_owned()) }
            }
            FolderError::Another { .. }
            | FolderError::Unnamed { .. }
            | FolderError::Imported { .. }
            | FolderError::Own(_) => Self::Usage {
                message: error.to_string(),
                help: Some("choose another folder with --out".to_owned()),
            },
            FolderError::Written(message) => Self::Resolved(message),
        }
    }
}

impl From<InputError> for CliError {
    fn from(error: InputError) -> Self {
        match error {
            InputError::Read { path, source } => Self::Unreadable { path, source },
            InputError::Content(mistake) => {
                if let Some(message) = mistake.in_a_window() {
                    return Self::Usage { message, help: mistake.help };
                }
                let name = mistake.path.display().to_string();
                Self::Input {
                    message: mistake.message,
                    text: Arc::new(NamedSource::new(name, mistake.text).with_language("TOML")),
                    span: mistake.span.into(),
                    help: mistake.help,
                }
            }
        }
    }
}

impl From<PlanError> for CliError {
    fn from(error: PlanError) -> Self {
        match error {
            PlanError::Input(error) => error.into(),
            PlanError::ForSplines(option) => family::FamilyOptions::for_splines(option),
            PlanError::Search(failure) => Self::Search(failure),
            PlanError::Interrupted => Self::Interrupted("no motion was found before".to_owned()),
            PlanError::NoMotion => Self::NoMotion,
            PlanError::Several => Self::Usage { message: error.to_string(), help: None },
        }
    }
}

impl From<TrajectoryError> for CliError {
    fn from(error: TrajectoryError) -> Self {
        let message = error.to_string();
        match error {
            TrajectoryError::File(FileError { path, source, .. }) => {
                Self::Unreadable { path, source }
            }
            TrajectoryError::Content { .. } => Self::Usage { message, help: None },
        }
    }
}

#[cfg(feature = "film")]
impl From<crate::film::FilmError> for CliError {
    fn from(error: crate::film::FilmError) -> Self {
        use crate::film::FilmError;
        match error {
            FilmError::File(error) => Self::File(error),
            FilmError::Interrupted => Self::Interrupted("no film was written".to_owned()),
            FilmError::NoFfmpeg { .. } => Self::Usage {
                message: error.to_string(),
                help: Some(
                    "install ffmpeg, or write .gif, .apng or a folder of pictures without it"
                        .to_owned(),
                ),
            },
            error => Self::Film(error),
        }
    }
}

#[cfg(feature = "harness")]
impl From<crate::experiment::ShardError> for CliError {
    fn from(error: crate::experiment::ShardError) -> Self {
        Self::Shard { help: error.help(), error }
    }
}

impl From<toml::ser::Error> for CliError {
    fn from(error: toml::ser::Error) -> Self {
        Self::Resolved(error.to_string())
    }
}

impl CliError {
    fn exit_status(&self) -> u8 {
        match self {
            Self::Unreadable { .. } | Self::Input { .. } | Self::Usage { .. } => 2,
            #[cfg(feature = "harness")]
            Self::Shard { .. }
            | Self::Import(crate::import::ImportError::Content { .. })
            | Self::Report(crate::report::ReportError::NoChart { .. }) => 2,
            Self::Required(_) => 3,
            _ => 1,
        }
    }
}

/// Does what the arguments of the process ask; see [`main_with`].
pub fn main() -> ExitCode {
    main_with(std::env::args_os()).into()
}

/// Parses arguments, the first of which is the program's name, and does what they ask: exit status 0 done, 1 failed, 2 bad usage or
/// input, 3 not as required. Help and bad usage end the process.
pub fn main_with(arguments: impl IntoIterator<Item = OsString>) -> u8 {
    let cli = Cli::parse_from(arguments);
    let hook = |_: &_| -> Box<dyn miette::ReportHandler> {
        Box::new(MietteHandlerOpts::new().terminal_links(false).context_lines(1).build())
    };
    // Only fails where a hook is set already, which then serves as well.
    let _ = miette::set_hook(Box::new(hook));
    let outcome = match cli.verb {
        #[cfg(feature = "harness")]
        Verb::Run(run) => run.execute(),
        #[cfg(feature = "harness")]
        Verb::Submit(submit) => submit.execute(),
        #[cfg(feature = "harness")]
        Verb::Status(status) => status.execute(),
        #[cfg(feature = "harness")]
        Verb::Report(report) => report.execute(),
        #[cfg(feature = "harness")]
        Verb::Compact(compact) => compact.execute(),
        #[cfg(feature = "harness")]
        Verb::Export(export) => export.execute(),
        #[cfg(feature = "harness")]
        Verb::Import(import) => import.execute(),
        Verb::Plan(plan) => plan.execute(),
        #[cfg(feature = "harness")]
        Verb::Serve(serve) => serve.execute(),
        Verb::Replay(replay) => replay.execute(),
        #[cfg(feature = "film")]
        Verb::Animate(animate) => animate.execute(),
        Verb::List(list) => list.execute(),
        Verb::Robot(robot) => robot.execute(),
        Verb::Check(check) => check.execute(),
        Verb::Completions(completions) => completions.execute(),
        Verb::Man(man) => man.execute(),
    };
    match outcome {
        Ok(()) => 0,
        Err(error) => {
            let status = error.exit_status();
            // Where that cannot be written, what it would have said is of no use to anybody.
            let _ = writeln!(io::stderr(), "{}", shown_error(error));
            status
        }
    }
}

/// Prints a line to standard output. A reader who has seen enough and left is no error.
fn say(line: fmt::Arguments<'_>) -> Result<(), CliError> {
    match writeln!(io::stdout(), "{}", plain(&line.to_string())) {
        Err(source) if source.kind() != io::ErrorKind::BrokenPipe => {
            let path = PathBuf::from("standard output");
            Err(FileError { action: "write to", path, source }.into())
        }
        _ => Ok(()),
    }
}

/// Prints a line to standard error, if it can be.
fn note(line: fmt::Arguments<'_>) {
    let _ = writeln!(io::stderr(), "{}", plain(&line.to_string()));
}

/// A text without characters that a terminal takes for orders, such as those that begin escape sequences: each is
/// written as JSON writes it.
fn plain(text: &str) -> String {
    let is_order = |c: char| c.is_control() && c != '\n' && c != '\t';
    text.chars().fold(String::with_capacity(text.len()), |mut plain, c| {
        if is_order(c) {
            let _ = write!(plain, "\\u{:04x}", u32::from(c));
        } else {
            plain.push(c);
        }
        plain
    })
}

/// An error as a terminal shows it: in colour where it has any, and nothing else of what a terminal takes for orders.
fn shown_error(error: CliError) -> String {
    let shown = format!("{:?}", Report::new(error));
    let mut parts = shown.split("\x1b[");
    let mut text = plain(parts.next().unwrap_or_default());
    for part in parts {
        let rest = part.trim_start_matches(|c: char| c.is_ascii_digit() || c == ';');
        let colour = &part[..part.len() - rest.len()];
        text += if rest.starts_with('m') { "\x1b[" } else { "\\u001b[" };
        text += colour;
        text += &plain(rest);
    }
    text
}

/// Says once what is unphysical about a robot, unless the robot comes with the program.
fn warn_of(robot: &Robot) {
    warn_once(robot.unexpected_warning());
}

/// Prints a warning that was not printed before.
fn warn_once(warning: Option<String>) {
    static PRINTED: Mutex<BTreeSet<String>> = Mutex::new(BTreeSet::new());
    if let (Some(warning), Ok(mut printed)) = (warning, PRINTED.lock())
        && printed.insert(warning.clone())
    {
        note!("warning: {warning}");
    }
}

/// Prints one JSON object.
fn say_json(value: &impl Serialize) -> Result<(), CliError> {
    let text = serde_json::to_string_pretty(value);
    say!("{}", text.map_err(|error| CliError::Resolved(error.to_string()))?);
    Ok(())
}

/// Set by Ctrl-C and other signals that ask the program to end.
fn watch() -> Arc<Watch> {
    static WATCH: LazyLock<Arc<Watch>> = LazyLock::new(|| {
        let watch = Arc::new(Watch::default());
        signals::interrupt_on_signals(&watch);
        watch
    });
    WATCH.clone()
}

/// Starts the threads that work is shared out to, before there is any: later, those that are missing are a panic.
fn start_worker_threads() -> Result<(), CliError> {
    // An error without a cause is that they were started already.
    match rayon::ThreadPoolBuilder::new().build_global() {
        Err(error) if error.source().is_some() => Err(CliError::Threads(error.to_string())),
        _ => Ok(()),
    }
}

/// A path given as an argument, for messages.
fn shown(path: Option<&PathBuf>, otherwise: &str) -> String {
    path.map_or_else(|| otherwise.to_owned(), |path| path.display().to_string())
}
