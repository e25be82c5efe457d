//! What the best motion is worth over a swept setting.

use super::best::BestMotion;
use super::words::AT_GOAL_DEG;
use crate::analysis::statistics::median;
use crate::experiment::Instance;
use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark};
use crate::figure::panel::{MARGIN, Panel, range};
use crate::figure::style::{INK, Marker, PAPER, Stroke, mix};
use crate::reorientation::sweep::{shown, title};
use crate::reorientation::symbols::{K_B, T_F};
use crate::robot::JointKind;
use crate::words::plural;

/// A setting that can be swept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Swept {
    /// `K_b`.
    WeightBase,
    /// Limit on rates.
    RateLimit,
    /// Limit on accelerations.
    AccelerationLimit,
    /// Limit on jerks.
    JerkLimit,
    /// Limit on the base's turn.
    TurnLimit,
    /// Angle of the one cone.
    Cone,
    /// Limit on the base's rate.
    BaseRateLimit,
    /// Limit on the tool's speed.
    ToolSpeedLimit,
    /// Limit on torques.
    TorqueLimit,
    /// Least distance.
    Clearance,
    /// Weight of the largest turn.
    WeightLargestTurn,
    /// Weight of the mean turn.
    WeightMeanTurn,
    /// Free coefficients per joint.
    Terms,
    /// Pieces of a spline.
    Pieces,
}

/// Most curves of a panel, and how many it rather has.
pub(super) const MOST_CURVES: usize = 8;
const FEW_CURVES: usize = 4;
/// Most panels in a row, and in a chart.
const ACROSS: usize = 4;
pub(super) const MOST_PANELS: usize = 24;

impl Swept {
    /// All of them.
    pub(super) const ALL: [Self; 14] = [
        Self::WeightBase,
        Self::RateLimit,
        Self::AccelerationLimit,
        Self::JerkLimit,
        Self::TurnLimit,
        Self::Cone,
        Self::BaseRateLimit,
        Self::ToolSpeedLimit,
        Self::TorqueLimit,
        Self::Clearance,
        Self::WeightLargestTurn,
        Self::WeightMeanTurn,
        Self::Terms,
        Self::Pieces,
    ];

    /// Its key in a file.
    pub(super) fn name(self) -> &'static str {
        match self {
            Self::WeightBase => "weight_base",
            Self::RateLimit => "rate_limit_deg_s",
            Self::AccelerationLimit => "acceleration_limit_deg_s2",
            Self::JerkLimit => "jerk_limit_deg_s3",
            Self::TurnLimit => "base_turn_deg",
            Self::Cone => "base_cone_deg",
            Self::BaseRateLimit => "base_rate_deg_s",
            Self::ToolSpeedLimit => "tool_speed_m_s",
            Self::TorqueLimit => "torque_n_m",
            Self::Clearance => "clearance_m",
            Self::WeightLargestTurn => "weight_largest_turn",
            Self::WeightMeanTurn => "weight_mean_turn",
            Self::Terms => "terms",
            Self::Pieces => "pieces",
        }
    }

    fn label(self) -> String {
        match self {
            Self::WeightBase => format!("weight of the base {K_B}"),
            Self::RateLimit => "limit on rates [°/s]".to_owned(),
            Self::AccelerationLimit => "limit on accelerations [°/s²]".to_owned(),
            Self::JerkLimit => "limit on jerks [°/s³]".to_owned(),
            Self::TurnLimit => "limit on turns of the base [°]".to_owned(),
            Self::Cone => "angle of the cone [°]".to_owned(),
            Self::BaseRateLimit => "limit on rates of the base [°/s]".to_owned(),
            Self::ToolSpeedLimit => "limit on speeds of the tool [m/s]".to_owned(),
            Self::TorqueLimit => "limit on torques [N·m]".to_owned(),
            Self::Clearance => "clearance asked for [m]".to_owned(),
            Self::WeightLargestTurn => "weight of the largest turn [1/°]".to_owned(),
            Self::WeightMeanTurn => "weight of the mean turn [1/°]".to_owned(),
            Self::Terms => "free coefficients per joint".to_owned(),
            Self::Pieces => "pieces".to_owned(),
        }
    }
}

/// The best motion at one value of a setting.
#[derive(Debug, Clone)]
pub(super) struct Point {
    /// All other settings but the pose, as charts write them.
    pub(super) others: Vec<String>,
    /// Which pose; empty where there is but one.
    pub(super) pose: String,
    pub(super) setting: f64,
    pub(super) cost: f64,
    /// Error of the base \[°\].
    pub(super) residual_deg: f64,
    /// Duration \[s\].
    pub(super) duration: f64,
    /// Largest turn of the base \[°\]; NaN where it was not stored.
    pub(super) turn_deg: f64,
    /// What the joints do.
    pub(super) shape: Shape,
    /// Whether a lower value of the setting gave no motion, and the next lower one that did is below it.
    pub(super) follows_failure: bool,
}

/// What the joints of a motion do, whatever its duration: the positions of those that turn and of those that slide, each joint
/// at equal shares of the time.
#[derive(Debug, Clone, Default)]
pub(super) struct Shape(pub(super) [Vec<Vec<f64>>; 2]);

/// Intervals at which shapes are compared.
const SHAPE_INTERVALS: usize = 32;
/// Motions whose joints are further apart than this share of the largest travel of a joint are of different branches.
const SAME_BRANCH: f64 = 0.25;

impl Shape {
    fn of(motion: &BestMotion<'_>) -> Self {
        let sampled = motion.sample(SHAPE_INTERVALS);
        let of_kind = |kind: JointKind| {
            let own = sampled.joints.iter().filter(|joint| joint.kind == kind);
            own.map(|joint| joint.derivatives.iter().map(|d| d[0]).collect()).collect()
        };
        Self([JointKind::Revolute, JointKind::Prismatic].map(of_kind))
    }

    /// Whether two motions are of one branch of solutions: at no time is a joint of one further from where it is in the other
    /// than a quarter of the largest travel of a joint of its kind.
    fn is_near(&self, other: &Self) -> bool {
        self.0.iter().zip(&other.0).all(|(own, other)| {
            let travel = |joint: &Vec<f64>| {
                let [low, high] = range(joint.iter().copied(), f64::NEG_INFINITY);
                high - low
            };
            let travel = own.iter().chain(other).map(travel).fold(0.0, f64::max);
            let pairs = own.iter().zip(other).flat_map(|(own, other)| own.iter().zip(other));
            pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max) <= SAME_BRANCH * travel
        })
    }
}

impl Point {
    /// Whether the motion ends elsewhere than at the goal, so that its duration does not compare.
    fn misses(&self) -> bool {
        self.residual_deg > AT_GOAL_DEG
    }

    /// Whether a line joins it to the one before: both reach the goal, no value between them is without a motion, and the two
    /// motions are of one branch of solutions.
    fn is_joined_to(&self, before: &Self) -> bool {
        let reach = !self.misses() && !before.misses();
        reach && !self.follows_failure && self.shape.is_near(&before.shape)
    }
}

/// The setting that tells tasks of one group apart.
const POSE: &str = "pose";

/// The best motions at the values of a setting, those that have one.
pub(super) fn points(best: &[BestMotion<'_>], instances: &[Instance], swept: Swept) -> Vec<Point> {
    let place = |instance: &Instance| {
        let pose = instance.coordinate(POSE).map_or_else(String::new, shown);
        let setting = instance.coordinate(swept.name())?.real()?;
        Some((others(instance, &[swept.name(), POSE]), pose, setting))
    };
    let places: Vec<_> = instances.iter().filter_map(place).collect();
    // Where there is more than one best motion of a place, as of several experiments, it counts as found.
    let found: Vec<_> = best.iter().filter_map(|motion| place(motion.instance)).collect();
    let failed: Vec<_> = places.iter().filter(|place| !found.contains(place)).collect();
    let follows_failure = |(others, pose, setting): &(Vec<String>, String, f64)| {
        let is_like = |other: &&(Vec<String>, String, f64)| &other.0 == others && &other.1 == pose;
        let below = found.iter().filter(is_like).map(|other| other.2).filter(|v| v < setting);
        let below = below.fold(f64::NEG_INFINITY, f64::max);
        let mut failed = failed.iter().copied().filter(is_like);
        failed.any(|other| below < other.2 && other.2 < *setting)
    };
    let point = |motion: &BestMotion<'_>| {
        let place = place(motion.instance)?;
        let follows_failure = follows_failure(&place);
        let (others, pose, setting) = place;
        let point = Point {
            others,
            pose,
            setting,
            shape: Shape::of(motion),
            follows_failure,
            cost: motion.run.cost,
            residual_deg: motion.residual_deg,
            duration: motion.duration,
            turn_deg: motion.turn_deg,
        };
        [point.cost, point.residual_deg, point.duration]
            .iter()
            .all(|v| v.is_finite())
            .then_some(point)
    };
    best.iter().filter_map(point).collect()
}

/// The settings of an instance but for some, as charts write them.
pub(super) fn others(instance: &Instance, settings: &[&str]) -> Vec<String> {
    let others = instance.coordinates.iter().filter(|c| !settings.contains(&c.setting.as_str()));
    others.map(|c| title(&c.setting, &shown(&c.value))).collect()
}

/// Whether a setting takes several values where all others are the same.
pub(super) fn varies(points: &[Point]) -> bool {
    let is_same = |a: &Point, b: &Point| a.others == b.others && a.pose == b.pose;
    let mut pairs = points.iter().enumerate();
    pairs.any(|(i, a)| points[..i].iter().any(|b| is_same(a, b) && a.setting != b.setting))
}

/// One combination of all other settings: its poses, each in the order of the setting.
struct Combination<'a> {
    others: &'a [String],
    poses: Vec<Vec<&'a Point>>,
}

impl Combination<'_> {
    /// Whether the task has poses to choose from.
    fn is_posed(&self) -> bool {
        self.poses.iter().flatten().any(|point| !point.pose.is_empty())
    }
}

fn combinations(points: &[Point]) -> Vec<Combination<'_>> {
    let mut all: Vec<Combination<'_>> = Vec::new();
    for point in points {
        let place = all.iter().position(|own| own.others == point.others).unwrap_or_else(|| {
            all.push(Combination { others: &point.others, poses: Vec::new() });
            all.len() - 1
        });
        let poses = &mut all[place].poses;
        match poses.iter_mut().find(|pose| pose[0].pose == point.pose) {
            Some(pose) => pose.push(point),
            None => poses.push(vec![point]),
        }
    }
    for pose in all.iter_mut().flat_map(|own| &mut own.poses) {
        pose.sort_by(|a, b| a.setting.total_cmp(&b.setting));
    }
    all
}

/// A panel's title, and its combinations, each with what the title does not say.
type Facet<'a> = (String, Vec<(String, &'a Combination<'a>)>);

/// The combinations in as few panels as have few curves each; none where these are too many.
fn facets<'a>(all: &'a [Combination<'a>]) -> Option<Vec<Facet<'a>>> {
    let depth = all.iter().map(|own| own.others.len()).max()?;
    let split = |depth: usize| {
        let mut facets: Vec<Facet<'_>> = Vec::new();
        for own in all {
            let (title, rest) = own.others.split_at(depth.min(own.others.len()));
            let (title, rest) = (title.join(", "), rest.join(", "));
            match facets.iter_mut().find(|facet| facet.0 == title) {
                Some(facet) => facet.1.push((rest, own)),
                None => facets.push((title, vec![(rest, own)])),
            }
        }
        facets
    };
    let choices = [FEW_CURVES, MOST_CURVES].into_iter();
    let mut choices = choices.flat_map(|most| (0..=depth).map(move |depth| (most, depth)));
    choices.find_map(|(most, depth)| {
        let facets = split(depth);
        let fits = facets.len() <= MOST_PANELS && facets.iter().all(|f| f.1.len() <= most);
        fits.then_some(facets)
    })
}

/// What is drawn of a motion.
#[derive(Clone, Copy)]
enum Ordinate {
    Cost,
    Residual,
    Duration,
    Turn,
}

impl Ordinate {
    fn of(self, point: &Point) -> f64 {
        match self {
            Self::Cost => point.cost,
            Self::Residual => point.residual_deg,
            Self::Duration => point.duration,
            Self::Turn => point.turn_deg,
        }
    }

    fn label(self) -> String {
        match self {
            Self::Cost => "best J".to_owned(),
            Self::Residual => "residual [°]".to_owned(),
            Self::Duration => duration(),
            Self::Turn => "largest turn [°]".to_owned(),
        }
    }
}

/// How the motions of a sweep are drawn.
struct Drawing<'a> {
    points: &'a [Point],
    swept: Swept,
    /// What curves are called, in the order of their looks.
    names: Vec<&'a str>,
}

/// The best motions over one setting: residual and duration, over a weight of turns the largest turn as well, over the number of
/// terms or pieces the cost as well. Motions that miss the goal are hollow. Lines join neighbours of one branch, see
/// [`Point::is_joined_to`]. None where the setting does not vary, or other settings give too many combinations.
///
/// Over jerk limits a reference tells what follows while jerk alone limits the motion, `t_f ∝ j̄^(−1/3)`. `bound` is the
/// least cost whatever the number of terms, where it is known.
pub(super) fn sweep(points: &[Point], swept: Swept, bound: Option<f64>) -> Option<Figure> {
    let combinations = combinations(points);
    let facets = facets(&combinations).filter(|_| varies(points))?;
    let mut names: Vec<&str> = Vec::new();
    for (name, _) in facets.iter().flat_map(|facet| &facet.1) {
        if !names.contains(&name.as_str()) {
            names.push(name);
        }
    }
    let drawing = Drawing { points, swept, names };
    let ordinates: &[Ordinate] = match swept {
        Swept::WeightBase => &[Ordinate::Residual, Ordinate::Duration],
        Swept::Terms | Swept::Pieces => &[Ordinate::Cost, Ordinate::Duration, Ordinate::Residual],
        Swept::WeightLargestTurn | Swept::WeightMeanTurn
            if points.iter().all(|point| point.turn_deg.is_finite()) =>
        {
            &[Ordinate::Turn, Ordinate::Duration, Ordinate::Residual]
        }
        _ => &[Ordinate::Duration, Ordinate::Residual],
    };
    if let [facet] = &facets[..] {
        let mut reference = match (swept, &combinations[..]) {
            (Swept::Terms, [_]) => {
                bound.map(|j| Line::level("free form, least found", j, drawing.settings()))
            }
            (Swept::JerkLimit, [only]) if !only.is_posed() => cube_root_law(&only.poses[0]),
            _ => None,
        };
        // The first ordinate alone has it.
        let panel = |ordinate: &Ordinate| drawing.panel(facet, *ordinate, reference.take());
        let panels: Vec<Panel> = ordinates.iter().map(panel).collect();
        let height = if panels.len() > 1 { 30.0 } else { 44.0 };
        return Some(Figure::column(panels, height));
    }
    // Rows of panels for the one ordinate, then for the next.
    let across = facets.len().min(ACROSS);
    let mut panels: Vec<Panel> = Vec::new();
    for ordinate in ordinates {
        panels.extend(facets.iter().map(|facet| drawing.panel(facet, *ordinate, None)));
        let rows = panels.len().next_multiple_of(across);
        let nothing = || Axis::linear("", [0.0, 1.0], 0.0);
        panels.resize_with(rows, || Panel::bare(nothing(), nothing(), Vec::new()));
    }
    Some(Figure { across, ..Figure::grid(panels) })
}

impl Drawing<'_> {
    fn settings(&self) -> [f64; 2] {
        range(self.points.iter().map(|point| point.setting), 0.0)
    }

    fn panel(
        &self,
        (title, combinations): &Facet<'_>,
        ordinate: Ordinate,
        reference: Option<Line>,
    ) -> Panel {
        let label = self.swept.label();
        let is_positive = self.points.iter().all(|point| point.setting > 0.0);
        let x = match self.swept {
            Swept::Terms => Axis::linear(&label, self.settings(), MARGIN).whole(),
            _ if !is_positive => Axis::linear(&label, self.settings(), MARGIN),
            _ => Axis::logarithmic(&label, self.settings(), MARGIN),
        };
        let own = self.points.iter().map(|point| ordinate.of(point));
        let lines = reference.iter().flat_map(|line| line.points.iter().map(|[_, y]| *y));
        let [low, high] = range(own.chain(lines), f64::NEG_INFINITY);
        let y = match ordinate {
            // What searches leave is not drawn as if it were something.
            Ordinate::Residual => {
                Axis::linear(&ordinate.label(), [0.0, high.max(10.0 * AT_GOAL_DEG)], MARGIN)
            }
            Ordinate::Duration if self.swept != Swept::WeightBase && low > 0.0 => {
                Axis::logarithmic(&ordinate.label(), [low, high], MARGIN)
            }
            _ => Axis::linear(&ordinate.label(), [low, high], MARGIN),
        };
        let mut marks: Vec<Mark> = reference.into_iter().map(Mark::Line).collect();
        for (name, combination) in combinations {
            marks.extend(self.curves(name, combination, ordinate));
        }
        if self.points.iter().any(Point::misses) {
            let name = format!("goal missed by more than {AT_GOAL_DEG}°");
            let stroke = Stroke { hollow: true, ..Stroke::plain(INK, 0.0) };
            let stroke = stroke.with_marker(Marker::Circle);
            marks.push(Mark::Points { name, stroke, points: Vec::new() });
        }
        Panel::new(x, y, marks).titled(title)
    }

    /// The curves of a combination; of several poses each thin, and the median of those that reach the goal throughout.
    fn curves(&self, name: &str, own: &Combination<'_>, ordinate: Ordinate) -> Vec<Mark> {
        let look = self.names.iter().position(|known| *known == name).unwrap_or_default();
        let full = Stroke::of(look).with_marker(Marker::ALL[look % Marker::ALL.len()]);
        let pale = mix(full.colour, PAPER, 0.4);
        let stroke = if own.is_posed() { Stroke::plain(pale, 0.12) } else { full };
        let place = |point: &Point| [point.setting, ordinate.of(point)];
        let mut marks = Vec::new();
        let mut told = name;
        for pose in &own.poses {
            for piece in pose.chunk_by(|a, b| b.is_joined_to(a)) {
                let points = piece.iter().map(|point| place(point)).collect();
                let name = if own.is_posed() { "" } else { std::mem::take(&mut told) };
                marks.push(Mark::Line(Line::new(name, stroke, points)));
            }
            let missed = pose.iter().filter(|point| point.misses());
            let points = missed.map(|point| place(point)).collect();
            let stroke = Stroke { hollow: true, width: 0.0, ..full };
            let stroke =
                Stroke { colour: if own.is_posed() { pale } else { full.colour }, ..stroke };
            marks.push(Mark::Points { name: String::new(), stroke, points });
        }
        if own.is_posed() {
            marks.push(Mark::Note("thin: single poses".to_owned()));
            marks.extend(median_line(name, own, ordinate, full).into_iter().flatten());
        }
        marks
    }
}

/// The median over the poses that reach the goal at every value of the setting; of costs and residuals over all. Its pieces join
/// neighbours that are joined in every pose.
fn median_line(
    name: &str,
    own: &Combination<'_>,
    ordinate: Ordinate,
    stroke: Stroke,
) -> Option<Vec<Mark>> {
    let most = own.poses.iter().map(Vec::len).max()?;
    let counts = |pose: &&Vec<&Point>| {
        let compares = matches!(ordinate, Ordinate::Cost | Ordinate::Residual);
        pose.len() == most && (compares || !pose.iter().any(|point| point.misses()))
    };
    let first = own.poses.iter().find(counts)?;
    // While a sweep is half done, poses may lack different values.
    let same_settings = |pose: &&Vec<&Point>| {
        pose.iter().zip(first).all(|(point, other)| point.setting == other.setting)
    };
    let poses: Vec<_> = own.poses.iter().filter(counts).filter(same_settings).collect();
    let places: Vec<usize> = (0..first.len()).collect();
    let joined =
        |&before: &usize, &i: &usize| poses.iter().all(|pose| pose[i].is_joined_to(pose[before]));
    let point = |&i: &usize| {
        let values = poses.iter().map(|pose| ordinate.of(pose[i])).collect();
        [first[i].setting, median(values)]
    };
    let pieces = places.chunk_by(joined).map(|piece| piece.iter().map(point).collect());
    let throughout = match ordinate {
        Ordinate::Duration | Ordinate::Turn => " that reach the goal throughout",
        _ => "",
    };
    let before = if name.is_empty() { String::new() } else { format!("{name}: ") };
    let told = format!("{before}median of {}{throughout}", plural(poses.len(), "pose"));
    Some(pieces.map(|points| Mark::Line(Line::new(&told, stroke, points))).collect())
}

/// Intervals in which the law is drawn.
const LAW_POINTS: f64 = 32.0;

/// `t_f ∝ j̄^(−1/3)` over the motions that reach the goal, from the lowest limit on.
fn cube_root_law(curve: &[&Point]) -> Option<Line> {
    let mut reached = curve.iter().filter(|point| !point.misses());
    let (first, last) = (reached.next()?, reached.next_back()?);
    let law = format!("{T_F} as the jerk limit to the power −1/3");
    let at = |jerk: f64| [jerk, first.duration * (jerk / first.setting).powf(-1.0 / 3.0)];
    // Straight on logarithmic axes alone.
    let jerk =
        |i: u32| first.setting * (last.setting / first.setting).powf(f64::from(i) / LAW_POINTS);
    let points = (0..=LAW_POINTS as u32).map(|i| at(jerk(i)));
    Some(Line::new(&law, Stroke::reference(), points.collect()))
}

/// The label of an axis of durations.
pub(super) fn duration() -> String {
    format!("duration {T_F} [s]")
}
