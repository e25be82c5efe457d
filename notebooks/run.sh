#!/usr/bin/env bash
# Makes a Python environment with the package of this workspace and executes all notebooks in place; they run the
# experiments that they read. Needs Rust, a C compiler, Python 3.11 or later and PyPI.
#   notebooks/run.sh            writes the outputs into the notebooks
#   notebooks/run.sh --check    executes copies below target/, fails if one raises, and checks types
# What is stored in target/notebooks/results is not done again. DRIFTLESS_WHEEL names a wheel of the package to
# install instead of building one, which needs neither Rust nor a C compiler.
set -euo pipefail
wheel=${DRIFTLESS_WHEEL:+$(realpath "$DRIFTLESS_WHEEL")}
cd "$(dirname "${BASH_SOURCE[0]}")/.."

fail() {
    echo "notebooks/run.sh: $1" >&2
    exit "${2:-1}"
}

case "$*" in
    "" | --check) ;;
    -h | --help) sed -n '2,7s/^# \{0,1\}//p' notebooks/run.sh; exit ;;
    *) fail "unknown arguments: $* (there is only --check)" 2 ;;
esac
if [ -n "$wheel" ]; then
    [ -f "$wheel" ] || fail "DRIFTLESS_WHEEL is \`$DRIFTLESS_WHEEL\`, expected a wheel"
else
    command -v cargo > /dev/null || fail "cargo is missing; install the Rust toolchain, or name a wheel in DRIFTLESS_WHEEL"
fi
python=${PYTHON:-python3}
"$python" -c 'import sys, venv; sys.exit(sys.version_info < (3, 11))' \
    || fail "\`$python\` is not Python 3.11 or later with venv; name another in PYTHON"

folder=${CARGO_TARGET_DIR:-target}/notebooks
mkdir -p "$folder"
folder=$(cd "$folder" && pwd)
export PIP_DISABLE_PIP_VERSION_CHECK=1 PIP_QUIET=1
echo "== Python environment"
[ -x "$folder/venv/bin/pip" ] || "$python" -m venv "$folder/venv"
"$folder/venv/bin/pip" install -r notebooks/requirements.txt
echo "== package"
if [ -n "$wheel" ]; then
    # A wheel that was built anew has the version of the one before.
    "$folder/venv/bin/pip" install --force-reinstall --no-deps "$wheel"
else
    # Within the workspace's folder for builds, so that only what has changed is compiled.
    CARGO_TARGET_DIR=$(dirname "$folder") MATURIN_PEP517_ARGS=--locked \
        "$folder/venv/bin/pip" install --force-reinstall --no-deps ./python
fi

# The settings and kernels of whoever runs this stay out of it.
export JUPYTER_CONFIG_DIR=$folder/jupyter/config JUPYTER_DATA_DIR=$folder/jupyter/data
export IPYTHONDIR=$folder/jupyter/ipython PYTHONDONTWRITEBYTECODE=1
unset JUPYTER_PATH JUPYTER_CONFIG_PATH
mkdir -p "$IPYTHONDIR"
if [ "$*" = --check ]; then
    where=(--output-dir "$folder/check")
    echo "== types"
    notebooks/check_types.sh "$folder/venv"
else
    where=(--inplace)
fi
for notebook in notebooks/*.ipynb; do
    echo "== $notebook"
    "$folder/venv/bin/python" -m nbconvert --log-level WARN --to notebook --execute "$notebook" "${where[@]}" \
        --ExecutePreprocessor.record_timing=False --ExecutePreprocessor.timeout=1800
done
