"""Split sums for PyTorch: prefiltered levels and shading, differentiable in light, shape and material.

    levels = prefilter(environment, levels=6, size=(64, 64))
    radiance = shade(levels, n, v, roughness, f0, "split-sum-two", Tables(6))

Radiance is linear RGB of any scale, as float32 or float64, on any device with float64. Roughness is perceptual roughness:
alpha is its square. Needs torch 1.13 or later. Wrong input raises ValueError.
"""

try:
    import torch  # noqa: F401
except ImportError as error:
    raise ImportError("splitsum.torch needs PyTorch: install torch") from error

from .harmonics import spherical_harmonics
from .light import EnvironmentLight
from .prefiltering import prefilter
from .shading import LOOKUPS, Tables, prepare, shade

METHODS = tuple(LOOKUPS)

__all__ = ["METHODS", "EnvironmentLight", "Tables", "prefilter", "prepare", "shade", "spherical_harmonics"]
