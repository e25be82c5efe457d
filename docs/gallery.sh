#!/bin/sh
# Runs the experiments of the gallery, and copies their pictures and a picture of the page to docs/gallery.
# Needs `driftless` on the path; the picture of the page needs Python 3.11 and Chromium, too.
#
#   docs/gallery.sh [RESULTS]    # folder of the results; what is there is not run again
set -eu
cd "$(dirname "$0")/.."
results=${1:-results}

for experiment in default functions convergence poses jerk-sweep weight-sweep terms-sweep; do
    driftless run "experiments/$experiment.toml" --out "$results/$experiment" --quiet
done
