#!/usr/bin/env bash
# Races this crate's optimisers against their peers in Python on the same functions; prints a table.
# Needs Python 3.11 or later and half an hour of one core.
# shellcheck source=benches/peers/environment.sh
. "$(dirname "$0")/../environment.sh"
cargo run --release --quiet --example peers_race > "$folder/ours.json"
"$python" "$here/peers.py" "$here/race.json" "$folder/ours.json"
