"""Writes the DFG table that SAPIEN 3.0.3 makes, FILE.exr: roughness to the right, n.v down.

Its shader, in libsvulkan2.so, has k = (roughness / 2)^2 in Schlick's masking: alpha/4, where the text that it follows has
alpha/2. Pictures in constant light confirm it. Arguments: FILE.exr.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import numpy as np
from dfg import pairs, write

SIDE = 128


def schlick(n_dot_l, n_dot_v, roughness):
    k = (roughness / 2) ** 2
    return 1 / ((n_dot_l * (1 - k) + k) * (n_dot_v * (1 - k) + k))


centres = (np.arange(SIDE) + 0.5) / SIDE
write(sys.argv[1], np.stack([pairs(n_dot_v, centres, schlick) for n_dot_v in centres]))
