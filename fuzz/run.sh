#!/usr/bin/env bash
# Fuzzes the readers of files and, against an integrator of its own, the planner. Needs a Rust toolchain, a C++ compiler and
# crates.io.
#   fuzz/run.sh             two minutes per target
#   fuzz/run.sh 3600        an hour per target
#   fuzz/run.sh 600 stored  some targets
# As many targets run at a time as there are processors, from a seed that is always the same. What one finds stands in
# fuzz/artifacts/TARGET.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:-120}
shift || true
targets=("$@")
[ $# -gt 0 ] || targets=(robot task replay trajectory experiment stored import integrator)
if ! command -v c++ > /dev/null; then
    echo "fuzzing is skipped: there is no C++ compiler"
    exit 0
fi
export built=${CARGO_TARGET_DIR:-$PWD/../target}
# With the Python package, which has no binary, dependencies are those that the command and the tests are built with.
RUSTC_WORKSPACE_WRAPPER=$PWD/instrument cargo build --release --locked --bins \
    --package driftless-fuzz --package driftless-python --target-dir "$built"
one() {
    # New inputs go into a folder of their own; those in corpus/ are kept by hand.
    local target=$1 seconds=$2 work=$built/fuzz/$1
    mkdir -p "$work" "artifacts/$target"
    local outcome=0
    "$built/release/$target" "$work" "corpus/$target" -artifact_prefix="artifacts/$target/" -seed=1 \
        -max_total_time="$seconds" -dict=toml.dict -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 > "$work.log" 2>&1 ||
        outcome=1
    echo "-- $target, $seconds s"
    grep -E "ERROR|panicked|instead of|Test unit|DONE|^stat::number_of_executed" "$work.log" || tail -5 "$work.log"
    return "$outcome"
}
export -f one
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c "one {} $seconds"
