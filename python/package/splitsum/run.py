"""Reads finished runs of `splitsum run`."""

from __future__ import annotations

import csv
import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from . import _native

try:
    import pandas
except ImportError:
    pandas = None


def read_exr(path: str | os.PathLike[str], layer: str | None = None) -> tuple[NDArray[np.float32], Any]:
    """Reads an OpenEXR file: colour, an array (h, w, 3), and channel A, an array (h, w) or None.

    Colour is linear RGB, converted to the primaries of Rec.709. `layer` selects channels `layer.R` ..., or a part.
    """
    return _native.read_exr(path, layer)


class Images:
    """Images of a row, arrays (h, w, 3) of linear radiance."""

    def image(self) -> NDArray[np.float32]:
        """Reads the cell's image."""
        return read_exr(self._path("radiance"))[0]

    def reference(self) -> NDArray[np.float32]:
        """Reads its reference."""
        return read_exr(self._path("reference"))[0]

    def standard_error(self) -> NDArray[np.float32]:
        """Reads the standard error of the reference, for each pixel and channel."""
        return read_exr(self._path("reference"), "standard_error")[0]

    def mask(self) -> NDArray[np.bool_]:
        """Returns the pixels that count, an array (h, w)."""
        column = "reference" if isinstance(self.get("reference"), str) else "radiance"
        return read_exr(self._path(column))[1] > 0

    def _path(self, column: str) -> Path:
        name = self.get(column)
        if column == "reference" and not isinstance(name, str) and isinstance(self.get("radiance"), str):
            raise ValueError(f"{self['run']}: cell {self['cell']} has no reference, by reference = \"none\" of its experiment")
        if not isinstance(name, str):
            raise FileNotFoundError(f"{self['run']}: cell {self['cell']} has no image; published runs have only tables")
        return Path(self["run"], "images", name)


class Row(Images, dict):
    """A row of a run without pandas: columns by name, missing values None."""


if pandas:

    class Series(Images, pandas.Series):
        """A row of a run."""

    class Frame(pandas.DataFrame):
        """The rows of a run."""

        _constructor = property(lambda self: Frame)
        _constructor_sliced = property(lambda self: Series)


def read_run(path: str | os.PathLike[str]) -> Any:
    """Reads the rows of errors.csv, joined with images.csv if the run has it (docs/columns.md).

    Returns a pandas.DataFrame, or a list of dictionaries without pandas. Each row (`run.iloc[0]`, `run[0]`) has the methods
    image(), reference(), standard_error() and mask(). The column `run` is the folder.
    """
    tables = [_read(Path(path, "errors.csv"))]
    if Path(path, "images.csv").exists():
        tables.append(_read(Path(path, "images.csv")))
    if pandas:
        rows = Frame(tables[0])
        for images in tables[1:]:
            rows = rows.merge(pandas.DataFrame(images), how="left", on="cell")
        return rows.assign(run=os.fspath(path))
    images = {row["cell"]: row for row in tables[-1]}
    return [Row(row, **images.get(row["cell"], {}), run=os.fspath(path)) for row in tables[0]]


def _read(path: Path) -> Any:
    """Reads a table: a column is of numbers if all its values are."""
    if pandas:
        return pandas.read_csv(path, dtype={"cell": str}, keep_default_na=False, na_values=[""])
    with open(path, newline="", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    for column in rows[0].keys() - {"cell"} if rows else ():
        values = [row[column] or None for row in rows]
        try:
            values = [None if value is None else float(value) for value in values]
        except ValueError:
            pass
        for row, value in zip(rows, values):
            row[column] = value
    return rows
