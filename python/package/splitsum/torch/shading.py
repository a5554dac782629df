"""Split sums as differentiable functions: `P(d, level) (f0 A + B)`, by one, two or four lookups d.

A twin of shaders/lib/taps.glsl, shaders/lib/tap_lookup.glsl and shaders/lib/prefilter_mapping.glsl.
"""

from __future__ import annotations

from collections.abc import Sequence
from functools import lru_cache
from typing import Any

import numpy as np
import torch
from torch import Tensor

from .. import Mapping, _native, _spacing, dfg_table, taps
from . import checks
from .maps import Levels

LOOKUPS = {"split-sum": 0, "split-sum-one": 1, "split-sum-two": 2, "split-sum-four": 4}
"""Taps of each method; the textbook's lookup has none."""
ROUGHNESS_TOLERANCE = 1e-4
"""How far the roughness of a map's level may differ from the tables': lists are typed with few digits."""


class Tables:
    """The tables of split sums for the levels of a map: the DFG table, the taps, and the roughness of each level.

    `mapping` and `levels` are the map's, as for `splitsum.taps`; `weight` is its weight and `masking` the surface's. A
    table of taps is fitted when a method first needs it, which takes some seconds unless the package has it.
    """

    def __init__(
        self,
        levels: int | None = None,
        mapping: Mapping = "linear",
        *,
        model: str = "ggx",
        masking: str = "separable",
        weight: str = "cosine",
        dfg_side: int = 128,
    ):
        self.level_count, self.mapping = _spacing(mapping, levels)
        self.roughnesses = [alpha**0.5 for alpha in _native.level_alphas(self.mapping, self.level_count)]
        self._bend = _native.level_bend(self.mapping) if isinstance(self.mapping, str) else None
        self._model, self._masking, self._weight, self._dfg_side = model, masking, weight, dfg_side
        self._of_device = lru_cache(maxsize=16)(self._made)

    def level(self, roughness: Tensor) -> Tensor:
        """Returns the real level of a roughness, from 0 on."""
        last = self.level_count - 1
        if self._bend is not None:
            return roughness * (1 + self._bend * (1 - roughness)) * last
        knots = torch.tensor(self.roughnesses, dtype=roughness.dtype, device=roughness.device)
        fine = torch.bucketize(roughness.detach().contiguous(), knots, right=True).sub(1).clamp(0, last - 1)
        return (fine + (roughness - knots[fine]) / (knots[fine + 1] - knots[fine])).clamp(0, last)

    def albedos(self, n_dot_v: Tensor, roughness: Tensor) -> tuple[Tensor, Tensor]:
        """Looks up A and B, (n, 1) each; they have nodes at fourth roots of n·v and alpha."""
        table = self._of_device("dfg", roughness.dtype, roughness.device)
        alpha = (roughness * roughness).clamp(min=_native.SHADED_ALPHA_MIN)
        lows = _native.SHADED_COSINE_MIN**0.25, _native.SHADED_ALPHA_MIN**0.25
        position = [(x.sqrt().sqrt() - low) / (1 - low) for x, low in zip((n_dot_v, alpha), lows)]
        return _bilinear(table, *position).split(1, -1)

    def taps(self, count: int, n_dot_v: Tensor, roughness: Tensor, dielectric: Tensor) -> tuple[Tensor, ...]:
        """Looks up place, level and weight of each tap: (n, count) each. The weight of one tap is 1."""
        table = self._of_device(count, roughness.dtype, roughness.device)
        # The floor of the widths stands for a mirror.
        roughness = torch.where(
            roughness * roughness <= _native.SHADED_ALPHA_MIN, torch.zeros_like(roughness), roughness
        )
        metal, other = _bilinear(table, n_dot_v.sqrt(), roughness).chunk(2, -1)
        found = torch.lerp(metal, other, dielectric)
        places, levels = found[:, : 2 * count : 2], found[:, 1 : 2 * count : 2]
        weights = torch.ones_like(places) if count == 1 else found[:, 2 * count : 3 * count]
        return places, levels, weights

    def _made(self, name: Any, dtype: torch.dtype, device: torch.device) -> Tensor:
        """Makes the DFG table, or the table of so many taps: (rows, columns, channels)."""
        if name == "dfg":
            table = _dfg_table(self._dfg_side, self._model, self._masking)
        else:
            mapping = self.mapping if isinstance(self.mapping, str) else tuple(self.mapping)
            table = _taps(name, self.level_count, mapping, self._model, self._masking, self._weight)
        return torch.from_numpy(table).to(device, dtype)


@lru_cache(maxsize=8)
def _dfg_table(side: int, model: str, masking: str) -> np.ndarray:
    return dfg_table(side, axes="fourth-roots", model=model, masking=masking)


@lru_cache(maxsize=16)
def _taps(count: int, levels: int, mapping: Any, model: str, masking: str, weight: str) -> np.ndarray:
    """Returns the parts of a table beside each other: (17, 17, channels), for F0 1, then for the other."""
    table = taps(count, model=model, masking=masking, levels=levels, mapping=mapping, weight=weight)
    side = table.shape[1]
    return table.reshape(-1, side, side, 4).transpose(1, 2, 0, 3).reshape(side, side, -1).copy()


def _bilinear(table: Tensor, x: Tensor, y: Tensor) -> Tensor:
    """Looks up a table (rows, columns, channels) with nodes at both ends of its axes, x and y in [0, 1]: (n, channels)."""
    rows, columns, channels = table.shape
    found = []
    x, y = x.clamp(0, 1) * (columns - 1), y.clamp(0, 1) * (rows - 1)
    column = x.detach().floor().clamp(max=columns - 2)
    row = y.detach().floor().clamp(max=rows - 2)
    right, down = (x - column)[:, None], (y - row)[:, None]
    first = (row * columns + column).long()
    texels = table.reshape(-1, channels)
    for step in (0, columns):
        left, other = texels.index_select(0, first + step), texels.index_select(0, first + step + 1)
        found.append(left + right * (other - left))
    return found[0] + down * (found[1] - found[0])


def _dielectric_share(f0: Tensor, a: Tensor, b: Tensor) -> Tensor:
    """Returns the share of the taps for the dielectric's F0; the rest are the taps for F0 1. `f0` is the mean of a colour."""
    low = _native.DIELECTRIC_F0
    return ((1 - f0) * (low * a + b) / ((1 - low) * (f0 * a + b))).clamp(0, 1)


def reflect(v: Tensor, n: Tensor) -> Tensor:
    """Mirrors v about n."""
    return 2 * (n * v).sum(-1, keepdim=True) * n - v


def normalise(vectors: Tensor) -> Tensor:
    """Scales vectors to length 1; zero vectors, which mark pixels without a surface, stay 0."""
    return vectors * (vectors * vectors).sum(-1, keepdim=True).clamp(min=1e-20).rsqrt()


def shade(
    levels: Sequence[Tensor] | Levels,
    n: Tensor,
    v: Tensor,
    roughness: Tensor,
    f0: Tensor,
    method: str = "split-sum-two",
    tables: Tables | None = None,
) -> Tensor:
    """Shades pixels by a split sum: returns radiance (..., 3), differentiable in all inputs.

    `levels` is the prefiltered map, finest level first: cubes (6, s, s, 3) or equirectangular maps (h, w, 3). `n` and `v`
    are the normal and the direction to the viewer, (..., 3), of any length. `roughness` is perceptual roughness, (...) or
    (..., 1), `f0` a colour (..., 3) or a grey (...) or (..., 1). Shapes broadcast. `method` is "split-sum" (the textbook),
    "split-sum-one", "split-sum-two" or "split-sum-four". `tables` are for the map's levels; the default is
    `Tables(len(levels))`.
    """
    check_method(method)
    levels = prepare(levels)
    tables = tables or _default_tables(len(levels.shapes))
    _check_tables(levels, tables)
    shape, n, v, roughness, f0 = _pixels(n, v, roughness, f0)
    _check_roughness(roughness, tables)
    n, v = normalise(n), normalise(v)
    n_dot_v = (n * v).sum(-1).clamp(min=_native.SHADED_COSINE_MIN)
    a, b = tables.albedos(n_dot_v, roughness)
    r = reflect(v, n)
    if LOOKUPS[method] == 0:
        mean = levels.lookup(r, tables.level(roughness))
    else:
        dielectric = _dielectric_share(f0.mean(-1, keepdim=True), a, b)
        found = tables.taps(LOOKUPS[method], n_dot_v, roughness, dielectric)
        mean = torch.zeros_like(n)
        for place, level, weight in zip(*(values.split(1, -1) for values in found)):
            mean = mean + weight * levels.lookup(torch.lerp(n, r, place), level[:, 0])
        mean = mean.clamp(min=0)
    return (mean * (f0 * a + b)).reshape(shape)


def check_method(method: str) -> None:
    if method not in LOOKUPS:
        raise ValueError(f'method: "{method}" has no gradients here; expected one of {", ".join(LOOKUPS)}')


def prepare(levels: Sequence[Tensor] | Levels) -> Levels:
    """Checks the levels of a map, once for several calls of `shade`."""
    if isinstance(levels, Levels):
        return levels
    checked = [checks.map_level(f"levels[{k}]", level) for k, level in enumerate(levels)]
    if len(checked) < 2 or len({level.ndim for level in checked}) > 1:
        raise ValueError(f"levels: {len(checked)} of them; expected two or more of one layout, the finest first")
    return Levels(checked, getattr(levels, "alphas", None))


def _check_tables(levels: Levels, tables: Tables) -> None:
    if tables.level_count != len(levels.shapes):
        raise ValueError(
            f"tables: made for {tables.level_count} levels, but the map has {len(levels.shapes)}; expected Tables of its levels"
        )
    roughnesses = [alpha**0.5 for alpha in levels.alphas or []]
    if any(abs(a - b) > ROUGHNESS_TOLERANCE for a, b in zip(roughnesses, tables.roughnesses)):
        made, has = (", ".join(f"{value:.3g}" for value in values) for values in (tables.roughnesses, roughnesses))
        raise ValueError(
            f"tables: made for levels of roughness {made}, but the map has {has}; expected Tables of its levels"
        )


@lru_cache(maxsize=8)
def _default_tables(levels: int) -> Tables:
    return Tables(levels)


def _pixels(n: Tensor, v: Tensor, roughness: Tensor, f0: Tensor) -> tuple:
    """Checks and broadcasts the inputs of pixels: their shape (..., 3), then n, v, roughness and f0 of all pixels."""
    n, v = checks.real("n", n), checks.real("v", v)
    for name, vectors in (("n", n), ("v", v)):
        if vectors.shape[-1:] != (3,):
            raise ValueError(f"{name}: its shape is {tuple(vectors.shape)}; expected (..., 3)")
    axes = max(n.ndim, v.ndim)
    roughness, f0 = (
        torch.as_tensor(value, dtype=n.dtype, device=n.device)
        if isinstance(value, (int, float))
        else checks.real(name, value)
        for name, value in (("roughness", roughness), ("f0", f0))
    )
    if roughness.ndim < axes or roughness.shape[-1:] != (1,):
        roughness = roughness[..., None]
    if f0.ndim < axes and f0.shape[-1:] != (3,) or f0.ndim == 0:
        f0 = f0[..., None]
    # A NaN would become an index of a table. Roughness has a range of its own.
    for name, value in (("n", n), ("v", v), ("f0", f0)):
        checks.finite(name, value, "finite numbers")
    common = torch.float32 if all(value.dtype == torch.float32 for value in (n, v, roughness, f0)) else torch.float64
    n, v, roughness, f0 = (value.to(common) for value in (n, v, roughness, f0))
    try:
        n, v, roughness, f0 = torch.broadcast_tensors(n, v, roughness, f0)
    except RuntimeError:
        shapes = ", ".join(str(tuple(value.shape)) for value in (n, v, roughness, f0))
        raise ValueError(f"n, v, roughness, f0: their shapes {shapes} do not broadcast") from None
    flat = [value.reshape(-1, 3) for value in (n, v, roughness, f0)]
    return n.shape, flat[0], flat[1], flat[2][:, 0], flat[3]


def _check_roughness(roughness: Tensor, tables: Tables) -> None:
    low, high = tables.roughnesses[0], tables.roughnesses[-1]
    values = roughness.detach()
    # Rounding of float32 may leave the range by a last digit.
    is_inside = (values >= low - 1e-6) & (values <= high + 1e-6)
    if not is_inside.all():
        bad = values[~is_inside][0].item()
        raise ValueError(f"roughness: {bad:g} is outside [{low:g}, {high:g}], the roughness of the map's levels")
