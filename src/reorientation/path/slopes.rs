//! How what is watched follows the path's coefficients.

use nalgebra::{DMatrix, DVector, Vector3};

use super::sampled::{LocalMaximum, Sampled};
use super::watched::{Place, Slopes, Watched};
use super::{Kind, Way};
use crate::attitude::RotationSlopes;
use crate::lanes::Width;
use crate::reorientation::terms::Terms;
use crate::search::{Fold, Linearisation, Piece, PieceId, Term};
use crate::trajectory::{Curve as _, Family};

/// How far below its limit, as a share of it, what is penalised may lie to be linearised too.
const MARGIN: f64 = 0.5;

/// The same of clearances, as a share of the reach.
const CLEARANCE_MARGIN: f64 = 0.25;

/// The same of what asks for a duration, as a share of the longest asked for.
const NEAR: f64 = 0.75;

/// Positions change by this much in differences \[rad or m\].
const DIFFERENCE: f64 = 1e-5;

/// A bend that is a smaller share of the largest is none.
const NOTHING: f64 = 1e-3;

/// What of the way the cost follows from near a path.
pub(in crate::reorientation) struct PathPieces {
    /// Of every kind of limits that is asked for, the durations \[s\] or the excess over it.
    demands: Vec<(Kind, Vec<Piece>)>,
    /// Of the largest turn \[rad\].
    turns: Vec<Piece>,
    mean_turn: Option<Piece>,
    weights: [f64; 2],
    /// How many coefficients there are.
    variables: usize,
    /// The excess over what does not follow the duration, as a sum over its kinds.
    pub(in crate::reorientation) excess: f64,
}

impl PathPieces {
    /// Durations \[s\] that limits ask for.
    pub(in crate::reorientation) fn durations(&self) -> impl Iterator<Item = &Piece> {
        self.demands.iter().filter(|(kind, _)| kind.power().is_some()).flat_map(|(_, own)| own)
    }

    /// What is added to the cost of a motion in the shortest time: one term per kind of limits that asks for no duration, and one per
    /// weight of turns.
    pub(in crate::reorientation) fn terms(&self) -> Vec<Term> {
        let shapes = self.demands.iter().filter(|(kind, _)| kind.power().is_none());
        let mut terms: Vec<Term> = shapes.map(|(_, own)| Terms::excess(own.clone())).collect();
        let [largest, mean] = self.weights;
        if largest > 0.0 {
            terms.push(Terms::turn(largest, self.turns.clone()));
        }
        terms.extend(self.mean_turn.iter().map(|piece| Terms::turn(mean, vec![piece.clone()])));
        terms
    }

    /// The slopes by the coefficients of what is added to the cost of a motion that lasts so long \[s\], and the slope by its duration.
    pub(in crate::reorientation) fn slopes_over(&self, duration: f64) -> (DVector<f64>, f64) {
        let mut terms = self.terms();
        let mut by_duration = 0.0;
        for (kind, own) in &self.demands {
            let Some(power) = kind.power() else { continue };
            let longest = own.iter().max_by(|a, b| a.value.total_cmp(&b.value));
            if let Some(piece) = longest.filter(|piece| piece.value > duration) {
                // The excess is (t / t_f)^p − 1, where the limit asks for t.
                let excess = (piece.value / duration).powi(power);
                let slope = f64::from(power) * excess / piece.value;
                let term = Terms::excess(vec![Piece {
                    gradient: &piece.gradient * slope,
                    ..piece.clone()
                }]);
                by_duration -= term.weight * f64::from(power) * excess / duration;
                terms.push(term);
            }
        }
        (Linearisation::new(terms).subgradient(self.variables).slopes, by_duration)
    }
}

impl<F: Family> Sampled<'_, F> {
    /// All pieces that matter near the path, where what follows the duration asks for one of `asked` \[s\] at least; their tracks
    /// begin with `first_track`.
    pub(in crate::reorientation) fn pieces(
        &self,
        width: Width,
        asked: f64,
        first_track: u64,
    ) -> PathPieces {
        let task = self.task;
        let longest = self.way_of_places().duration().max(asked);
        let weights = task.path.turn_weights;
        let peaks = self.local_peaks(|watched, height| {
            let matters = |[demand, _]: [f64; 2]| match watched.kind().power() {
                Some(_) => demand >= NEAR * longest,
                None if watched.kind() == Kind::Clearance => demand >= -CLEARANCE_MARGIN,
                None => demand >= -MARGIN,
            };
            (watched == Watched::BaseTurn && weights[0] > 0.0)
                || watched.demand(task, height).is_some_and(matters)
        });
        let demanding = self.tables.watched.iter().filter(|own| own.demand(task, 0.0).is_some());
        let mut demands: Vec<(Kind, Vec<Piece>)> = Vec::new();
        for kind in demanding.map(|watched| watched.kind()) {
            if !demands.iter().any(|(known, _)| *known == kind) {
                // What keeps its limit has no excess.
                let zero = Piece::new(u64::MAX, 0.0, vec![0.0; self.family.dimension()]);
                demands.push((kind, kind.power().map_or_else(|| vec![zero], |_| Vec::new())));
            }
        }
        let mut turns = Vec::new();
        let mut way = Way::default();
        for (peak, gradient) in peaks.iter().zip(self.gradients(width, &peaks)) {
            let track = first_track + self.index(peak.watched) as u64;
            let id = PieceId { track, place: peak.tau };
            if peak.watched == Watched::BaseTurn {
                turns.push(Piece { id, value: peak.height, gradient: gradient.clone() });
            }
            let Some([value, slope]) = peak.watched.demand(task, peak.height) else { continue };
            way.raise(peak.watched.kind(), value);
            let own = demands.iter_mut().find(|(kind, _)| *kind == peak.watched.kind());
            if let Some((_, own)) = own {
                own.push(Piece { id, value, gradient: gradient * slope });
            }
        }
        let mean_turn = (weights[1] > 0.0).then(|| self.mean_piece(width));
        PathPieces {
            demands,
            turns,
            mean_turn,
            weights,
            variables: self.family.dimension(),
            excess: way.excess(f64::INFINITY),
        }
    }

    /// Positive parts of the second derivative of the sum of local maxima on tracks that begin with zero, each times its multiplier.
    ///
    /// A maximum over `τ` of `g(τ, x)` has the second derivative `g_xx − g_xτ g_τx / g_ττ`. The second part is positive, and is how
    /// the peak moves along the path. Of the first, what follows through the joints' positions is taken of clearances, which bend
    /// most.
    pub(in crate::reorientation) fn folds(
        &self,
        width: Width,
        multipliers: &[(PieceId, f64)],
    ) -> Vec<Fold> {
        let step = 0.1 / (self.places.len() - 1) as f64;
        let mut folds = Vec::new();
        let (mut moving, mut ends) = (Vec::new(), Vec::new());
        for (id, multiplier) in multipliers {
            let Some(&watched) = self.tables.watched.get(id.track as usize) else { continue };
            let tau = id.place;
            let height = |tau: f64| watched.height(self.task, &self.at(tau));
            let here = height(tau);
            let Some([_, slope]) = watched.demand(self.task, here) else { continue };
            let weight = multiplier * slope;
            if let Watched::Clearance(_) = watched {
                self.add_bend_by_joints(watched, tau, weight, &mut folds);
            }
            if tau < step || tau > 1.0 - step {
                continue;
            }
            let both = [tau - step, tau + step];
            let [before, after] = both.map(height);
            let bend = (before + after - 2.0 * here) / (step * step);
            if bend < 0.0 {
                moving.push(weight / -bend);
                ends.extend(both.map(|tau| LocalMaximum { watched, tau, height: 0.0 }));
            }
        }
        let gradients = self.gradients(width, &ends);
        for (curvature, pair) in moving.into_iter().zip(gradients.chunks_exact(2)) {
            folds.push(Fold { direction: (&pair[1] - &pair[0]) / (2.0 * step), curvature });
        }
        folds.retain(|fold| fold.curvature > 0.0 && fold.curvature.is_finite());
        folds
    }

    /// The positive part of how a height bends with the joints' positions, times a weight.
    fn add_bend_by_joints(&self, watched: Watched, tau: f64, weight: f64, folds: &mut Vec<Fold>) {
        let place = self.at(tau);
        let joints = place.positions.len();
        let slopes = |place: &Place| watched.slopes(self.task, place).by_joints[0].clone();
        let mut bend = DMatrix::zeros(joints, joints);
        for joint in 0..joints {
            let [ahead, back] = [DIFFERENCE, -DIFFERENCE].map(|change| {
                let mut beside = place.clone();
                beside.positions[joint] += change;
                DVector::from_vec(slopes(&beside))
            });
            bend.set_column(joint, &((ahead - back) / (2.0 * DIFFERENCE)));
        }
        let eigen = ((&bend + bend.transpose()) / 2.0).symmetric_eigen();
        let least = NOTHING * eigen.eigenvalues.amax();
        for (value, shares) in eigen.eigenvalues.iter().zip(eigen.eigenvectors.column_iter()) {
            if *value > least {
                let by_joints = [shares.iter().copied().collect(), Vec::new(), Vec::new()];
                let along = Slopes { by_joints, ..Slopes::default() };
                let direction = self.by_joints(&along, tau);
                folds.push(Fold { direction, curvature: weight * value });
            }
        }
    }

    /// The derivatives of peaks by the coefficients. A peak moves along the path with them, which changes it to second order only.
    fn gradients(&self, width: Width, peaks: &[LocalMaximum]) -> Vec<DVector<f64>> {
        let places: Vec<Place> = peaks.iter().map(|peak| self.at(peak.tau)).collect();
        let slopes: Vec<Slopes> =
            peaks.iter().zip(&places).map(|(peak, place)| self.peak_slopes(peak, place)).collect();
        let turning = slopes.iter().zip(&places).filter(|(slopes, _)| slopes.turns());
        let taus: Vec<f64> = turning.map(|(_, place)| place.tau).collect();
        let rotations = if taus.is_empty() { Vec::new() } else { self.rotations(width, &taus) };
        let mut rotations = rotations.into_iter();
        let all = slopes.iter().zip(&places).map(|(slopes, place)| {
            let mut gradient = self.by_joints(slopes, place.tau);
            if slopes.turns()
                && let Some(rotation) = rotations.next()
            {
                gradient += rotation.by_coefficient.tr_mul(&slopes.by_turn);
            }
            gradient
        });
        all.collect()
    }

    /// How the height of a peak follows from what there is at its place.
    ///
    /// Where bodies overlap, the shortest way apart may lead out on one side before the peak and on the other after it. Such a
    /// peak moves along the path as either side changes, and the derivative is that mean of both along which the height is level.
    fn peak_slopes(&self, peak: &LocalMaximum, place: &Place) -> Slopes {
        let (watched, tau) = (peak.watched, peak.tau);
        let step = self.beside();
        let is_inside = (step..=1.0 - step).contains(&tau);
        if matches!(watched, Watched::Clearance(_)) && peak.height > 0.0 && is_inside {
            let [(rising, before), (falling, after)] = [tau - step, tau + step].map(|tau| {
                let place = self.at(tau);
                let slopes = watched.slopes(self.task, &place);
                (slopes.along(self.task, &place), slopes)
            });
            if rising > 0.0 && falling < 0.0 {
                return before.mean(&after, rising / (rising - falling));
            }
        }
        watched.slopes(self.task, place)
    }

    /// The base's rotation to some times of the path, with its derivatives.
    fn rotations(&self, width: Width, taus: &[f64]) -> Vec<RotationSlopes> {
        let Sampled { task, family, tables, coefficients, .. } = *self;
        tables.rollout.slopes_at(width, &task.robot, family, coefficients, taus)
    }

    /// The part of a derivative that is through positions and rates at the place.
    fn by_joints(&self, slopes: &Slopes, tau: f64) -> DVector<f64> {
        let mut gradient = DVector::zeros(self.family.dimension());
        for (order, by_joint) in slopes.by_joints.iter().enumerate() {
            for (joint, slope) in by_joint.iter().enumerate().filter(|(_, slope)| **slope != 0.0) {
                let own = self.family.coefficients_of(joint);
                for (k, change) in own.zip(self.curves[joint].coefficient_slopes(order, tau)) {
                    gradient[k] += slope * change;
                }
            }
        }
        gradient
    }

    /// The mean turn of the base.
    fn mean_piece(&self, width: Width) -> Piece {
        let taus: Vec<f64> = self.places[1..].iter().map(|place| place.tau).collect();
        let steps = taus.len() as f64;
        let mut gradient = DVector::zeros(self.family.dimension());
        let rotations = self.rotations(width, &taus);
        for (place, rotation) in self.places[1..].iter().zip(rotations) {
            let share = if place.tau < 1.0 { 1.0 / steps } else { 0.5 / steps };
            let by_turn: Vector3<f64> = Watched::turn_slopes(self.task, place) * share;
            gradient += rotation.by_coefficient.tr_mul(&by_turn);
        }
        let index = self.index(Watched::BaseTurn);
        Piece { value: self.mean(index), ..Piece::new(0, 0.0, gradient.data.as_vec().clone()) }
    }
}
