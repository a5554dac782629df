#!/bin/sh
# cmgen of Filament 1.9.25 (Debian 12, libfilament-tools 1.9.25+dfsg2-10).
# Guess: row y of the DFG table of 128 rows holds the roughness of its centre, 1 - (y + .5) / 128, as its columns hold the
#   n.v of theirs; so a lookup at a roughness reads the albedo of that roughness.
# Seen: row y holds 1 - (y - .5) / 128, one row more. At n.v above .6 and roughness above .5 its albedos are .001 off
#   quadrature at most by that roughness, and .010 by that of the centre.
# Hurt: who looks the table up at centres, as Filament does, reads a surface 1/128 rougher than it is: a black dielectric
#   of roughness .7 is 1.2 % too dark. Who fits a formula to the table, or compares tables of two programs, has the shift too.
# Avoid: look up at a roughness 1/128 smaller, or compute the table elsewhere.
set -eu
t=$(mktemp -d)
trap 'rm -rf "$t"' EXIT
cd "$t"
command -v apt-get >/dev/null && command -v dpkg-deb >/dev/null || exit 77
mkdir debs
cd debs
apt-get -q download libfilament-tools=1.9.25+dfsg2-10 libfilament1.9=1.9.25+dfsg2-10 libtinyexr1d libastcenc3d \
    libstb0 libatomic1 libpng16-16 >/dev/null 2>&1 || exit 77
cd ..
for package in debs/*.deb; do dpkg-deb -x "$package" root; done
python3 -m pip -q --disable-pip-version-check install --root-user-action ignore --target p numpy==2.4.6 OpenEXR==3.4.13 || exit 77
LD_LIBRARY_PATH=$(find root -name '*.so*' -printf '%h\n' | sort -u | paste -sd:) root/usr/bin/cmgen -q -s 128 --ibl-dfg=dfg.exr >/dev/null || exit 77
PYTHONPATH=p python3 - <<'P'
import sys

import numpy as np
import OpenEXR

SIDE = 128
channels = OpenEXR.File("dfg.exr").channels()
table = np.asarray((channels.get("RGB") or channels["RGBA"]).pixels[..., :2], float)


def albedo(n_dot_v, roughness):
    """Of a white GGX surface, Smith's height-correlated masking: half vectors of density D n.h, at the centres of a grid."""
    alpha2 = roughness**4
    u, turn = np.meshgrid((np.arange(512) + 0.5) / 512, (np.arange(256) + 0.5) / 256 * np.pi)
    h = np.sqrt((1 - u) / (1 + (alpha2 - 1) * u))
    v_dot_h = np.sqrt((1 - n_dot_v**2) * (1 - h**2)) * np.cos(turn) + n_dot_v * h
    n_dot_l = 2 * v_dot_h * h - n_dot_v
    is_up = (n_dot_l > 0) & (v_dot_h > 0)
    masked = n_dot_v * np.sqrt(n_dot_l**2 * (1 - alpha2) + alpha2) + n_dot_l * np.sqrt(n_dot_v**2 * (1 - alpha2) + alpha2)
    weight = np.where(is_up, 2 * n_dot_l * v_dot_h / (h * np.where(is_up, masked, 1)), 0)
    return weight.mean()


def off(rows):
    """Largest difference of the table from albedos, where its own 1024 samples a texel leave .001: rows are shifted by so many."""
    texels = [(row, column) for row in range(4, 64, 6) for column in range(80, 128, 6)]
    pairs = [((column + 0.5) / SIDE, 1 - (row + 0.5 + rows) / SIDE) for row, column in texels]
    return max(abs(table[texel].sum() - albedo(*pair)) for texel, pair in zip(texels, pairs))


centre, above, two = off(0), off(-1), off(-2)
print(f"largest error of the albedo: {centre:.4f} by the roughness of a row's centre, {above:.4f} by that of one row more, {two:.4f} of two")
if not (above < 0.002 and min(centre, two) > 4 * above):
    sys.exit("CHANGED: rows are elsewhere")
print("still so: each row holds the roughness of the row above it")
P
