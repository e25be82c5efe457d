//! Derivatives of the composite cost against differences.

use std::sync::Arc;

use driftless::input::Document;
use driftless::lanes::Width;
use driftless::reorientation::{BestKnown, Formulated, Formulation, TaskFile};
use driftless::search::Rng;
use driftless::search::{Composite, Linearisation, Multipliers, Piece, PieceId, Problem};
use nalgebra::DVector;

fn paper(terms: usize) -> Formulated {
    let document = Document::embedded("task", &format!("[trajectory]\nterms = {terms}\n"));
    let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
    Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).unwrap()
}

/// The components of the base's error.
fn error(parts: &Linearisation) -> &[Piece] {
    &parts.terms[0].pieces
}

/// The durations that limits ask for.
fn durations(parts: &Linearisation) -> &[Piece] {
    &parts.terms[1].pieces
}

fn largest(parts: &Linearisation) -> f64 {
    durations(parts).iter().map(|p| p.value).fold(0.0, f64::max)
}

/// Whether it is the same peak, a little further on.
fn is_same(a: PieceId, b: PieceId) -> bool {
    a.track == b.track && (a.place - b.place).abs() < 0.05
}

fn multipliers(durations: Vec<(PieceId, f64)>) -> Multipliers {
    let error = [0.8, -1.1, 0.5].into_iter().zip(0..);
    let error = error.map(|(nu, component)| (PieceId::alone(component), nu)).collect();
    Multipliers { terms: vec![error, durations] }
}

/// Differences of sixth order, extrapolated from three central ones.
fn difference(value: impl Fn(f64) -> f64) -> f64 {
    let h = 1e-4;
    let central = |h: f64| (value(h) - value(-h)) / (2.0 * h);
    let (d1, d2, d3) = (central(h), central(2.0 * h), central(3.0 * h));
    (15.0 * d1 - 6.0 * d2 + d3) / 10.0
}

fn check(x: &[f64]) {
    let problem = paper(x.len() / 6);
    let here = problem.linearise(x).unwrap();
    let shifted = |j: usize, step: f64| {
        let mut x = x.to_vec();
        x[j] += step;
        problem.linearise(&x).unwrap()
    };
    for j in 0..x.len() {
        for k in 0..3 {
            let expected = difference(|step| error(&shifted(j, step))[k].value);
            let found = error(&here)[k].gradient[j];
            assert!(
                (found - expected).abs() < 1e-8,
                "residual {k}, variable {j}: {found} {expected}"
            );
        }
        let largest = largest(&here);
        for piece in durations(&here).iter().filter(|p| p.value > 0.85 * largest) {
            let same = |step: f64| {
                let there = shifted(j, step);
                let same = durations(&there).iter().find(|p| is_same(p.id, piece.id));
                same.unwrap().value
            };
            let (found, expected) = (piece.gradient[j], difference(same));
            assert!(
                (found - expected).abs() < 1e-8 * piece.gradient.amax(),
                "{:?}, variable {j}: {found} {expected}",
                piece.id
            );
        }
    }
}

/// The second derivative of a Lagrangian against differences of first derivatives.
fn check_curvature(x: &[f64]) {
    let problem = paper(x.len() / 6);
    let here = problem.linearise(x).unwrap();
    let largest = largest(&here);
    let active = durations(&here).iter().filter(|p| p.value > 0.85 * largest);
    let weights = [0.7, -0.2, 0.4, 0.9, 0.1];
    let active = active.zip(weights.into_iter().cycle()).map(|(p, w)| (p.id, w));
    let multipliers = multipliers(active.collect());
    let gradient = |j: usize, step: f64| {
        let mut x = x.to_vec();
        x[j] += step;
        let there = problem.linearise(&x).unwrap();
        let mut sum = DVector::zeros(x.len());
        for (term, weighed) in there.terms.iter().zip(&multipliers.terms) {
            for (id, weight) in weighed {
                let same = term.pieces.iter().find(|p| is_same(p.id, *id));
                sum += &same.unwrap().gradient * *weight;
            }
        }
        sum
    };
    let found = problem.curvature(x, &multipliers).unwrap();
    for j in 0..x.len() {
        for k in 0..x.len() {
            let expected = difference(|step| gradient(j, step)[k]);
            let miss = (found[(k, j)] - expected).abs();
            assert!(miss < 1e-3 * found.amax(), "{k} {j}: {} {expected}", found[(k, j)]);
        }
    }
}

/// Vectors of any number of lanes give the same bits.
#[test]
fn do_not_depend_on_lanes() {
    let mut rng = Rng::new(9);
    for terms in 1..=4 {
        let x = point(terms, &mut rng);
        let document = Document::embedded("task", &format!("[trajectory]\nterms = {terms}\n"));
        let (problem, boxes) = TaskFile::read(&document).unwrap().build(&document).unwrap();
        let mut all = Vec::new();
        for width in Width::available().filter(|width| *width != Width::Scalar) {
            let problem = Arc::new(problem.with_width(width));
            let problem = Formulated::new(Formulation::TimeFree, problem, &boxes).unwrap();
            let here = problem.linearise(&x).unwrap();
            let active = durations(&here).iter().map(|piece| (piece.id, 0.3)).collect();
            let multipliers = multipliers(active);
            let mut numbers: Vec<f64> = error(&here).iter().map(|piece| piece.value).collect();
            let pieces = here.terms.iter().flat_map(|term| &term.pieces);
            pieces.for_each(|piece| numbers.extend(&piece.gradient));
            numbers.extend(&problem.curvature(&x, &multipliers).unwrap());
            all.push(numbers.into_iter().map(f64::to_bits).collect::<Vec<_>>());
        }
        assert!(all.windows(2).all(|pair| pair[0] == pair[1]), "{terms} terms");
    }
}

/// A point of the inner part of the box.
fn point(terms: usize, rng: &mut Rng) -> Vec<f64> {
    paper(terms).bounds().iter().map(|[l, u]| 0.4 * rng.uniform(l, u)).collect()
}

#[test]
fn curvature_agrees_with_differences() {
    let mut rng = Rng::new(5);
    for terms in 1..=4 {
        check_curvature(&point(terms, &mut rng));
    }
}

#[test]
fn agree_with_differences() {
    let mut rng = Rng::new(11);
    for terms in [1, 2, 2, 2, 3, 5, 8] {
        check(&point(terms, &mut rng));
    }
}

/// A linearisation knows the same cost as an evaluation, though it looks for all peaks.
#[test]
fn linearisations_and_evaluations_give_the_same_cost() {
    let mut rng = Rng::new(3);
    for terms in 1..=6 {
        let problem = paper(terms);
        for i in 0..200 {
            let shrink = if i == 0 { 0.0 } else { rng.unit() };
            let x: Vec<f64> =
                problem.bounds().iter().map(|[l, u]| shrink * rng.uniform(l, u)).collect();
            let (found, expected) =
                (problem.linearise(&x).unwrap().cost(), problem.evaluate(&x).unwrap().cost);
            assert!((found - expected).abs() < 1e-12 * expected, "{terms} {i}: {found} {expected}");
        }
    }
}

#[test]
fn agree_with_differences_without_bumps() {
    check(&[0.0; 12]);
}

/// At the best motion known the norm has a kink, its parts have none.
#[test]
fn agree_with_differences_at_zero_residual() {
    let best = BestKnown::of(paper(2).task()).unwrap();
    let x: Vec<f64> = best.coefficients.concat();
    assert!(paper(2).linearise(&x).unwrap().terms[0].value() < 1e-7);
    check(&x);
    check_curvature(&x);
}
