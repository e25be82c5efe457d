//! `driftless serve`.

use std::ffi::OsStr;
use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;

use super::family::FamilyOptions;
use super::found::told;
use super::kind::read_task;
use super::motion::MotionFiles;
use super::plan::warn_of_weights;
use super::progress::Bar;
use super::{CliError, shown, start_worker_threads, watch};
use crate::process::{Client, Socket, TOKEN};
use crate::reorientation::{
    Asked, Formulated, Formulation, PlanError, Planned, Search, TaskFile, TaskProblem,
};
use crate::task::TaskTable;

/// Serve a task to an external optimiser, which asks for costs
#[derive(Debug, Args)]
pub(super) struct Serve {
    /// Task file, or the name of a shipped robot, which has its own task [default: the paper's task]
    #[arg(value_name = "TASK")]
    file: Option<PathBuf>,
    /// Variables to search in: raw (sine polynomials only), scaled or time-free [default: time-free]
    #[arg(long, value_name = "NAME")]
    formulation: Option<String>,
    #[command(flatten)]
    family: FamilyOptions,
    /// Seed to pass to the optimiser, below 2³¹
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = clap::value_parser!(u64).range(..1 << 31))]
    seed: u64,
    /// Maximum number of evaluations
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..))]
    budget: u64,
    /// Listen on a port of 127.0.0.1, by default any free one, instead of standard input and output. Clients must send the token
    /// in the environment variable `DRIFTLESS_TOKEN` or, if that is not set, the one that is printed
    #[arg(long, value_name = "PORT", num_args = 0..=1, require_equals = true, default_missing_value = "0")]
    listen: Option<u16>,
    #[command(flatten)]
    files: MotionFiles,
}

impl Serve {
    pub(super) fn execute(self) -> Result<(), CliError> {
        start_worker_threads()?;
        self.files.check()?;
        let formulation = self.formulation()?;
        let document = read_task(self.file.as_deref())?;
        let TaskFile { task, trajectory } = TaskFile::read(&document)?;
        let trajectory = self.family.choice().over(trajectory, false);
        let file = TaskFile { trajectory: trajectory.map_err(FamilyOptions::for_splines)?, task };
        let refused = |error| document.error_at(0..0, error, None);
        let problem = file.problem(&document)?;
        self.files.check_joints(&problem.task().robot)?;
        warn_of_weights(problem.task());
        if problem.task().already_there().is_some() {
            let task = shown(self.file.as_ref(), "the paper's task");
            let message = format!("{task}: already there: there is nothing to search");
            return Err(CliError::Usage { message, help: None });
        }
        match problem {
            TaskProblem::SinePolynomial(problem, boxes) => {
                let formulation = formulation.unwrap_or(Formulation::TimeFree);
                let formulated =
                    Formulated::new(formulation, Arc::new(problem), &boxes).map_err(refused)?;
                self.serve(&file.task, |client, search| search.sines(client, &formulated, &boxes))
            }
            TaskProblem::Spline(problem, boxes) => {
                let problem = Arc::new(problem);
                let formulated = match formulation {
                    None | Some(Formulation::TimeFree) => Formulated::free_form(problem),
                    Some(Formulation::Scaled) => Formulated::free_form_scaled(problem, &boxes),
                    Some(Formulation::Raw) => {
                        return Err(CliError::Usage {
                            message: "found `--formulation raw` for splines, expected scaled or time-free"
                                .to_owned(),
                            help: None,
                        });
                    }
                };
                let formulated = formulated.map_err(refused)?;
                let longest = boxes.duration[1];
                self.serve(&file.task, |client, search| {
                    search.best(client, &formulated, &formulated, longest)
                })
            }
        }
    }

    fn formulation(&self) -> Result<Option<Formulation>, CliError> {
        let Some(name) = &self.formulation else { return Ok(None) };
        match Formulation::named(Some(name)) {
            Some(formulation) => Ok(Some(formulation)),
            None => Err(CliError::Usage {
                message: format!("no formulation `{name}`, expected raw, scaled or time-free"),
                help: None,
            }),
        }
    }

    /// The other end of the line.
    fn client(&self) -> Result<Client, CliError> {
        let Some(port) = self.listen else { return Ok(Client::on_standard_streams()?) };
        let own = std::env::var_os(TOKEN).filter(|token| !token.is_empty());
        let own = own.map(|token| usable(&token)).transpose()?;
        let is_known = own.is_some();
        let socket = Socket::bind(port, own)?;
        if is_known {
            note!("listening on {}, token in {TOKEN}", socket.address());
        } else {
            note!("listening on {}, token {}", socket.address(), socket.token());
        }
        Ok(Client::on_socket(socket)?)
    }

    /// Answers until the search is over, and says what it has come to: to the optimiser, and to people.
    fn serve(
        &self,
        task: &TaskTable,
        search: impl FnOnce(&Client, Search<'_>) -> Result<Planned, PlanError>,
    ) -> Result<(), CliError> {
        let client = self.client()?;
        let found = {
            let watch = watch();
            let _bar = Bar::new(self.budget, watch.clone());
            let found =
                search(&client, Search { seed: self.seed, budget: self.budget, watch: &watch });
            found.inspect_err(|error| match error {
                PlanError::Search(failure) => client.refuse(failure.reason()),
                other => client.refuse(&other.to_string()),
            })?
        };
        let name = client.name();
        client.tell(&found.json(Asked {
            task: shown(self.file.as_ref(), "xiao2023"),
            inherited: task.inherited(),
            optimiser: &name,
            seed: self.seed,
        }));
        let file = shown(self.file.as_ref(), "the paper's task");
        note!("{file} by {name}, seed {}", self.seed);
        note!("{}", told(&found));
        self.files.write(&*found.problem, &found.coefficients, found.assessment.duration)?;
        if found.interrupted {
            return Err(CliError::Interrupted("this is the best motion so far".to_owned()));
        }
        found.failure.map_or(Ok(()), |failure| Err(CliError::Search(failure)))
    }
}

/// A token that can stand in a line.
fn usable(token: &OsStr) -> Result<String, CliError> {
    let is_plain =
        |token: &&str| token.len() <= 1000 && token.chars().all(|c| c.is_ascii_graphic());
    token.to_str().filter(is_plain).map(str::to_owned).ok_or_else(|| CliError::Usage {
        message: format!("{TOKEN} is not a valid token, expected at most 1000 letters, digits and punctuation characters"),
        help: None,
    })
}
