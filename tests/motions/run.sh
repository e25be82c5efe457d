#!/usr/bin/env bash
# Plans motions of four robots, writes them in every format, and has them read by the tools whose formats they are: numpy, SciPy's reader
# of MAT-files, PyYAML, ROS 2's message types (rosbags), MuJoCo. Compares their numbers with each other, torques and the base with what MuJoCo makes of the joints, and
# runs the player for MuJoCo; reads MAT-files with Octave where that is installed. Needs Python 3.11 or later and PyPI.
#   ./run.sh               builds the program
#   PROGRAM=… ./run.sh     takes a program that is built already
#   ./run.sh TASK.toml …   takes these tasks instead
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
tasks=()
for task in "$@"; do
    if [ -e "$task" ]; then tasks+=("$(realpath "$task")"); else tasks+=("$task"); fi
done
[ ${#tasks[@]} -gt 0 ] || tasks=("$here/tasks/gantry.toml" dual_arm xiao2023 panda canadarm2)
cd "$here/../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/motions
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
export PYTHONDONTWRITEBYTECODE=1
[ -n "${PROGRAM:-}" ] || cargo build --release --locked
program=$(realpath "${PROGRAM:-$target/release/driftless}")
rm -rf "$folder/files"
"$python" "$here/check.py" "$program" "$folder/files" "${tasks[@]}"
