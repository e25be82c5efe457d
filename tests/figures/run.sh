#!/usr/bin/env bash
# Draws small experiments and has every figure read by tools that others wrote: PDF by qpdf and pypdf, SVG as XML,
# PNG by Pillow. Needs Python 3.11 or later and PyPI.
#   ./run.sh            builds the program
#   PROGRAM=… ./run.sh  takes a program that is built already
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/figures
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
[ -n "${PROGRAM:-}" ] || cargo build --release --locked
program=${PROGRAM:-$target/release/driftless}
rm -rf "$folder/results"
while read -r name seeds budget; do
    "$program" run "experiments/$name.toml" --out "$folder/results/$name" --seeds "$seeds" --budget "$budget" \
        > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
done << 'EXPERIMENTS'
default 5 1000
convergence 3 300
functions 5 1000
weight-sweep 2 500
jerk-sweep 2 500
terms-sweep 2 500
EXPERIMENTS
"$python" "$here/test_figures.py" "$folder/results"
