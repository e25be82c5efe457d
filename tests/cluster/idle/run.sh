#!/usr/bin/env bash
# How much of the workers' time is idle with few shards and with many, on GNU parallel: a line per number of shards.
#   run.sh computing.toml 2 16 64       with one shard for each of 2 workers, with 16 and with 64
#   run.sh waiting.toml 8 32 128
# Idle is what remains of workers × time from the first start to the last end without the time of tasks, as GNU parallel logs them.
# What others do on the machine changes both, and the share little.
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
experiment=$1 workers=$2
program=${PROGRAM:-$here/../../../target/release/driftless}
results=$(mktemp -d)
trap 'rm -rf "$results"' EXIT
for shards in "${@:2}"; do
    "$program" submit "$here/$experiment" --to parallel --workers "$workers" --shards "$shards" --out "$results/$shards" --go \
        > "$results/log" 2>&1 || { cat "$results/log" >&2; exit 1; }
    awk -F '\t' -v workers="$workers" -v shards="$shards" '
        NR > 1 {
            if (NR == 2 || $3 < first) first = $3
            if ($3 + $4 > last) last = $3 + $4
            busy += $4
        }
        END { printf "%d shards on %d workers: %.1f s, idle %.0f %%\n", shards, workers, last - first, 100 * (1 - busy / workers / (last - first)) }
    ' "$results/$shards/logs/parallel.tsv"
done
