"""Turns each PFM in FOLDER into linear EXR. Arguments: FOLDER."""
import pathlib
import sys

import numpy as np
import OpenEXR
from common import read_pfm

folder = pathlib.Path(sys.argv[1])
for path in sorted(folder.rglob("*.pfm")):
    image = read_pfm(path)
    if not np.isfinite(image).all():
        sys.exit(f"{path}: has values that are not finite")
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": image}).write(str(path.with_suffix(".exr")))
    path.unlink()
count = len(list(folder.rglob("*.exr")))
if not count:
    sys.exit(f"{folder.name}: no pictures")
print(f"{folder.name}: {count} pictures")
