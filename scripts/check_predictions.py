"""Counts how many fits of one run are within the prediction intervals of another:

    python3 scripts/check_predictions.py PUBLISHED RUN OUT

PUBLISHED is the published folder of a run that asks `recovery`, RUN the folder of a run of the same surfaces under other environments.
A prediction interval (`new_roughness_lo` and `_hi`, `new_f0_ratio_lo` and `_hi`) should hold 95 % of the fits under new environments.
Between two published values of roughness it is interpolated, and wider by the error of that (`Law`); beyond them there is none.
OUT/predictions.csv has a row per surface, method and loss; OUT/predictions_digest.csv sums over roughness. Fits of whole photos count.
"""

import csv
import math
import sys
from pathlib import Path

# How exact a fit is; src/instrument/recovery/fit.rs.
TOLERANCE = 2e-4
KEY = ["scene", "perceptual_roughness", "f0", "method", "loss"]
COLUMNS = [
    *KEY,
    "n",
    "roughness_inside",
    "new_roughness_lo",
    "new_roughness_hi",
    "least_roughness",
    "most_roughness",
    "f0_inside",
    "new_f0_ratio_lo",
    "new_f0_ratio_hi",
    "least_f0_ratio",
    "most_f0_ratio",
]


def rows(path):
    with open(path, newline="", encoding="utf-8") as file:
        return list(csv.DictReader(file))


def surface(scene, roughness, f0):
    """Roughness is a square root of alpha: equal values may differ in their last digit."""
    return scene, round(float(roughness), 6), round(float(f0), 6)


def is_whole(row):
    return float(row["n_dot_v_from"]) == 0 and float(row["n_dot_v_to"]) == 1


def cells_of(run):
    """The axes of all cells by id."""
    return {row["cell"]: row for row in rows(run / "errors.csv")}


def fits(run):
    """Recovered roughness and ratio of F0 of each environment, by the columns of KEY."""
    cells = cells_of(run)
    found = {}
    for row in filter(is_whole, rows(run / "recovery.csv")):
        photo, candidate = cells[row["cell"]], cells[row["candidate"]]
        true = surface(photo["scene"], row["true_roughness"], row["true_f0"])
        key = (*true, candidate["method"], row["loss"])
        fit = (float(row["roughness"]), float(row["f0"]) / float(row["true_f0"]))
        found.setdefault(key, []).append(fit)
    return found


def predictions(published):
    """The prediction intervals of roughness and of the ratio of F0, by the columns of KEY."""
    found = {}
    for row in filter(is_whole, rows(published / "answers" / "recovery.csv")):
        key = (*surface(row["scene"], row["perceptual_roughness"], row["f0"]), row["method"], row["loss"])
        ends = [row[f"new_{value}_{end}"] for value in ("roughness", "f0_ratio") for end in ("lo", "hi")]
        if all(ends):
            found[key] = tuple(map(float, ends))
    return found


class Law:
    """The prediction of a factor over roughness, in logarithms: a middle and half a width.

    Between two published values of roughness both are interpolated linearly. The middle of the published ones is not linear: it bends
    with the levels of the map, about six over all roughness, and with the bias. How much it bends shows at each published value, by
    its distance from the line through its neighbours: the error of a line between a and b is the second divided difference times
    (r - a)(b - r). The differences at all published values vary by chance, so Student's quantile of their root mean square counts, and
    half a width is the root of the sum of both squares.
    """

    def __init__(self, intervals):
        """`intervals`: the ends of the factor by roughness."""
        logs = [(r, math.log(lo), math.log(hi)) for r, (lo, hi) in sorted(intervals.items())]
        self.points = [(r, 0.5 * (lo + hi), 0.5 * (hi - lo)) for r, lo, hi in logs]
        triples = list(zip(self.points, self.points[1:], self.points[2:]))
        self.bends = [second_difference(*([p[:2] for p in triple])) for triple in triples]

    def between(self, r):
        """The ends at a roughness; `None` beyond the published ones, or if there are too few."""
        for (a, middle_a, half_a), (b, middle_b, half_b) in zip(self.points, self.points[1:]):
            if a < r < b and self.bends:
                part = (r - a) / (b - a)
                bend = math.sqrt(sum(bend * bend for bend in self.bends) / len(self.bends))
                error = student(len(self.bends)) * bend * (r - a) * (b - r)
                half = math.hypot(half_a + part * (half_b - half_a), error)
                middle = middle_a + part * (middle_b - middle_a)
                return math.exp(middle - half), math.exp(middle + half)
        return None


def second_difference(a, b, c):
    """The second divided difference of three points (x, y)."""
    return ((c[1] - b[1]) / (c[0] - b[0]) - (b[1] - a[1]) / (b[0] - a[0])) / (c[0] - a[0])


def student(degrees):
    """The 97.5 % quantile of Student's distribution, by integer degrees of freedom."""
    known = [12.706, 4.303, 3.182, 2.776, 2.571, 2.447, 2.365, 2.306, 2.262, 2.228]
    return known[degrees - 1] if degrees <= len(known) else 1.96 + 2.4 / (degrees - 1)


def interpolated(predicted, key):
    """The prediction at a roughness between published ones; `None` if there is none."""
    scene, roughness, *rest = key
    of_series = {
        k[1]: ends
        for k, ends in predicted.items()
        if (k[0], *k[2:]) == (scene, *rest) and min(ends) > 0
    }
    biases = {r: (lo / r, hi / r) for r, (lo, hi, _, _) in of_series.items()}
    ratios = {r: (lo, hi) for r, (_, _, lo, hi) in of_series.items()}
    bias, ratio = Law(biases).between(roughness), Law(ratios).between(roughness)
    return bias and ratio and (bias[0] * roughness, bias[1] * roughness, *ratio)


def inside(values, lo, hi):
    return sum(lo - TOLERANCE <= value <= hi + TOLERANCE for value in values)


def compared(predicted, fitted):
    """One row of COLUMNS for each key of a run that is predicted, the published ones first."""
    published = [(key, predicted[key]) for key in predicted if key in fitted]
    others = [(key, interpolated(predicted, key)) for key in fitted if key not in predicted]
    for key, ends in published + [(key, ends) for key, ends in others if ends]:
        lo, hi, ratio_lo, ratio_hi = ends
        roughness, ratios = zip(*fitted[key])
        counts = [len(roughness), inside(roughness, lo, hi), lo, hi, min(roughness), max(roughness)]
        f0 = [inside(ratios, ratio_lo, ratio_hi), ratio_lo, ratio_hi, min(ratios), max(ratios)]
        yield dict(zip(COLUMNS, [*key, *counts, *f0]))


def digest(table):
    """Sums over roughness: "81 of 84" in roughness and in F0."""
    sums = {}
    for row in table:
        total = sums.setdefault((row["scene"], row["f0"], row["method"], row["loss"]), [0, 0, 0])
        for index, name in enumerate(["roughness_inside", "f0_inside", "n"]):
            total[index] += row[name]
    for (scene, f0, method, loss), (roughness, ratio, n) in sums.items():
        yield {
            "scene": scene,
            "f0": f"{f0:g}",
            "method": method,
            "loss": loss,
            "roughness within": f"{roughness} of {n}",
            "F0 within": f"{ratio} of {n}",
        }


def write(path, table):
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, table[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(table)


def main(published, run, out):
    table = list(compared(predictions(published), fits(run)))
    if not table:
        sys.exit(f"{run}: no surface, method and loss with a prediction interval in {published}")
    write(out / "predictions.csv", table)
    write(out / "predictions_digest.csv", list(digest(table)))
    n = sum(row["n"] for row in table)
    for name in ("roughness", "f0"):
        count = sum(row[f"{name}_inside"] for row in table)
        print(f"{name}: {count} of {n} fits within their prediction interval ({100 * count / n:.1f} %)")


if __name__ == "__main__":
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    main(*map(Path, sys.argv[1:]))
