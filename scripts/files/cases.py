"""A case is a file by a real program, and what splitsum must read from it."""

import csv
import io
import math
import subprocess
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

import numpy as np

from marker import MARKER, Numbers

# Coefficients of nine harmonics for a mean of 1, and for slopes of 1 along x, y and z.
OF_MEAN = 2 * math.sqrt(math.pi)
OF_SLOPE = math.sqrt(4 * math.pi / 3)


@dataclass
class Case:
    name: str
    # Writes the file into the current folder and returns its name.
    make: Callable[[], str]
    expected: Numbers = field(default_factory=lambda: MARKER)
    tolerance: float = 1e-3
    # Text that the messages must contain.
    says: str = ""
    flags: tuple = ()


@dataclass
class Refusal:
    """A file that must be refused, with this text in the message."""

    name: str
    make: Callable[[], str]
    says: str
    flags: tuple = ()


@dataclass
class Check:
    """Any other comparison: `run` returns what was found, and raises `Wrong` if that is wrong."""

    name: str
    run: Callable[[], str]
    expected: str


class Wrong(Exception):
    pass


class Skipped(Exception):
    pass


@dataclass
class Reader:
    """The program under test."""

    program: Path

    def run(self, *arguments):
        return subprocess.run([self.program, *arguments], capture_output=True, text=True, timeout=300)

    def numbers(self, environment, flags=()):
        """Mean and slopes of an environment, and the messages."""
        queries = Path(f"{environment.replace('/', '_')}.csv")
        with queries.open("w", newline="") as file:
            csv.writer(file).writerows([["environment"], [environment]])
        done = self.run("integrate", queries, "--kind", "sh9", *flags)
        if done.returncode != 0:
            raise Wrong(f"exit {done.returncode}: {done.stderr.strip()}")
        row = next(csv.DictReader(io.StringIO(done.stdout)))
        at = lambda name: np.array([float(row[f"{name}_{channel}"]) for channel in "rgb"])
        slopes = np.stack([at("l11"), at("l1m1"), at("l10")], -1) / OF_SLOPE
        return Numbers(at("l00") / OF_MEAN, slopes), done.stderr

    def judge(self, case):
        """Returns the expected and the found text; raises `Wrong` with what is wrong."""
        if isinstance(case, Check):
            return case.expected, case.run()
        file = case.make()
        if isinstance(case, Refusal):
            try:
                numbers, _ = self.numbers(file, case.flags)
            except Wrong as refused:
                if case.says not in str(refused):
                    raise Wrong(f"expected refusal {case.says!r}, got {refused}") from None
                return f"refusal {case.says!r}", "the same"
            raise Wrong(f"expected refusal {case.says!r}, got {numbers}")
        numbers, messages = self.numbers(file, case.flags)
        difference = numbers.difference(case.expected)
        if not difference < case.tolerance:
            raise Wrong(f"expected {case.expected}, got {numbers}: {100 * difference:.2g} % of the mean; {messages}")
        if case.says not in messages:
            raise Wrong(f"expected the message {case.says!r}, got {messages!r}")
        return str(case.expected), f"{numbers} ({difference:.1e} off)"
