"""What the notebooks share: where results land, experiments by name, and showing a figure.

Results, motions and figures for print land in `target/notebooks`, away from the reader's own `results/`.
"""

import io
import os
import subprocess
import sys
from pathlib import Path

import matplotlib
import PIL.Image
import polars as pl
from IPython.display import Image, display  # pyright: ignore[reportUnknownVariableType]
from matplotlib import pyplot as plt
from matplotlib.figure import Figure

import driftless

ROOT = Path(__file__).resolve().parent.parent
WORK = ROOT / os.environ.get("CARGO_TARGET_DIR", "target") / "notebooks"
WORK.mkdir(parents=True, exist_ok=True)
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


def command(*arguments: str | Path | int) -> str:
    """Runs the command `driftless` in `target/notebooks` and returns what it prints."""
    words = [str(argument) for argument in arguments]
    plain = {name: value for name, value in os.environ.items() if "COLOR" not in name}  # a kernel asks for colours
    done = subprocess.run(
        [sys.executable, "-m", "driftless", *words],
        cwd=WORK,
        capture_output=True,
        text=True,
        env={**plain, "NO_COLOR": "1"},
    )
    if done.returncode != 0:
        raise RuntimeError(f"`driftless {' '.join(words)}` ended with status {done.returncode}:\n{done.stderr}")
    return done.stdout


def experiment(file: str | Path, seeds: int, budget: int | None = None) -> driftless.Result:
    """Does the runs of an experiment that are missing.

    `file` is a path, or the name of one of the experiments in `experiments/`.
    """
    file = Path(file) if Path(file).suffix else ROOT / "experiments" / f"{file}.toml"
    folder = WORK / "results" / f"{file.stem}-{seeds}-seeds{f'-{budget}' if budget else ''}"
    return driftless.run(file, seeds=seeds, budget=budget, out=folder, progress=False)


def runs(result: driftless.Result) -> pl.DataFrame:
    """One row per run; `results/README.md` describes the columns."""
    rows = pl.scan_parquet(result.path / "runs" / "*.parquet").unique("key").collect()
    return rows.sort("optimiser", "instance", "seed")


def traces(result: driftless.Result) -> pl.DataFrame:
    """Improvements of the best cost, with the optimiser, formulation and seed of each run."""
    rows = pl.scan_parquet(result.path / "traces" / "*.parquet").unique().collect()
    return rows.join(runs(result).select("key", "instance", "optimiser", "formulation", "seed"), on="key")


def show(figure: Figure, name: str, alt: str) -> None:
    """Shows a figure at its size in print, and keeps it as `target/notebooks/figures/NAME.pdf`."""
    (WORK / "figures").mkdir(parents=True, exist_ok=True)
    figure.savefig(WORK / "figures" / f"{name}.pdf", metadata={"CreationDate": None})
    drawn = io.BytesIO()
    figure.savefig(drawn, format="png")
    show_picture(drawn, round(figure.get_figwidth() * 96), alt)
    plt.close(figure)


def show_picture(drawn: Path | io.BytesIO, width: int, alt: str) -> None:
    """Shows a PNG at this width [px], with fewer colours."""
    png = io.BytesIO()
    few_colours = PIL.Image.open(drawn).convert("RGB").quantize(
        256, PIL.Image.Quantize.MAXCOVERAGE, dither=PIL.Image.Dither.NONE
    )
    few_colours.save(png, format="png", optimize=True)  # a third of the size
    display(Image(png.getvalue(), width=width, alt=alt))  # type: ignore[no-untyped-call]
