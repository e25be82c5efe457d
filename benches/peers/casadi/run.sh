#!/usr/bin/env bash
# Compares `scp` with CasADi and IPOPT: ./run.sh [STARTS]. Needs Python 3.11 or later, gcc and PyPI.
# Both run on one core, CPU=1 unless set otherwise, with one thread each.
. "$(dirname "$0")/../environment.sh"
cargo build --release --locked --no-default-features --example peers_starts
export OMP_NUM_THREADS=1 OPENBLAS_NUM_THREADS=1
taskset -c "${CPU:-1}" "$python" "$here/compare.py" "$target/release/examples/peers_starts" "$folder" "${1:-100}"
