//! `driftless list`.

use std::sync::Arc;

use clap::Args;
use schemars::schema_for;

use super::CliError;
use crate::functions::TestFunction;
use crate::input::Document;
use crate::lanes::Width;
use crate::optimiser::Settings;
use crate::reorientation::{
    Boxes, FamilyName, Formulated, Formulation, SearchedFamily as _, TaskFile, TaskProblem,
};
use crate::robot::Robot;
use crate::search::Problem as _;
use crate::trajectory::Spline;

/// Show optimisers, problems and robots with their settings
#[derive(Debug, Args)]
pub(super) struct List {}

impl List {
    #[expect(clippy::unused_self, reason = "every verb is a value that executes")]
    pub(super) fn execute(self) -> Result<(), CliError> {
        say!("optimisers, with their settings and defaults");
        for settings in Settings::all() {
            say!("\n  {}", settings.name());
            for setting in settings.describe() {
                say!("    {} = {}", setting.name, setting.default);
                say!("        {}", setting.meaning);
            }
        }
        problems()?;
        functions()?;
        let width = Width::widest();
        say!(
            "\nthis processor evaluates {} places of a path at once ({})",
            width.lanes(),
            width.name()
        );
        say!("\nrobots that come with the program");
        for name in Robot::embedded_names() {
            if let Some(document) = Robot::embedded(name) {
                let robot = Robot::from_document(&document)?;
                say!("\n  {name}: {} joints, {:.1} kg", robot.joint_count(), robot.total_mass());
            }
        }
        Ok(())
    }
}

/// The formulations of the paper's task with the boxes that are searched.
fn problems() -> Result<(), CliError> {
    let document = TaskFile::paper();
    let (problem, boxes) = TaskFile::read(&document)?.build(&document)?;
    let problem = Arc::new(problem);
    say!("\nproblems: the reorientation task in these formulations");
    say!("(dimensions and boxes are those of the paper's task)");
    for formulation in Formulation::ALL {
        let formulated = Formulated::new(formulation, problem.clone(), &boxes)
            .map_err(|error| document.error_at(0..0, error, None))?;
        say!("\n  {}: {} variables", formulation.name(), formulated.bounds().len());
        say!("    {}", variables(formulation, &boxes));
    }
    splines()
}

/// The same over splines.
fn splines() -> Result<(), CliError> {
    let name = FamilyName::Spline.name();
    let text = format!("[trajectory]\nfamily = \"{name}\"\n");
    let document = Document::embedded("the paper's task", &text);
    let TaskProblem::Spline(problem, boxes) = TaskFile::read(&document)?.problem(&document)? else {
        return Ok(());
    };
    let (knots, problem) = (problem.family().knots().clone(), Arc::new(problem));
    say!(
        "\nand over splines, which files ask for by `[trajectory] family = \"{name}\"`, of {} pieces and degree {}",
        knots.pieces(),
        knots.degree()
    );
    let points = "control points in the joint's range and a tenth of its width beyond";
    let [shortest, longest] = boxes.duration;
    for &formulation in Spline::FORMULATIONS {
        let formulated = Spline::formulated(formulation, problem.clone(), &boxes)
            .map_err(|error| document.error_at(0..0, error, None))?;
        let duration = match formulation {
            Formulation::TimeFree => "; t_f is the shortest within the limits".to_owned(),
            _ => format!(", {shortest:.3} s ≤ t_f ≤ {longest:.3} s"),
        };
        say!("\n  {}: {} variables", formulation.name(), formulated.bounds().len());
        say!("    {points}{duration}");
    }
    Ok(())
}

/// The test functions with what their documentation says.
fn functions() -> Result<(), CliError> {
    say!("\ntest functions of two variables or more in [-5, 5], least value 0");
    let schema = schema_for!(TestFunction);
    for variant in schema.get("oneOf").and_then(|all| all.as_array()).into_iter().flatten() {
        let text = |key: &str| variant.get(key).and_then(|text| text.as_str()).unwrap_or_default();
        say!("\n  {}\n    {}", text("const"), text("description").replace('`', ""));
    }
    Ok(())
}

fn variables(formulation: Formulation, boxes: &Boxes) -> String {
    let coefficients = || {
        let each = boxes.coefficient.iter().enumerate();
        let each: Vec<_> = each.map(|(k, c)| format!("|c_{}| ≤ {c}", k + 1)).collect();
        each.join(", ")
    };
    let [shortest, longest] = boxes.duration;
    let duration = format!("{shortest:.3} s ≤ t_f ≤ {longest:.3} s");
    match formulation {
        Formulation::Raw => {
            let each = boxes.alpha.iter().enumerate();
            let each: Vec<_> = each.map(|(k, a)| format!("|α_{}| ≤ {a:.3e}", k + 6)).collect();
            format!("{}, {duration}", each.join(", "))
        }
        Formulation::Scaled => format!("{}, {duration}", coefficients()),
        Formulation::TimeFree => {
            format!("{}; t_f is the shortest within the limits", coefficients())
        }
    }
}
