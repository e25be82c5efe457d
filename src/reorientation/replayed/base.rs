//! How the base turns along a path through points. The rate is smooth between points only, so no step reaches across one.

use nalgebra::{UnitQuaternion, Vector3};
use rayon::prelude::*;

use crate::attitude::increments;
use crate::momentum::{drifting_twist, total_momentum};
use crate::task::Task;
use crate::trajectory::{Peak, PointPath};

/// The widest first step: no joint moves further in one \[rad or m\].
const FIRST_STEP: f64 = 0.5;

/// The steps of a segment are halved until its turn changes by no more than this angle \[rad\], for each of those that it has first.
const SAME_TURN: f64 = 1e-13;

/// Steps over all segments, about; a segment may have two at least.
const MOST_STEPS: usize = 1 << 22;

/// The largest difference of ends \[rad\] that is taken for an estimate of an error. Steps too wide for a path err by anything.
const AN_ESTIMATE: f64 = 1e-2;

/// Places, about, at which base and momentum are looked at on the way, all points among them.
const LOOKS: f64 = 2000.0;

/// The base along a path.
#[derive(Debug, Clone)]
pub(super) struct BasePath {
    /// Its attitude at every point, relative to that at the first.
    turns: Vec<UnitQuaternion<f64>>,
    /// By how much the last may be wrong \[rad\]; infinite where that is not known.
    pub(super) error: f64,
}

/// What is seen of the base on the way, and by when, as a share of the duration.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Seen {
    /// Largest turn from the start \[rad\].
    pub(super) turn: Peak,
    /// Largest angular speed \[rad/s\].
    pub(super) rate: Peak,
    /// Largest linear \[N·s\] and angular \[N·m·s\] momentum of the whole beside the task's own, which should be none.
    pub(super) momentum: [f64; 2],
}

/// A segment's turn, and the same with half as many steps.
#[derive(Clone, Copy)]
struct Turn {
    fine: UnitQuaternion<f64>,
    coarse: UnitQuaternion<f64>,
    is_followed: bool,
}

impl BasePath {
    pub(super) fn of(task: &Task, path: &PointPath<'_>) -> Self {
        let segments = path.segments();
        let most = (MOST_STEPS / segments).max(2);
        let turn = |start, segment| turn(task, path, start, segment, most);
        let turns: Vec<Turn> = if task.angular_momentum.is_none() {
            let start = task.start.base;
            (0..segments).into_par_iter().map(|segment| turn(start, segment)).collect()
        } else {
            // With momentum a segment's turn follows from where it starts.
            let mut start = task.start.base;
            let next = |segment| {
                let turn = turn(start, segment);
                start *= turn.fine;
                turn
            };
            (0..segments).map(next).collect()
        };
        let [mut fine, mut coarse] = [UnitQuaternion::identity(); 2];
        let mut all = Vec::with_capacity(segments + 1);
        all.push(fine);
        let mut is_followed = true;
        for turn in turns {
            // A product of many strays from the unit length.
            fine = UnitQuaternion::new_normalize((fine * turn.fine).into_inner());
            coarse = UnitQuaternion::new_normalize((coarse * turn.coarse).into_inner());
            is_followed &= turn.is_followed;
            all.push(fine);
        }
        let difference = coarse.angle_to(&fine);
        let is_estimate = is_followed && difference <= AN_ESTIMATE;
        Self { turns: all, error: if is_estimate { difference } else { f64::INFINITY } }
    }

    /// The attitude at the last point, relative to that at the first.
    pub(super) fn end(&self) -> UnitQuaternion<f64> {
        self.turns[self.turns.len() - 1]
    }

    /// The attitudes, relative to that at the first point, at these times since then \[s\], which grow.
    pub(super) fn at(
        &self,
        task: &Task,
        path: &PointPath<'_>,
        times: &[f64],
    ) -> Vec<UnitQuaternion<f64>> {
        let most = (MOST_STEPS / times.len().max(1)).max(2);
        let at = |&time: &f64| {
            let (segment, share) = path.place(time);
            let steps = first_steps(path, segment).saturating_mul(4).min(most);
            let part = |share: f64| {
                let drift =
                    task.drift(task.start.base * self.turns[segment], share * path.width(segment));
                let write = |place, positions: &mut [f64], rates: &mut [f64]| {
                    path.write(segment, place * share, positions, rates);
                    for rate in rates {
                        *rate *= share;
                    }
                };
                product(increments(&task.robot, steps, drift, write))
            };
            self.turns[segment] * if share > 0.0 { part(share) } else { UnitQuaternion::identity() }
        };
        times.par_iter().map(at).collect()
    }

    /// Looks at the base on the way.
    pub(super) fn look(&self, task: &Task, path: &PointPath<'_>) -> Seen {
        let robot = &task.robot;
        let duration = path.points().duration();
        let look = |segment: usize| {
            let start = path.points().times()[segment];
            let width = path.width(segment);
            let looks = (LOOKS * width / duration).ceil().max(1.0) as usize;
            let mut seen = Seen::default();
            let mut attitude = self.turns[segment];
            let write = |share, positions: &mut [f64], rates: &mut [f64]| {
                path.write(segment, share, positions, rates);
            };
            let drift = task.drift(task.start.base * attitude, width);
            let mut steps = increments(robot, looks, drift, write);
            let mut positions = vec![0.0; path.points().joints()];
            let mut rates = positions.clone();
            for i in 0..=looks {
                let share = i as f64 / looks as f64;
                let tau = (start + share * width) / duration;
                path.write(segment, share, &mut positions, &mut rates);
                for rate in &mut rates {
                    *rate /= width;
                }
                let own = task.momentum_at(&(task.start.base * attitude));
                let base = drifting_twist(robot, &positions, &rates, own);
                let (linear, angular) = total_momentum(robot, &positions, &rates, &base);
                let [rate, linear, angular] = [base.angular, linear, angular - own]
                    .map(|vector| Vector3::from(vector).norm());
                let turn =
                    if i == looks { self.turns[segment + 1].angle() } else { attitude.angle() };
                seen = seen.or(&Seen {
                    turn: Peak { value: turn, tau },
                    rate: Peak { value: rate, tau },
                    momentum: [linear, angular],
                });
                if i + 1 < looks {
                    attitude *= steps.next().unwrap_or_default();
                }
            }
            seen
        };
        // The first of equal peaks, whatever the number of threads.
        let looks: Vec<Seen> = (0..path.segments()).into_par_iter().map(look).collect();
        looks.iter().fold(Seen::default(), Seen::or)
    }
}

impl Seen {
    fn or(self, next: &Self) -> Self {
        Self {
            turn: self.turn.or(next.turn),
            rate: self.rate.or(next.rate),
            momentum: [0, 1].map(|k| f64::max(self.momentum[k], next.momentum[k])),
        }
    }
}

/// Steps in which no joint goes far.
fn first_steps(path: &PointPath<'_>, segment: usize) -> usize {
    (path.reach(segment) / FIRST_STEP).ceil().max(1.0) as usize
}

fn turn(
    task: &Task,
    path: &PointPath<'_>,
    start: UnitQuaternion<f64>,
    segment: usize,
    most: usize,
) -> Turn {
    let drift = task.drift(start, path.width(segment));
    let with = |steps: usize| {
        let write = |share, positions: &mut [f64], rates: &mut [f64]| {
            path.write(segment, share, positions, rates);
        };
        product(increments(&task.robot, steps, drift, write))
    };
    let first = first_steps(path, segment);
    let is_followed = first <= most / 2;
    let mut steps = if is_followed { first } else { 1 };
    let mut coarse = with(steps);
    // The further joints go, the more is rounded.
    let same = SAME_TURN * first as f64;
    loop {
        steps *= 2;
        let fine = with(steps);
        if coarse.angle_to(&fine) <= same || steps > most / 2 || !is_followed {
            return Turn { fine, coarse, is_followed };
        }
        coarse = fine;
    }
}

fn product(steps: impl Iterator<Item = UnitQuaternion<f64>>) -> UnitQuaternion<f64> {
    steps.fold(UnitQuaternion::identity(), |net, step| net * step)
}
