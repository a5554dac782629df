#!/bin/sh
# flip-evaluator 1.7 (PyPI, NVIDIA's FLIP), HDR-FLIP with its automatic exposures.
# Guess: a pixel that is equal in both images adds no error, so one firefly shared by reference
#   and test can only lower the mean, by one pixel in 65536.
# Seen: it raises the mean by half or more, everywhere in the picture. The shortest exposure comes
#   from the brightest pixel of the reference; one sun, lamp or firefly adds many dark exposures,
#   and every other pixel keeps its worst error over all of them.
# Hurt: who compares FLIP means across scenes, or across references of other sample counts: a
#   reference with one firefly more makes the same renderer look half again as bad.
# Avoid: pass startExposure and stopExposure by hand, the same for all, and report them.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/p" flip-evaluator==1.7 numpy==2.4.6 || exit 77
PYTHONPATH="$t/p" python3 - <<'P'
import sys
from importlib.metadata import version
import numpy as np, flip_evaluator as flip

def run(ref, test, p=None):
    _, mean, used = flip.evaluate(ref.astype(np.float32), test.astype(np.float32), "HDR",
                                  inputsRGB=False, applyMagma=False, parameters=p or {})
    return mean, used

print("flip-evaluator", version("flip-evaluator"))
n = 256
y, x = np.mgrid[0:n, 0:n]
grey = 0.3 + 0.5 * x / n + 0.4 * np.sin(y / 9.0) ** 2
ref = grey[..., None] * np.array([1, 0.8, 0.6])
noise = np.random.default_rng(0).standard_normal((n, n, 1))
kinds = {"waves of 10 %": 1 + 0.1 * np.sin(x / 5.0)[..., None], "noise of 5 %": 1 + 0.05 * noise,
         "5 % too bright": 1.05}
ratios, fixed = [], []
for name, factor in kinds.items():
    a, b = ref.copy(), ref * factor
    mean, used = run(a, b)
    a[5, 5] = b[5, 5] = 1000.0
    hot, used_hot = run(a, b)
    p = {"startExposure": used["startExposure"], "stopExposure": used["stopExposure"]}
    by_hand, _ = run(a, b, p)
    ratios.append(hot / mean)
    fixed.append(by_hand / mean)
    print(f"{name}: mean {mean:.4f} ({used['numExposures']} exposures); with one equal pixel of "
          f"1000 {hot:.4f} ({used_hot['numExposures']}): x {hot / mean:.2f}, expected x 1.00; "
          f"with the first run's exposures x {by_hand / mean:.2f}")
if min(ratios) < 1.3 or not all(abs(f - 1) < 0.02 for f in fixed):
    sys.exit("CHANGED: one equal bright pixel no longer raises the mean by 30 %")
print("still so: one equal pixel raises HDR-FLIP by %.0f to %.0f %%"
      % (100 * min(ratios) - 100, 100 * max(ratios) - 100))
P
