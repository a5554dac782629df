#!/bin/sh
# panda3d-simplepbr 0.13.1 with panda3d (PyPI): spherical harmonics of EnvMap, run on the CPU.
# Guess: nine coefficients hold a uniform white sky exactly: irradiance pi from every side.
# Seen: pi x 1.34 along Z, pi x .83 along X and Y: a white sphere under a white sky has a bright top
#   and bottom and dark sides. Directions of texels reach the basis without being normalized, so
#   cube corners weigh up to three times in the second band; a tilted sky (1 + x), whose
#   far side has irradiance pi/3, leaves almost none there (2 %). A smaller slip beside it: eight of
#   the nine coefficients get the cosine lobe's factor, the ninth (x2 - y2) does not.
# Hurt: all diffuse surfaces of Panda3D scenes lit by simplepbr's maps: they show a vertical
#   gradient that looks like light from the sky and is in no map.
# Avoid: fill sh_coefficients oneself from unit directions, or correct against a uniform map.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore \
    --target "$t/p" panda3d-simplepbr==0.13.1 panda3d==1.10.16 typing-extensions || exit 77
PYTHONPATH="$t/p" python3 - <<'P'
import math, struct, sys
from importlib.metadata import version
import panda3d.core as p3d
from simplepbr import EnvMap

print("panda3d-simplepbr", version("panda3d-simplepbr"), "panda3d", version("panda3d"))
n = 32

def direction(face, x, y):
    # OpenGL's cube; the pictures are stored bottom row first, as Panda3D keeps them.
    u, v = 2 * (x + 0.5) / n - 1, 2 * (y + 0.5) / n - 1
    d = [(1, -v, -u), (-1, -v, u), (u, 1, v), (u, -1, -v), (u, -v, 1), (-u, -v, -1)][face]
    norm = math.sqrt(sum(c * c for c in d))
    return [c / norm for c in d]

def irradiance(radiance):
    cube = p3d.Texture()
    cube.setup_cube_map(n, p3d.Texture.T_float, p3d.Texture.F_rgb32)
    values = [radiance(direction(f, x, y)) for f in range(6) for y in range(n) for x in range(n)]
    cube.set_ram_image(b"".join(struct.pack("3f", v, v, v) for v in values))
    sh = [c[0] for c in EnvMap(cube, prefiltered_size=16, prefiltered_samples=1,
                               blocking_prepare=True).sh_coefficients]
    def at(x, y, z):  # the formula of the package's own fragment shader
        basis = [0.282095, 0.488603 * x, 0.488603 * z, 0.488603 * y, 1.092548 * x * z,
                 1.092548 * y * z, 1.092548 * y * x, 0.946176 * z * z - 0.315392,
                 0.546274 * (x * x - y * y)]
        return sum(c * b for c, b in zip(sh, basis))
    return at

flat = irradiance(lambda d: 1.0)
names = {"+X": (1, 0, 0), "-X": (-1, 0, 0), "+Y": (0, 1, 0), "+Z": (0, 0, 1), "-Z": (0, 0, -1)}
ratios = {k: flat(*v) / math.pi for k, v in names.items()}
print("uniform sky, irradiance over pi:", {k: round(v, 3) for k, v in ratios.items()},
      "(expected 1)")
tilted = irradiance(lambda d: 1 + d[0])
far = tilted(-1, 0, 0) / (math.pi / 3)
print(f"sky of 1 + x from behind, over the exact pi/3: {far:.3f} (expected 1)")
if max(ratios.values()) < 1.1 or min(ratios.values()) > 0.95:
    sys.exit("CHANGED: a uniform sky gives uniform irradiance")
print(f"still so: a uniform sky lights from {min(ratios.values()):.2f} to "
      f"{max(ratios.values()):.2f} of its irradiance")
P
