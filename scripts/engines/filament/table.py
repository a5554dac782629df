"""Writes the DFG table in Filament, FILE.exr: n.v to the right, roughness down and falling, as cmgen lays it out.

The roughness of row y of n is (n - y + 0.5)/n, ending at 1: one row more than its centre (CubemapIBL::DFG of libs/ibl), so a surface
reads A and B of a roughness 1/n larger. Arguments: FILE.exr.
"""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).parents[1]))
import numpy as np
from dfg import pairs, write

SIDE = 128


def smith(n_dot_l, n_dot_v, roughness):
    """Height-correlated."""
    a2 = roughness**4
    return 2 / (n_dot_v * np.sqrt(n_dot_l**2 * (1 - a2) + a2) + n_dot_l * np.sqrt(n_dot_v**2 * (1 - a2) + a2))


at = np.arange(SIDE)
roughness = np.minimum((SIDE - at + 0.5) / SIDE, 1)
write(sys.argv[1], np.stack([pairs(n_dot_v, roughness, smith) for n_dot_v in (at + 0.5) / SIDE], axis=1))
