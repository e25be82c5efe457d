#!/usr/bin/env bash
# Checks the statistics against SciPy, statsmodels, scikit-posthocs, optimagic and cocopp: makes a Python
# environment, works the expected values out again, fails if they are not those of expected.json, then runs
# the Rust tests on that file. `run.sh --renew` writes the file anew first. Needs Python 3.11 or later and PyPI.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
venv=${CARGO_TARGET_DIR:-target}/statistics/venv
[ -x "$venv/bin/python" ] || python3 -m venv "$venv"
"$venv/bin/python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
PYTHONDONTWRITEBYTECODE=1 "$venv/bin/python" "$here/make_expected.py" "$@"
cargo test --release --locked --test statistics
