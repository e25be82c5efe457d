# shellcheck shell=bash disable=SC2034
# What the scripts in the folders beside this file share; each sources it first. It goes to the crate's root
# and makes a Python environment with the folder's own requirements.
#   here    the folder of the script      target  where cargo builds
#   folder  where all goes that it makes  python  the environment's Python
set -euo pipefail
here=$(cd "$(dirname "$0")" && pwd)
cd "$here/../../.."
target=${CARGO_TARGET_DIR:-target}
folder=$target/peers/$(basename "$here")
python=$folder/venv/bin/python
[ -x "$python" ] || python3 -m venv "$folder/venv"
"$python" -m pip install --quiet --disable-pip-version-check -r "$here/requirements.txt"
export PYTHONDONTWRITEBYTECODE=1
