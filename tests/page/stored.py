"""What the files beside a page say that it should show."""

import csv
import math
import tomllib
from pathlib import Path


class Table:
    """A table's CSV, and its cells as text from its Markdown."""

    def __init__(self, folder: Path, name: str):
        self.bytes = (folder / f"{name}.csv").read_bytes()
        rows = list(csv.reader(self.bytes.decode().splitlines()))
        self.header, self.rows = rows[0], rows[1:]
        lines = (folder / f"{name}.md").read_text().splitlines()
        cells = [self._cells(line) for line in lines if line.startswith("|")]
        self.shown_header, self.shown = cells[0], cells[2:]
        assert len(self.shown) == len(self.rows), f"{name}: Markdown and CSV differ in length"

    @staticmethod
    def _cells(line):
        cells = line.strip().strip("|").replace("\\|", "\0").split("|")
        return [cell.strip().replace("\0", "|") for cell in cells]

    def order(self, column: str, descending: bool) -> list[int] | None:
        """Indices of the rows by a column of numbers, infinite and then missing ones last; None for texts."""
        values = [row[self.header.index(column)] for row in self.rows]
        try:
            numbers = [float(value) if value else math.nan for value in values]
        except ValueError:
            return None
        if all(math.isnan(number) for number in numbers):
            return None

        def key(i):
            number = numbers[i]
            if math.isfinite(number):
                return (0, -number if descending else number)
            return (2 if math.isnan(number) else 1, 0)

        return sorted(range(len(numbers)), key=key)

    def matching(self, words: str) -> int:
        """Number of rows in which every word stands, in either form of a cell."""
        texts = [" ".join(row + shown).lower() for row, shown in zip(self.rows, self.shown)]
        return sum(all(word in text for word in words.lower().split()) for text in texts)


def experiment(folder: Path) -> dict:
    return tomllib.loads((folder / "experiment.toml").read_text())


def goal(folder: Path) -> list[float] | None:
    """Yaw, pitch and roll of the goal, where all instances have the same."""
    file = experiment(folder)
    sweep = file.get("sweep", {})
    if "task" not in file or "random_poses" in sweep or "pose" in sweep:
        return None
    return file["task"]["goal"]["base_zyx_deg"]
