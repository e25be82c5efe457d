//! Rollouts of the base's attitude, one number at a time or in lanes, for `compare.py`.
//!
//! `rollout WIDTH MOTIONS`: for every line on standard input it goes through all motions and prints the
//! seconds that a rollout took; at the end it prints, as JSON, the rotation at the end of each motion.
//! Without arguments it prints the names of the widths that this machine has.

use std::error::Error;
use std::hint::black_box;
use std::time::Instant;

use driftless::lanes::Width;
use driftless::reorientation::TaskFile;
use nalgebra::UnitQuaternion;
use serde_json::json;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<_> = std::env::args().skip(1).collect();
    let [width, motions] = arguments.as_slice() else {
        let names: Vec<_> = Width::available().map(Width::name).collect();
        println!("{}", json!(names));
        return Ok(());
    };
    let width = Width::available().find(|w| w.name() == width).ok_or("no such width")?;
    let document = TaskFile::paper();
    let (problem, _) = TaskFile::read(&document)?.build(&document)?;
    let problem = problem.with_width(width);

    let text = std::fs::read_to_string(motions)?;
    // The first number is that of the motions.
    let numbers = text.split_whitespace().skip(1).map(str::parse);
    let motions: Vec<f64> = numbers.collect::<Result<_, _>>()?;
    let motions = motions.chunks_exact(problem.family().dimension());

    let mut rotations = vec![UnitQuaternion::identity(); motions.len()];
    for line in std::io::stdin().lines() {
        line?;
        let clock = Instant::now();
        for (rotation, motion) in rotations.iter_mut().zip(motions.clone()) {
            *rotation = problem.net_rotation(black_box(motion));
        }
        println!("{:e}", clock.elapsed().as_secs_f64() / rotations.len() as f64);
    }
    let rotations: Vec<_> = rotations.iter().map(|q| [q.w, q.i, q.j, q.k]).collect();
    println!("{}", json!(rotations));
    Ok(())
}
