#!/usr/bin/env bash
# Races this crate's optimisers against their peers in Python on the same functions; prints a table.
# Needs Python 3.11 or later and half an hour of one core.
set -euo pipefail
cd "$(dirname "$0")/../../.."
here=benches/peers/optimisers
peers=${CARGO_TARGET_DIR:-target}/peers/optimisers
[ -x "$peers/bin/python" ] || python3 -m venv "$peers"
"$peers/bin/pip" install --quiet --requirement "$here/requirements.txt"
cargo run --release --quiet --example race > "$peers/ours.json"
"$peers/bin/python" "$here/peers.py" "$here/race.json" "$peers/ours.json"
