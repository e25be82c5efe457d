#!/bin/sh
# Runs the experiments of the gallery and of docs/free-form.md, and copies their pictures, a picture of the page and one of every robot
# to docs/gallery. Needs `driftless` on the path; the last two need Python 3.11 or later, PyPI and Chromium, too.
#   docs/gallery.sh [RESULTS]    # folder of the results; what is stored there is not run again
set -eu
cd "$(dirname "$0")/.."
results=${1:-results}
gallery=docs/gallery

for experiment in default functions poses free-form jerk-sweep weight-sweep terms-sweep \
    pieces valleys reach; do
    driftless run "experiments/$experiment.toml" --out "$results/$experiment" --quiet
done
driftless run "$gallery/robots.toml" --out "$results/shipped-robots" --quiet

# SVG where it is small enough for a repository.
for picture in \
    poses/convergence.svg poses/final-costs.svg \
    poses/running-time-distribution.svg poses/expected-running-time.svg \
    functions/performance-profiles.svg functions/data-profiles.svg \
    poses/critical-difference.svg functions/effect-sizes.svg free-form/dimensions.svg pieces/pieces-sweep.svg \
    jerk-sweep/jerk-sweep.svg weight-sweep/weight-sweep.svg terms-sweep/terms-sweep.svg weight-sweep/pareto.svg \
    default/snapshots.svg default/joint-angles.svg default/joint-derivatives.png default/base-attitude.svg; do
    cp "$results/${picture%/*}/figures/${picture#*/}" "$gallery"
done

cp "$results/valleys/figures/final-costs.png" "$gallery/valleys.png"
cp "$results/reach/figures/final-costs.png" "$gallery/reach.png"

venv=target/gallery/venv
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r tests/page/requirements.txt pillow==13.0.0
export PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=tests/page
"$venv/bin/python" "$gallery/page.py" "$results/default/report.html" "$gallery/page.png"
"$venv/bin/python" "$gallery/page.py" "$results/shipped-robots/report.html" "$gallery/robots"
