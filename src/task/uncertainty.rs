//! What is not known exactly: masses, inertias, where the arm is mounted, how well joints follow their paths.

use std::collections::BTreeMap;
use std::num::NonZeroUsize;

use nalgebra::Vector3;
use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use serde::{Deserialize, Serialize};
use toml::Spanned;

use super::Task;
use super::joints::Limit;
use crate::input::{Document, Fraction, InputError, NonNegative, count};
use crate::robot::{Robot, RobotError, unit};

/// The `[task.uncertainty]` table.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default, expecting = "a table")]
pub(super) struct UncertaintyTable {
    pub(super) mass: Spanned<Shares>,
    pub(super) inertia: Spanned<Shares>,
    pub(super) mount_m: NonNegative,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joint_deg: Option<Spanned<Limit>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) joint: Option<Spanned<Limit>>,
    #[serde(deserialize_with = "count::<100_000, _, _>")]
    pub(super) samples: NonZeroUsize,
    pub(super) seed: u64,
}

/// A share of all bodies, or shares of some by name.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(untagged, expecting = "a number from 0 to 1, or a table of such numbers by body")]
pub(super) enum Shares {
    All(Fraction),
    Named(BTreeMap<String, Fraction>),
}

impl Shares {
    /// For base and links: the base's comes first.
    pub(super) fn listed(
        shares: &Spanned<Self>,
        robot: &Robot,
        document: &Document,
    ) -> Result<Vec<f64>, InputError> {
        match shares.get_ref() {
            Self::All(share) => Ok(vec![share.0; 1 + robot.links().len()]),
            Self::Named(shares_by_name) => {
                let mut listed = vec![0.0; 1 + robot.links().len()];
                for (name, share) in shares_by_name {
                    let body = robot.heavy_bodies().find(|(_, body)| body == name);
                    let (body, _) = body.ok_or_else(|| {
                        let message =
                            format!("robot `{}` has no body `{name}` with mass", robot.name());
                        let names: Vec<&str> = robot.heavy_bodies().map(|(_, name)| name).collect();
                        let help = format!("its bodies are {}", names.join(", "));
                        document.error_at(shares.span(), message, Some(help))
                    })?;
                    listed[place(body)] = share.0;
                }
                Ok(listed)
            }
        }
    }
}

/// Where a body stands in lists that begin with the base.
fn place(body: Option<usize>) -> usize {
    body.map_or(0, |link| link + 1)
}

/// How far the robot may be from what its file says, each part for itself and as likely by any amount up to that.
#[derive(Debug, Clone, PartialEq)]
pub struct Uncertainty {
    /// Share of each body's mass, the base's before those of links.
    pub masses: Vec<f64>,
    /// Share of each body's inertia, beside what the mass changes of it.
    pub inertias: Vec<f64>,
    /// How far the arm may be mounted from where it should, along each base axis \[m\].
    pub mount: f64,
    /// By how much each joint may be off its path all the way \[rad or m\].
    pub joints: Vec<f64>,
    /// How many robots are drawn, and the seed of the random numbers.
    pub samples: usize,
    /// The seed of the random numbers.
    pub seed: u64,
}

/// The `robust` table of a `[task]`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, expecting = "a table")]
pub(super) struct RobustTable {
    #[serde(deserialize_with = "count::<10_000, _, _>")]
    samples: NonZeroUsize,
    #[serde(default)]
    of: RobustOf,
    #[serde(skip_serializing_if = "Option::is_none")]
    weight: Option<NonNegative>,
    #[serde(skip_serializing_if = "Option::is_none")]
    seed: Option<u64>,
}

/// Which of the residuals of sampled robots counts.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum RobustOf {
    /// All of them alike.
    Mean,
    /// The largest.
    #[default]
    Worst,
}

/// A wish that the base ends near its goal with sampled robots, too.
#[derive(Debug, Clone, PartialEq)]
pub struct Robust {
    /// What is not known, how many robots are drawn, and the seed of the random numbers.
    pub uncertainty: Uncertainty,
    /// Which of their residuals counts.
    pub of: RobustOf,
    /// What a degree of that costs.
    pub weight: f64,
}

impl RobustTable {
    /// The wish; where the table says nothing, a degree costs as much as with the robot itself, and robots are others than those that
    /// motions are judged by.
    pub(super) fn build(&self, uncertainty: &Uncertainty, base_weight: f64) -> Robust {
        let seed = self.seed.unwrap_or_else(|| uncertainty.seed.wrapping_add(1));
        Robust {
            uncertainty: Uncertainty { samples: self.samples.get(), seed, ..uncertainty.clone() },
            of: self.of,
            weight: self.weight.map_or(base_weight, |weight| weight.0),
        }
    }
}

impl Robust {
    /// All that a cost follows from, as JSON.
    pub(crate) fn identity(&self) -> serde_json::Value {
        let Uncertainty { masses, inertias, mount, joints, samples, seed } = &self.uncertainty;
        serde_json::json!({
            "masses": masses, "inertias": inertias, "mount": mount, "joints": joints,
            "samples": samples, "seed": seed, "of": self.of, "weight": self.weight,
        })
    }
}

/// One thing that is not known exactly.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Unknown {
    /// A body's mass; the base's as `None`.
    Mass(Option<usize>),
    /// A body's inertia.
    Inertia(Option<usize>),
    /// Where the arm is mounted, along one of the base's axes.
    Mount(usize),
    /// Where a joint is.
    Joint(usize),
}

impl Default for UncertaintyTable {
    fn default() -> Self {
        let none = || Spanned::new(0..0, Shares::All(Fraction(0.0)));
        let samples = NonZeroUsize::MIN.saturating_add(255);
        let (joint_deg, joint, seed) = (None, None, 1);
        Self {
            mass: none(),
            inertia: none(),
            mount_m: NonNegative(0.0),
            joint_deg,
            joint,
            samples,
            seed,
        }
    }
}

impl Uncertainty {
    /// All that is not known exactly of a robot.
    pub fn unknowns(&self, robot: &Robot) -> Vec<Unknown> {
        let bodies = || robot.heavy_bodies().map(|(body, _)| body);
        let masses = bodies().filter(|body| self.masses[place(*body)] > 0.0).map(Unknown::Mass);
        let inertias = bodies().filter(|body| self.inertias[place(*body)] > 0.0);
        let inertias = inertias.map(Unknown::Inertia);
        let mount = (0..3).filter(|_| self.mount > 0.0).map(Unknown::Mount);
        let joints = robot.leading().filter(|joint| self.joints[*joint] > 0.0).map(Unknown::Joint);
        masses.chain(inertias).chain(mount).chain(joints).collect()
    }

    /// The task as it is where unknowns are off by these shares of what they may be off by, −1 to 1.
    pub fn varied(&self, task: &Task, shares: &[(Unknown, f64)]) -> Result<Task, RobotError> {
        let share = |unknown| {
            let own = shares.iter().filter(|(other, _)| *other == unknown);
            own.map(|(_, share)| share).sum::<f64>()
        };
        let factors = |body| {
            let [mass, inertia] = [&self.masses, &self.inertias].map(|shares| shares[place(body)]);
            [1.0 + mass * share(Unknown::Mass(body)), 1.0 + inertia * share(Unknown::Inertia(body))]
        };
        let shift = Vector3::from_fn(|axis, _| self.mount * share(Unknown::Mount(axis)));
        let offset = |(joint, most): (usize, &f64)| most * share(Unknown::Joint(joint));
        let offsets: Vec<f64> = self.joints.iter().enumerate().map(offset).collect();
        Ok(Task { robot: task.robot.varied(factors, shift, &offsets)?.into(), ..task.clone() })
    }

    /// Sampled tasks, each unknown drawn independently.
    pub fn draw(&self, task: &Task) -> Result<Vec<Task>, RobotError> {
        let mut random = ChaCha8Rng::seed_from_u64(self.seed);
        let unknowns = self.unknowns(&task.robot);
        let draw = |_| {
            let mut share = || 2.0 * unit(&mut random) - 1.0;
            let shares: Vec<_> = unknowns.iter().map(|unknown| (*unknown, share())).collect();
            self.varied(task, &shares)
        };
        (0..self.samples).map(draw).collect()
    }
}

impl Unknown {
    /// What it is called.
    pub fn name(self, robot: &Robot) -> String {
        let body =
            |body: Option<usize>| body.map_or("base", |link| robot.links()[link].name.as_str());
        match self {
            Self::Mass(of) => format!("mass of {}", body(of)),
            Self::Inertia(of) => format!("inertia of {}", body(of)),
            Self::Mount(axis) => format!("mount along {}", ["x", "y", "z"][axis]),
            Self::Joint(joint) => {
                let name = robot.joints().nth(joint).map_or("", |joint| joint.name);
                format!("offset of {name}")
            }
        }
    }
}
