#!/bin/sh
# skylibs 0.7.7 (PyPI, module envmap): EnvironmentMap.solidAngles() of the format "sphere".
# Guess: the solid angles of a mirror ball sum to 4 pi, with an error at the rim that shrinks with
#   the resolution (exactly 4 times a pixel's share of the unit disc, the same for every pixel).
# Seen: they sum to 1.77 times 4 pi at 64, 256 and 512 pixels alike. Inside all is right; pixels on
#   the rim have one corner outside the ball and get triangles across the whole sphere: up to 180
#   times their size at 512. A lamp behind the ball, moved from lat-long to "sphere" by
#   convertTo, has 30 times its light when it is summed with the class's own solid angles.
# Hurt: light probes from photographs of a chrome ball (the format's purpose): sums, mean colours,
#   SH and sun finding are dominated by the mirror image's least reliable pixels.
# Avoid: weigh mirror balls by the constant 4 (2/n)^2, or convert to "latlong" before summing
#   (its solid angles sum to 1.0000, those of "angular" to 1.0004).
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/p" skylibs==0.7.7 numpy==2.4.6 scipy==1.17.1 || exit 77
PYTHONPATH="$t/p" python3 - <<'P'
import sys, warnings
from importlib.metadata import version
warnings.simplefilter("ignore")
import numpy as np
from envmap import EnvironmentMap

print("skylibs", version("skylibs"))
sums = []
for n in (64, 256, 512):
    y, x = np.mgrid[0:n, 0:n]
    r = np.hypot(x + 0.5 - n / 2, y + 0.5 - n / 2) / (n / 2)
    omega = EnvironmentMap(np.ones((n, n, 3)), "sphere").solidAngles()
    each = 4 * (2 / n) ** 2
    sums.append(np.nansum(omega) / (4 * np.pi))
    print(f"{n} pixels: sum over 4 pi {sums[-1]:.3f} (expected 1), largest pixel "
          f"{np.nanmax(omega) / each:.0f} times its size (expected 1), inside r < .9 "
          f"{omega[r < 0.9].mean() / each:.4f}")
n = 128
sky = EnvironmentMap(np.ones((n, 2 * n, 3)), "latlong")
x, y, z, _ = sky.worldCoordinates()
lamps = {}
for name, toward in {"in front": -z, "right": x, "behind": z}.items():
    lamp = EnvironmentMap(np.exp(40 * (toward - 1))[..., None] * np.ones(3), "latlong")
    true = (lamp.data * lamp.solidAngles()[..., None]).sum()
    ball = lamp.copy().convertTo("sphere", n)
    lamps[name] = np.nansum(ball.data * ball.solidAngles()[..., None]) / true
    print(f"lamp {name}, lat-long to mirror ball: light x {lamps[name]:.2f} (expected 1.00)")
if min(sums) < 1.2 or lamps["behind"] < 5:
    sys.exit("CHANGED: the solid angles of a mirror ball sum to 4 pi")
print(f"still so: a mirror ball has {sums[-1]:.2f} times 4 pi, at every resolution")
P
