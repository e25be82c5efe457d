//! The robot along a motion.

use nalgebra::Vector3;

use crate::figure::Figure;
use crate::figure::axis::Axis;
use crate::figure::marks::{Line, Mark, Marked};
use crate::figure::panel::Panel;
use crate::figure::style::{COLOURS, DASHES, GRID, INK, Marker, PAPER, Stroke, Width, mix};
use crate::posture::{BaseBox, Branches, Satellite};
use crate::reorientation::motion::Motion;
use crate::reorientation::snapshot::Snapshot;
use crate::task::Task;

/// Snapshots of a motion, and those in a row.
const SNAPSHOTS: usize = 6;
const ACROSS: usize = 3;
/// Where it is seen from, in inertial axes.
const FROM: [f64; 3] = [1.0, -1.6, 0.9];
/// Free share around what is seen.
const AROUND: f64 = 1.06;

/// A parallel projection.
struct View {
    right: Vector3<f64>,
    up: Vector3<f64>,
    towards: Vector3<f64>,
}

impl View {
    fn new() -> Self {
        let towards = Vector3::from(FROM).normalize();
        let right = Vector3::z().cross(&towards).normalize();
        Self { up: towards.cross(&right), right, towards }
    }

    fn of(&self, place: &Vector3<f64>) -> [f64; 2] {
        [self.right.dot(place), self.up.dot(place)]
    }
}

/// The robot at equal distances of time, seen along one direction. The base's goal attitude is dotted, the tool's way is
/// drawn up to each time.
pub(super) fn snapshots(motion: &Motion, task: &Task) -> Figure {
    let view = View::new();
    let blocks = Satellite::of(&task.robot).blocks();
    let last = motion.time.len().saturating_sub(1);
    let branches = Branches::of(&task.robot);
    let all: Vec<Snapshot> = (0..=last).map(|i| Snapshot::of(task, &branches, motion, i)).collect();
    let chosen: Vec<usize> = (0..SNAPSHOTS).map(|k| k * last / (SNAPSHOTS - 1)).collect();
    let drawings: Vec<Vec<Mark>> =
        chosen.iter().map(|&i| drawing(&view, &blocks, task, &all[..=i])).collect();
    let (middle, [half_x, half_y]) = seen(&drawings);
    let width = (Width::Column.mm() - ACROSS as f64) / ACROSS as f64;
    let height = width * (half_y / half_x).clamp(0.6, 1.5);
    // The same scale in both directions and in all panels.
    let scale = f64::max(half_x / width, half_y / height) * AROUND;
    let axis = |middle: f64, length: f64| {
        Axis::linear("", [middle - scale * length, middle + scale * length], 0.0)
    };
    let panels = chosen.iter().zip(drawings).map(|(&i, marks)| {
        let time = format!("t = {:.2} s", all[i].time);
        Panel::bare(axis(middle[0], width), axis(middle[1], height), marks).titled(&time)
    });
    Figure { width: Width::Column, across: ACROSS, height, panels: panels.collect() }
}

/// The middle and half the size of all that is drawn.
fn seen(drawings: &[Vec<Mark>]) -> ([f64; 2], [f64; 2]) {
    let places = drawings.iter().flatten().flat_map(|mark| match mark {
        Mark::Area { corners, .. } => &corners[..],
        Mark::Line(line) => &line.points[..],
        _ => &[],
    });
    let ends = [[f64::INFINITY, f64::NEG_INFINITY]; 2];
    let ends = places.fold(ends, |ends, place| {
        [0, 1].map(|k| [ends[k][0].min(place[k]), ends[k][1].max(place[k])])
    });
    (ends.map(|[low, high]| 0.5 * (low + high)), ends.map(|[low, high]| 0.5 * (high - low)))
}

/// The last of some snapshots, with the tool's way through all.
fn drawing(view: &View, blocks: &[BaseBox], task: &Task, way: &[Snapshot]) -> Vec<Mark> {
    let (Some(now), Some((body, others))) = (way.last(), blocks.split_first()) else {
        return Vec::new();
    };
    let place = |corner: &Vector3<f64>| view.of(&(now.base + now.attitude * corner));
    let is_near = |place: &Vector3<f64>| view.towards.dot(&(place - now.base)) > 0.0;
    let (mut behind, mut before) = (Vec::new(), Vec::new());
    let tool: Vec<Vector3<f64>> = way.iter().map(|s| s.tool).collect();
    for piece in tool.chunk_by(|a, b| is_near(a) == is_near(b)) {
        let marks = if is_near(&piece[0]) { &mut before } else { &mut behind };
        let points = piece.iter().map(|place| view.of(place)).collect();
        marks.push(Mark::Line(Line::new("", Stroke::plain(COLOURS[1], 0.25), points)));
    }
    for link in &now.links {
        let ends = [view.of(&link[0]), view.of(&link[1])];
        let stroke = Stroke::plain(INK, 0.9).with_marker(Marker::Circle);
        let marks = if is_near(&(0.5 * (link[0] + link[1]))) { &mut before } else { &mut behind };
        marks.push(Mark::Line(Line::new("", stroke, ends.to_vec())));
    }
    // Faces that look this way, and their edges.
    let faces = |block: &BaseBox| -> Vec<(usize, Vec<[f64; 2]>)> {
        let all = (0..3).flat_map(|edge| [-1.0, 1.0].map(|side| (edge, side)));
        let seen = all.filter(|&(edge, side)| {
            view.towards.dot(&(now.attitude * block.normal(edge, side))) > 0.0
        });
        seen.map(|(edge, side)| (edge, block.face(edge, side).iter().map(place).collect()))
            .collect()
    };
    let shade = |edge: usize| mix(GRID, INK, 0.02 + 0.14 * edge as f64);
    for block in others {
        let marks = if is_near(&(now.base + now.attitude * block.centre)) {
            &mut before
        } else {
            &mut behind
        };
        for (edge, corners) in faces(block) {
            let is_flat = block.is_flat();
            let colour = if is_flat { mix(COLOURS[0], PAPER, 0.55) } else { shade(edge) };
            marks.insert(0, Mark::Area { colour, corners });
        }
    }
    let mut marks = behind;
    for (edge, corners) in faces(body) {
        marks.push(Mark::Area { colour: shade(edge), corners });
    }
    marks.extend(goal(view, body, task, now));
    marks.extend(before);
    marks
}

/// The edges of the base's body in its goal attitude, where the base is now.
fn goal(view: &View, body: &BaseBox, task: &Task, now: &Snapshot) -> Vec<Mark> {
    let place = |corner: &Vector3<f64>| view.of(&(now.base + task.goal.base * corner));
    let stroke = Stroke { dashes: DASHES[2], ..Stroke::plain(INK, 0.12) };
    let edge = |ends: [Vector3<f64>; 2]| Line {
        name: String::new(),
        stroke,
        points: ends.iter().map(place).collect(),
        marked: Marked::Points,
    };
    body.outline().into_iter().map(|ends| Mark::Line(edge(ends))).collect()
}
