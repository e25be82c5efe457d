//! `driftless list`.

use std::sync::Arc;

use clap::Args;
use schemars::schema_for;
use serde::Serialize;
use serde_json::{Value, json};

use super::{CliError, say_json};
use crate::functions::TestFunction;
use crate::input::Document;
use crate::lanes::Width;
use crate::optimiser::{Setting, Settings};
use crate::reorientation::{
    Boxes, FamilyName, Formulated, Formulation, SearchedFamily as _, TaskFile, TaskProblem,
};
use crate::robot::Robot;
use crate::search::Problem as _;
use crate::trajectory::{Knots, Spline};
use crate::words::plural;

/// List optimisers with their settings, problems and robots
#[derive(Debug, Args)]
pub(super) struct List {
    /// Print one JSON object
    #[arg(long)]
    json: bool,
}

/// A formulation of the paper's task.
#[derive(Debug, Serialize)]
struct FormulationJson {
    family: &'static str,
    formulation: &'static str,
    variables: usize,
    #[serde(rename = "box")]
    bounds: String,
}

/// A test function.
#[derive(Debug, Serialize)]
struct FunctionJson {
    name: String,
    description: String,
}

/// A robot that comes with the program.
#[derive(Debug, Serialize)]
struct RobotJson {
    name: &'static str,
    joints: usize,
    mass_kg: f64,
}

impl List {
    pub(super) fn execute(self) -> Result<(), CliError> {
        let (sines, splines) = (sines()?, splines()?);
        let (functions, robots) = (functions(), robots()?);
        let width = Width::widest();
        if self.json {
            let optimiser = |settings: &Settings| {
                let setting = |own: Setting| json!({ "name": own.name, "default": own.default, "meaning": own.meaning });
                let own: Vec<_> = settings.describe().into_iter().map(setting).collect();
                json!({ "name": settings.name(), "settings": own })
            };
            return say_json(&json!({
                "optimisers": Settings::all().iter().map(optimiser).collect::<Vec<_>>(),
                "formulations": sines.iter().chain(&splines.1).collect::<Vec<_>>(),
                "functions": functions,
                "processor": { "lanes": width.lanes(), "vectors": width.name() },
                "robots": robots,
            }));
        }
        say!("optimisers, with their settings and defaults");
        for settings in Settings::all() {
            say!("\n  {}", settings.name());
            for setting in settings.describe() {
                say!("    {} = {}", setting.name, setting.default);
                say!("        {}", setting.meaning);
            }
        }
        say!("\nproblems: the reorientation task in these formulations");
        say!("(dimensions and boxes are those of the paper's task)");
        sines.iter().try_for_each(say_formulation)?;
        let (knots, splines) = splines;
        say!(
            "\nand over splines, which files ask for by `[trajectory] family = \"{}\"`, of {} and degree {}",
            FamilyName::Spline.name(),
            plural(knots.pieces(), "piece"),
            knots.degree()
        );
        splines.iter().try_for_each(say_formulation)?;
        say!("\ntest functions of two variables or more in [-5, 5], least value 0");
        for FunctionJson { name, description } in functions {
            say!("\n  {name}\n    {description}");
        }
        say!(
            "\nthis processor evaluates {} of a path at once ({})",
            plural(width.lanes(), "place"),
            width.name()
        );
        say!("\nrobots that come with the program");
        for RobotJson { name, joints, mass_kg } in robots {
            say!("\n  {name}: {}, {mass_kg:.1} kg", plural(joints, "joint"));
        }
        Ok(())
    }
}

fn say_formulation(own: &FormulationJson) -> Result<(), CliError> {
    say!("\n  {}: {}", own.formulation, plural(own.variables, "variable"));
    say!("    {}", own.bounds);
    Ok(())
}

/// The formulations of the paper's task with the boxes that are searched.
fn sines() -> Result<Vec<FormulationJson>, CliError> {
    let document = TaskFile::paper();
    let (problem, boxes) = TaskFile::read(&document)?.build(&document)?;
    let problem = Arc::new(problem);
    let described = |formulation: Formulation| {
        let formulated = Formulated::new(formulation, problem.clone(), &boxes)
            .map_err(|error| document.error_at(0..0, error, None))?;
        Ok(FormulationJson {
            family: FamilyName::SinePolynomial.name(),
            formulation: formulation.name(),
            variables: formulated.bounds().len(),
            bounds: variables(formulation, &boxes),
        })
    };
    Formulation::ALL.into_iter().map(described).collect()
}

/// The same over splines, and their knots.
fn splines() -> Result<(Knots, Vec<FormulationJson>), CliError> {
    let name = FamilyName::Spline.name();
    let text = format!("[trajectory]\nfamily = \"{name}\"\n");
    let document = Document::embedded("the paper's task", &text);
    let TaskProblem::Spline(problem, boxes) = TaskFile::read(&document)?.problem(&document)? else {
        return Err(CliError::Resolved("the family is not that of splines".to_owned()));
    };
    let (knots, problem) = (problem.family().knots().clone(), Arc::new(problem));
    let points = "control points in the joint's range and a tenth of its width beyond";
    let [shortest, longest] = boxes.duration;
    let described = |&formulation: &Formulation| {
        let formulated = Spline::formulated(formulation, problem.clone(), &boxes)
            .map_err(|error| document.error_at(0..0, error, None))?;
        let duration = match formulation {
            Formulation::TimeFree => "; t_f is the shortest within the limits".to_owned(),
            _ => format!(", {shortest:.3} s ≤ t_f ≤ {longest:.3} s"),
        };
        Ok(FormulationJson {
            family: name,
            formulation: formulation.name(),
            variables: formulated.bounds().len(),
            bounds: format!("{points}{duration}"),
        })
    };
    let all: Result<Vec<_>, CliError> = Spline::FORMULATIONS.iter().map(described).collect();
    Ok((knots, all?))
}

/// The test functions with what their documentation says.
fn functions() -> Vec<FunctionJson> {
    let schema = schema_for!(TestFunction);
    let variants = schema.get("oneOf").and_then(|all| all.as_array()).into_iter().flatten();
    let described = |variant: &Value| {
        let text = |key: &str| variant.get(key).and_then(Value::as_str).unwrap_or_default();
        FunctionJson {
            name: text("const").to_owned(),
            description: text("description").replace('`', ""),
        }
    };
    variants.map(described).collect()
}

fn robots() -> Result<Vec<RobotJson>, CliError> {
    let documents = Robot::embedded_names().filter_map(|name| Some((name, Robot::embedded(name)?)));
    let described = |(name, document): (&'static str, Document)| {
        let robot = Robot::from_document(&document)?;
        Ok(RobotJson { name, joints: robot.joint_count(), mass_kg: robot.total_mass() })
    };
    documents.map(described).collect()
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
