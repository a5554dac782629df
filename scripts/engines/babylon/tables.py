"""Decodes the DFG tables of Babylon.js from its source: n.v to the right, roughness down. Arguments: brdfTextureTools.js FOLDER."""
import base64
import io
import pathlib
import re
import sys

import numpy as np
import OpenEXR
from PIL import Image

source, folder = pathlib.Path(sys.argv[1]).read_text(), pathlib.Path(sys.argv[2])
for name, constant in [("dfg", "_environmentBRDFBase64Texture"), ("openpbr", "_openPBREnvironmentBRDFBase64Texture")]:
    text = re.search(constant + r' = "data:image/png;base64,([^"]*)"', source)[1]
    texels = np.asarray(Image.open(io.BytesIO(base64.b64decode(text))).convert("RGBA"), np.float32) / 255
    # RGBD: fromRGBD of helperFunctions, whose power is 2.2.
    linear = texels[..., :3] ** 2.2 / np.maximum(texels[..., 3:], 1 / 255)
    OpenEXR.File({"type": OpenEXR.scanlineimage}, {"RGB": linear.astype(np.float32)}).write(str(folder / f"{name}.exr"))
