//! What tasks limit on the way: limits bind, and hold between the places that the search looks at; those that no motion keeps are
//! told as such.

use std::num::NonZeroUsize;
use std::sync::Arc;

use driftless::input::Document;
use driftless::optimiser::{Scp, Settings};
use driftless::reorientation::{
    Accuracy, Excursions, FamilyChoice, FamilyName, Formulated, Planned, Planner, Reach,
    Reorientation, Search, TaskFile,
};
use driftless::search::Watch;
use driftless::trajectory::Spline;

/// The best motion of 16 pieces from a few starts.
fn planned(text: &str) -> Planned {
    let document = Document::embedded("task.toml", text);
    let file = TaskFile::read(&document).unwrap_or_else(|error| panic!("{text}: {error}"));
    let task = file.task.build(&document).unwrap_or_else(|error| panic!("{text}: {error}"));
    let family = Spline::new(&task.start.joints, &task.goal.joints, 16, 4);
    let accuracy = Accuracy { attitude_steps: 24, peak_intervals: 47 };
    let problem = Reorientation::over(Arc::new(task), family, accuracy);
    let problem = Formulated::free_form(Arc::new(problem)).unwrap();
    let scp = Scp { starts: NonZeroUsize::new(6), tolerance: 1e-7, ..Scp::default() };
    let search = Search { seed: 1, budget: 20_000, watch: &Watch::default() };
    search.best(&scp, &problem, &problem, f64::INFINITY).unwrap()
}

/// The share of a limit that a motion uses, looked at 20,000 times.
fn share(found: &Planned, limit: &str) -> f64 {
    let duration = found.assessment.duration;
    let motion = found.problem.sample(&found.coefficients, duration, 20_000);
    let excursions = Excursions::of(found.problem.task(), &motion);
    let used = excursions.used.iter().find(|used| used.limit.name() == limit);
    used.unwrap_or_else(|| panic!("{limit}: {:?}", excursions.used)).share
}

/// Each limit alone, narrow enough to cost time.
const LIMITS: [(&str, &str); 8] = [
    ("base_turn", "limits = { base_turn_deg = 10 }"),
    ("base_turn", "limits = { base_turn_deg = 20, base_turn_from = 'start' }"),
    (
        "base_cone",
        "limits = { base_cone = { axis = [1, 0, 0], from = [1, 0, 0], within_deg = 25 } }",
    ),
    (
        "base_cone",
        "limits = { base_cone = { axis = [0, 1, 0], from = [0, -1, 0], outside_deg = 155 } }",
    ),
    ("base_rate", "limits = { base_rate_deg_s = 9 }"),
    ("tool_speed", "limits = { tool_speed_m_s = 0.6 }"),
    ("torque", "limits = { torque_n_m = [15, 15, 10, 10, 1, 1] }"),
    ("clearance", "limits = { clearance_m = 0.05 }"),
];

#[test]
fn limits_bind_and_hold() {
    let free = planned("[task]\n").assessment.duration;
    for (limit, text) in LIMITS {
        let found = planned(&format!("[task]\n{text}\n"));
        let name = format!("{text}: {:?}", found.assessment.path);
        assert_eq!(found.reach, Reach::Reached, "{name}");
        assert!(found.assessment.duration > free + 1e-3, "{free}, {name}");
        let share = share(&found, limit);
        assert!(share <= 1.0 + 1e-6, "{share}, {name}");
        assert!(share >= 0.999, "{share}, {name}");
    }
}

/// A search looks at fewer places than a plan's spline has pieces, and what it finds here breaks its limits between them. Starts
/// followed again with the goal weighing more came to 7.02 s.
#[test]
fn plans_keep_limits_between_the_places_of_a_search() {
    let text = "[task]\nlimits = { clearance_m = 0.05, base_turn_deg = 15 }\n";
    let document = Document::embedded("task.toml", text);
    let settings = Settings::Scp(Scp::default());
    let planner = Planner::read(&document, FamilyChoice::default(), settings).unwrap();
    let found = planner.plan(1, 150_000, &Watch::default()).unwrap();
    assert_eq!(found.reach, Reach::Reached);
    assert!(found.assessment.duration < 6.6, "{}", found.assessment.duration);
    for limit in ["clearance", "base_turn"] {
        let share = share(&found, limit);
        assert!(share <= 1.0 + 1e-4, "{limit}: {share}");
    }
}

#[test]
fn solids_are_kept_out_of() {
    let text = "[task.keep_out.target]\nshapes = [{ sphere = { centre = [-0.6, -1.2, 1.6], radius = 0.4 } }]\n\
         [task.keep_out.mast]\nframe = 'base'\n\
         shapes = [{ capsule = { from = [0.4, 0.4, 0.4], to = [0.4, 0.4, 1.6], radius = 0.05 } }]\n";
    let found = planned(text);
    assert_eq!(found.reach, Reach::Reached, "{:?}", found.assessment.path);
    let motion = found.problem.sample(&found.coefficients, found.assessment.duration, 20_000);
    let closest = Excursions::of(found.problem.task(), &motion).closest.unwrap();
    assert!(closest.distance >= -1e-5, "{closest:?}");
}

/// Less turn on the way for more time.
#[test]
fn turns_are_weighed() {
    let turn = |text: &str| {
        let found = planned(text);
        let motion = found.problem.sample(&found.coefficients, found.assessment.duration, 5000);
        let from = found.problem.task().start.base;
        let turns = motion.base.iter().map(|base| from.angle_to(base));
        (turns.fold(0.0, f64::max), found.assessment.duration)
    };
    let [plain, weighed] =
        ["", "weights = { largest_turn = 0.02 }\nlimits = { base_turn_from = 'start' }"]
            .map(|text| turn(&format!("[task]\n{text}\n")));
    assert!(weighed.0 < plain.0 - 0.05 && weighed.1 > plain.1, "{plain:?} {weighed:?}");
}

#[test]
fn impossible_limits_are_told() {
    let told = |text: &str| {
        let document = Document::embedded("task.toml", &format!("[task]\n{text}\n"));
        let file = TaskFile::read(&document).unwrap();
        let error = file.task.build(&document).err().map(|error| error.to_string());
        error.unwrap_or_else(|| panic!("{text} was taken"))
    };
    let cases = [
        (
            "limits = { base_turn_deg = 15, base_turn_from = 'start' }",
            "at the goal the base is turned by 17.2",
        ),
        (
            "limits = { base_cone = { axis = [0, 0, 1], from = [1, 0, 0], within_deg = 20 } }",
            "at the start the axis is 7",
        ),
        (
            "limits = { base_cone = { axis = [0, 0, 1], from = [0, 0, 1], outside_deg = 20 } }",
            "at the start the axis is 16.5",
        ),
        ("limits = { clearance_m = 1 }", "at the start `"),
        (
            "[task.keep_out.dock]\nframe = 'base'\nshapes = [{ box = { centre = [0, 0, 1], size = [3, 3, 3] } }]",
            "`dock` overlap by",
        ),
    ];
    for (text, message) in cases {
        let found = told(text);
        assert!(found.contains(message), "{text}: {found}");
        assert!(!found.contains('\n'), "{found}");
    }
}

#[test]
fn mistakes_are_told_where_they_are() {
    let told = |text: &str| {
        let document = Document::embedded("task.toml", text);
        let file = TaskFile::read(&document).map_err(|error| error.to_string());
        let built = file.and_then(|f| f.task.build(&document).map_err(|error| error.to_string()));
        built.err().unwrap_or_else(|| panic!("{text} was taken"))
    };
    let cases = [
        ("[task.limits]\nbase_turn_deg = -1\n", "task.toml: 2:17: found -1"),
        // Half of the paper's turn of 17.3°.
        (
            "[task.limits]\nbase_turn_deg = 8.6\n",
            "2:17: on its way from start to goal the base is turned by 8.6",
        ),
        ("[task.limits]\nclearance_m = nan\n", "finite number, zero or above"),
        ("[task.limits]\nbase_turn_from = 'end'\n", "`start`, `goal`, `nearer`"),
        ("[task.limits]\ntorque_n_m = [1, 2]\n", "found 2 values, expected 6"),
        ("[task.limits]\ntorque_n_m = 0\n", "above zero"),
        (
            "[task.limits]\nbase_cone = { axis = [0, 0, 0], from = [0, 0, 1], within_deg = 20 }\n",
            "`axis` is zero, expected a direction",
        ),
        (
            "[task.limits]\nbase_cone = { axis = [0, 0, 1], from = [0, 0, 1] }\n",
            "expected one of `within_deg` and `outside_deg`",
        ),
        (
            "[task.limits]\nbase_cone = { axis = [0, 0, 1], from = [0, 0, 1], within_deg = 200 }\n",
            "less than 180°",
        ),
        ("[task.limits]\nbase_cone = 3\n", "a table with `axis`"),
        ("[task.keep_out.a]\nshapes = []\n", "`a` has no shapes"),
        ("[task.keep_out.a]\nframe = 'tool'\nshapes = [{ sphere = { radius = 1 } }]\n", "`base`"),
        ("[task.weights]\nmean_turn = -1\n", "zero or above"),
    ];
    for (text, message) in cases {
        let found = told(text);
        assert!(found.contains(message), "{text}: {found}");
    }
}

/// A task that asks for nothing on the way is the same as before there was anything to ask for.
#[test]
fn families_without_limits_have_none() {
    let document = Document::embedded("task.toml", "[trajectory]\nfamily = 'spline'\n");
    let file = TaskFile::read(&document).unwrap();
    assert_eq!(file.trajectory.family(), FamilyName::Spline);
    let task = file.task.build(&document).unwrap();
    assert!(task.path.is_empty() && task.impossible().is_none());
}
