"""Compares the pictures of run.sh with `reference` and with our model of each engine; writes results/engines.

Arguments: FOLDER of run.sh, --splitsum PROGRAM, --out DIR. Pictures of splitsum are kept in FOLDER/ours and reused.
With --keep, rows of DIR stay whose engine, material and map have no picture in FOLDER. With --picture, DIR/spheres.png alone is written.
With --check PERCENT in place of --out it fails if the mean of a picture is further from its model, or a pixel in the mean
by eight times as much.
"""
import argparse
import csv
import hashlib
import json
import pathlib
import statistics
import subprocess
import sys

import matplotlib
import numpy as np
import OpenEXR

matplotlib.use("Agg")
from matplotlib import pyplot

EXTENT = 1.05
# Relative standard error of a pixel of the reference.
REFERENCE_ERROR = 0.01
# Pixels this near to the outline are left out: engines draw a mesh there, and some of them a part of a pixel.
EDGE = 1.25

# For each engine: its package; the flags that its BRDF shares with the reference; the flags of our model of it, and with exact maps
# if its levels are for other widths than it reads; flags of a material's model; its weight of irradiance over pi, if that is not the
# light that the specular term leaves, and whether that weight reads the table of A and B; and the materials for which we have no
# model. Tables of A and B are in FOLDER. SAPIEN's and Filament's are computed as they compute them.
COMPUTED = {name: f"{name}-table.exr" for name in ("sapien", "filament")}
# A lobe of two widths has no masking by Schlick's fit, but a table may.
SCHLICK = "schlick-table/dfg.exr"
# Babylon.js' own, of 8 bits; run.sh decodes them from the package that it draws with.
BABYLON, OPENPBR = "babylon-tables/dfg.exr", "babylon-tables/openpbr.exr"
TABLES = [*COMPUTED.values(), SCHLICK, BABYLON, OPENPBR]
HERE = pathlib.Path(__file__).parent
CUBE = "--prefilter-size 256x256 --prefilter-level-count 6 --diffuse irradiance-map"
ENGINES = {
    "mitsuba": {"title": "Mitsuba 3.9.1", "brdf": "--masking separable", "widths": "disney"},
    "cycles": {"title": "Cycles (Blender 5.2.3)", "brdf": "--masking correlated", "widths": "disney"},
    "three": {
        "title": "three.js 0.187.0", "brdf": "--masking correlated --compensation fdez-aguera", "widths": "gltf",
        "model": f"--method split-sum-filament {CUBE} --level-mapping quadratic --dfg centres --dfg-size 16",
        "bend": "--bend three", "coat": "--coat-renderer three",
    },
    "babylon": {
        "title": "Babylon.js 9.35.0", "brdf": "--masking correlated --compensation turquin", "widths": "gltf",
        "model": f"--method split-sum-babylon {CUBE.replace('irradiance-map', 'sh9')} --dfg file:{BABYLON}#{HERE}/babylon/table.toml",
        "coat": "--coat-renderer babylon", "lacks": ["anisotropic"], "irradiance_weight": f"file:{HERE}/babylon/irradiance.glsl",
    },
    "openpbr": {
        "title": "Babylon.js 9.35.0, OpenPBR", "brdf": "--masking correlated --compensation turquin", "widths": "openpbr",
        "model": f"--method file:{HERE}/openpbr/model.glsl {CUBE.replace('irradiance-map', 'sh9')} --dfg file:{OPENPBR}#{HERE}/babylon/table.toml",
        "anisotropic": f"file:{HERE}/openpbr/anisotropic.glsl", "coat": "--coat-renderer openpbr",
        "under_coat": lambda base, coat: min(base**4 + 2 * coat**4, 1) ** 0.25,
    },
    "playcanvas": {
        "title": "PlayCanvas 2.23.3", "brdf": "--masking correlated", "widths": "gltf",
        "model": f"--method split-sum-playcanvas {CUBE}",
        "bend": "--bend playcanvas", "coat": "--coat-renderer khronos", "lacks": ["anisotropic"],
        "irradiance_weight": f"file:{HERE}/babylon/irradiance.glsl",
    },
    "filament": {
        "title": "Filament (Open3D 0.20.0)", "brdf": "--masking correlated --compensation turquin", "widths": "kulla",
        "model": f"--method split-sum-filament {CUBE.replace('irradiance-map', 'sh9').replace('count 6', 'count 5')} --level-mapping quadratic --dfg file:{COMPUTED['filament']}#cmgen",
        "coat": "--coat-renderer filament",
    },
    "vtk": {
        "title": "VTK 9.7.1", "brdf": "--masking schlick --compensation fdez-aguera", "widths": "disney",
        "model": f"--method split-sum-vtk {CUBE.replace('irradiance-map', 'sh9')}", "coat": "--coat-renderer vtk",
        "anisotropic": f"file:{HERE}/vtk/anisotropic.glsl", "irradiance_weight": f"file:{HERE}/vtk/irradiance.glsl",
        "weight_reads_table": True,
    },
    "f3d": {
        "title": "F3D 4.0.0", "brdf": "--masking schlick --compensation fdez-aguera",
    },
    "sapien": {
        "title": "SAPIEN 3.0.3", "brdf": "--masking schlick",
        "model": f"--method file:{HERE}/sapien/model.glsl {CUBE.replace('irradiance-map', 'none').replace('count 6', 'count 5')} --dfg file:{COMPUTED['sapien']}#sapien",
        "exact": f"--method split-sum {CUBE.replace('irradiance-map', 'none')} --dfg file:{COMPUTED['sapien']}#sapien",
    },
    "materialx": {"title": "MaterialX 1.39.5", "brdf": "--masking correlated --compensation turquin", "widths": "gltf"},
    "eevee": {"title": "EEVEE (Blender 5.2.3)", "brdf": "--masking correlated --compensation cycles"},
}
# It shades with VTK's code.
ENGINES["f3d"] |= {key: ENGINES["vtk"][key] for key in ("model", "irradiance_weight", "weight_reads_table")}
EXPLAINED = ["metal", "plastic", "coated"]
PAGE = """# Spheres in real engines

Written by `scripts/engines/compare.py` from pictures of `scripts/engines/run.sh` ([how each engine runs](../../scripts/engines/README.md)).

{remark}
## How far from the truth, and why

Percent rms, medians over roughness. Metal, plastic and coated: pictures under the marker and the studio. *Lookup*: our model of the engine, with
exact maps, to the truth. *Bake*: the picture to our model, where the engine's maps alone differ. Both of metals. *Factors*: metals and black
dielectrics in constant light, where no lookup errs: the table of A and B, and the formula around it.

{answer}

## By engine

Medians over the maps but `constant`, and over roughness; rms is the root of relMSE. *Truth*: `reference` with the masking, compensation and
layering (`khr`) that the engine's material follows, at {error} % standard error a pixel. *Our model*: `splitsum render` with the engine's lookup, factors and
table size, and exact maps. So the difference between model and truth is the engine's lookup and factors, the difference between picture and model its bake
and whatever our model misses. Pixels of the outline are left out. All rows: [spheres.csv](spheres.csv), for constant light too.

{table}

## Our bakes in the engine

The same engine under its own bake and under one of `splitsum bake --for`, with as many texels ([bakes.csv](bakes.csv), written by
`scripts/engines/gain.py`): metals of roughness 0.3, 0.5 and 0.7, geometric means, percent rms. *Exact maps*: the engine's lookup and factors with exact
maps, so what is left is the bake. *Factor*: relMSE with its own bake over relMSE with ours.

{bakes}
![Metal spheres by engine and roughness](spheres.png)

A metal of F0 1, 0.5, 0.2 under `studio`. The last row is the reference with `--compensation turquin`; Mitsuba, Cycles and PlayCanvas scatter once.
"""


def read(path):
    channels = OpenEXR.File(str(path)).channels()
    return np.array((channels.get("RGB") or channels["RGBA"]).pixels[..., :3], np.float64)


class Ours:
    """Pictures of `splitsum render`, kept under the hash of their flags, of the files in them, and of the map."""

    def __init__(self, program, folder, size):
        self.program, self.folder, self.size = program, folder / "ours", size
        self.maps = folder / "maps"
        self.folder.mkdir(exist_ok=True)
        for name, file in COMPUTED.items():
            if not (folder / file).exists():
                subprocess.run([sys.executable, HERE / name / "table.py", folder / file], check=True)
        table = self.folder.parent / SCHLICK
        if not table.exists():
            settings = ["masking=schlick", "prefilter_size=8x8", "prefilter_level_count=2", "dfg_size=128"]
            command = [program, "bake", "builtin:constant", "--for", "raw", "--out", table.parent]
            subprocess.run(command + [part for setting in settings for part in ("--set", setting)], check=True, stdout=subprocess.DEVNULL)

    def picture(self, sphere, flags):
        for name in TABLES:
            flags = flags.replace(f"file:{name}", f"file:{self.folder.parent / name}")
        flags = f"{flags} --size {self.size}x{self.size} --perceptual-roughness {sphere['roughness']}".split()
        light = self.maps / f"{sphere['map']}.exr"
        named = [flag.removeprefix("file:").split("#")[0] for flag in flags if flag.startswith("file:")]
        files = [path.read_bytes() for path in map(pathlib.Path, named) if path.is_file()]
        key = hashlib.sha256(b"".join([json.dumps(flags).encode(), light.read_bytes(), *files])).hexdigest()[:24]
        path = self.folder / f"{key}.exr"
        if not path.exists():
            command = [self.program, "render", *flags, "--environment", str(light), "--out", str(path)]
            done = subprocess.run(command, capture_output=True, text=True)
            if done.returncode:
                raise SystemExit(f"{' '.join(command)}\n{done.stderr}")
        return read(path)


def surface(sphere, engine):
    """Flags of the material."""
    colors = ",".join(map(str, sphere["base_color"]))
    flags = f"--metallic {sphere['metallic']} --albedo {colors} {engine['brdf']}"
    if "anisotropy" in sphere:
        # Schlick's masking is a fit for lobes of one width.
        flags = flags.replace("--masking schlick", "--masking correlated")
        flags += f" --anisotropy {sphere['anisotropy']} --anisotropy-widths {engine['widths']}"
    if "coat" in sphere:
        flags += f" --coat {sphere['coat']} --coat-perceptual-roughness {sphere['coat_roughness']}"
    return flags


def reference(ours, sphere, engine):
    has_diffuse = sphere["material"] == "plastic" or "fdez" in engine["brdf"]
    flags = f"--method reference --relative-error {REFERENCE_ERROR} --samples 65536 --diffuse {'reference' if has_diffuse else 'none'}"
    return ours.picture(sphere, f"{flags} {surface(sphere, engine)}")


def model(ours, sphere, engine):
    """Our picture of the engine's, or None if we have no model."""
    if "model" not in engine or sphere["material"] in engine.get("lacks", []):
        return None
    return lookup(ours, sphere, engine, engine["model"])


def lookup(ours, sphere, engine, flags):
    """Our picture by these flags of a method and its maps."""
    table = ""
    if "anisotropy" in sphere:
        method = flags.split()[1]
        bent = engine.get("anisotropic", "split-sum-bent")
        flags = f"{flags.replace(method, bent)} {engine.get('bend', '')}"
        if "schlick" in engine["brdf"]:
            table = f" --dfg file:{SCHLICK}#vtk"
    if "coat" in sphere:
        flags += f" {engine['coat']}"
        if "under_coat" in engine:
            sphere = {**sphere, "roughness": engine["under_coat"](sphere["roughness"], sphere["coat_roughness"])}
    elif "irradiance_weight" in engine:
        return specular_and_irradiance(ours, sphere, engine, flags + table)
    return ours.picture(sphere, f"{flags}{table} {surface(sphere, engine)}")


def specular_and_irradiance(ours, sphere, engine, flags):
    """The sum of two terms: the lookup alone, and irradiance over pi times the engine's own weight of it."""
    diffuse = flags.split("--diffuse ")[1].split()[0]
    flags = flags.replace(f"--diffuse {diffuse}", "--diffuse none")
    # This compensation adds irradiance, which is in the weight.
    lobe = ours.picture(sphere, f"{flags} {surface(sphere, engine).replace('--compensation fdez-aguera', '')}")
    table = flags[flags.index("--dfg"):] if "weight_reads_table" in engine and "--dfg file" in flags else ""
    plain = {**engine, "brdf": engine["brdf"].split("--compensation")[0]}
    weight = ours.picture(sphere, f"--method {engine['irradiance_weight']} --diffuse none {table} {surface(sphere, plain)}")
    irradiance = ours.picture(sphere, f"--method none --diffuse {diffuse} --albedo 1 --metallic 0")
    return lobe + weight * irradiance


def mean_luminance(path):
    image = read(path)
    weights = np.sin((np.arange(len(image)) + 0.5) / len(image) * np.pi)
    return np.average(image.mean(axis=1) @ [0.2126, 0.7152, 0.0722], weights=weights)


def inner(size):
    at = ((np.arange(size) + 0.5) / size * 2 - 1) * EXTENT
    return np.hypot(*np.meshgrid(at, at)) < 1 - EDGE * 2 * EXTENT / size


def scores(found, truth, mean):
    """Ratio of the means, and relMSE as in docs/conventions.md."""
    return found.mean() / truth.mean(), np.mean((found - truth) ** 2 / (truth**2 + 0.01 * mean**2))


def compare(folder, program, names, with_reference):
    listed = json.loads((folder / "spheres.json").read_text())
    ours, mask = Ours(program, folder, listed["size"]), inner(listed["size"])
    means = {name: mean_luminance(folder / "maps" / f"{name}.exr") for name in listed["maps"]}
    rows = []
    for name, engine in [(name, ENGINES[name]) for name in names]:
        for sphere in listed["spheres"]:
            path = folder / name / f"{sphere['name']}.exr"
            if not path.exists():
                continue
            found, mean = read(path)[mask], means[sphere["map"]]
            modelled = model(ours, sphere, engine)
            row = {"engine": name, "version": engine["title"], **{key: sphere[key] for key in ("material", "map", "roughness")}}
            pairs = {}
            if modelled is not None:
                pairs["_to_model"] = (found, modelled[mask])
            if with_reference:
                truth = reference(ours, sphere, engine)[mask]
                pairs[""] = (found, truth)
                if modelled is not None:
                    pairs["_of_model"] = (modelled[mask], truth)
            for suffix in ("", "_to_model", "_of_model"):
                ratio, relmse = scores(*pairs[suffix], mean) if suffix in pairs else (None, None)
                row |= {f"mean_ratio{suffix}": ratio, f"relmse{suffix}": relmse}
            rows.append(row)
        print(f"compared {name}", flush=True)
    return rows


def with_kept(rows, path):
    """Adds the rows of the file that are of other engines, materials or maps; sorts by ENGINES."""
    keys = ("engine", "material", "map")
    drawn = {tuple(row[key] for key in keys) for row in rows}
    with open(path, newline="") as file:
        kept = [row for row in csv.DictReader(file) if tuple(row[key] for key in keys) not in drawn]
    names = ("engine", "version", "material", "map")
    kept = [{key: value if key in names else float(value) if value else None for key, value in row.items()} for row in kept]
    return sorted([*kept, *rows], key=lambda row: list(ENGINES).index(row["engine"]))


def check(rows, percent):
    """Prints a line a picture that has a model; returns whether all are close to it. A turned or mirrored map, another scale
    or another SH moves a picture by far more."""
    passed = True
    for row in [row for row in rows if row["mean_ratio_to_model"] is not None]:
        off, rms = 100 * abs(row["mean_ratio_to_model"] - 1), 100 * row["relmse_to_model"] ** 0.5
        is_close = off <= percent and rms <= 8 * percent
        passed &= is_close
        what = f"{row['version']}: {row['map']}, {row['material']}, roughness {row['roughness']:g}"
        print(f"{'PASSED' if is_close else 'FAILED'} {what}: mean {off:.2f} % off, {rms:.1f} % rms")
    return passed


def text(value):
    return "" if value is None else f"{value:.5g}" if isinstance(value, float) else str(value)


def percent(values):
    if not values:
        return ""
    value = 100 * statistics.median(values)
    return f"{value:.2g}" if value < 99.5 else f"{value:.0f}"


# The columns of answer.csv after engine and version: rms in percent, medians over roughness. `lookup` is of our model to the truth,
# `bake` of the picture to our model, both of metals under lit maps; `factors` of the picture to the truth in constant light, where every
# lookup is right: the table of A and B and the formula around it.
ANSWER = EXPLAINED + ["lookup", "bake", "factors"]


def answer(rows):
    """What answer.csv says of each engine."""
    found = []
    for name, engine in ENGINES.items():
        own = [row for row in rows if row["engine"] == name]
        if not own:
            continue
        lit = [row for row in own if row["map"] != "constant"]
        metals = [row for row in lit if row["material"] == "metal"]
        chosen = {material: ("relmse", [row for row in lit if row["material"] == material]) for material in EXPLAINED}
        chosen |= {"lookup": ("relmse_of_model", metals), "bake": ("relmse_to_model", metals)}
        plain = [row for row in own if row["map"] == "constant" and row["material"] in ("metal", "dielectric")]
        chosen["factors"] = ("relmse", plain)
        shares = {
            column: percent([row[key] ** 0.5 for row in part if row[key] is not None]) for column, (key, part) in chosen.items()
        }
        found.append({"engine": name, "version": engine["title"], **shares})
    return found


def answer_table(rows):
    """Markdown of answer.csv."""
    lines = [f"| engine | {' | '.join(ANSWER)} |", "|---|" + "---:|" * len(ANSWER)]
    lines += [f"| {line['version']} | {' | '.join(line[column] for column in ANSWER)} |" for line in answer(rows)]
    return "\n".join(lines)


def table(rows):
    """Markdown: a line an engine and material, under lit maps."""
    lines = ["| engine | material | rms to the truth | of it our model has | rms to our model | mean ratio to our model |", "|---|---|---:|---:|---:|---|"]
    for name, engine in ENGINES.items():
        for material in EXPLAINED:
            own = [row for row in rows if row["engine"] == name and row["material"] == material and row["map"] != "constant"]
            if not own:
                continue
            rms = [percent([row[key] ** 0.5 for row in own if row[key] is not None]) for key in ("relmse", "relmse_of_model", "relmse_to_model")]
            ratios = [row["mean_ratio_to_model"] for row in own if row["mean_ratio_to_model"] is not None]
            span = f"{min(ratios):.3f} to {max(ratios):.3f}" if ratios else ""
            lines.append(f"| {engine['title']} | {material} | {' | '.join(rms)} | {span} |")
    return "\n".join(lines)


def picture(folder, program, out):
    """A metal under the studio: a row an engine, a column a roughness, the reference last."""
    listed = json.loads((folder / "spheres.json").read_text())
    ours = Ours(program, folder, listed["size"])
    spheres = [sphere for sphere in listed["spheres"] if sphere["map"] == "studio" and sphere["material"] == "metal"]
    names = [name for name in ENGINES if (folder / name).exists()]
    # Columns that most engines have.
    count = {sphere["name"]: sum((folder / name / f"{sphere['name']}.exr").exists() for name in names) for sphere in spheres}
    spheres = [sphere for sphere in spheres if 2 * count[sphere["name"]] > len(names)]
    if not spheres:
        return
    columns, edge = len(spheres), 1.6
    figure, axes = pyplot.subplots(len(names) + 1, columns, figsize=(edge * columns + 1.2, edge * (len(names) + 1)), squeeze=False)
    shown = {"brdf": "--masking correlated --compensation turquin", "widths": "gltf"}
    for line, name in zip(axes, [*names, None]):
        for axis, sphere in zip(line, spheres):
            axis.set(xticks=[], yticks=[])
            axis.spines[:].set_visible(False)
            path = folder / str(name) / f"{sphere['name']}.exr"
            if name is None or path.exists():
                image = reference(ours, sphere, shown) if name is None else read(path)
                axis.imshow((image / (1 + image)).clip(0, 1) ** (1 / 2.2))
        line[0].set_ylabel("reference" if name is None else ENGINES[name]["title"].replace(" (", "\n(").replace(", ", ",\n"), fontsize=8)
    for axis, sphere in zip(axes[0], spheres):
        axis.set_title(f"roughness {sphere['roughness']:g}", fontsize=8)
    figure.subplots_adjust(wspace=0.02, hspace=0.02)
    figure.savefig(out, dpi=80, bbox_inches="tight")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--splitsum", required=True)
    wanted = parser.add_mutually_exclusive_group(required=True)
    wanted.add_argument("--out", type=pathlib.Path)
    wanted.add_argument("--check", type=float, metavar="PERCENT")
    parser.add_argument("--engine", action="append", choices=ENGINES, help="these alone")
    parser.add_argument("--keep", action="store_true", help="keep the rows in --out that are not compared")
    parser.add_argument("--picture", action="store_true", help="write spheres.png alone")
    arguments = parser.parse_args()
    if arguments.picture:
        picture(arguments.folder, arguments.splitsum, arguments.out / "spheres.png")
        return
    rows = compare(arguments.folder, arguments.splitsum, arguments.engine or list(ENGINES), arguments.check is None)
    if not rows:
        parser.error(f"{arguments.folder} has no pictures: run scripts/engines/run.sh first")
    if arguments.check is not None:
        raise SystemExit(not check(rows, arguments.check))
    arguments.out.mkdir(parents=True, exist_ok=True)
    if arguments.keep:
        rows = with_kept(rows, arguments.out / "spheres.csv")
    with open(arguments.out / "spheres.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, rows[0].keys(), lineterminator="\n")
        writer.writeheader()
        writer.writerows({key: text(value) for key, value in row.items()} for row in rows)
    with open(arguments.out / "answer.csv", "w", newline="") as file:
        writer = csv.DictWriter(file, ["engine", "version", *ANSWER], lineterminator="\n")
        writer.writeheader()
        writer.writerows(answer(rows))
    kept = {name: arguments.out / f"{name}.md" for name in ("remark", "bakes")}
    texts = {name: path.read_text() if path.exists() else "" for name, path in kept.items()}
    page = PAGE.format(**texts, answer=answer_table(rows), table=table(rows), error=f"{100 * REFERENCE_ERROR:g}")
    (arguments.out / "README.md").write_text(page)
    if not arguments.keep:
        picture(arguments.folder, arguments.splitsum, arguments.out / "spheres.png")


if __name__ == "__main__":
    main()
