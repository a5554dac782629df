"""Writes the maps as SAPIEN can hold them: FOLDER/dimmed/NAME.exr, divided by BRIGHTEST. Arguments: FOLDER."""
import pathlib
import sys

import numpy as np
import OpenEXR

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
from common import SAPIEN_BRIGHTEST

folder = pathlib.Path(sys.argv[1])
out = folder / "dimmed"
out.mkdir(exist_ok=True)
for path in sorted((folder / "maps").glob("*.exr")):
    image = OpenEXR.File(str(path)).channels()["RGB"].pixels
    dimmed = (image / SAPIEN_BRIGHTEST).astype(np.float32)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": dimmed}).write(str(out / path.name))
