"""Known maps, and the numbers that a right reader finds in them.

The marker has radiance R = 2 + x, G = 1 + y / 2, B = 1/2 + z / 4 from the direction (x, y, z), with y
up: a turned, mirrored, scaled or recoloured map has other numbers. The sun is a bright disc around
+x in a dark sky.
"""

import math
from dataclasses import dataclass

import numpy as np

WIDTH, HEIGHT = 256, 128
MEAN = np.array([2.0, 1.0, 0.5])
# Row c: the slopes of channel c along x, y and z.
SLOPES = np.diag([1.0, 0.5, 0.25])
SKY = 0.125


@dataclass
class Numbers:
    """Mean and slopes of a map, by channel: what nine spherical harmonics say of it."""

    mean: np.ndarray
    slopes: np.ndarray

    def __str__(self):
        slopes = [f"{'RGB'[c]}{'xyz'[i]} {value:.4g}" for (c, i), value in np.ndenumerate(self.slopes)
                  if abs(value) > 5e-4 * max(self.mean.max(), 1e-9)]
        return f"mean {' '.join(f'{value:.4g}' for value in self.mean)}, slopes {', '.join(slopes) or 0}"

    def difference(self, other):
        """The largest difference, in units of the brightest mean of `other`."""
        largest = max(np.abs(self.mean - other.mean).max(), np.abs(self.slopes - other.slopes).max())
        return largest / other.mean.max()

    def times(self, matrix):
        """The numbers after a matrix on colours, or after a factor."""
        matrix = np.eye(3) * matrix if np.isscalar(matrix) else matrix
        return Numbers(matrix @ self.mean, matrix @ self.slopes)


MARKER = Numbers(MEAN, SLOPES)


def directions(width=WIDTH, height=HEIGHT):
    """Directions of the texel centres of a lat-long map: the centre is +z, a quarter is +x."""
    v, u = np.mgrid[0:height, 0:width]
    theta, phi = np.pi * (v + 0.5) / height, 2 * np.pi * (0.5 - (u + 0.5) / width)
    return np.stack([np.sin(phi) * np.sin(theta), np.cos(theta), np.cos(phi) * np.sin(theta)], -1)


def marker(width=WIDTH, height=HEIGHT):
    return (MEAN + directions(width, height) @ SLOPES.T).astype(np.float32)


def lamps(width=WIDTH, height=HEIGHT):
    """Ten lamps of some degrees, one near each pole, on a dim sky: what mips that are too coarse blur."""
    k = np.arange(10)
    towards = np.stack([np.cos(2.4 * k), 0.9 - 0.2 * k, np.sin(2.4 * k)], -1)
    towards /= np.linalg.norm(towards, axis=-1, keepdims=True)
    to_sky = directions(width, height)
    glow = np.exp(200 * (to_sky @ towards.T - 1)).sum(-1)
    return (glow[..., None] * [40.0, 35.0, 30.0] + 1.8 + 1.2 * to_sky[..., 1:2]).astype(np.float32)


def sun(radiance=100000.0, sky=SKY, degrees=12.0):
    is_sun = directions() @ [1.0, 0.0, 0.0] > math.cos(math.radians(degrees))
    return np.where(is_sun[..., None], radiance, sky).astype(np.float32) * np.ones(3, np.float32)


def numbers_of(image):
    """Mean and slopes of a lat-long array, each texel a constant over its solid angle."""
    height, width = image.shape[:2]
    edges = np.cos(np.pi * np.arange(height + 1) / height)
    weights = ((edges[:-1] - edges[1:]) / (2 * width))[:, None] * np.ones(width)
    mean = np.einsum("vu,vuc->c", weights, image)
    slopes = 3 * np.einsum("vu,vui,vuc->ci", weights, directions(width, height), image)
    return Numbers(mean, slopes)
