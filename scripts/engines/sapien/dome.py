"""Writes SAPIEN's default dome as it exports it, dome.ktx, and the light that its six images hold, dome.pfm.

Arguments: FOLDER, and the FOLDER of spheres.json.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import use_swiftshader, write_pfm

use_swiftshader("sapien")
import numpy as np
import sapien
from sapien.asset import create_dome_envmap

SIDE = 512
SKY, GROUND, BLEND = 0.6, 0.2, 0.3

folder = pathlib.Path(sys.argv[1])
sapien.render.set_camera_shader_dir("default")
sapien.Scene()
create_dome_envmap(str(folder / "dome.ktx"), [SKY] * 3, [GROUND] * 3, BLEND)
# As create_dome_envmap defines it: codes, by the elevation over BLEND radians on each side of the horizon.
elevation = np.pi * (0.5 - (np.arange(SIDE) + 0.5) / SIDE)
share = (elevation / BLEND).clip(-1, 1) * 0.5 + 0.5
codes = np.floor(255 * (GROUND + (SKY - GROUND) * share)) / 255
linear = np.where(codes <= 0.04045, codes / 12.92, ((codes + 0.055) / 1.055) ** 2.4)
write_pfm(folder / "dome.pfm", np.broadcast_to(linear[:, None, None], (SIDE, 2 * SIDE, 3)))
