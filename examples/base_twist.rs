//! How the base of a robot answers its joints: reads a robot file or URDF, and states from standard input.
//!
//! ```sh
//! echo '[{"positions": {"shoulder": 0.3}, "rates": {"shoulder": 1.0}}]' | cargo run --release --example base_twist arm.urdf
//! ```
//!
//! Positions \[rad or m\] and rates \[rad/s or m/s\] are those of joints by name, zero where there is none. Prints one list per state:
//! linear \[m/s\] and angular velocity \[rad/s\] of the base with zero momentum, along base axes.

use std::collections::HashMap;
use std::error::Error;
use std::path::Path;

use driftless::input::Document;
use driftless::momentum::base_twist;
use driftless::robot::Robot;
use serde::Deserialize;

#[derive(Deserialize)]
struct State {
    positions: HashMap<String, f64>,
    rates: HashMap<String, f64>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let path = std::env::args().nth(1).ok_or("expected a robot file or a URDF")?;
    let robot = Robot::from_document(&Document::read(Path::new(&path))?)?;
    let states: Vec<State> = serde_json::from_reader(std::io::stdin())?;
    let twists: Vec<[f64; 6]> = states.iter().map(|state| twist(&robot, state)).collect();
    println!("{}", serde_json::to_string(&twists)?);
    Ok(())
}

fn twist(robot: &Robot, State { positions, rates }: &State) -> [f64; 6] {
    let listed = |values: &HashMap<String, f64>| -> Vec<f64> {
        robot.joints().map(|joint| values.get(joint.name).copied().unwrap_or_default()).collect()
    };
    let twist = base_twist(robot, &listed(positions), &listed(rates));
    let (v, w) = (twist.linear, twist.angular);
    [v.x, v.y, v.z, w.x, w.y, w.z]
}
