"""Measures how time and memory grow with the number of cells: `python3 scripts/many_cells.py PROGRAM [CELLS...]`.

PROGRAM is a release build, `target/release/splitsum`. Each count runs an experiment of images of 16x16 pixels without
pictures: 15 sample counts and the split sum share a reference. Prints a row a count, a thousand cells as a default 4, 16
and 64: CPU seconds a thousand cells and peak memory of `run` without tables, of the same command again, of `merge`,
which writes tables and report, and of `plan --json`. docs/running.md has figures.
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

CELLS_A_REFERENCE = 16
DEFAULT_COUNTS = [4_000, 16_000, 64_000]

EXPERIMENT = """\
name = "many-cells"
asks = ["error"]
size = [16, 16]
scene = "design"
reference = {{ samples = 32, noise_share = 0 }}
[axes]
environment = ["builtin:gradient"]
brdf = ["ggx"]
f0 = [1]
alpha = {alphas}
method = ["sampled", "split-sum"]
samples = [1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15]
diffuse = ["none"]
albedo = [0]
[precompute]
prefilter_size = [16, 16]
prefilter_level_count = 2
dfg_size = 16
dfg_sample_count = 64
"""


def experiment(cells):
    widths = cells // CELLS_A_REFERENCE
    return EXPERIMENT.format(alphas=[0.1 + 0.9 * (k + 1) / widths for k in range(widths)])


def measured(command, folder):
    """CPU seconds and peak memory in MB of a command; its output goes to a file of the folder."""
    with open(folder / "output.txt", "w", encoding="utf-8") as output:
        process = subprocess.Popen(command, cwd=folder, stdout=output, stderr=subprocess.STDOUT)
        _, status, usage = os.wait4(process.pid, 0)
    if status != 0:
        sys.exit(f"{' '.join(command)}: exit status {os.waitstatus_to_exitcode(status)}")
    return usage.ru_utime + usage.ru_stime, usage.ru_maxrss / 1000


def row(program, cells):
    columns = [f"{cells:6}"]
    with tempfile.TemporaryDirectory(dir=".") as name:
        folder = Path(name)
        (folder / "many.toml").write_text(experiment(cells), encoding="utf-8")
        for arguments in [
            ["run", "many.toml", "--shard", "1/1", "--out", "part", "--no-cache"],
            ["run", "many.toml", "--shard", "1/1", "--out", "part", "--no-cache"],
            ["merge", "part"],
            ["plan", "many.toml", "--json"],
        ]:
            seconds, megabytes = measured([program, *arguments], folder)
            columns.append(f"{seconds * 1000 / cells:9.2f} s {megabytes:5.0f} MB")
    return " | ".join(columns)


def main():
    if len(sys.argv) < 2 or not all(count.isdigit() for count in sys.argv[2:]):
        sys.exit(__doc__)
    program = str(Path(sys.argv[1]).resolve())
    print("cells  | run, per thousand   | again               | merge               | plan --json", flush=True)
    for cells in [int(count) for count in sys.argv[2:]] or DEFAULT_COUNTS:
        print(row(program, cells), flush=True)


if __name__ == "__main__":
    main()
