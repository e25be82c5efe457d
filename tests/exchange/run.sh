#!/usr/bin/env bash
# Runs small experiments, exports them in both formats and has them read by the tools whose formats they are;
# compares what these say with the stored tables, also of two experiments together, and reads the exports back. Needs Python 3.11 or later and PyPI.
#   ./run.sh            builds the program and takes a minute
#   PROGRAM=… ./run.sh  takes a program that is built already
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/exchange
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
export PYTHONDONTWRITEBYTECODE=1 MPLBACKEND=Agg
[ -n "${PROGRAM:-}" ] || cargo build --release --locked
program=${PROGRAM:-$target/release/driftless}
results=$folder/results
rm -rf "$results"
for experiment in "$here"/experiments/*.toml; do
    name=$(basename "$experiment" .toml)
    "$program" run "$experiment" --out "$results/$name/stored" > /dev/null 2>&1
    "$program" report "$results/$name/stored" > /dev/null 2>&1
    for format in ioh coco; do
        "$program" export "$results/$name/stored" --format $format --out "$results/$name/$format" > /dev/null
    done
done
"$python" "$here/compare.py" "$results"

# Two experiments' exports in one folder, and what `import` makes of it beside both.
together=$folder/together
rm -rf "$together"
ours=("$results/functions/stored" "$results/others/stored")
"$program" report "${ours[@]}" --out "$together/ours" > /dev/null 2>&1
for format in ioh coco; do
    mkdir -p "$together/$format"
    for name in functions others; do
        cp -r "$results/$name/$format" "$together/$format/$name"
    done
    "$program" import --format $format "$together/$format" --out "$together/from-$format" > /dev/null 2>&1
done
"$program" report "${ours[@]}" "$together/from-ioh" "$together/from-coco" --out "$together/all" > /dev/null 2>&1
"$python" "$here/together.py" "$together"
