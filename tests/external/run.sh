#!/usr/bin/env bash
# Installs the packages that the solvers of docs/solvers need, and runs the tests that need them. Octave is installed where it is
# missing and that is allowed: on Debian, as root. Needs Python 3.11 or later and PyPI.
set -euo pipefail
cd "$(dirname "$0")/../.."
folder=${CARGO_TARGET_DIR:-target}/external
[ -x "$folder/venv/bin/python3" ] || python3 -m venv "$folder/venv"
"$folder/venv/bin/python3" -m pip install --quiet --disable-pip-version-check -r tests/external/requirements.txt
if ! command -v octave-cli > /dev/null && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    apt-get update > /dev/null &&
        DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends octave octave-instrument-control > /dev/null ||
        echo "skipped: Octave cannot be installed"
fi
# One thread per process: what runs beside each other is enough.
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1
PATH=$(cd "$folder/venv/bin" && pwd):$PATH
export PATH
cargo build --release --locked --examples
cargo test --release --locked --test external -- --include-ignored packages solvers_to_start_from
