#!/usr/bin/env bash
# Runs an experiment on HyperQueue, GNU parallel and Slurm, all on this machine, by the tests in this folder. A scheduler that is
# not there is skipped. HyperQueue comes from PyPI, into `target/cluster`; `--install` installs the others first where it can:
# on Debian, as root.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../.."
target=${CARGO_TARGET_DIR:-$PWD/target}
PATH=$PATH:/usr/sbin:/sbin

if [ "${1-}" = --install ] && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    apt-get update
    DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes --no-install-recommends slurmctld slurmd slurm-client munge parallel
fi
# Every scheduler is a module of the tests.
tests=()
skip() {
    echo "skipped: $1"
}
python=$target/cluster/venv/bin/python
mkdir -p "$target/cluster"
if { [ -x "$python" ] || python3 -m venv "$target/cluster/venv"; } &&
    "$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"; then
    tests+=(hyperqueue::)
else
    skip "HyperQueue, which Python and PyPI are needed for"
fi
if parallel --version 2> /dev/null | grep --quiet "^GNU parallel"; then
    tests+=(parallel::)
else
    skip "GNU parallel, which is not installed; tests/cluster/run.sh --install does it"
fi
slurm=slurm::
for program in munged slurmctld slurmd sbatch; do
    if ! command -v "$program" > /dev/null; then
        skip "Slurm, which is not installed ($program is missing); tests/cluster/run.sh --install does it"
        slurm=
        break
    fi
done
[ -z "$slurm" ] || tests+=("$slurm")
[ "${#tests[@]}" -gt 0 ] || exit 0
cargo test --release --locked --test cluster --no-run

folder=$(mktemp -d)
started=() # processes, each the leader of a group
start() {
    local log=$1
    shift
    setsid "$@" > "$folder/$log" 2>&1 &
    started+=($!)
}
stop() {
    trap - EXIT INT TERM
    if [ -n "${SLURM_CONF-}" ]; then
        timeout 10 scancel --user="$(id -un)" || true
        # Jobs have sessions of their own.
        for _ in {1..50}; do
            [ -n "$(timeout 10 squeue --noheader)" ] || break
            sleep 0.2
        done
    fi
    for process in "${started[@]}"; do
        kill -- "-$process" 2> /dev/null || true
    done
    wait
    rm -rf "$folder"
}
trap stop EXIT
trap 'exit 130' INT
trap 'exit 143' TERM

free_port() {
    local port
    while port=$(shuf -i 20000-30000 -n 1); (: > "/dev/tcp/127.0.0.1/$port") 2> /dev/null; do :; done
    echo "$port"
}

# A Slurm without systemd, of five nodes, all of them this machine; the last is started by the test.
start_slurm() {
    chmod 755 "$folder"
    mkdir "$folder/state"
    export SLURM_CONF=$folder/slurm.conf DRIFTLESS_SLURM=$folder
    sed -e "s|@FOLDER@|$folder|; s|@HOST@|$(hostname -s)|; s|@USER@|$(id -un)|; s|@CONTROL_PORT@|$(free_port)|" \
        "$here/slurm.conf" > "$SLURM_CONF"
    local node
    for node in {0..4}; do
        mkdir "$folder/node$node"
        echo "NodeName=node$node NodeHostname=$(hostname -s) NodeAddr=127.0.0.1 Port=$(free_port) CPUs=1"
    done >> "$SLURM_CONF"
    (umask 077 && head -c 1024 /dev/urandom > "$folder/munge.key")
    start munged.out munged --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
        --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" --seed-file="$folder/munged.seed"
    until [ -S "$folder/munge.socket" ]; do
        kill -0 "${started[0]}" || { cat "$folder"/munged.*; exit 1; }
        sleep 0.1
    done
    start slurmctld.out slurmctld -D
    for node in {0..3}; do
        start "node$node.out" slurmd -D -N "node$node"
    done
    for second in {1..60}; do
        [ "$(timeout 10 sinfo --noheader --Node --format=%t 2> /dev/null | grep --count --line-regexp idle)" != 4 ] || break
        [ "$second" -lt 60 ] || { cat "$folder"/*.out; exit 1; }
        sleep 1
    done
}

[ -z "$slurm" ] || start_slurm
# What the tests call `hq`.
mkdir "$folder/bin"
printf '#!/bin/sh\nexec %q %q "$@"\n' "$python" "$here/hq.py" > "$folder/bin/hq"
chmod +x "$folder/bin/hq"
export PATH=$folder/bin:$PATH DRIFTLESS_HYPERQUEUE=$python PYTHONDONTWRITEBYTECODE=1

# In a group of its own and waited for, so that Ctrl-C ends all in order; what it stores goes with the rest.
TMPDIR=$folder setsid cargo test --release --locked --test cluster -- --ignored --nocapture --test-threads=3 "${tests[@]}" &
started+=($!)
wait $!
