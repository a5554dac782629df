"""How much better an engine draws with our bake than with its own: pictures of run.sh with and without --ours.

Arguments: FOLDER of run.sh, --splitsum PROGRAM, --out DIR. It writes DIR/bakes.csv, and DIR/bakes.md for compare.py. For each engine, map, material and roughness it has the relMSE of both
pictures to the engine's lookup and factors with exact maps, and to `reference`, and the factors between own and ours. With
--at-least X in place of --out it fails if the geometric mean of the first factor is below X for an engine and map. Metals alone are
compared, so the prefiltered map alone counts, and not in constant light, where every filter is right.
"""
import argparse
import csv
import json
import math
import pathlib

from compare import ENGINES, Ours, inner, lookup, mean_luminance, read, reference, scores, text

METALS = ["metal", "white"]


def rows_of(folder, program):
    listed = json.loads((folder / "spheres.json").read_text())
    ours, mask = Ours(program, folder, listed["size"]), inner(listed["size"])
    for name, engine in ENGINES.items():
        for sphere in listed["spheres"]:
            paths = [folder / f"{name}{suffix}" / f"{sphere['name']}.exr" for suffix in ("", "-ours")]
            if sphere["material"] not in METALS or sphere["map"] == "constant" or not all(path.exists() for path in paths):
                continue
            mean = mean_luminance(folder / "maps" / f"{sphere['map']}.exr")
            pictures = [read(path)[mask] for path in paths]
            exact = lookup(ours, sphere, engine, engine.get("exact", engine.get("model")))[mask]
            truth = reference(ours, sphere, engine)[mask]
            row = {"engine": name, "version": engine["title"], **{key: sphere[key] for key in ("map", "material", "roughness")}}
            for against, image in [("exact", exact), ("truth", truth)]:
                (own_ratio, own), (our_ratio, our) = [scores(picture, image, mean) for picture in pictures]
                row |= {f"mean_ratio_own_to_{against}": own_ratio, f"mean_ratio_ours_to_{against}": our_ratio}
                row |= {f"relmse_own_to_{against}": own, f"relmse_ours_to_{against}": our, f"factor_to_{against}": own / our}
            yield row


def means(rows):
    """The geometric means of relMSE and factors by engine, map and material."""
    keys = ["relmse_own_to_exact", "relmse_ours_to_exact", "factor_to_exact", "relmse_own_to_truth", "relmse_ours_to_truth", "factor_to_truth"]
    groups = {}
    for row in rows:
        groups.setdefault((row["version"], row["map"], row["material"]), []).append(row)
    for group, members in groups.items():
        yield group, {key: math.exp(sum(math.log(float(row[key])) for row in members) / len(members)) for key in keys}


def table(rows):
    """Markdown: percent rms and factors of relMSE, geometric means over roughness."""
    lines = ["| engine | map | material | to exact maps: own | ours | factor | to the truth: own | ours | factor |", "|---|---|---|" + "---:|" * 6]
    for group, mean in means(rows):
        rms = [f"{100 * mean[f'relmse_{whose}_to_{against}'] ** 0.5:.2g}" for against in ("exact", "truth") for whose in ("own", "ours")]
        factors = [f"{mean[f'factor_to_{against}']:.2g}" for against in ("exact", "truth")]
        lines.append(f"| {' | '.join(group)} | {rms[0]} | {rms[1]} | {factors[0]} | {rms[2]} | {rms[3]} | {factors[1]} |")
    return "\n".join(lines)


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--splitsum", required=True)
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--out", type=pathlib.Path)
    wanted.add_argument("--at-least", type=float, metavar="X")
    arguments = parser.parse_args()
    rows = list(rows_of(arguments.folder, arguments.splitsum))
    if not rows:
        parser.error(f"{arguments.folder} has no pictures of both bakes: run scripts/engines/run.sh with and without --ours first")
    print(table(rows))
    if arguments.out:
        arguments.out.mkdir(parents=True, exist_ok=True)
        (arguments.out / "bakes.md").write_text(table(rows) + "\n")
        with open(arguments.out / "bakes.csv", "w", newline="") as file:
            writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
            writer.writeheader()
            writer.writerows({key: text(value) for key, value in row.items()} for row in rows)
    elif any(mean["factor_to_exact"] < arguments.at_least for _, mean in means(rows)):
        raise SystemExit(f"FAILED: a factor below {arguments.at_least:g}")


if __name__ == "__main__":
    main()
