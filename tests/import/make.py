"""Makes the data that the tests import, with the loggers whose formats they are: ioh 0.4.2 and coco-experiment 2.8.2.

    python -m venv venv && venv/bin/pip install ioh==0.4.2 coco-experiment==2.8.2 numpy==2.4.6
    venv/bin/python make.py
"""

import shutil
from pathlib import Path

import cocoex
import ioh
import numpy as np

HERE = Path(__file__).parent


def points(dimension, seed, scale):
    rng = np.random.default_rng(seed)
    return scale * rng.uniform(-5, 5, (60, dimension))


def make_ioh():
    """Two algorithms on two functions of BBOB, two instances, two runs each. Rows are improvements and the last evaluation."""
    shutil.rmtree(HERE / "ioh", ignore_errors=True)
    for name, scale in [("uniform", 1.0), ("narrow", 0.5)]:
        logger = ioh.logger.Analyzer(
            root=str(HERE / "ioh"), folder_name=name, algorithm_name=name, algorithm_info=f"scale {scale}", store_positions=True
        )
        suite = ioh.suite.BBOB([1, 8], [1, 2], [2])
        suite.attach_logger(logger)
        for problem in suite:
            for seed in range(2):
                for x in points(2, seed, scale):
                    problem(x)
                problem.reset()
        logger.close()


def make_coco():
    """One algorithm on two functions of bbob with 2 and 3 variables, two instances."""
    shutil.rmtree(HERE / "coco", ignore_errors=True)
    suite = cocoex.Suite("bbob", "instances: 1-2", "function_indices: 1,8 dimensions: 2,3")
    observer = cocoex.Observer("bbob", "result_folder: made algorithm_name: uniform algorithm_info: uniform")
    for problem in suite:
        problem.observe_with(observer)
        for x in points(problem.dimension, 0, 1.0):
            problem(x)
        problem.free()
    shutil.move(observer.result_folder, HERE / "coco")
    shutil.rmtree("exdata")
    for unused in [*(HERE / "coco").rglob("*.rdat"), *(HERE / "coco").rglob("*.mdat")]:
        unused.unlink()


make_ioh()
make_coco()
