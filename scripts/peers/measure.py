"""Runs every baker that is installed on every map, in one go; writes tables of cost and errors. scripts/bench-peers.sh calls it."""
import argparse
import csv
import json
import pathlib
import subprocess
import sys
import time
from statistics import median
from bakers import HERE, LEVELS, SIDE, Cmgen, Khronos, Splitsum, Three, run

ALPHAS = [0.05, 0.1, 0.25, 0.5, 1]
ROUNDS = 5
TEXTS = ("baker", "makes", "timed", "program")  # columns
LABELS = {
    "splitsum": "splitsum",
    "cmgen": "cmgen (Filament)",
    "khronos": "glTF-IBL-Sampler (Khronos)",
    "three.js": "three.js PMREM",
}
OWN = {"linear 5": "splitsum", "linear 7": "splitsum, 7 levels", "quadratic 6": "splitsum, 6 levels, quadratic"}
SPLIT = "exact tables: the split itself"
BAKES_TITLE, SPEED_TITLE = "How wrong are the bakes of other tools?", "What splitsum costs compared with other tools"
TITLES = {
    "image": """## The error in the image

relMSE against the split sum with exact factors, median over maps; scene `design`, GGX, f0 1, with our DFG table. All cubes have 256
texels a side; CPU s is the cost of one map ([what is timed](../speed/README.md)).""",
    "level": """## Each level against its integral

relMSE of the texels against the exact integral at the level's alpha (`splitsum check-bake`), and the range of the bias over maps. Our
levels and their judge are the same convolution, so our errors are rounding. `check-bake` also compares three directions of each cube with
adaptive cubature: under the studio they agree within 2e-5.""",
    "cost": """## Prefiltered maps

CPU seconds, user and system, of all threads, for a map of 1024x512. Bakers take turns, map by map; `over ours` is the median of the
paired ratios.""",
    "dfg": """## DFG table

256x256, correlated masking. Largest error and rms against the exact integral; then relMSE of the image with the table and our own cube,
under the first map. Our time is the difference of two bakes.""",
    "reference": """## Reference

CPU seconds until relMSE 1e-3 of a metal ball, GGX at alpha 0.2, 128x128, under the first map. Each renderer is compared with its own
image of many samples; start and compilation are excluded.""",
}
TARGET = 1e-3  # relMSE that references are timed to


def say(text):
    print(f"splitsum: {text}", flush=True)


def write(path, rows):
    with open(path, "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)
    return rows


def markdown(columns, rows):
    rule = ["---" if column in TEXTS else "---:" for column in columns]
    return "".join(f"| {' | '.join(map(str, row))} |\n" for row in [columns, rule, *rows])


def scores(program, files, map, flags):
    return json.loads(run(program, "check-bake", *files, "--environment", map, "--json", *flags)[1])


def bakes(program, bakers, maps, work):
    """A row a map, baker and level; and where each cube lies."""
    rows, files = [], {}
    for map in maps:
        for baker in bakers:
            seconds, file = baker.bake(map, work / f"{map.stem}-{baker.name}")
            files[map, baker] = file
            found = scores(program, [file], map, ["--preset", baker.preset])
            say(f"{map.stem}, {baker.name}: {seconds:.2f} CPU s")
            for level, score in enumerate(found["levels"]):
                said = {"environment": map.stem, "baker": baker.name, "version": baker.version, "cpu_s": f"{seconds:.3f}", "level": level}
                rows.append({**said, "size": score["size"][0], **{key: f"{score[key]:.4g}" for key in ("alpha", "relmse", "bias_rel")}})
    return rows, files


def images(program, experiment, bakers, maps, files, luts, work):
    """A row a map, cube, table and alpha: the error that the tables cause, beside the error of the split itself."""
    rows = []
    for map in maps:
        out = work / f"{map.stem}-images"
        cubes = {f"file:{files[map, baker]}#{baker.preset}": baker.name for baker in bakers if baker.name != "splitsum"}
        # Tables are of no map: one says it.
        of_map = luts if map == maps[0] else {}
        sets = [f"environment={map}", f"prefiltered={','.join(['own', *cubes])}", f"dfg={','.join(['own', *of_map])}"]
        sets += ["level_mapping=linear,quadratic", "prefilter_level_count=5,6,7"]
        run(program, "run", experiment, *(word for value in sets for word in ("--set", value)), "--out", out)
        with open(out / "errors.csv") as file:
            for row in csv.DictReader(file):
                baker = cubes.get(row["prefiltered"], OWN.get(f"{row['level_mapping']} {row['prefilter_level_count']}"))
                baker = SPLIT if row["method"] == "reference" else baker
                table = of_map.get(row["dfg"], "splitsum")
                if baker and (table == "splitsum" or baker == "splitsum"):
                    said = {"environment": map.stem, "prefiltered": baker, "dfg": table, "alpha": row["alpha"]}
                    rows.append({**said, "relmse": f"{float(row['relmse']):.4g}"})
        say(f"{map.stem}: images")
    return rows


def tables(program, work, cmgen, luts, map):
    """CPU seconds and errors of DFG tables of 256 x 256 with 1024 samples a texel."""
    costs = {"splitsum": []}
    for _ in range(ROUNDS):
        sets = ["brdf=ggx", "masking=correlated", "prefilter_size=16x16", "prefilter_level_count=2"]
        words = [word for value in sets for word in ("--set", value)]
        bake = lambda side: run(program, "bake", map, "--for", "raw", *words, "--set", f"dfg_size={side}", "--out", work / f"dfg-{side}")[0]
        costs["splitsum"].append(bake(256) - bake(2))
        if cmgen:
            costs.setdefault("cmgen", []).append(run(cmgen, "-q", "-s", 256, f"--ibl-dfg={work / 'dfg.exr'}")[0])
    rows = []
    for value, baker in {f"file:{work / 'dfg-256/dfg.exr'}#splitsum": "splitsum", **luts}.items():
        file, preset = value.removeprefix("file:").split("#")
        found = scores(program, [f"dfg={file}"], map, ["--preset", preset, "--masking", "correlated"])["dfg"]
        seconds = f"{median(costs[baker]):.3f}" if baker in costs else ""
        rows.append({"baker": baker, "cpu_s": seconds, "max_error": f"{found['max_error']:.3g}", "rms": f"{found['rms']:.3g}"})
    return rows


def ball(map, alpha, side):
    """A mirror of that width under a map, as `render` takes it."""
    return ["--size", f"{side}x{side}", "--environment", map, "--alpha", alpha, "--f0", 1, "--albedo", 0, "--diffuse", "none"]


def crossing(rows):
    """CPU seconds at TARGET, by the straight line between logarithms of the counts around it."""
    from math import exp, log
    for low, high in zip(rows, rows[1:]):
        if low["relmse"] >= TARGET >= high["relmse"]:
            part = log(low["relmse"] / TARGET) / log(low["relmse"] / high["relmse"])
            return exp(log(low["seconds"]) + part * log(high["seconds"] / low["seconds"]))
    raise RuntimeError(f"relMSE {TARGET} lies outside of {rows}")


def ours_to_target(program, work, map, mean):
    """The same of ours: each count costs its samples, without start and compilation."""
    sphere = [*ball(map, 0.2, 128), "--method", "reference"]
    file = lambda count: work / f"ball-{count}.exr"
    image = lambda count, seed=1: run(program, "render", *sphere, "--samples", count, "--seed", seed, "--out", file(count))[0]
    image(16384, 2)
    most, least = (median([image(count) for _ in range(3)]) for count in (2048, 64))
    rows = []
    for count in (32, 64, 128, 256):
        image(count)
        pair = [file(count), file(16384)]
        found = json.loads(run(program, "compare", *pair, "--environment-mean", mean, "--json")[1])
        rows.append({"seconds": (most - least) / (2048 - 64) * count, "relmse": found["relmse"]})
    return crossing(rows)


def references(given, mean):
    """A row a program: CPU seconds to TARGET."""
    map = given.maps[0]
    rows = [{"program": "splitsum", "cpu_s": f"{ours_to_target(given.program, given.work, map, mean):.3f}"}]
    if given.mitsuba:
        counts = [16, 64, 256]
        found = json.loads(run(given.mitsuba, HERE / "mitsuba_sphere.py", map, 0.2, 128, *counts)[1])
        rows.append({"program": f"Mitsuba {found['version']}, multijitter", "cpu_s": f"{crossing(found['rows']):.3f}"})
    return rows


def mean_luminance(work, map):
    with open(work / f"{map.stem}-images/environments.csv") as file:
        return next(csv.DictReader(file))["mean_luminance"]


def sheet(program, bakers, map, files, work, path):
    """Spheres under one map: a row an alpha, a column a baker."""
    from PIL import Image, ImageDraw
    alphas, side, top = [0.1, 0.25, 0.5, 1], 144, 18
    columns = [("exact tables", ["--method", "ladder-view", "--samples", 4096])]
    for baker in bakers:
        value = "own" if baker.name == "splitsum" else f"file:{files[map, baker]}#{baker.preset}"
        size = ["--prefilter-size", f"{SIDE}x{SIDE}", "--prefilter-level-count", LEVELS] if value == "own" else []
        columns.append((LABELS[baker.name], ["--method", "split-sum", "--prefiltered", value, *size]))
    whole = Image.new("RGB", (70 + (side + 4) * len(columns), top + (side + 4) * len(alphas)), "white")
    draw = ImageDraw.Draw(whole)
    for x, (name, flags) in enumerate(columns):
        draw.text((74 + (side + 4) * x, 3), name, fill="black")
        for y, alpha in enumerate(alphas):
            draw.text((4, top + (side + 4) * y + side // 2), f"alpha {alpha:g}", fill="black")
            out = work / "ball.png"
            run(program, "render", *ball(map, alpha, side), *flags, "--out", out)
            whole.paste(Image.open(out).convert("RGB"), (70 + (side + 4) * x, top + (side + 4) * y))
    whole.save(path, optimize=True)


def error(rows, **where):
    """The median relMSE of the rows that agree, as text."""
    found = [float(row["relmse"]) for row in rows if all(row[key] == value for key, value in where.items())]
    return f"{median(found):.1e}"


def bakes_page(bakers, rows, pictures, map):
    names = [baker.name for baker in bakers]
    lines = []
    for name in dict.fromkeys([*names, *OWN.values(), SPLIT]):
        mine = [row for row in rows if row["baker"] == name and row["level"] == 0]
        label = f"{LABELS[name]} {mine[0]['version']}" if mine else name
        seconds = f"{median(float(row['cpu_s']) for row in mine):.2g}" if mine else ""
        lines.append([label, seconds, *(error(pictures, prefiltered=name, dfg="splitsum", alpha=str(alpha)) for alpha in ALPHAS)])
    text = f"{TITLES['image']}\n\n{markdown(['baker', 'CPU s', *(f'alpha {alpha}' for alpha in ALPHAS)], lines)}\n"
    text += f"![Spheres by alpha and baker](bakes.png)\n\nSpheres under {map.stem}, f0 1. With exact tables only the split errs.\n\n"
    lines = []
    for name in names:
        for level in range(max(row["level"] for row in rows if row["baker"] == name) + 1):
            cells = [row for row in rows if row["baker"] == name and row["level"] == level]
            worst = max(cells, key=lambda row: float(row["relmse"]))
            biases = [100 * float(row["bias_rel"]) for row in cells]
            of_worst = f"{float(worst['relmse']):.1e} {worst['environment'].removesuffix('_1k')}"
            bias = f"{min(biases):+.1f} to {max(biases):+.1f} %"
            lines.append([LABELS[name], level, cells[0]["size"], cells[0]["alpha"], error(cells), of_worst, bias])
    columns = ["baker", "level", "side", "alpha", "relMSE, median", "of the worst map", "bias"]
    return text + f"{TITLES['level']}\n\n{markdown(columns, lines)}"


def speed_page(bakers, rows, pictures, dfg, timed):
    cost = {baker.name: [float(row["cpu_s"]) for row in rows if row["baker"] == baker.name and row["level"] == 0] for baker in bakers}
    lines = []
    for baker in bakers:
        seconds = cost[baker.name]
        ratios = [theirs / ours for theirs, ours in zip(seconds, cost["splitsum"])]
        version = next(row["version"] for row in rows if row["baker"] == baker.name)
        what = "whole process" if baker.is_whole else "the filter alone"
        spread = f"{min(seconds):.2f} to {max(seconds):.2f}"
        lines.append([f"{LABELS[baker.name]} {version}", baker.makes, what, f"{median(seconds):.2f}", spread, f"{median(ratios):.2g}"])
    columns = ["baker", "makes", "timed", "CPU s, median", "range", "over ours"]
    text = f"{TITLES['cost']}\n\n{markdown(columns, lines)}\n"
    lines = []
    for row in dfg:
        own = {"environment": rows[0]["environment"], "prefiltered": "splitsum", "dfg": row["baker"]}
        errors = [error(pictures, **own, alpha=str(alpha)) for alpha in ALPHAS]
        lines.append([LABELS[row["baker"]], *list(row.values())[1:], *errors])
    columns = ["baker", "CPU s", "largest error", "rms", *(f"alpha {alpha}" for alpha in ALPHAS)]
    text += f"{TITLES['dfg']}\n\n{markdown(columns, lines)}\n"
    return text + f"{TITLES['reference']}\n\n{markdown(['program', 'CPU s'], [list(row.values()) for row in timed])}"


def origin(maps):
    """When and where the figures were taken."""
    cpu = next((line.split(":")[1].strip() for line in open("/proc/cpuinfo") if line.startswith("model name")), "an unknown CPU")
    commit = subprocess.run(["git", "describe", "--always", "--dirty", "--abbrev=12"], capture_output=True, text=True).stdout.strip()
    named = ", ".join(map.stem.removesuffix("_1k") for map in maps)
    return f"{time.strftime('%Y-%m-%d', time.gmtime())}, commit {commit}, {cpu}. Maps: {named}.\n"


def publish(folder, title, text, maps):
    """The page of a folder: its hand-written remark, and the tables."""
    remark = folder / "remark.md"
    remark = f"{remark.read_text().strip()}\n\n" if remark.exists() else ""
    (folder / "README.md").write_text(f"# {title}\n\nWritten by `scripts/bench-peers.sh`.\n\n{remark}{text}\n{origin(maps)}")


def main():
    parser = argparse.ArgumentParser()
    for name in ("program", "experiment", "work", "out", "cmgen", "khronos", "modules", "chromium", "mitsuba"):
        parser.add_argument(f"--{name}", type=lambda text: text and pathlib.Path(text).absolute())
    parser.add_argument("--versions", default="")
    parser.add_argument("maps", nargs="+", type=lambda text: pathlib.Path(text).absolute())
    given = parser.parse_args()
    versions = dict(pair.split("=", 1) for pair in given.versions.split(",") if pair)
    bakers = [Splitsum(given.program)]
    if given.cmgen:
        bakers.append(Cmgen(given.cmgen, versions["cmgen"]))
    if given.khronos:
        bakers.append(Khronos(given.khronos, versions["khronos"]))
    if given.modules:
        bakers.append(Three(given.chromium, given.modules, given.work))
    try:
        rows, files = bakes(given.program, bakers, given.maps, given.work)
    finally:
        for baker in bakers:
            baker.close()
    bakes_folder, speed_folder = given.out / "bakes", given.out / "speed"
    for folder in (bakes_folder, speed_folder):
        folder.mkdir(parents=True, exist_ok=True)
    write(bakes_folder / "levels.csv", rows)
    # Each names its conventions as an experiment does.
    luts = {f"file:{files[given.maps[0], baker].parent / 'lut.png'}#khronos": "khronos" for baker in bakers if baker.name == "khronos"}
    if given.cmgen:
        run(given.cmgen, "-q", "-s", 256, f"--ibl-dfg={given.work / 'dfg.exr'}")
        luts[f"file:{given.work / 'dfg.exr'}#cmgen"] = "cmgen"
    pictures = write(bakes_folder / "images.csv", images(given.program, given.experiment, bakers, given.maps, files, luts, given.work))
    dfg = write(speed_folder / "dfg.csv", tables(given.program, given.work, given.cmgen, luts, given.maps[0]))
    timed = write(speed_folder / "references.csv", references(given, mean_luminance(given.work, given.maps[0])))
    publish(speed_folder, SPEED_TITLE, speed_page(bakers, rows, pictures, dfg, timed), given.maps)
    sheet(given.program, bakers, given.maps[0], files, given.work, bakes_folder / "bakes.png")
    publish(bakes_folder, BAKES_TITLE, bakes_page(bakers, rows, pictures, given.maps[0]), given.maps)
    say(f"tables are in {bakes_folder} and {speed_folder}")


if __name__ == "__main__":
    try:
        main()
    except RuntimeError as error:
        sys.exit(f"splitsum: {error}")
