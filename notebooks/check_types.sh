#!/usr/bin/env bash
# Checks the types of `your-own-optimiser.ipynb`, as one file, with mypy and pyright, both strict. matplotlib's types
# are too loose for a strict pyright, so only mypy checks the modules beside it.
#   notebooks/check_types.sh [VENV]    an environment with the package; without it, the one that run.sh makes
# Needs PyPI: mypy and pyright are installed into the environment.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

folder=${CARGO_TARGET_DIR:-target}/notebooks
venv=$(cd "${1:-$folder/venv}" && pwd)
"$venv/bin/pip" install --quiet --disable-pip-version-check -r notebooks/requirements-types.txt

mkdir -p "$folder/types"
folder=$(cd "$folder/types" && pwd)
"$venv/bin/python" -m nbconvert --log-level WARN --to script --output-dir "$folder" notebooks/your-own-optimiser.ipynb
cp notebooks/*.py "$folder"
cat > "$folder/pyrightconfig.json" << END
{ "include": ["your-own-optimiser.py"], "typeCheckingMode": "strict" }
END
cd "$folder"
"$venv/bin/python" -m mypy --strict --python-executable "$venv/bin/python" ./*.py
"$venv/bin/python" -m pyright --pythonpath "$venv/bin/python"
