#!/usr/bin/env bash
# Builds the wheel, installs it into an environment of its own and tests it: pytest, mypy, pyright. Other versions of Python that
# are found, 3.10 to 3.13, install the same wheel and run the tests of problems, tasks and the package as such. Needs Rust, a C
# compiler, Python 3.10 or later and PyPI.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
mkdir -p "$target/python"
folder=$(cd "$target/python" && pwd)
python=${PYTHON:-python3}

quiet=(--quiet --disable-pip-version-check)
[ -x "$folder/venv/bin/python" ] || "$python" -m venv "$folder/venv"
rm -rf "$folder/wheels"
# Within the workspace's folder for builds, so that only what has changed is compiled.
CARGO_TARGET_DIR=$(cd "$target" && pwd) MATURIN_PEP517_ARGS=--locked \
    "$folder/venv/bin/python" -m pip wheel "${quiet[@]}" --no-deps --wheel-dir "$folder/wheels" ./python
wheel=$(echo "$folder"/wheels/driftless-*.whl)
"$folder/venv/bin/python" -m pip install "${quiet[@]}" --force-reinstall --no-deps "$wheel"
"$folder/venv/bin/python" -m pip install "${quiet[@]}" "${wheel}[test,nevergrad]"

# The command without Python, which results are compared with.
cargo build --release --locked
DRIFTLESS=$(cd "$target/release" && pwd)/driftless
export DRIFTLESS OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1 MPLBACKEND=agg

"$folder/venv/bin/pytest" --quiet python
(cd python && "$folder/venv/bin/mypy" --cache-dir "$folder/mypy" && "$folder/venv/bin/pyright" --pythonpath "$folder/venv/bin/python")

own=$("$folder/venv/bin/python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
for version in 3.10 3.11 3.12 3.13; do
    [ "$version" = "$own" ] && continue
    found=
    # What `command` finds may be a shim that starts nothing.
    for candidate in $(command -v "python$version") "${PYENV_ROOT:-$HOME/.pyenv}"/versions/"$version".*/bin/python3; do
        if "$candidate" -c 'import venv, ensurepip' > /dev/null 2>&1; then
            found=$candidate
            break
        fi
    done
    if [ -z "$found" ]; then
        echo "skipped: there is no Python $version"
        continue
    fi
    echo "-- Python $version"
    other=$folder/venv-$version
    [ -x "$other/bin/python" ] || "$found" -m venv "$other"
    "$other/bin/python" -m pip install "${quiet[@]}" --force-reinstall --no-deps "$wheel"
    "$other/bin/python" -m pip install "${quiet[@]}" "${wheel}[plot,pandas]" pytest
    "$other/bin/pytest" --quiet python/tests/test_{problems,tasks,package}.py
done
