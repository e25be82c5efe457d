//! The functions of COCO's suite `bbob`, which IOHprofiler has too, under the same numbers and with the same instances.
//!
//! Both log differences from the optimum, so their runs compare. COCO's data have no names; these are IOHprofiler's.

/// What COCO calls the suite. IOHprofiler writes it in capitals.
pub(super) const SUITE: &str = "bbob";

/// By number, from one.
const NAMES: [&str; 24] = [
    "Sphere",
    "Ellipsoid",
    "Rastrigin",
    "BuecheRastrigin",
    "LinearSlope",
    "AttractiveSector",
    "StepEllipsoid",
    "Rosenbrock",
    "RosenbrockRotated",
    "EllipsoidRotated",
    "Discus",
    "BentCigar",
    "SharpRidge",
    "DifferentPowers",
    "RastriginRotated",
    "Weierstrass",
    "Schaffers10",
    "Schaffers1000",
    "GriewankRosenbrock",
    "Schwefel",
    "Gallagher101",
    "Gallagher21",
    "Katsuura",
    "LunacekBiRastrigin",
];

/// The name of a function.
pub(super) fn name(number: u32) -> Option<&'static str> {
    NAMES.get(usize::try_from(number).ok()?.checked_sub(1)?).copied()
}
