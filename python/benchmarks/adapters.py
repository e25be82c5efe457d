"""Optimisers of other packages beside those of driftless, on the default task.

    OPENBLAS_NUM_THREADS=1 python python/benchmarks/adapters.py
"""

from __future__ import annotations

import polars as pl

import driftless

result = driftless.run(
    name="adapters",
    problems=driftless.Task(),
    optimisers=[
        "scp",
        "cma-es",
        "l-shade",
        driftless.scipy("COBYQA"),
        driftless.scipy("SLSQP"),
        driftless.cma(),
        driftless.minionpy("jSO"),
        driftless.minionpy("LSRTDE"),
        driftless.nevergrad("NGOpt"),
    ],
    seeds=5,
    budget=5_000,
)
result.report()
pl.Config(tbl_rows=20, tbl_cols=20, tbl_hide_column_data_types=True, tbl_hide_dataframe_shape=True)
print(result.table("summary"))
