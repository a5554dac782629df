"""Times two working trees against each other: `python3 scripts/bench_against.py BEFORE AFTER [ROW...]`.

scripts/bench-against.sh checks out the first. Every figure is of whole processes and all their children: user and system
seconds, seconds by the clock, and the largest process's peak memory. Medians over rounds; the ratio is the median of the
rounds' ratios, since a machine's speed drifts between rounds and hardly within one.
"""

import argparse
import csv
import os
import re
import shutil
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path
from typing import Callable

# What a run of one tree used, by the names below.
Usage = dict[str, float]
CPU, WALL, MEMORY = "CPU s", "wall s", "peak MB"
SAMPLED = "M samples a CPU s"


@dataclass
class Tree:
    """A checked-out commit with its release build."""

    root: Path
    scratch: Path
    prepared: set[str] = field(default_factory=set)

    @property
    def program(self) -> str:
        return str(self.root / "target/release/splitsum")

    def run(self, command: list[str], extra_environment: dict[str, str] | None = None) -> Usage:
        """Runs a command to its end; an error ends the script with the end of the command's output."""
        start = time.monotonic()
        log = self.scratch / "log.txt"
        environment = os.environ | (extra_environment or {})
        with log.open("w") as out:
            process = subprocess.Popen(
                command, cwd=self.root, stdin=subprocess.DEVNULL, stdout=out, stderr=subprocess.STDOUT, env=environment
            )
            _, status, used = os.wait4(process.pid, 0)
        wall = time.monotonic() - start
        if status != 0:
            sys.exit(f"{self.root}: {' '.join(command)} failed:\n" + "\n".join(log.read_text().splitlines()[-15:]))
        return {CPU: used.ru_utime + used.ru_stime, WALL: wall, MEMORY: used.ru_maxrss / 1024}

    def output(self) -> str:
        """What the last command printed."""
        return (self.scratch / "log.txt").read_text()

    def fresh(self, name: str) -> str:
        """A folder that does not exist yet."""
        folder = self.scratch / name
        shutil.rmtree(folder, ignore_errors=True)
        return str(folder)

    def splitsum(self, *arguments: str) -> Usage:
        return self.run([self.program, *arguments])


def experiment(name: str) -> Callable[[Tree], Usage]:
    """The experiment of that name, as each tree ships it, with nothing kept from before."""
    return lambda tree: tree.splitsum("run", f"experiments/{name}.toml", "--no-cache", "--out", tree.fresh(name))


def start(tree: Tree) -> Usage:
    """Start, device and pipelines: a picture of one pixel."""
    return tree.splitsum("render", "--size", "1x1", "--out", tree.fresh("start.exr"))


def integrate(tree: Tree) -> Usage:
    """Twelve queries in f64."""
    queries = tree.scratch / "queries.csv"
    with queries.open("w") as out:
        print("environment,brdf,alpha,f0,nx,ny,nz,vx,vy,vz", file=out)
        for alpha in (0.05, 0.2, 0.5, 1):
            for brdf in ("ggx", "beckmann", "phong"):
                print(f"builtin:studio,{brdf},{alpha},0.04,0,0.6,0.8,0,0,1", file=out)
    return tree.splitsum("integrate", str(queries), "--out", str(tree.scratch / "answers.csv"))


def reference(tree: Tree) -> Usage:
    """A sphere of 128x128 to a relative mean square error of 1e-3, by the program's own estimate."""
    surface = ["--alpha", "0.2", "--albedo", "0", "--f0", "1", "--environment", "builtin:studio", "--size", "128x128"]
    stop = ["--relative-error", "0.0316"]
    return tree.splitsum("render", "--method", "reference", *surface, *stop, "--out", tree.fresh("reference.exr"))


def bake(tree: Tree) -> Usage:
    """All tables of one model."""
    return tree.splitsum("bake", "builtin:studio", "--set", "brdf=ggx", "--out", tree.fresh("bake"))


def check_bake(tree: Tree) -> Usage:
    """A good cube of 256x256 texels a face."""
    folder = tree.scratch / "cube"
    if "cube" not in tree.prepared:
        shutil.rmtree(folder, ignore_errors=True)
        sizes = ["--set", "prefilter_size=256x256"]
        tree.splitsum("bake", "builtin:studio", "--for", "khronos", *sizes, "--out", str(folder))
        tree.prepared.add("cube")
    return tree.splitsum("check-bake", str(folder), "--environment", "builtin:studio")


def throughput(tree: Tree) -> Usage:
    """The bench's shading speed, GGX, N = 40."""
    if "bench" not in tree.prepared:
        tree.run(["cargo", "bench", "--locked", "--bench", "throughput", "--no-run"])
        tree.prepared.add("bench")
    tree.run(["cargo", "bench", "--locked", "--bench", "throughput", "--", "sampled"])
    speed = re.search(r"^sampled, ggx.*: ([0-9.]+) million samples", tree.output(), re.MULTILINE | re.IGNORECASE)
    if not speed:
        sys.exit(f"{tree.root}: the bench printed no speed:\n{tree.output()}")
    return {SAMPLED: float(speed.group(1))}


def build(tree: Tree) -> Usage:
    """The build of scripts/demo.sh into an empty folder."""
    target = tree.fresh("build")
    usage = tree.run(["cargo", "build", "--release", "--locked"], {"CARGO_TARGET_DIR": target})
    shutil.rmtree(target)
    return usage


def edit(tree: Tree) -> Usage:
    """A changed shader to its picture as CONTRIBUTING.md says: with a build of profile `edit`, or without one."""
    compile_ = ["cargo", "build", "--profile", "edit", "--locked", "--bin", "splitsum"]
    picture = [str(tree.root / "target/edit/splitsum"), "render", "--out", tree.fresh("edit.exr")]
    needs_build = not (tree.root / "src/cli/edited_shaders.rs").exists()
    if "edit" not in tree.prepared:
        tree.run(compile_)
        tree.prepared.add("edit")
    shader = tree.root / "shaders/brdf/ggx.glsl"
    unedited = shader.read_text()
    # No round finds the shader of an earlier one.
    shader.write_text(f"{unedited}// {time.time_ns()}\n")
    try:
        built = tree.run(compile_) if needs_build else {}
        drawn = tree.run(picture, {"SPLITSUM_SHADERS": "shaders"})
    finally:
        shader.write_text(unedited)
    return {figure: built.get(figure, 0) + drawn[figure] for figure in (CPU, WALL)}


def tests(tree: Tree) -> Usage:
    """README's test command after the build."""
    return tree.run(["sh", "scripts/test.sh"])


@dataclass
class Row:
    """A work to time, and the figures that are reported of it."""

    measure: Callable[[Tree], Usage]
    figures: tuple[str, ...] = (CPU,)
    rounds: int = 5


ROWS = {
    "quick": Row(experiment("quick"), (CPU, MEMORY), rounds=3),
    "start": Row(start),
    "integrate": Row(integrate),
    "reference": Row(reference),
    "bake": Row(bake),
    "check-bake": Row(check_bake),
    "throughput": Row(throughput, (SAMPLED,), rounds=3),
    "pictures": Row(experiment("pictures"), rounds=1),
    "front": Row(experiment("front"), rounds=1),
    "split-sums": Row(experiment("split-sums"), rounds=1),
    "build": Row(build, (CPU, WALL), rounds=1),
    "edit": Row(edit, rounds=3),
    "tests": Row(tests, (WALL,), rounds=1),
}
BY_DEFAULT = [name for name in ROWS if name not in ("build", "edit", "tests")]


def measure(name: str, rounds: int | None, trees: tuple[Tree, Tree]) -> list[dict[str, str]]:
    """Runs a row's rounds; returns a line per figure."""
    row = ROWS[name]
    count = rounds or row.rounds
    pairs: list[tuple[Usage, Usage]] = []
    for index in range(count):
        print(f"{name}: round {index + 1} of {count}", file=sys.stderr)
        before, after = trees
        if index % 2 == 0:
            first = row.measure(before)
            pairs.append((first, row.measure(after)))
        else:
            second = row.measure(after)
            pairs.append((row.measure(before), second))
    lines = []
    for figure in row.figures:
        befores, afters = ([usage[figure] for usage in side] for side in zip(*pairs))
        ratios = sorted(after / before for before, after in zip(befores, afters))
        lines.append(
            {
                "work": name,
                "figure": figure,
                "rounds": str(count),
                "before": f"{statistics.median(befores):.4g}",
                "after": f"{statistics.median(afters):.4g}",
                "ratio": f"{statistics.median(ratios):.3f}",
                "ratio_least": f"{ratios[0]:.3f}",
                "ratio_most": f"{ratios[-1]:.3f}",
            }
        )
    return lines


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("before", type=Path)
    parser.add_argument("after", type=Path)
    parser.add_argument("--rounds", type=int, help="rounds of each row, in place of its own number")
    parser.add_argument("--out", type=Path, help="write the table as CSV, too")
    parser.add_argument("rows", nargs="*", metavar="ROW", help=", ".join(ROWS))
    arguments = parser.parse_intermixed_args()
    unknown = [name for name in arguments.rows if name not in ROWS]
    if unknown:
        parser.error(f"{unknown[0]} is not a row; expected {', '.join(ROWS)}")
    if arguments.rounds is not None and arguments.rounds < 1:
        parser.error("--rounds takes a whole number from 1 on")
    with tempfile.TemporaryDirectory() as scratch:
        trees = []
        for name in ("before", "after"):
            folder = Path(scratch, name)
            folder.mkdir()
            trees.append(Tree(getattr(arguments, name).resolve(), folder))
        for tree in trees:
            print(f"building {tree.root}", file=sys.stderr)
            tree.run(["cargo", "build", "--release", "--locked"])
        lines = []
        for name in arguments.rows or BY_DEFAULT:
            for line in measure(name, arguments.rounds, (trees[0], trees[1])):
                if not lines:
                    print("| " + " | ".join(line) + " |")
                    print("|---" * 2 + "|---:" * (len(line) - 2) + "|")
                print("| " + " | ".join(line.values()) + " |", flush=True)
                lines.append(line)
    if arguments.out:
        with arguments.out.open("w", newline="") as out:
            writer = csv.DictWriter(out, lines[0])
            writer.writeheader()
            writer.writerows(lines)


if __name__ == "__main__":
    main()
