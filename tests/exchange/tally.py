"""Counts comparisons and keeps the largest difference."""

import numpy as np


class Tally:
    """What was compared under one name."""

    def __init__(self):
        self.count, self.largest, self.where = 0, 0.0, ""

    def compare(self, found, expected, where):
        """Two numbers, or arrays of one shape; infinities have to be in the same places."""
        found, expected = np.atleast_1d(found).astype(float), np.atleast_1d(expected).astype(float)
        if found.shape != expected.shape:
            raise SystemExit(f"{where}: {found.shape} numbers instead of {expected.shape}")
        with np.errstate(invalid="ignore", divide="ignore"):
            difference = np.abs(found - expected) / np.maximum(np.abs(expected), np.abs(found))
        difference = np.where(found == expected, 0.0, np.where(np.isfinite(difference), difference, np.inf))
        self.count += difference.size
        if difference.size and difference.max() > self.largest:
            worst = difference.argmax()
            self.largest = difference.max()
            self.where = f"{where}: {found.flat[worst]} instead of {expected.flat[worst]}"
