"""Counts how many fits of one run are within the prediction intervals of another:

    python3 scripts/check_predictions.py PUBLISHED RUN OUT

PUBLISHED is the published folder of a run that asks `recovery`, RUN the folder of a run of the same surfaces under other environments.
A prediction interval (`new_roughness_lo` and `_hi`, `new_f0_ratio_lo` and `_hi`) should hold 95 % of the fits under new environments.
OUT/predictions.csv has a row per surface, method and loss; OUT/predictions_digest.csv sums over roughness. Fits of whole photos count.
"""

import csv
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


def inside(values, lo, hi):
    return sum(lo - TOLERANCE <= value <= hi + TOLERANCE for value in values)


def compared(predicted, fitted):
    """One row of COLUMNS for each key that both runs have."""
    for key in (key for key in predicted if key in fitted):
        lo, hi, ratio_lo, ratio_hi = predicted[key]
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
