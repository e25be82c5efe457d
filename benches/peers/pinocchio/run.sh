#!/usr/bin/env bash
# Compares the base's rollout with one in C++ on Pinocchio: ./run.sh [ROUNDS]. Needs Python 3.11 or
# later, g++ and PyPI. All run on one core, CPU=1 unless set otherwise, with one thread each.
# shellcheck source=benches/peers/environment.sh
. "$(dirname "$0")/../environment.sh"
include=$("$python" -c 'import sysconfig; print(sysconfig.get_path("purelib"))')/cmeel.prefix/include
# Headers alone: what the library has compiled is not compiled for this processor. The definitions are
# those that Pinocchio's own build files ask for; warnings are about its headers.
compile() {
    local program=$1
    shift
    [ "$program" -nt "$here/rollout.cpp" ] || g++ -std=c++17 -O3 -march=native -DNDEBUG -w "$@" \
        -DBOOST_MPL_LIMIT_LIST_SIZE=30 -DBOOST_MPL_LIMIT_VECTOR_SIZE=30 \
        -DBOOST_MPL_CFG_NO_PREPROCESSED_HEADERS -DBOOST_FUSION_INVOKE_MAX_ARITY=12 \
        -isystem "$include" -isystem "$include/eigen3" "$here/rollout.cpp" -o "$program"
}
compile "$folder/rollout"
compile "$folder/rollout-fast-math" -ffast-math -DEIGEN_DONT_VECTORIZE
cargo build --release --locked -p driftless --no-default-features --example peers_rollout
ours=$target/release/examples/peers_rollout
taskset -c "${CPU:-1}" "$python" "$here/compare.py" "$ours" "$folder" "${1:-30}"
