"""Finds how many samples a pixel sampling needs to beat a method: break_even.py [RUN] [METHOD].

The default is the published run of experiments/quick.toml and its split sum. For your own method (docs/own-method.md):

    splitsum run experiments/break-even.toml --set method=sampled,file:my.glsl --out runs/mine
    python python/examples/break_even.py runs/mine file:my.glsl
"""

import sys
from pathlib import Path

import matplotlib.pyplot as plt
import splitsum

quick = Path(__file__).parents[2] / "results" / "quick"
run = sys.argv[1] if len(sys.argv) > 1 else quick
method = sys.argv[2] if len(sys.argv) > 2 else "split-sum"
rows = splitsum.read_run(run)
rows = rows[
    (rows.scene == "design") & (rows.brdf == "ggx") & (rows.f0 == 1) & (rows.exposure == 1) & (rows.contrast == 1)
]
if not (rows.method == method).any():
    sys.exit(f"{run} has no method {method}; expected one of {', '.join(rows.method.unique())}")

# The mean over environments and point sets, by alpha; sampled methods also by samples.
errors = rows.groupby(["method", "alpha", "samples"], dropna=False).relmse.mean()
sampled = next(name for name in rows.method.unique() if name.startswith("sampled"))
for color, alpha in enumerate(sorted(rows.alpha.unique())):
    own = errors[method, alpha].iloc[0]
    curve = errors[sampled, alpha]
    # From the first count on which all larger counts win, too.
    loses = curve[curve >= own].index
    wins = curve.index[curve.index > (loses.max() if len(loses) else 0)]
    count = f"{wins.min():.0f}" if len(wins) else f"more than {curve.index.max():.0f}"
    print(f"alpha {alpha}: {count} samples")
    plt.loglog(curve.index, curve, marker="o", color=f"C{color}", label=f"alpha {alpha}")
    plt.axhline(own, color=f"C{color}", linestyle="--", linewidth=1)
    if len(wins):
        plt.plot(wins.min(), curve[wins.min()], marker="*", markersize=16, color=f"C{color}")
plt.xticks(curve.index, [f"{count:.0f}" for count in curve.index])
plt.minorticks_off()
plt.xlabel(f"samples per pixel ({sampled})")
plt.ylabel("relMSE")
plt.title(f"Sampling beats {method} (dashed) from the star on", fontsize="medium")
plt.legend()
plt.savefig("break_even.png")
