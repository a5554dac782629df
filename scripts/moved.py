"""Prints which numbers of two folders of answers differ: `python3 scripts/moved.py BEFORE AFTER`.

A line per column that moved: how many of its numbers, the median and the largest move in per cent, and the row that moved
most. Times are left out, since they depend on the machine. Columns, rows or tables of one side alone are named.
"""

import statistics
import sys
from pathlib import Path

from compare_answers import ZERO, number, rows


def percent(before, after):
    """The change in per cent of the larger of both; infinite if only one of them is a number."""
    if before is None or after is None:
        return float("inf")
    most = max(abs(before), abs(after))
    return 0.0 if most < ZERO else 100.0 * abs(after - before) / most


def name_of(row):
    """The row's words, which say of what its numbers are."""
    return ", ".join(text for text in row.values() if text and number(text) is None)


def report(table, before, after):
    """Prints the moves of a table; returns how many cells moved."""
    old, new = rows(before), rows(after)
    if len(old) != len(new):
        print(f"{table}: {len(new)} rows, {len(old)} before")
        return abs(len(new) - len(old))
    columns, others = (list(lines[0]) if lines else [] for lines in (old, new))
    for column in sorted(set(columns) ^ set(others)):
        print(f"{table}: column {column} is new" if column in others else f"{table}: column {column} is gone")
    total = 0
    for column in (column for column in columns if column in others):
        moves = []
        for then, now in zip(old, new):
            if then[column] != now[column]:
                moves.append((percent(number(then[column]), number(now[column])), then, now))
        if not moves:
            continue
        total += len(moves)
        size, then, now = max(moves, key=lambda move: move[0])
        middle = statistics.median(move[0] for move in moves)
        print(
            f"{table}: {column}: {len(moves)} of {len(old)} moved, median {middle:.2g} %, most {size:.2g} %: "
            f"{then[column] or 'empty'} to {now[column] or 'empty'} ({name_of(now)})"
        )
    return total


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: python3 scripts/moved.py BEFORE AFTER")
    before, after = map(Path, sys.argv[1:])
    names = [{path.name for path in folder.glob("*.csv") if not path.name.startswith("times")} for folder in (before, after)]
    for folder, found in zip((before, after), names):
        if not found:
            sys.exit(f"{folder}: has no tables; expected the folder answers/ of a run")
    for name in sorted(names[0] ^ names[1]):
        print(f"{name}: is new" if name in names[1] else f"{name}: is gone")
    moved = sum(report(name, before / name, after / name) for name in sorted(names[0] & names[1]))
    print(f"{moved} cells moved" if moved else "no number moved")


if __name__ == "__main__":
    main()
