#!/usr/bin/env bash
# Plans a motion for every robot that comes with the program and has two simulators that others wrote drive the robot
# along it: Pinocchio and MuJoCo. Fails where the base ends up elsewhere than planned by more than 0.001 degrees. Then
# holds limits on the way against what Pinocchio and Coal make of planned motions, goals of the tool against Pinocchio, motions
# with angular momentum against MuJoCo, and the program's reading of real URDF files against Pinocchio's. Needs Python 3.11 or later and PyPI.
#   ./run.sh --few         checks five limits instead of all, 2 goals of the tool per robot instead of 100, and 2 tasks with momentum
#   ./run.sh TASK.toml …   takes these tasks instead, and nothing of the rest
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
limits=("$here"/limits/*.toml)
poses=100
drifts=("$here"/drift/*.toml)
if [ "${1-}" = --few ]; then
    shift
    limits=()
    poses=2
    drifts=("$here/drift/xiao2023_tumbling.toml" "$here/drift/ur5e.toml")
    for name in base_rate tool_speed torque clearance_derived keep_out_inertial; do limits+=("$here/limits/$name.toml"); done
fi
tasks=()
for task in "$@"; do tasks+=("$(realpath "$task")"); done
cd "$here/../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/simulators
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
cargo build --release --locked --bin driftless --example base_twist
export PYTHONDONTWRITEBYTECODE=1
release=$(realpath "$target/release")
"$python" "$here/simulate.py" "$release/driftless" "${tasks[@]}"
[ ${#tasks[@]} -gt 0 ] || "$python" "$here/limits.py" "$release/driftless" "${limits[@]}"
[ ${#tasks[@]} -gt 0 ] || "$python" "$here/tool_goals.py" "$release/driftless" --poses $poses
[ ${#tasks[@]} -gt 0 ] || "$python" "$here/drift.py" "$release/driftless" "${drifts[@]}"
[ ${#tasks[@]} -gt 0 ] || "$python" "$here/urdfs.py" "$release/examples/base_twist"
