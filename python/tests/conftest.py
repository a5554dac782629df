"""The repository's goldens and its program, which the package must agree with."""

import csv
import os
import subprocess
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
GOLDEN = ROOT / "tests" / "golden"
MAP = str(GOLDEN / "env_analytic.exr")


@pytest.fixture(scope="session")
def program():
    """Returns a function that runs `splitsum` with arguments and returns its output."""
    path = Path(os.environ.get("SPLITSUM", ROOT / "target" / "release" / "splitsum"))
    if not path.exists():
        pytest.skip(f"{path} is missing: cargo build --release, or set SPLITSUM")

    def run(*arguments):
        result = subprocess.run([path, *map(str, arguments)], capture_output=True, check=False, text=True)
        assert result.returncode == 0, result.stderr
        return result.stdout

    return run


def table(path):
    """Reads a CSV file: columns by name, arrays of numbers where all are numbers."""
    with open(path, newline="") as file:
        rows = list(csv.DictReader(file))

    def column(name):
        values = [row[name] for row in rows]
        try:
            return np.array(values, float)
        except ValueError:
            return np.array(values)

    return {name: column(name) for name in rows[0]}


def vectors(columns, prefix, axes="xyz"):
    """Joins three columns to an array (n, 3)."""
    return np.stack([columns[prefix + axis] for axis in axes], -1)


def directions(height, width):
    """Returns the direction of each texel of an equirectangular map (docs/conventions.md)."""
    u, v = (np.arange(width) + 0.5) / width, (np.arange(height) + 0.5)[:, None] / height
    phi, theta = 2 * np.pi * (0.5 - u), np.pi * v
    return np.stack(np.broadcast_arrays(np.sin(phi) * np.sin(theta), np.cos(theta), np.cos(phi) * np.sin(theta)), -1)
