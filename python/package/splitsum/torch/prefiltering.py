"""The levels of a prefiltered map as a differentiable function of the environment."""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache

import numpy as np
import torch
from torch import Tensor

from .. import Mapping, _level_alphas, _native
from . import checks
from .harmonics import SmoothMap, analyse, synthesise
from .maps import Levels, equirect_uv, texel_directions

DEGREE_MAX = 1024
"""Highest degree of a map's coefficients."""


class FilteredMap(list):
    """The levels of a map, finest first, with the alpha of each, so that `shade` refuses tables of other levels."""

    def __init__(self, levels: Sequence[Tensor], alphas: Sequence[float]):
        super().__init__(levels)
        self.alphas = tuple(alphas)


def prefilter(
    environment: Tensor,
    alphas: float | Sequence[float] | None = None,
    *,
    levels: int | None = None,
    mapping: Mapping = "linear",
    layout: str = "cube",
    size: tuple[int, int] | Sequence[tuple[int, int]] | None = None,
    model: str = "ggx",
    weight: str = "cosine",
    masking: str = "separable",
    degree: int = DEGREE_MAX,
) -> FilteredMap:
    """Averages an environment over lobes of the widths `alphas`, without noise; the levels are linear in the environment.

    `environment` is equirectangular, a tensor (h, w, 3), or a cube (6, s, s, 3) with the faces +x, -x, +y, -y, +z, -z.
    Instead of `alphas`, `levels` and `mapping` give the widths, as in `splitsum.prefilter`. Each level is half the size of
    the one before; `size` is width and height of the first, or a list with a size of each level. The `layout` is "cube" or "equirect". Alpha 0 averages the
    environment over each texel.

    In spherical harmonics a level is a product, P_lm = k_l L_lm. A cube is read at 2 s rows of an equirectangular map
    first. Degrees beyond `degree` are dropped: twice the rows of the environment suffice, and fewer save time.
    Sums are in float64. Texels that ring below 0 are 0.
    """
    environment = checks.map_level("environment", environment)
    if (alphas is None) == (levels is None and isinstance(mapping, str)):
        raise ValueError("alphas, levels: expected one of them")
    alphas = _level_alphas(mapping, levels) if alphas is None else np.atleast_1d(np.asarray(alphas, float)).tolist()
    shapes = checks.level_shapes(layout, size, len(alphas))
    for alpha in alphas:
        if not 0 <= alpha <= 1:
            raise ValueError(f"alphas: {alpha} is outside [0, 1]")
    factors = [_factors(alpha, degree, (model, weight, masking)) for alpha in alphas]
    image = environment.to(torch.float64)
    needed = max(map(len, factors))
    harmonics = analyse(_equirect(image), needed - 1) if needed else None
    found = []
    for shape, of_degree in zip(shapes, factors):
        if len(of_degree):
            level = _level(harmonics, torch.from_numpy(of_degree).to(image.device), shape)
        else:
            level = _mirror(image, shape)
        found.append(level.to(environment.dtype))
    return FilteredMap(found, alphas)


@lru_cache(maxsize=64)
def _factors(alpha: float, degree: int, names: tuple[str, str, str]) -> np.ndarray:
    return _native.level_factors(alpha, min(degree, DEGREE_MAX), names)


def _equirect(image: Tensor) -> Tensor:
    """Converts a cube to an equirectangular map of at least its resolution."""
    if image.ndim == 3:
        return image
    rows = 2 * image.shape[1]
    directions = texel_directions((rows, 2 * rows, 3), image)
    found = Levels([image]).lookup(directions.reshape(-1, 3), image.new_zeros(2 * rows * rows))
    return found.reshape(rows, 2 * rows, 3)


def _level(harmonics: Tensor, factors: Tensor, shape: tuple[int, ...]) -> Tensor:
    """Computes the texels of a map convolved with a kernel of these factors."""
    if len(shape) == 3:
        return synthesise(harmonics, factors, shape[1], shape[0]).clamp(min=0)
    rows = SmoothMap.rows_for(len(factors) - 1)
    smooth = synthesise(harmonics, factors, 2 * rows, rows)
    return _smooth_map(shape, rows, factors.device).values(smooth).reshape(shape).clamp(min=0)


@lru_cache(maxsize=16)
def _smooth_map(shape: tuple[int, ...], rows: int, device: torch.device) -> SmoothMap:
    directions = texel_directions(shape, torch.zeros((), dtype=torch.float64, device=device))
    return SmoothMap(equirect_uv(directions.reshape(-1, 3)) % 1, rows)


def _mirror(image: Tensor, shape: tuple[int, ...]) -> Tensor:
    """Averages a map over each texel of a level, at least two points per texel of the map."""
    rows, columns = _texels_around(shape)
    map_rows, map_columns = _texels_around(image.shape)
    finer = max(-(-map_rows // rows), -(-map_columns // columns))
    points = min(max(2 * finer, 2), 16)
    source = Levels([image])
    total = image.new_zeros(())
    for k in range(points * points):
        inside = ((k % points + 0.5) / points, (k // points + 0.5) / points)
        directions = texel_directions(shape, image, inside).reshape(-1, 3)
        total = total + source.lookup(directions, image.new_zeros(len(directions)))
    return (total / points**2).reshape(shape)


def _texels_around(shape: Sequence[int]) -> tuple[int, int]:
    """Counts the texels from pole to pole, and around. A cube has two faces from pole to pole and four around."""
    height, width = shape[-3:-1]
    return (2 * height, 4 * width) if len(shape) == 4 else (height, width)
