//! First and second derivatives of the cost, for optimisers that use them.

use nalgebra::{DMatrix, DVector, Matrix3, UnitQuaternion, Vector3};

use super::fitness::Reorientation;
use super::measure::Tables;
use crate::attitude::{Rollout, RotationCurvature};
use crate::lanes::{LaneWork, Lanes};
use crate::search::{
    Bent, ErrorSlopes, Failure, LinearLimits, Linearisation, Multipliers, Piece, PieceId,
    TimedParts, TimedWeights,
};
use crate::task::Task;
use crate::trajectory::{Curve, Family, LocalPeak, Peak, duration_asked};

/// How far below the largest, as a share of it, a part may lie to be linearised too.
const NEAR: f64 = 0.75;

impl<F: Family> Reorientation<F> {
    /// The time-free cost's parts: the vector part of the base's error, and the duration that each
    /// local peak of rate, acceleration and jerk asks for.
    pub(super) fn linearise(&self, coefficients: &[f64]) -> Linearisation {
        let mut durations = self.asked_durations(coefficients);
        let error = self.error_slopes(coefficients, &Timing::of_longest(self.task(), &durations));
        let mut found = Vec::new();
        let mut violation = 0.0;
        if let Some(sampled) = self.sampled(coefficients) {
            let asked = durations.iter().map(|piece| piece.value).fold(0.0, f64::max);
            let pieces = sampled.pieces(self.width(), asked, self.joint_tracks());
            durations.extend(pieces.durations().cloned());
            found = pieces.terms();
            violation = pieces.excess;
        }
        let mut linearisation = self.terms().time_free(error_pieces(&error), durations);
        linearisation.terms.extend(found);
        linearisation.terms.extend(self.robust_term(coefficients));
        linearisation.with_violation(violation)
    }

    /// The durations that local peaks of rate, acceleration and jerk ask for, and the least one.
    fn asked_durations(&self, coefficients: &[f64]) -> Vec<Piece> {
        let samples = self.samples(coefficients);
        let limits = &self.task().limits;
        let places = self.family().local_peaks(&samples, coefficients, limits, NEAR);
        let curves: Vec<_> = self.curves(coefficients).collect();
        let asked =
            places.into_iter().map(|place| self.duration_piece(&curves[place.joint], place));
        let least = self.task().least_duration;
        let floor = (least > 0.0).then(|| Piece {
            id: PieceId::alone(FLOOR),
            value: least,
            gradient: DVector::zeros(coefficients.len()),
        });
        asked.chain(floor).collect()
    }

    /// How long the shortest motion along a path takes, where the base's error follows that.
    pub(super) fn timing(&self, coefficients: &[f64]) -> Timing {
        if self.task().angular_momentum.is_none() {
            return Timing::default();
        }
        if self.family().is_linear() {
            Timing::of_limits(&self.limits(&self.samples(coefficients)), coefficients.len())
        } else {
            Timing::of_longest(self.task(), &self.asked_durations(coefficients))
        }
    }

    /// A subgradient of the cost of a motion that lasts `duration` seconds: its slopes by the coefficients, and that by the
    /// duration.
    pub(super) fn slopes_over(&self, coefficients: &[f64], duration: f64) -> (DVector<f64>, f64) {
        let weights = self.terms().timed();
        let untimed = TimedWeights { time: 0.0, ..weights };
        let timing = Timing { duration, slopes: None };
        let (error, error_by_duration) =
            self.error_slopes_by(&self.tables().rollout, coefficients, &timing);
        let samples = self.samples(coefficients);
        let is_linear = self.family().is_linear();
        let limits = if is_linear { self.limits(&samples) } else { LinearLimits::default() };
        let size = error.value.norm();
        let along = error.value.dot(&error_by_duration);
        let parts = TimedParts { limits, error, bent: Bent::default() };
        let mut slopes = untimed.subgradient(&parts).slopes;
        let mut by_duration = weights.time;
        if size > 0.0 {
            by_duration += weights.error * along / size;
        }
        if let Some(sampled) = self.sampled(coefficients) {
            let pieces = sampled.pieces(self.width(), duration, 0);
            let (more, by) = pieces.slopes_over(duration);
            slopes += more;
            by_duration += by;
        }
        if let Some(term) = self.robust_term(coefficients) {
            slopes += Linearisation::new(vec![term]).subgradient(coefficients.len()).slopes;
        }
        let peaks = self.family().peaks(&samples, coefficients);
        let curves: Vec<_> = self.curves(coefficients).collect();
        for order in 1..=3 {
            let share = |&(joint, peaks): &(usize, &[Peak; 3])| {
                peaks[order - 1].value / self.task().limits.0[joint][order - 1]
            };
            let highest = peaks.0.iter().enumerate().max_by(|a, b| share(a).total_cmp(&share(b)));
            let Some((joint, peaks)) = highest else { continue };
            let place = LocalPeak { joint, order, tau: peaks[order - 1].tau };
            let asked = self.duration_piece(&curves[joint], place);
            if asked.value > duration {
                // The excess is (t / t_f)^p − 1, where the limit asks for t.
                let rise =
                    weights.excess * order as f64 * (asked.value / duration).powi(order as i32);
                slopes.axpy(rise / asked.value, &asked.gradient, 1.0);
                by_duration -= rise / duration;
            }
        }
        (slopes, by_duration)
    }

    /// The path with these coefficients, sampled.
    pub(super) fn samples(&self, coefficients: &[f64]) -> F::Samples {
        let mut samples = self.workspace().samples;
        self.width().run(Sampling { problem: self, coefficients, samples: &mut samples });
        samples
    }

    /// The base's error, for families whose derivatives are linear in their coefficients.
    pub(super) fn error_slopes(&self, coefficients: &[f64], timing: &Timing) -> ErrorSlopes {
        self.error_slopes_by(&self.tables().rollout, coefficients, timing).0
    }

    /// The same, right to a few digits.
    pub(super) fn rough_error_slopes(&self, coefficients: &[f64], timing: &Timing) -> ErrorSlopes {
        self.error_slopes_by(&self.tables().rough, coefficients, timing).0
    }

    /// The same, with the derivative by the duration.
    fn error_slopes_by(
        &self,
        rollout: &Rollout<F>,
        coefficients: &[f64],
        timing: &Timing,
    ) -> (ErrorSlopes, DVector<f64>) {
        let (width, family, task) = (self.width(), self.family(), self.task());
        let drift = task.drift(task.start.base, timing.duration);
        let (net, turn_by_duration) = match drift {
            None => (rollout.slopes(width, &task.robot, family, coefficients), Vector3::zeros()),
            Some(drift) => rollout.drifting_slopes(width, &task.robot, family, coefficients, drift),
        };
        let (error, by_turn) = self.turned_error(net.rotation);
        let mut slopes = by_turn * &net.by_coefficient;
        let by_duration = by_turn * turn_by_duration;
        if let Some(duration_slopes) = &timing.slopes {
            slopes.ger(1.0, &by_duration, duration_slopes, 1.0);
        }
        let slopes = DMatrix::from_column_slice(3, slopes.ncols(), slopes.as_slice());
        let value = DVector::from_column_slice(error.imag().as_slice());
        (ErrorSlopes { value, slopes }, DVector::from_column_slice(by_duration.as_slice()))
    }

    /// The joints' paths.
    fn curves(&self, coefficients: &[f64]) -> impl Iterator<Item = F::Curve<'_>> {
        let family = self.family();
        (0..family.joints())
            .map(move |joint| family.curve(joint, &coefficients[family.coefficients_of(joint)]))
    }

    /// The base's error, and how its vector part follows a turn of the base's end in base axes.
    fn turned_error(&self, net: UnitQuaternion<f64>) -> (UnitQuaternion<f64>, Matrix3<f64>) {
        let error = self.error_after(net);
        // q ⊗ (0, ½ v) has the vector part ½ (q_w v + q_v × v).
        let by_turn = (Matrix3::from_diagonal_element(error.w) + error.imag().cross_matrix()) / 2.0;
        (error, by_turn)
    }

    /// The duration \[s\] that a derivative of this value asks for at this place.
    fn duration_for(&self, place: &LocalPeak, derivative: f64) -> f64 {
        let limit = self.task().limits.0[place.joint][place.order - 1];
        duration_asked(derivative.abs() / limit, place.order)
    }

    /// The duration that one limit asks for at one place of the path, and its derivatives.
    fn duration_piece(&self, curve: &F::Curve<'_>, place: LocalPeak) -> Piece {
        let LocalPeak { joint, order, tau } = place;
        let own = self.family().coefficients_of(joint);
        let derivative = curve.derivatives::<4>(tau)[order];
        let value = self.duration_for(&place, derivative);
        let by_derivative = value / (order as f64 * derivative);
        let mut gradient = DVector::zeros(self.family().dimension());
        for (k, slope) in own.zip(curve.coefficient_slopes(order, tau)) {
            gradient[k] = by_derivative * slope;
        }
        Piece { id: to_id(&place), value, gradient }
    }
}

impl<F: Family> Reorientation<F> {
    /// How many tracks [`to_id`] has for peaks of joints.
    fn joint_tracks(&self) -> u64 {
        3 * self.family().joints() as u64
    }
}

/// The components of an error.
fn error_pieces(ErrorSlopes { value, slopes }: &ErrorSlopes) -> Vec<Piece> {
    let piece = |(component, value): (usize, &f64)| Piece {
        id: PieceId::alone(component as u64),
        value: *value,
        gradient: slopes.row(component).transpose(),
    };
    value.iter().enumerate().map(piece).collect()
}

/// The track of the least duration among pieces.
const FLOOR: u64 = u64::MAX;

/// How long a motion takes, and how that follows the coefficients, where the limits say how long. Without momentum neither matters.
#[derive(Debug, Clone, Default)]
pub(super) struct Timing {
    /// \[s\]
    pub(super) duration: f64,
    slopes: Option<DVector<f64>>,
}

impl Timing {
    fn of_longest(task: &Task, durations: &[Piece]) -> Self {
        if task.angular_momentum.is_none() {
            return Self::default();
        }
        let longest = durations.iter().max_by(|a, b| a.value.total_cmp(&b.value));
        longest.map_or_else(Self::default, |piece| Self {
            duration: piece.value,
            slopes: Some(piece.gradient.clone()),
        })
    }

    fn of_limits(limits: &LinearLimits, variables: usize) -> Self {
        Self { duration: limits.time, slopes: Some(limits.time_slopes(variables)) }
    }
}

/// A peak is on the track of its joint and order, where it stands in normalised time.
fn to_id(peak: &LocalPeak) -> PieceId {
    PieceId { track: (3 * peak.joint + peak.order - 1) as u64, place: peak.tau }
}

/// A path's samples.
struct Sampling<'a, F: Family> {
    problem: &'a Reorientation<F>,
    coefficients: &'a [f64],
    samples: &'a mut F::Samples,
}

impl<F: Family> LaneWork for Sampling<'_, F> {
    type Output = ();

    #[inline(always)]
    fn run<T: Lanes>(self) {
        let sampler = &self.problem.tables().sampler;
        self.problem.family().sample::<T>(sampler, self.coefficients, self.samples);
    }
}

/// The second derivative of the base's rotation over a path, times a vector.
struct Bend<'a, F: Family> {
    problem: &'a Reorientation<F>,
    coefficients: &'a [f64],
    vector: Vector3<f64>,
}

impl<F: Family> LaneWork for Bend<'_, F> {
    type Output = RotationCurvature;

    #[inline(always)]
    fn run<T: Lanes>(self) -> RotationCurvature {
        let (robot, family) = (&self.problem.task().robot, self.problem.family());
        let Tables { midpoints, .. } = self.problem.tables();
        midpoints.curvature::<T>(robot, family, self.coefficients, &self.vector)
    }
}

/// The multipliers of the error's components.
fn to_vector(multipliers: &[(PieceId, f64)]) -> Result<Vector3<f64>, Failure> {
    let mut vector = Vector3::zeros();
    for (id, multiplier) in multipliers {
        let component = vector.get_mut(id.track as usize);
        let unknown =
            || Failure::new(format!("found component {} of an error, expected 0 to 2", id.track));
        *component.ok_or_else(unknown)? = *multiplier;
    }
    Ok(vector)
}

/// Second derivatives.
impl<F: Family> Reorientation<F> {
    pub(super) fn curvature(
        &self,
        coefficients: &[f64],
        multipliers: &Multipliers,
    ) -> Result<DMatrix<f64>, Failure> {
        // What is asked for on the way is taken for linear.
        let [error, durations, ..] = &multipliers.terms[..] else {
            let found = multipliers.terms.len();
            return Err(format!("found multipliers of {found} terms, expected 2 at least").into());
        };
        let mut curvature = self.base_error_curvature(coefficients, &to_vector(error)?);
        let of_joints = durations.iter().filter(|(id, _)| id.track < self.joint_tracks());
        for (id, lambda) in of_joints {
            let place = self.to_peak(id)?;
            let own = self.family().coefficients_of(place.joint);
            let block = self.piece_curvature(&coefficients[own.clone()], &place) * *lambda;
            let mut part = curvature.view_mut((own.start, own.start), (own.len(), own.len()));
            part += block;
        }
        Ok(curvature)
    }

    /// The peak that [`to_id`] gave this id.
    fn to_peak(&self, id: &PieceId) -> Result<LocalPeak, Failure> {
        let (joints, track) = (self.family().joints(), id.track as usize);
        if track < 3 * joints {
            return Ok(LocalPeak { joint: track / 3, order: track % 3 + 1, tau: id.place });
        }
        Err(format!("found a piece on track {track}, expected one of {}", 3 * joints).into())
    }

    /// With momentum that of a robot without, which is near enough to make the last steps few.
    fn base_error_curvature(&self, coefficients: &[f64], nu: &Vector3<f64>) -> DMatrix<f64> {
        let (error, by_turn) = self.turned_error(self.net_rotation(coefficients));
        let turned =
            self.width().run(Bend { problem: self, coefficients, vector: by_turn.tr_mul(nu) });
        // The vector part of q ⊗ exp(½ v) is the line along v less |v|²/8 of itself.
        let shrink = -0.25 * nu.dot(&error.imag());
        turned.curvature + turned.by_coefficient.tr_mul(&turned.by_coefficient) * shrink
    }

    /// Second derivatives of the duration that one limit asks for, by its joint's coefficients.
    fn piece_curvature(&self, own: &[f64], place: &LocalPeak) -> DMatrix<f64> {
        let LocalPeak { joint, order, tau } = *place;
        let curve = self.family().curve(joint, own);
        let derivatives = curve.derivatives::<6>(tau);
        let v = derivatives[order];
        let duration = self.duration_for(place, v);
        let slopes =
            |order| DVector::from_iterator(own.len(), curve.coefficient_slopes(order, tau));
        let (slope, drift) = (slopes(order), slopes(order + 1));
        let bend = curve.coefficient_curvature(order, tau);
        let mut second = DMatrix::from_fn(slope.len(), slope.len(), bend);
        if tau > 0.0 && tau < 1.0 {
            // The peak moves along the path.
            second -= &drift * drift.transpose() / derivatives[order + 2];
        }
        let power = 1.0 / order as f64;
        (second / v + &slope * slope.transpose() * ((power - 1.0) / (v * v))) * (power * duration)
    }
}
