"""Compares the answers of a run with the published ones: `python3 scripts/compare_answers.py PUBLISHED NEW`.

Both are folders `answers/`. Tables have the same columns and rows; each number agrees within its own error:

- a number with an interval, in its cell (`0.67 (95 % 0.54 to 0.83)`) or in columns `_lo` and `_hi`: each number is in the other's interval
- `error` and `rms_percent` beside `noise_floor`: the rms against two references differ by at most the rms of the difference of the
  references, sqrt(2 noise_floor)
- unresolved ratios (`is_resolved` 0) are noise and are not compared; nor are times, and noise floors, which only say how exact the
  references of a run are
- other numbers: within 5 %, the rounding of the two digits that pages print; below 1e-12 they are the rounding of 0
"""

import csv
import re
import sys
from pathlib import Path

NUMBER = r"-?\d+(?:\.\d+)?(?:e-?\d+)?"
INTERVAL = re.compile(rf"({NUMBER}|more than {NUMBER})(?: \({NUMBER} % rms\))? \(95 % ({NUMBER}) to (more than )?({NUMBER})\)")
ROUNDING = 0.05
ZERO = 1e-12
# Cells that are printed of a table: those that differ most.
SHOWN = 5


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def number(text):
    try:
        return float(text)
    except ValueError:
        return None


def is_near(old, new):
    most = max(abs(old), abs(new))
    return most < ZERO or abs(new - old) <= ROUNDING * most


def agrees_in_words(old, new):
    """Compares texts that hold numbers: intervals first, then the other numbers and the words between them."""
    if old == new:
        return True
    intervals = [list(INTERVAL.finditer(text)) for text in (old, new)]
    if len(intervals[0]) != len(intervals[1]):
        return False
    for then, now in zip(*intervals):
        for one, other in ((then, now), (now, then)):
            value = float(one[1].removeprefix("more than "))
            if value < float(other[2]) or (value > float(other[4]) and not other[3]):
                return False
    old, new = (INTERVAL.sub("interval", text) for text in (old, new))
    numbers = zip(re.findall(NUMBER, old), re.findall(NUMBER, new))
    return re.sub(NUMBER, "#", old) == re.sub(NUMBER, "#", new) and all(is_near(float(a), float(b)) for a, b in numbers)


def agrees(column, old, new):
    then, now = number(old[column]), number(new[column])
    if then is None or now is None:
        return agrees_in_words(old[column], new[column])
    if column in ("error", "rms_percent") and number(old.get("noise_floor", "")) is not None:
        noise = (2 * max(float(old["noise_floor"]), float(new["noise_floor"]))) ** 0.5
        rms = [value**0.5 if column == "error" else value / 100 for value in (then, now)]
        return abs(rms[0] - rms[1]) <= noise or is_near(then, now)
    ends = [number(row.get(f"{column}_{end}", "")) for row in (old, new) for end in ("lo", "hi")]
    if None not in ends:
        return (ends[0] <= now <= ends[1] and ends[2] <= then <= ends[3]) or is_near(then, now)
    return then == now or is_near(then, now)


def difference(old, new):
    """How far two cells differ, relative to the larger one; infinite for words."""
    then, now = number(old), number(new)
    if then is None or now is None:
        return float("inf")
    return abs(now - then) / max(abs(then), abs(now), ZERO)


def compare(old, new):
    """Prints how a table agrees; returns the number of cells that do not."""
    then, now = rows(old), rows(new)
    if len(then) != len(now) or (then and list(then[0]) != list(now[0])):
        print(f"{old.name}: {len(now)} rows for {len(then)}, or other columns")
        return 1
    same = within = 0
    wrong = []
    for line, (a, b) in enumerate(zip(then, now), 2):
        if "noise_floor" not in a and "0" in (a.get("is_resolved"), b.get("is_resolved")):
            continue
        for column in a:
            if column == "noise_floor":
                continue
            if a[column] == b[column]:
                same += 1
            elif agrees(column, a, b):
                within += 1
            else:
                place = f"  {old}:{line}: {column}: {b[column]}, published {a[column]}"
                wrong.append((difference(a[column], b[column]), place))
    wrong.sort(key=lambda one: -one[0])
    most = [place for _, place in wrong[:SHOWN]]
    print(f"{old.name}: {same} cells equal, {within} within their errors, {len(wrong)} differ", *most, sep="\n")
    return len(wrong)


def main():
    if len(sys.argv) != 3:
        sys.exit("usage: python3 scripts/compare_answers.py PUBLISHED NEW")
    published, new = map(Path, sys.argv[1:])
    tables = sorted(path for path in published.glob("*.csv") if not path.name.startswith("times"))
    if not tables:
        sys.exit(f"{published}: has no tables; expected the answers of a published run")
    missing = [path.name for path in tables if not (new / path.name).exists()]
    if missing:
        sys.exit(f"{new}: has no {', '.join(missing)}")
    sys.exit(sum(compare(path, new / path.name) for path in tables) > 0)


if __name__ == "__main__":
    main()
