#!/usr/bin/env bash
# Fuzzes the readers of files and, against an integrator of its own, the planner. Needs a Rust toolchain, a C++ compiler and
# crates.io.
#   fuzz/run.sh             two minutes for each of the planner's targets
#   fuzz/run.sh 3600        an hour each
#   fuzz/run.sh 600 stored  some targets; `experiment` and `stored` need the harness, whose build takes long
# As many targets run at a time as there are processors, from a seed that is always the same. What one finds stands in
# fuzz/artifacts/TARGET.
set -euo pipefail
cd "$(dirname "$0")"
seconds=${1:-120}
shift || true
targets=("$@")
[ $# -gt 0 ] || targets=(robot task replay integrator)
features=()
case " ${targets[*]} " in *" experiment "* | *" stored "*) features=(--features harness) ;; esac
if ! command -v c++ > /dev/null; then
    echo "fuzzing is skipped: there is no C++ compiler"
    exit 0
fi
# Instrumented builds stay apart from others.
unset CARGO_TARGET_DIR
tools=$PWD/target/tools
export PATH=$tools/bin:$PATH
command -v cargo-fuzz > /dev/null || cargo install --quiet --locked --debug --root "$tools" cargo-fuzz
cargo fuzz build --sanitizer none "${features[@]}"
one() {
    # New inputs go into a folder of their own; those in corpus/ are kept by hand.
    local target=$1 seconds=$2 found=target/corpus/$1 log=target/$1.log
    mkdir -p "$found" "artifacts/$target"
    "$(ls -d target/*/release/"$target")" "$found" "corpus/$target" -artifact_prefix="artifacts/$target/" \
        -seed=1 -max_total_time="$seconds" -dict=toml.dict -timeout=60 -rss_limit_mb=4096 -print_final_stats=1 > "$log" 2>&1 &&
        local outcome=0 || local outcome=1
    echo "-- $target, $seconds s"
    grep -E "ERROR|panicked|instead of|Test unit|DONE|^stat::number_of_executed" "$log" || tail -5 "$log"
    return $outcome
}
export -f one
printf '%s\n' "${targets[@]}" | xargs -P "$(nproc)" -I{} bash -c "one {} $seconds"
