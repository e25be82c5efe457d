//! Whatever is wrong with what a user writes: one clear error, exit status 2, no panic. The texts
//! are in `snapshots/`.

use crate::folder::{Folder, stderr};

/// The paper's robot with one text replaced by another.
fn robot(from: &str, to: &str) -> String {
    let text = include_str!("../../src/robot/shipped/xiao2023.toml");
    assert!(text.contains(from), "{from:?} is not in the robot file");
    text.replacen(from, to, 1)
}

/// Runs the command on a file and compares what it says.
fn rejects(name: &str, args: &[&str], file: &str, content: impl AsRef<[u8]>) {
    let output = Folder::new().with(file, content).run(args);
    let text = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{name}: {text}");
    assert!(!text.contains("panicked"), "{name}: {text}");
    assert!(output.stdout.is_empty(), "{name} printed a result");
    insta::assert_snapshot!(name, text);
}

#[test]
fn tasks() {
    for (name, text) in [
        ("unknown_key", "[task]\nrobto = 'xiao2023'\n"),
        ("wrong_type", "[task.weights]\nbase = 'heavy'\n"),
        ("syntax", "[task\n"),
        ("too_few_joints", "[task.start]\njoints_deg = [10, 30, 45, -20, -25]\n"),
        ("joint_out_of_range", "[task.goal]\njoints_deg = [40, 60, 90, -10, -30, 160]\n"),
        ("angle_not_a_number", "[task.start]\nbase_zyx_deg = [6, nan, 7]\n"),
        ("two_euler_angles", "[task.start]\nbase_zyx_deg = [6, 15]\n"),
        ("limit_not_positive", "[task.limits]\njerk_deg_s3 = -80\n"),
        ("limit_in_list_not_positive", "[task.limits]\nrate_deg_s = [60, 60, 0, 60, 60, 60]\n"),
        ("limits_too_few", "[task.limits]\nrate_deg_s = [60, 60]\n"),
        ("limit_infinite", "[task.limits]\nacceleration_deg_s2 = inf\n"),
        ("limit_of_wrong_type", "[task.limits]\nacceleration_deg_s2 = 'high'\n"),
        ("unknown_limit", "[task.limits]\nbase_speed_deg_s = 1\n"),
        ("weight_out_of_range", "[task.weights]\nbase = 1.5\n"),
        ("unknown_robot", "[task]\nrobot = 'xiao2032'\n"),
        ("no_terms", "[trajectory]\nterms = 0\n"),
        ("too_many_terms", "[trajectory]\nterms = 17\n"),
        ("steps_without_end", "[trajectory]\nattitude_steps = 1_000_000_000_000\n"),
        ("box_without_end", "[trajectory.box]\ncoefficient = [1e308]\n"),
        ("no_steps", "[trajectory]\nattitude_steps = 0\n"),
        ("box_reversed", "[trajectory.box]\nduration = [9, 3]\n"),
        ("box_from_zero", "[trajectory.box]\nduration = [0, 3]\n"),
        ("box_without_widths", "[trajectory.box]\ncoefficient = []\n"),
        ("box_alpha_too_few", "[trajectory.box]\nalpha = [1e-4]\n"),
        ("task_is_no_table", "task = 3\n"),
        ("unknown_family", "[trajectory]\nfamily = 'spine'\n"),
        ("terms_of_a_spline", "[trajectory]\nfamily = 'spline'\nterms = 3\n"),
        (
            "coefficient_of_a_spline",
            "[trajectory]\nfamily = 'spline'\n[trajectory.box]\ncoefficient = [1]\n",
        ),
        (
            "alpha_of_a_spline",
            "[trajectory]\nfamily = 'spline'\n[trajectory.box]\nalpha = [1, 2]\n",
        ),
        ("pieces_without_spline", "[trajectory]\nfamily = 'sine-polynomial'\npieces = 20\n"),
        ("degree_without_spline", "[trajectory]\nfamily = 'sine-polynomial'\ndegree = 3\n"),
        ("too_few_pieces", "[trajectory]\nfamily = 'spline'\npieces = 3\n"),
        ("too_many_pieces", "[trajectory]\nfamily = 'spline'\npieces = 1001\n"),
        ("degree_too_low", "[trajectory]\nfamily = 'spline'\ndegree = 2\n"),
        ("degree_no_number", "[trajectory]\nfamily = 'spline'\ndegree = 'cubic'\n"),
    ] {
        rejects(&format!("task_{name}"), &["plan", "task.toml"], "task.toml", text);
    }
}

#[test]
fn robots() {
    for (name, text) in [
        ("missing_mass", robot("mass = 6.3\n", "")),
        ("missing_joints", "name = 'x'\n[base]\nmass = 1\nmount = [0, 0, 0]\ninertia = { xx = 1, yy = 1, zz = 1 }\n".to_owned()),
        ("no_joints", "joint = []\nname = 'x'\n[base]\nmass = 1\nmount = [0, 0, 0]\ninertia = { xx = 1, yy = 1, zz = 1 }\n".to_owned()),
        ("unknown_key", robot("mass = 6.3", "mas = 6.3")),
        ("mass_negative", robot("mass = 6.9", "mass = -6.9")),
        ("mass_zero", robot("mass = 600", "mass = 0")),
        ("mass_infinite", robot("mass = 11", "mass = inf")),
        ("inertia_indefinite", robot("zz = 0.01, yz", "zz = -0.01, yz")),
        ("inertia_incomplete", robot("zz = 0.015", "xz = 0")),
        ("range_reversed", robot("[-165, 165]", "[165, -165]")),
        ("range_empty", robot("[-165, 165]", "[10, 10]")),
        ("range_of_one", robot("[-165, 165]", "[165]")),
        ("centre_of_mass_short", robot("[0, 0, 0.065]", "[0, 0.065]")),
        ("centre_of_mass_not_a_number", robot("[0, 0, 0.065]", "[0, nan, 0.065]")),
        ("dh_incomplete", robot("d = 0.115, ", "")),
    ] {
        rejects(&format!("robot_{name}"), &["check", "robot.toml"], "robot.toml", text);
    }
}

/// A mistake far out on a long line is shown with what stands around it.
#[test]
fn long_lines_are_shown_in_part() {
    let many =
        |last: &str| format!("[task.start]\njoints_deg = [{}{last}]\n", "10, ".repeat(20_000));
    for (text, place) in [(many("x"), "2:80015"), (many("nan"), "2:80015")] {
        let folder = Folder::new().with("task.toml", text);
        let output = folder.run(&["plan", "task.toml"]);
        let told = stderr(&output);
        assert_eq!(output.status.code(), Some(2), "{told}");
        assert!(told.contains(place) && told.contains("10, 10,") && told.len() < 1000, "{told}");
    }
    let text = format!("[task]\n{} = 3\n", "x".repeat(35_000));
    let output = Folder::new().with("task.toml", text).run(&["plan", "task.toml"]);
    let told = stderr(&output);
    assert_eq!(output.status.code(), Some(2), "{told}");
    assert!(told.contains("2:1") && told.contains("robot") && told.len() < 2000, "{told}");
}

/// Motions and tables name joints.
#[test]
fn joints_with_one_name_are_refused() {
    let named = |first: &str, second: &str| {
        let robot = robot("[[joint]]", "[[joint]]");
        let parts: Vec<&str> = robot.split("[[joint]]").collect();
        format!(
            "{}[[joint]]\nname = '{first}'{}[[joint]]\nname = '{second}'{}",
            parts[0], parts[1], parts[2]
        )
    };
    for (name, text) in [("twice", named("elbow", "elbow")), ("blank", named("a", " "))] {
        rejects(&format!("joints_{name}"), &["check", "robot.toml"], "robot.toml", text);
    }
}

/// The paper's limits and attitudes are for its robot alone, also where another one has as many joints.
#[test]
fn another_robot_inherits_no_task() {
    let three = robot("[[joint]]", "[[joint]]");
    let three: Vec<&str> = three.split("[[joint]]").take(4).collect();
    let part = "[task]\nrobot = 'arm.toml'\n[task.start]\njoints_deg = [0, 0, 0]\nbase_zyx_deg = [0, 0, 0]\n\
        [task.limits]\njerk_deg_s3 = 9\n";
    for (name, robot, task) in [
        ("nothing", three.join("[[joint]]"), "[task]\nrobot = 'arm.toml'\n"),
        ("part", three.join("[[joint]]"), part),
        ("six_joints", robot("mass = 600", "mass = 400"), "[task]\nrobot = 'arm.toml'\n"),
    ] {
        let folder = Folder::new().with("arm.toml", robot).with("task.toml", task);
        let output = folder.run(&["plan", "task.toml"]);
        assert_eq!(output.status.code(), Some(2));
        insta::assert_snapshot!(format!("robot_states_{name}"), stderr(&output));
    }
}

/// A robot's mistake is shown in the robot's file, also when a task names it.
#[test]
fn robot_named_by_a_task() {
    let folder = Folder::new()
        .with("arm.toml", robot("mass = 6.3", "mass = -6.3"))
        .with("task.toml", "[task]\nrobot = 'arm.toml'\n");
    let output = folder.run(&["plan", "task.toml"]);
    assert_eq!(output.status.code(), Some(2));
    insta::assert_snapshot!("robot_named_by_a_task", stderr(&output));
}

#[cfg(feature = "harness")]
#[test]
fn experiments() {
    const FIELD: &str = "\n[[optimiser]]\nrandom = {}\n";
    for (name, text) in [
        ("without_name", FIELD.to_owned()),
        ("name_is_a_path", format!("name = '../x'{FIELD}")),
        ("no_field", "name = 'x'\noptimiser = []\n".to_owned()),
        ("without_field", "name = 'x'\n".to_owned()),
        ("unknown_optimiser", "name = 'x'\n[[optimiser]]\npos = {}\n".to_owned()),
        ("unknown_setting", "name = 'x'\n[[optimiser]]\npso = { poplation = 20 }\n".to_owned()),
        ("no_particles", "name = 'x'\n[[optimiser]]\npso = { population = 0 }\n".to_owned()),
        (
            "unknown_formulation",
            "name = 'x'\n[[optimiser]]\npso = { formulation = 'row' }\n".to_owned(),
        ),
        ("velocity_limit", "name = 'x'\n[[optimiser]]\npso = { velocity_limit = 2 }\n".to_owned()),
        ("no_seeds", format!("name = 'x'\nseeds = 0{FIELD}")),
        ("no_budget", format!("name = 'x'\nbudget = {{ evaluations = 0 }}{FIELD}")),
        ("budget_in_seconds", format!("name = 'x'\nbudget = {{ seconds = 3 }}{FIELD}")),
        ("sweep_unknown", format!("name = 'x'\n[sweep]\njerk = [20]{FIELD}")),
        ("sweep_weight", format!("name = 'x'\n[sweep]\nweight_base = [0.1, 1.1]{FIELD}")),
        ("sweep_terms", format!("name = 'x'\n[sweep]\nterms = [2, 99]{FIELD}")),
        ("optimiser_twice", format!("name = 'x'{FIELD}{FIELD}")),
        ("sweep_repeats", format!("name = 'x'\n[sweep]\nweight_base = [0.5, 0.5]{FIELD}")),
        (
            "population_huge",
            "name = 'x'\n[[optimiser]]\npso = { population = 1_000_000_000_000 }\n".to_owned(),
        ),
        ("too_few_vectors", "name = 'x'\n[[optimiser]]\nde = { population = 3 }\n".to_owned()),
        ("weight_not_a_number", "name = 'x'\n[[optimiser]]\nde = { weight = nan }\n".to_owned()),
        ("crossover_negative", "name = 'x'\n[[optimiser]]\nde = { crossover = -0.1 }\n".to_owned()),
        ("no_memory", "name = 'x'\n[[optimiser]]\nl-shade = { memory = 0 }\n".to_owned()),
        ("archive_negative", "name = 'x'\n[[optimiser]]\nl-shade = { archive = -1 }\n".to_owned()),
        (
            "population_in_parts",
            "name = 'x'\n[[optimiser]]\nl-shade = { population = 40.5 }\n".to_owned(),
        ),
        ("simplex_flat", "name = 'x'\n[[optimiser]]\nnelder-mead = { simplex = 0 }\n".to_owned()),
        (
            "tolerance_infinite",
            "name = 'x'\n[[optimiser]]\nnelder-mead = { cost_tolerance = inf }\n".to_owned(),
        ),
        ("step_too_large", "name = 'x'\n[[optimiser]]\ncma-es = { step = 1.5 }\n".to_owned()),
        (
            "hybrid_of_scp",
            "name = 'x'\n[[optimiser]]\nhybrid = { search = { scp = {} } }\n".to_owned(),
        ),
        (
            "hybrid_of_another_formulation",
            "name = 'x'\n[[optimiser]]\nhybrid = { search = { pso = { formulation = 'raw' } } }\n"
                .to_owned(),
        ),
        ("hybrid_without_budget", "name = 'x'\n[[optimiser]]\nhybrid = { share = 0 }\n".to_owned()),
        ("radius_of_nothing", "name = 'x'\n[[optimiser]]\nscp = { radius = 0 }\n".to_owned()),
        ("no_growth", "name = 'x'\n[[optimiser]]\ncma-es = { growth = 0 }\n".to_owned()),
        ("target_not_a_number", format!("name = 'x'\ntargets = [nan]{FIELD}")),
        ("targets_no_list", format!("name = 'x'\ntargets = 0.9{FIELD}")),
        (
            "targets_of_no_instance",
            format!("name = 'x'\ntargets = {{ 'terms=4' = [1] }}\n[sweep]\nterms = [2, 3]{FIELD}"),
        ),
    ] {
        rejects(
            &format!("experiment_{name}"),
            &["run", "experiment.toml"],
            "experiment.toml",
            text,
        );
    }
}

#[cfg(feature = "harness")]
#[test]
fn sweeps_on_the_way() {
    let cone = "base_cone = { axis = [1, 0, 0], from = [1, 0, 0], within_deg = 80 }\n";
    for (name, limits, sweep) in [
        ("cone_without_one", "", "base_cone_deg = [20, 30]"),
        ("cone_too_wide", cone, "base_cone_deg = [20, 180]"),
        ("cone_too_narrow", cone, "base_cone_deg = [80, 2]"),
        ("clearance_negative", "", "clearance_m = [0, -0.1]"),
        ("turn_from_the_start", "base_turn_from = 'start'\n", "base_turn_deg = [20, 5]"),
    ] {
        let text = format!(
            "name = 'x'\n[task.limits]\n{limits}[sweep]\n{sweep}\n[[optimiser]]\nrandom = {{}}\n"
        );
        rejects(&format!("sweep_{name}"), &["check", "experiment.toml"], "experiment.toml", text);
    }
}

#[cfg(feature = "harness")]
#[test]
fn sweeps() {
    let swept = |sweep: &str| format!("name = 'x'\n[[optimiser]]\npso = {{}}\nsweep = {sweep}\n");
    let instances =
        |sweep: &str| format!("name = 'x'\n[sweep]\n{sweep}\n[[optimiser]]\nrandom = {{}}\n");
    let field = |tables: &str| format!("name = 'x'\n{tables}\n");
    for (name, text) in [
        ("poses_of_two_kinds", instances("pose = [{}]\nrandom_poses = {}")),
        ("pose_unknown_key", instances("pose = [{ strat = { base_zyx_deg = [0, 0, 0] } }]")),
        (
            "pose_out_of_range",
            instances("pose = [{}, { goal = { joints_deg = [40, 60, 90, -10, -30, 160] } }]"),
        ),
        ("pose_too_few_joints", instances("pose = [{ start.joints_deg = [40, 60, 90] }]")),
        ("poses_without_turn", instances("random_poses = { turn_deg = 0 }")),
        ("poses_none", instances("random_poses = { count = 0 }")),
        ("no_budget", instances("budget = [1000, 0]")),
        ("pieces_without_spline", instances("pieces = [10, 20]")),
        ("terms_without_sine", instances("family = ['spline']\nterms = [2]")),
        ("pieces_too_few", instances("family = ['spline']\npieces = [10, 2]")),
        ("families_none", instances("family = []")),
        (
            "key_of_no_family",
            instances("family = ['sine-polynomial']")
                .replace("[sweep]", "[trajectory]\ndegree = 3\n[sweep]"),
        ),
        (
            "spline_in_powers_of_time",
            field("[trajectory]\nfamily = 'spline'\n[[optimiser]]\npso = { formulation = 'raw' }"),
        ),
        ("robot_unknown", instances("robot = ['xiao2023', 'nowhere.toml']")),
        ("task_unknown", instances("task = ['nowhere.toml']")),
        ("task_without_task", instances("task = ['experiment.toml']")),
        ("robots_and_tasks", instances("task = ['a.toml']\nrobot = ['xiao2023']")),
        (
            "tasks_of_two_kinds",
            instances("task = ['a.toml']")
                .replace("[sweep]", "[task.weights]\nbase = 0.5\n[sweep]"),
        ),
        ("setting_unknown", swept("{ poplation = [50, 100] }")),
        ("setting_out_of_range", swept("{ population = [50, 0] }")),
        ("setting_of_wrong_type", swept("{ formulation = ['raw', 3] }")),
        ("setting_no_list", swept("{ population = 50 }")),
        ("setting_empty", swept("{ population = [] }")),
        ("settings_no_table", swept("[50, 100]")),
        (
            "setting_beside",
            field("[[optimiser]]\npso = { social = 1 }\nsweep = { social = [1, 2] }"),
        ),
        ("unknown_beside", field("[[optimiser]]\npso = {}\nseed = 5")),
        ("two_in_one", field("[[optimiser]]\npso = {}\nrandom = {}")),
        ("no_optimiser", field("[[optimiser]]\nseeds = 5")),
        ("no_own_seeds", field("[[optimiser]]\npso = {}\nseeds = 0")),
        (
            "labels_alike",
            field(
                "[[optimiser]]\npso = { formulation = 'raw' }\nlabel = 'a'\n\
                 [[optimiser]]\npso = { formulation = 'scaled' }\nlabel = 'a'",
            ),
        ),
        (
            "budgets_of_two_kinds",
            field("sweep = { budget = [10, 20] }\n[[optimiser]]\npso = {}\nbudget.evaluations = 5"),
        ),
    ] {
        let args = ["run", "experiment.toml"];
        rejects(&format!("sweep_{name}"), &args, "experiment.toml", text);
    }
}

#[cfg(feature = "harness")]
#[test]
fn experiments_on_functions() {
    const FIELD: &str = "\n[[optimiser]]\nrandom = {}\n";
    let on = |table: &str| format!("name = 'x'\n[functions]\n{table}{FIELD}");
    let sphere = on("name = ['sphere']");
    for (name, text) in [
        ("and_task", format!("{sphere}[task.weights]\nbase = 0.5\n")),
        ("and_trajectory", format!("{sphere}[trajectory]\nterms = 2\n")),
        ("and_sweep", format!("{sphere}[sweep]\nterms = [2]\n")),
        ("without_names", on("dimension = [3]")),
        ("no_names", on("name = []")),
        ("unknown", on("name = ['spere']")),
        ("twice", on("name = ['sphere', 'sphere']")),
        ("no_dimensions", on("name = ['sphere']\ndimension = []")),
        ("one_dimension", on("name = ['sphere']\ndimension = [10, 1]")),
        ("dimension_no_list", on("name = ['sphere']\ndimension = 10")),
        ("no_instances", on("name = ['sphere']\ninstances = 0")),
        ("unknown_key", on("name = ['sphere']\ninstance = 1")),
        ("no_table", format!("name = 'x'\nfunctions = 'sphere'{FIELD}")),
        ("without_derivatives", format!("{sphere}[[optimiser]]\nscp = {{}}\n")),
        ("formulation", format!("{sphere}[[optimiser]]\npso = {{ formulation = 'raw' }}\n")),
    ] {
        let args = ["run", "experiment.toml"];
        rejects(&format!("functions_{name}"), &args, "experiment.toml", text);
    }
}

#[test]
fn motions() {
    let six = "[0, 0, 0, 0, 0, 0]";
    for (name, text) in [
        ("too_few", format!("[motion]\nt_f = 6\nalpha6 = [0, 0]\nalpha7 = {six}\n")),
        ("half", format!("[motion]\nt_f = 6\nalpha6 = {six}\n")),
        (
            "both",
            format!("[motion]\nt_f = 6\nalpha6 = {six}\nalpha7 = {six}\ncoefficients = [[1]]\n"),
        ),
        (
            "ragged",
            "[motion]\nt_f = 6\ncoefficients = [[1], [1], [1, 2], [1], [1], [1]]\n".to_owned(),
        ),
        ("no_time", format!("[motion]\nt_f = 0\nalpha6 = {six}\nalpha7 = {six}\n")),
        ("too_long", format!("[motion]\nt_f = 1e10\nalpha6 = {six}\nalpha7 = {six}\n")),
        ("missing", "[task.weights]\nbase = 0.5\n".to_owned()),
        (
            "spline_in_powers",
            format!(
                "[trajectory]\nfamily = 'spline'\n[motion]\nt_f = 6\nalpha6 = {six}\nalpha7 = {six}\n"
            ),
        ),
        (
            "spline_of_another_size",
            format!(
                "[trajectory]\nfamily = 'spline'\npieces = 10\n[motion]\nt_f = 6\ncoefficients = [{0}, {0}, {0}, {0}, {0}, {0}]\n",
                "[1, 2]"
            ),
        ),
    ] {
        rejects(&format!("motion_{name}"), &["replay", "motion.toml"], "motion.toml", text);
    }
}

#[test]
fn arguments() {
    for (name, args) in [
        ("no_such_file", &["plan", "nowhere.toml"][..]),
        ("unknown_verb", &["pln"]),
        ("unknown_optimiser", &["plan", "--optimiser", "psoo"]),
        ("seed_not_a_number", &["plan", "--seed", "first"]),
        ("motion_format", &["plan", "--motion", "motion.xlsx"]),
        ("no_budget", &["plan", "--budget", "0"]),
        ("check_without_file", &["check"]),
    ] {
        rejects(&format!("argument_{name}"), args, "unused", "");
    }
    #[cfg(feature = "harness")]
    for (name, args) in [
        ("no_verb", &[][..]),
        ("shard_too_large", &["run", "--shard", "4/4"][..]),
        ("shard_not_a_fraction", &["run", "--shard", "half"]),
        ("shard_is_a_file", &["run", "--shard", "experiment.toml"]),
        ("shard_of_none", &["run", "--shard", "/0"]),
        ("shard_unscheduled", &["run", "--shard"]),
        ("no_seeds", &["run", "--seeds", "0"]),
        ("no_jobs", &["run", "--jobs", "0"]),
    ] {
        rejects(&format!("argument_{name}"), args, "unused", "");
    }
    rejects("argument_not_text", &["check", "file.toml"], "file.toml", [0xff, 0xfe, 0x00]);
}
