#!/usr/bin/env bash
# Compares `scp` with CasADi and IPOPT: ./run.sh [STARTS]. Needs Python 3.11 or later, gcc and PyPI.
# Both run on one core, CPU=1 unless set otherwise, with one thread each.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/peers/casadi
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
cargo build --release --locked --no-default-features --example starts
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1 PYTHONDONTWRITEBYTECODE=1
taskset -c "${CPU:-1}" "$python" "$here/compare.py" "$target/release/examples/starts" "$folder" "${1:-100}"
