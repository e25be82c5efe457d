"""What the notebooks share: calling `driftless`, reading what it stored, and showing a figure.

Results, motions and figures for print land in `target/notebooks`, away from the reader's own `results/`.
"""

import io
import json
import os
import shutil
import subprocess
from pathlib import Path

import matplotlib
import PIL.Image
import polars as pl
from IPython.display import Image, display
from matplotlib import pyplot as plt

ROOT = Path(__file__).resolve().parent.parent
TARGET = ROOT / os.environ.get("CARGO_TARGET_DIR", "target")
PROGRAM = TARGET / "release" / "driftless"
WORK = TARGET / "notebooks"
MM = 1 / 25.4  # inches
ONE_COLUMN, TWO_COLUMNS = 88 * MM, 180 * MM

matplotlib.use("agg")
plt.style.use(ROOT / "notebooks" / "driftless.mplstyle")
pl.Config(
    tbl_hide_dataframe_shape=True,
    tbl_hide_column_data_types=True,
    tbl_rows=40,
    tbl_cols=20,
    fmt_str_lengths=90,
)


def driftless(*arguments):
    """Runs the program in `target/notebooks` and returns what it prints."""
    if not PROGRAM.exists():
        raise FileNotFoundError(f"{PROGRAM} is missing: run notebooks/run.sh, or cargo build --release")
    WORK.mkdir(parents=True, exist_ok=True)
    command = [str(argument) for argument in arguments]
    plain = {name: value for name, value in os.environ.items() if "COLOR" not in name}  # a kernel asks for colours
    done = subprocess.run([PROGRAM, *command], cwd=WORK, capture_output=True, text=True, env={**plain, "NO_COLOR": "1"})
    if done.returncode != 0:
        raise RuntimeError(f"`driftless {' '.join(command)}` ended with status {done.returncode}:\n{done.stderr}")
    return done.stdout


def driftless_json(*arguments):
    """The same with `--json`, as a dictionary."""
    return json.loads(driftless(*arguments, "--json"))


def experiment(file, seeds, budget=None):
    """Does the runs of an experiment that are missing, makes its tables and returns its folder.

    `file` is a path, or the name of one of the experiments that come with the program.
    """
    file = Path(file) if Path(file).suffix else ROOT / "experiments" / f"{file}.toml"
    folder = WORK / "results" / f"{file.stem}-{seeds}-seeds{f'-{budget}' if budget else ''}"
    driftless("run", file, "--out", folder, "--seeds", seeds, "--quiet", *(["--budget", budget] if budget else []))
    driftless("report", folder)
    return folder


def runs(folder):
    """One row per run; `results/README.md` describes the columns."""
    return pl.scan_parquet(folder / "runs" / "*.parquet").unique("key").collect().sort("optimiser", "instance", "seed")


def traces(folder):
    """Improvements of the best cost, with the optimiser, formulation and seed of each run."""
    rows = pl.scan_parquet(folder / "traces" / "*.parquet").unique().collect()
    return rows.join(runs(folder).select("key", "instance", "optimiser", "formulation", "seed"), on="key")


def table(folder, name):
    """A table of `driftless report`, with all digits."""
    return pl.read_csv(folder / "tables" / f"{name}.csv", infer_schema_length=None)


def best_motions(folder):
    """The best motion of every instance, from `driftless export`: paths by name."""
    out = folder / "motions"
    shutil.rmtree(out, ignore_errors=True)
    driftless("export", folder, "--format", "csv", "--out", out)
    return {path.stem: path for path in sorted(out.glob("*.csv"))}


def show(figure, name, alt):
    """Shows a figure at its size in print, and keeps it as `target/notebooks/figures/NAME.pdf`."""
    (WORK / "figures").mkdir(parents=True, exist_ok=True)
    figure.savefig(WORK / "figures" / f"{name}.pdf", metadata={"CreationDate": None})
    drawn, png = io.BytesIO(), io.BytesIO()
    figure.savefig(drawn, format="png")
    few_colours = PIL.Image.open(drawn).convert("RGB").quantize(256, PIL.Image.Quantize.MAXCOVERAGE, dither=0)
    few_colours.save(png, format="png", optimize=True)  # a third of the size
    display(Image(png.getvalue(), width=round(figure.get_figwidth() * 96), alt=alt))
    plt.close(figure)
