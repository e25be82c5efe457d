# Everyday commands; each is a plain cargo line in CONTRIBUTING.md.

# everything that has to pass before a change lands
ci:
    .ci/run

# the tests
test:
    cargo test --release

# formatting, lints and documentation, warnings as errors
lint:
    cargo fmt --check
    cargo clippy --release --all-targets -- -D warnings
    RUSTDOCFLAGS="-D warnings" cargo doc --release --no-deps

# the benchmarks
bench:
    cargo bench

# the tables of docs/performance.md
speed:
    cargo bench --bench speed

# scp beside CasADi and IPOPT, the other optimisers beside theirs, the rollout beside Pinocchio; needs
# Python 3.11 and g++
peers:
    benches/peers/casadi/run.sh
    benches/peers/casadi/run.sh --free-form
    benches/peers/optimisers/run.sh
    benches/peers/pinocchio/run.sh

# the statistics beside SciPy and others; needs Python 3.11
statistics:
    tests/statistics/run.sh

# what `export` writes, read by the tools whose formats it writes; needs Python 3.11
exchange:
    tests/exchange/run.sh

# the page of a report, opened in a browser; needs Python 3.11 and Chromium
page:
    tests/page/run.sh

# files of motions, read by the tools whose formats they are, and played by MuJoCo; needs Python 3.11
motions:
    tests/motions/run.sh

# figures as PDF, SVG and PNG read by other tools; needs Python 3.11
figures:
    tests/figures/run.sh

# motions of all robots that come with the program, in Pinocchio and MuJoCo; URDF files; needs Python 3.11
simulators:
    tests/simulators/run.sh

# the Python package on every version of Python that is found
python:
    python/test.sh

# the notebooks, executed on copies; needs Python 3.11
notebooks:
    notebooks/run.sh --check

# the solvers of docs/solvers, with the packages and languages that they need; needs Python 3.11
external:
    tests/external/run.sh

# jobs on HyperQueue, GNU parallel and Slurm, workers lost and added; a scheduler that is not installed is skipped
cluster:
    tests/cluster/run.sh

# readers of files and the planner, fuzzed; needs a C++ compiler
fuzz:
    fuzz/run.sh

# the book in target/book, and all links; needs Python 3.11
book:
    docs/build.sh

# spelling, shell scripts, workflows; needs Python 3.11
prose:
    .ci/lint

# licences and sources of dependencies
deny:
    .ci/deny

# the default experiment
run:
    cargo run --release -- run

# accept what the tests of texts and charts now print and draw; look at the difference before committing it
accept:
    INSTA_UPDATE=always DRIFTLESS_ACCEPT_CHARTS=1 cargo test --release --lib --test cli
