//! The table of `docs/performance.md`: `cargo bench --bench speed`.
//!
//! Where others use the machine too, times vary by half and more. So all lines are measured in turns, in one
//! process on one thread, and each is the median of its turns; what compares two lines is the median of the
//! turns' quotients.

mod operations;

use std::fmt::{Display, Write as _};
use std::hint::black_box;
use std::sync::Arc;
use std::time::Instant;

use driftless::input::Document;
use driftless::lanes::Width;
use driftless::optimiser::{De, Optimiser, Pso, RandomSearch, Scp};
use driftless::reorientation::{
    Accuracy, BestKnown, Boxes, Formulated, Formulation, Reorientation, TaskFile,
};
use driftless::search::{Bounds, Composite, Evaluation, Failure, Multipliers, Points, Problem};
use driftless::search::{Oracle, Rng, Watch};
use driftless::trajectory::Peaks;
use nalgebra::UnitQuaternion;
use operations::{Operations, Peak};

/// How often each line is measured.
const TURNS: usize = 15;

/// The paper's budget.
const BUDGET: u64 = 150_000;

/// The best known cost of the paper's task, to six digits: 0.781850.
const TARGET: f64 = 0.781_850;

struct Paper {
    problem: Reorientation,
    boxes: Boxes,
}

impl Paper {
    fn new() -> Self {
        let document = TaskFile::paper();
        let built = TaskFile::read(&document).and_then(|file| file.build(&document));
        let (problem, boxes) = built.expect("the default task");
        Self { problem, boxes }
    }

    fn formulated(&self, formulation: Formulation, width: Width) -> Formulated {
        Formulated::new(formulation, Arc::new(self.problem.with_width(width)), &self.boxes)
            .expect("sound boxes")
    }
}

/// Microseconds that one of `count` takes.
fn microseconds(count: usize, mut work: impl FnMut()) -> f64 {
    let clock = Instant::now();
    work();
    clock.elapsed().as_secs_f64() * 1e6 / count as f64
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// One line of a table, measured anew at each turn.
struct Line<'a> {
    name: String,
    measure: Box<dyn FnMut() -> f64 + 'a>,
    turns: Vec<f64>,
}

impl<'a> Line<'a> {
    fn new(name: impl Display, measure: impl FnMut() -> f64 + 'a) -> Self {
        Self { name: name.to_string(), measure: Box::new(measure), turns: Vec::new() }
    }

    fn median(&self) -> f64 {
        median(self.turns.clone())
    }

    /// How many times as long another line takes.
    fn shorter_than(&self, other: &Self) -> f64 {
        median(other.turns.iter().zip(&self.turns).map(|(other, own)| other / own).collect())
    }
}

fn take_turns(lines: &mut [Line<'_>]) {
    for _ in 0..TURNS {
        for line in &mut *lines {
            line.turns.push((line.measure)());
        }
    }
}

/// Points drawn uniformly from the box shrunk to this share.
fn points(problem: &dyn Problem, count: usize, share: f64) -> Points {
    let mut rng = Rng::new(7);
    let mut points = Points::zeros(problem.bounds().len(), count);
    for x in &mut points {
        for (x, [lower, upper]) in x.iter_mut().zip(problem.bounds().iter()) {
            *x = f64::midpoint(lower, upper)
                + share * rng.uniform(lower - upper, upper - lower) / 2.0;
        }
    }
    points
}

/// Evaluation and derivatives, with every number of lanes.
fn evaluations(paper: &Paper) {
    const COUNT: usize = 1000;
    let widths: Vec<Width> = Width::available().collect();
    let problems: Vec<_> =
        widths.iter().map(|&width| paper.formulated(Formulation::TimeFree, width)).collect();
    let all = points(&problems[0], COUNT, 1.0);
    let some = points(&problems[0], COUNT / 10, 0.5);
    let multipliers: Vec<_> = some.iter().map(|x| multipliers(&problems[0], x)).collect();

    let mut lines = Vec::new();
    for problem in &problems {
        lines.push(Line::new("fitness with limits", || {
            let mut sum = 0.0;
            let time = microseconds(COUNT, || {
                let _ = problem.evaluate_batch(&all, &mut |evaluation| sum += evaluation.cost);
            });
            black_box(sum);
            time
        }));
    }
    for problem in &problems {
        lines.push(Line::new("rollout of the attitude alone", || {
            microseconds(COUNT, || {
                for x in &all {
                    black_box(problem.task().net_rotation(black_box(x)));
                }
            })
        }));
    }
    for problem in &problems {
        lines.push(Line::new("first derivatives", || {
            microseconds(some.len(), || {
                for x in &some {
                    let _ = black_box(problem.linearise(black_box(x)));
                }
            })
        }));
    }
    for problem in &problems {
        lines.push(Line::new("second derivatives", || {
            microseconds(some.len(), || {
                for (x, multipliers) in some.iter().zip(&multipliers) {
                    let _ = black_box(problem.curvature(black_box(x), multipliers));
                }
            })
        }));
    }
    take_turns(&mut lines);

    let columns = widths.iter().map(|width| format!(" {} |", width.name()));
    println!("| microseconds for one of these |{}", columns.collect::<String>());
    println!("|---|{}", "---|".repeat(widths.len()));
    for group in lines.chunks(widths.len()) {
        let mut row = format!("| {} | {:.2} |", group[0].name, group[0].median());
        for line in &group[1..] {
            let _ = write!(row, " {:.2} ({:.1}×) |", line.median(), line.shorter_than(&group[0]));
        }
        println!("{row}");
    }
    println!();
}

fn multipliers(problem: &Formulated, x: &[f64]) -> Multipliers {
    let parts = problem.linearise(x).expect("the task never fails");
    let weigh = |term: usize, count: usize, by: f64| {
        parts.terms[term].pieces.iter().take(count).map(|piece| (piece.id, by)).collect()
    };
    Multipliers { terms: vec![weigh(0, 3, 1.0), weigh(1, 8, 0.1)] }
}

/// Robots with more joints than the paper's, by their tasks. The third is the fourth with two joints locked.
const ROBOTS: [(&str, &str); 4] = [
    ("`xiao2023`, 6 joints", "[task]\nrobot = 'xiao2023'"),
    ("`panda`, 7 joints", "[task]\nrobot = 'panda'"),
    (
        "`dual_arm`, 12 joints in two branches",
        "[task]\nrobot = 'dual_arm'\nlocked = ['left_iiwa_joint_7', 'right_iiwa_joint_7']
start.joints_deg = [0, 30, 0, -60, 0, 60, 0, 30, 0, -60, 0, 60]
goal.joints_deg = [20, 40, 10, -70, 10, 50, -20, 40, -10, -70, -10, 50]",
    ),
    ("`dual_arm`, 14 joints in two branches", "[task]\nrobot = 'dual_arm'"),
];

/// An evaluation by the robot's number of joints.
fn robots() {
    const COUNT: usize = 1000;
    let problem = |text: &str| {
        let document = Document::embedded("task.toml", text);
        let built = TaskFile::read(&document).and_then(|file| file.build(&document));
        let (problem, boxes) = built.expect("a task");
        Formulated::new(Formulation::TimeFree, Arc::new(problem), &boxes).expect("sound boxes")
    };
    let problems = ROBOTS.map(|(name, text)| (name, problem(text)));
    let points = problems.each_ref().map(|(_, problem)| points(problem, COUNT, 1.0));
    let mut lines = Vec::new();
    for ((name, problem), points) in problems.iter().zip(&points) {
        lines.push(Line::new(name, || {
            let mut sum = 0.0;
            let time = microseconds(COUNT, || {
                let _ = problem.evaluate_batch(points, &mut |evaluation| sum += evaluation.cost);
            });
            black_box(sum);
            time
        }));
    }
    take_turns(&mut lines);
    println!("| one evaluation | microseconds | as a multiple of the first |");
    println!("|---|---|---|");
    for line in &lines {
        println!("| {} | {:.2} | {:.2} |", line.name, line.median(), lines[0].shorter_than(line));
    }
    println!();
}

/// A problem that costs no time, in the box of another: what a run on it takes is the optimiser's.
struct Free<'a>(&'a Bounds);

impl Problem for Free<'_> {
    fn bounds(&self) -> &Bounds {
        self.0
    }

    fn evaluate(&self, x: &[f64]) -> Result<Evaluation, Failure> {
        Ok(x[0].into())
    }
}

/// Seconds that the paper's budget takes.
fn seconds(optimiser: &dyn Optimiser, problem: &dyn Problem, seed: u64) -> f64 {
    let watch = Watch::default();
    let mut oracle = Oracle::new(problem, BUDGET, &watch);
    let clock = Instant::now();
    let _ = optimiser.minimise(&mut oracle, &mut Rng::new(seed));
    clock.elapsed().as_secs_f64()
}

/// Whole runs, and the same with a problem that costs nothing.
fn runs(paper: &Paper) {
    let problem = paper.formulated(Formulation::TimeFree, Width::widest());
    let free = Free(problem.bounds());
    let optimisers: [(&str, &dyn Optimiser); 3] =
        [("pso", &Pso::default()), ("de", &De::default()), ("random", &RandomSearch::default())];
    println!(
        "| {BUDGET} evaluations | seconds | the optimiser's own, as a share of the problem's |"
    );
    println!("|---|---|---|");
    let mut all = vec![Vec::new(); optimisers.len()];
    for seed in 1..=TURNS as u64 {
        for ((_, optimiser), turns) in optimisers.iter().zip(&mut all) {
            let whole = seconds(*optimiser, &problem, seed);
            let own = seconds(*optimiser, &free, seed);
            turns.push([whole, own / (whole - own)]);
        }
    }
    for ((name, _), turns) in optimisers.iter().zip(&all) {
        let [whole, share] = [0, 1].map(|k| median(turns.iter().map(|turn| turn[k]).collect()));
        println!("| `{name}` | {whole:.3} | {:.1} % |", 100.0 * share);
    }
    println!();
}

/// `scp`: the time of a start, and until a motion as good as the best known is found.
fn convex(paper: &Paper) {
    const SEEDS: u64 = 100;
    let problem = paper.formulated(Formulation::TimeFree, Width::widest());
    let mut each = Vec::new();
    let mut until = Vec::new();
    for seed in 1..=SEEDS {
        let watch = Watch::default();
        let mut oracle = Oracle::new(&problem, u64::MAX, &watch);
        let mut rng = Rng::new(seed);
        let clock = Instant::now();
        loop {
            let start = Scp::start(problem.bounds(), &mut rng);
            let began = Instant::now();
            let _ = Scp::default().follow(&mut oracle, &start);
            each.push(began.elapsed().as_secs_f64() * 1e3);
            let best = oracle.best().map(|best| problem.certify(&best.x).1.cost);
            if best.is_some_and(|cost| cost <= TARGET) {
                break;
            }
        }
        until.push(clock.elapsed().as_secs_f64() * 1e3);
    }
    let worst = until.iter().copied().fold(0.0, f64::max);
    println!("| `scp`, {SEEDS} seeds | milliseconds |");
    println!("|---|---|");
    println!(
        "| one start, median of the {} that they needed | {:.2} |",
        each.len(),
        median(each.clone())
    );
    println!("| starts until J ≤ 0.781850, median | {:.2} |", median(until));
    println!("| starts until J ≤ 0.781850, worst | {worst:.1} |\n");
}

/// What the arithmetic alone takes.
fn bound(paper: &Paper) {
    let peak = Peak::of(Width::widest());
    println!("| one evaluation | products | sums | others | quotients | at the processor's peak |");
    println!("|---|---|---|---|---|---|");
    let mut all = 0.0;
    for (name, counted) in operations::of_an_evaluation(&paper.problem) {
        let Operations { products, sums, bits, quotients } = counted;
        let microseconds = peak.bound(counted) / 1e3;
        all += microseconds;
        println!("| {name} | {products} | {sums} | {bits} | {quotients} | {microseconds:.2} µs |");
    }
    println!("| both | | | | | {all:.2} µs |\n");
}

/// What finer and coarser settings cost, and by how much they miss.
fn accuracies(paper: &Paper) {
    const COUNT: usize = 300;
    let problem = &paper.problem;
    let points = |share: f64| {
        points(&paper.formulated(Formulation::TimeFree, Width::widest()), COUNT, share)
    };
    let (all, inner) = (points(1.0), points(0.5));
    let best = BestKnown::of(problem).map(|known| known.coefficients.concat()).unwrap_or_default();
    let fine = problem.with_accuracy(Accuracy::FINE);
    let turns = |problem: &Reorientation, points: &Points| -> Vec<_> {
        points.iter().map(|x| problem.net_rotation(x)).collect()
    };
    let [exact, exact_inner] = [&all, &inner].map(|points| turns(&fine, points));
    println!(
        "| `attitude_steps` | nodes | rollout | error in the box, median, worst | in its inner half | change of J of the best motion |"
    );
    println!("|---|---|---|---|---|---|");
    for steps in [12, 18, 24, 36, 48, 96] {
        let accuracy = Accuracy { attitude_steps: steps, ..problem.accuracy() };
        let problem = problem.with_accuracy(accuracy);
        let errors = |points: &Points, exact: &[UnitQuaternion<f64>]| {
            let found = turns(&problem, points);
            let errors = found.iter().zip(exact).map(|(q, exact)| (q.coords - exact.coords).norm());
            let errors: Vec<f64> = errors.collect();
            let worst = errors.iter().copied().fold(0.0, f64::max);
            format!("{:.0e}, {worst:.0e}", median(errors))
        };
        let time = median(
            (0..TURNS)
                .map(|_| microseconds(COUNT, || drop(black_box(turns(&problem, &all)))))
                .collect(),
        );
        let change = |accuracy| {
            let problem = fine.with_accuracy(accuracy);
            problem.assess(&best, None).cost - fine.assess(&best, None).cost
        };
        let only = Accuracy { attitude_steps: steps, ..Accuracy::FINE };
        println!(
            "| {steps} | {} | {time:.2} µs | {} | {} | {:.0e} |",
            2 * steps.next_multiple_of(3),
            errors(&all, &exact),
            errors(&inner, &exact_inner),
            change(only).abs()
        );
    }
    println!();

    println!(
        "| `peak_intervals` | evaluation | peaks missed by more than 10⁻⁹, with 2, 8, 16 terms |"
    );
    println!("|---|---|---|");
    let families = [2, 8, 16].map(|terms| {
        let widths = [1.0, 0.35, 0.15, 0.05].into_iter().chain(std::iter::repeat(0.05));
        let joint: Vec<f64> = widths.take(terms).collect();
        let problem = Reorientation::new(problem.task().clone(), terms, Accuracy::FINE);
        let mut rng = Rng::new(7);
        let mut draw = || -> Vec<f64> {
            let widths = joint.iter().cycle().take(problem.family().dimension());
            widths.map(|width| rng.uniform(-width, *width)).collect()
        };
        let points: Vec<_> = (0..COUNT).map(|_| draw()).collect();
        let exact: Vec<_> = points.iter().map(|x| peaks(&problem, x, 1024)).collect();
        (problem, points, exact)
    });
    for intervals in [15, 31, 47, 63, 95] {
        let missed = families.each_ref().map(|(problem, points, exact)| {
            let found = points.iter().flat_map(|x| peaks(problem, x, intervals));
            let pairs = found.zip(exact.iter().flatten());
            pairs.filter(|(found, exact)| *found < *exact * (1.0 - 1e-9)).count()
        });
        let accuracy = Accuracy { peak_intervals: intervals, ..problem.accuracy() };
        let problem = problem.with_accuracy(accuracy);
        let mut workspace = problem.workspace();
        let time = median(
            (0..TURNS)
                .map(|_| {
                    microseconds(COUNT, || {
                        for x in &all {
                            black_box(problem.evaluate(black_box(x), None, &mut workspace));
                        }
                    })
                })
                .collect(),
        );
        let [two, eight, sixteen] = missed;
        println!("| {intervals} | {time:.2} µs | {two}, {eight}, {sixteen} of {} |", 18 * COUNT);
    }
    println!();
}

/// The heights of all peaks of a path.
fn peaks(problem: &Reorientation, coefficients: &[f64], intervals: usize) -> Vec<f64> {
    let Peaks(peaks) = Peaks::of(problem.family(), coefficients, intervals);
    peaks.into_iter().flatten().map(|peak| peak.value).collect()
}

fn main() {
    let paper = Paper::new();
    let width = Width::widest();
    println!("{} lanes ({}), one thread, median of {TURNS} turns\n", width.lanes(), width.name());
    evaluations(&paper);
    robots();
    runs(&paper);
    convex(&paper);
    bound(&paper);
    accuracies(&paper);
}
