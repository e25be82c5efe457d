#!/usr/bin/env bash
# Builds the book into target/book and checks all links between pages, headings and files of the repository. Needs Python 3.11, PyPI and,
# the first time, some minutes to build mdBook.
set -euo pipefail
cd "$(dirname "$0")/.."
target=${CARGO_TARGET_DIR:-target}
tools=$(mkdir -p "$target/tools" && cd "$target/tools" && pwd)
export PATH=$tools/bin:$PATH
command -v mdbook > /dev/null ||
    CARGO_PROFILE_DEV_DEBUG=0 cargo install --quiet --locked --debug --no-default-features --root "$tools" mdbook
mdbook build docs --dest-dir "$(cd "$target" && pwd)/book"
[ -x "$tools/links/bin/python" ] || python3 -m venv "$tools/links"
"$tools/links/bin/python" -m pip install --quiet --disable-pip-version-check md-dead-link-check==1.3.0
# Links out of the repository are not followed.
printf '[tool.md_dead_link_check]\ncheck_web_links = false\n' > "$tools/links/config.toml"
"$tools/links/bin/md-dead-link-check" --no-color --config "$tools/links/config.toml"
