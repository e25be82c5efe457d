#!/usr/bin/env bash
# Starts a Slurm of one node on this machine, without systemd, runs the test in main.rs on it and stops it.
# `--install` installs Slurm first where it can: on Debian, as root.
set -euo pipefail
cd "$(dirname "$0")/../.."
PATH=$PATH:/usr/sbin:/sbin

if [ "${1-}" = --install ] && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    apt-get update
    DEBIAN_FRONTEND=noninteractive \
        apt-get install --yes --no-install-recommends slurmctld slurmd slurm-client munge
fi
for program in munged slurmctld slurmd sbatch; do
    if ! command -v "$program" > /dev/null; then
        echo "skipped: Slurm is not installed ($program is missing); tests/cluster/run.sh --install does it"
        exit 0
    fi
done
cargo test --release --test cluster --no-run

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
    timeout 10 scancel --user="$(id -un)" || true
    # Jobs have sessions of their own.
    for _ in {1..50}; do
        [ -n "$(timeout 10 squeue --noheader)" ] || break
        sleep 0.2
    done
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

chmod 755 "$folder"
mkdir "$folder/state" "$folder/spool"
export SLURM_CONF=$folder/slurm.conf
sed -e "s|@FOLDER@|$folder|; s|@HOST@|$(hostname -s)|; s|@USER@|$(id -un)|" \
    -e "s|@CONTROL_PORT@|$(free_port)|; s|@NODE_PORT@|$(free_port)|" tests/cluster/slurm.conf > "$SLURM_CONF"
(umask 077 && head -c 1024 /dev/urandom > "$folder/munge.key")
start munged.out munged --foreground --key-file="$folder/munge.key" --socket="$folder/munge.socket" \
    --pid-file="$folder/munged.pid" --log-file="$folder/munged.log" --seed-file="$folder/munged.seed"
until [ -S "$folder/munge.socket" ]; do
    kill -0 "${started[0]}" || { cat "$folder"/munged.*; exit 1; }
    sleep 0.1
done
start slurmctld.out slurmctld -D
start slurmd.out slurmd -D -N node
for second in {1..60}; do
    [ "$(timeout 10 sinfo --noheader --format=%t 2> /dev/null)" != idle ] || break
    [ "$second" -lt 60 ] || { cat "$folder"/slurm*.out; exit 1; }
    sleep 1
done

# In a group of its own and waited for, so that Ctrl-C ends all in order; what it stores goes with the rest.
TMPDIR=$folder setsid cargo test --release --test cluster -- --ignored --nocapture &
started+=($!)
wait $!
