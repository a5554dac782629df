"""Checks of arguments: each error says what is wrong and what was expected."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

SIDE_DEFAULT = 128
"""Side of the faces of the first level."""
EQUIRECT_DEFAULT = (448, 224)


def real(name: str, value: Any) -> Tensor:
    """Checks that an argument is a tensor of float32 or float64."""
    if not isinstance(value, Tensor) or value.dtype not in (torch.float32, torch.float64):
        found = value.dtype if isinstance(value, Tensor) else type(value).__name__
        raise ValueError(f"{name}: it is of type {found}; expected a tensor of float32 or float64")
    return value


def finite(name: str, value: Tensor, what: str) -> None:
    """Checks that a tensor has neither NaN nor infinite values; `what` it should hold, in words."""
    is_bad = ~torch.isfinite(value.detach())
    if is_bad.any():
        place = is_bad.nonzero()[0].tolist()
        raise ValueError(
            f"{name}: {int(is_bad.sum())} NaN or infinite values, the first at {place}; expected {what}"
        )


def map_level(name: str, value: Any) -> Tensor:
    """Checks a level of a map. Faces may be below each other, as `splitsum.prefilter` returns them."""
    value = real(name, value)
    shape = tuple(value.shape)
    if value.ndim == 3 and shape[2] == 3 and shape[1] > 0 and shape[0] == 6 * shape[1]:
        value = value.reshape(6, shape[1], shape[1], 3)
    is_cube = value.ndim == 4 and value.shape[0] == 6 and value.shape[1] == value.shape[2]
    if value.shape[-1:] != (3,) or not value.numel() or not (is_cube or value.ndim == 3):
        raise ValueError(
            f"{name}: its shape is {shape}; expected a cube (6, s, s, 3) or an equirectangular map (h, w, 3)"
        )
    finite(name, value, "finite radiance")
    return value


def level_shapes(layout: str, size: Any, count: int) -> list[tuple[int, ...]]:
    """Returns the shape of each level. `size` is the first level's, which the others halve, or a list with a size of each."""
    if layout not in ("cube", "equirect"):
        raise ValueError(f'layout: "{layout}"; expected "cube" or "equirect"')
    size = size or (EQUIRECT_DEFAULT if layout == "equirect" else (SIDE_DEFAULT, SIDE_DEFAULT))
    sizes = [(size[0] >> k, size[1] >> k) for k in range(count)] if isinstance(size[0], int) else [*size]
    if len(sizes) != count:
        raise ValueError(f"size: {len(sizes)} sizes, but {count} levels; expected one size or a list of {count}")
    for width, height in sizes:
        if min(width, height) < 1 or layout == "cube" and width != height:
            square = "square faces, " if layout == "cube" else ""
            raise ValueError(
                f"size: a level of {width}x{height}; expected {square}1 or more texels a side in every level"
            )
    return [(6, height, width, 3) if layout == "cube" else (height, width, 3) for width, height in sizes]
