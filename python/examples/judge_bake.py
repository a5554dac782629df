"""Judges a bake: judge_bake.py MAP FILES...; without arguments it makes two bakes and judges them."""

import sys
import tempfile
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np
import splitsum


def make_bake(folder, environment, alphas):
    """Writes levels of these widths, each a file with six faces below each other."""
    levels = splitsum.prefilter(environment, alphas, size=(64, 64))
    paths = [Path(folder, f"level{k}.exr") for k in range(len(levels))]
    for path, level in zip(paths, levels):
        splitsum.write_exr(path, level)
    return paths


def judge(environment, bakes):
    """Judges bakes by name, in the conventions of `splitsum bake`, and prints what is wrong."""
    scores = {}
    for name, files in bakes.items():
        scores[name] = splitsum.check_bake(files, environment, "splitsum")
        print(f"{name}: {scores[name]['verdict']}")
        for k, level in enumerate(scores[name]["levels"]):
            print(f"    level {k}, alpha {level['alpha']:.3f}: {level['verdict']}")
    return scores


def draw(scores, path):
    for name, score in scores.items():
        rms = [100 * np.sqrt(level["relmse"]) for level in score["levels"]]
        plt.semilogy(rms, marker="o", label=name)
    plt.axhline(3, color="black", linestyle=":", label="good: below 3 %")
    plt.xticks(range(max(len(score["levels"]) for score in scores.values())))
    plt.xlabel("level of the prefiltered map")
    plt.ylabel("error, % rms")
    plt.title("; ".join(f"{name}: {score['verdict'].split(':')[0].split(',')[0]}" for name, score in scores.items()))
    plt.legend()
    plt.savefig(path)


if len(sys.argv) > 2:
    scores = judge(sys.argv[1], {"bake": sys.argv[2:]})
else:
    roughness = np.linspace(0, 1, 5)
    with tempfile.TemporaryDirectory() as right, tempfile.TemporaryDirectory() as wrong:
        bakes = {
            "alpha = roughness²": make_bake(right, "builtin:studio", roughness**2),
            "alpha = roughness": make_bake(wrong, "builtin:studio", roughness),
        }
        scores = judge("builtin:studio", bakes)
draw(scores, "judge_bake.png")
