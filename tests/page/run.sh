#!/usr/bin/env bash
# Runs small versions of all experiments and one on another robot, makes their pages and opens each from the disk in a browser without a
# window: everything that a reader can click is clicked, and what it shows is compared with the tables' files.
# Needs Python 3.11 or later, PyPI and Chromium, which it installs where it may.
#   ./run.sh            builds the program
#   PROGRAM=… ./run.sh  takes a program that is built already
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/page
python=$folder/venv/bin/python
if ! command -v chromium > /dev/null && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    (apt-get update -qq && apt-get install -qq -y --no-install-recommends chromium fonts-dejavu-core) > /dev/null || true
fi
if ! command -v chromium > /dev/null; then
    echo "skipped: Chromium is not here and cannot be installed"
    exit
fi
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
# Rules of accessibility, where npm can fetch them.
axe=4.10.3
if [ ! -e "$folder/axe-$axe/package/axe.min.js" ] && command -v npm > /dev/null; then
    mkdir -p "$folder/axe-$axe"
    (cd "$folder/axe-$axe" && npm pack --silent "axe-core@$axe" && tar xzf "axe-core-$axe.tgz") > /dev/null \
        || rm -rf "$folder/axe-$axe"
fi
[ -n "${PROGRAM:-}" ] || cargo build --release --locked
program=${PROGRAM:-$target/release/driftless}
results=$folder/results
rm -rf "$results" "$folder"/*.png
# Seeds and evaluations per run.
while read -r experiment seeds budget; do
    name=$(basename "$experiment")
    "$program" run "$experiment.toml" --out "$results/$name" --seeds "$seeds" --budget "$budget" \
        > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
    "$program" report "$results/$name" > "$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
    cp "$results/$name/report.html" "$folder/before.html"
    "$program" report "$results/$name" > /dev/null 2>&1
    cmp "$results/$name/report.html" "$folder/before.html"
done << 'EXPERIMENTS'
experiments/default 5 2000
experiments/paper 2 4000
experiments/functions 5 2000
experiments/weight-sweep 2 1000
experiments/jerk-sweep 2 1000
experiments/terms-sweep 2 1000
experiments/poses 3 500
experiments/convergence 3 500
tests/page/three-joints 3 1000
EXPERIMENTS
PYTHONDONTWRITEBYTECODE=1 "$python" "$here/test_page.py" "$results" "$folder" "$folder/axe-$axe/package/axe.min.js"
