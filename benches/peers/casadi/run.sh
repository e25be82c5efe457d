#!/usr/bin/env bash
# Compares `scp` with CasADi and IPOPT: ./run.sh [STARTS], or of free-form motions ./run.sh --free-form [STARTS
# [PIECES …]]. Needs Python 3.11 or later, gcc and PyPI. All run on one core, CPU=1 unless set otherwise, with one
# thread each.
# shellcheck source=benches/peers/environment.sh
. "$(dirname "$0")/../environment.sh"
comparison=compare.py
if [ "${1-}" = --free-form ]; then
    comparison=compare_free_form.py
    shift
fi
cargo build --release --locked -p driftless --no-default-features --example peers_starts
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
taskset -c "${CPU:-1}" "$python" "$here/$comparison" "$target/release/examples/peers_starts" "$folder" "$@"
