"""Lookups in cubes and in equirectangular maps with levels, linear in texels and levels, across all edges.

The mappings are the renderer's (docs/conventions.md). A cube is a tensor (6, s, s, 3), an equirectangular map (h, w, 3).
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from functools import lru_cache

import torch
from torch import Tensor

SMALLEST = 1e-12
"""Below this a length counts as 0, so that gradients at the poles and of zero vectors stay finite."""


def texel_directions(shape: Sequence[int], like: Tensor, inside: tuple[float, float] = (0.5, 0.5)) -> Tensor:
    """Returns the unit direction of a place in each texel of a level of this shape: (..., 3)."""

    def places(count: int, part: float) -> Tensor:
        return (torch.arange(count, dtype=like.dtype, device=like.device) + part) / count

    if len(shape) == 4:
        v, u = torch.meshgrid(places(shape[1], inside[1]), places(shape[2], inside[0]), indexing="ij")
        points = _on_faces(2 * u - 1, 2 * v - 1)
        return points / points.norm(dim=-1, keepdim=True)
    theta = math.pi * places(shape[0], inside[1])[:, None]
    phi = 2 * math.pi * (0.5 - places(shape[1], inside[0]))
    return torch.stack(torch.broadcast_tensors(phi.sin() * theta.sin(), theta.cos(), phi.cos() * theta.sin()), -1)


def equirect_uv(directions: Tensor) -> Tensor:
    """Returns texture coordinates (..., 2) of directions of any length."""
    x, y, z = directions.unbind(-1)
    across = x * x + z * z
    z = torch.where(across < SMALLEST**2, z + SMALLEST, z)
    u = 0.5 - torch.atan2(x, z) / (2 * math.pi)
    v = torch.atan2(across.clamp(min=SMALLEST**2).sqrt(), y) / math.pi
    return torch.stack([u, v], -1)


class Levels:
    """The levels of a map, finest first, side by side for lookups."""

    def __init__(self, levels: Sequence[Tensor], alphas: Sequence[float] | None = None):
        """All levels are cubes or all are equirectangular. Autograd sees a copy of them. `alphas` are their widths, if known."""
        self.alphas = alphas
        self.shapes = tuple(tuple(level.shape) for level in levels)
        self.is_cube = levels[0].ndim == 4
        parts = []
        for level in levels:
            texels = level.reshape(-1, level.shape[-1])
            parts.append(texels)
            if self.is_cube:
                # At a corner of three faces there is no fourth texel: the mean of the three replaces it.
                corners = _cube_index(level.shape[1], texels.device)[1]
                parts.append(texels[corners.reshape(-1)].reshape(8, 3, -1).mean(1))
        self.texels = torch.cat(parts)

    def lookup(self, directions: Tensor, level: Tensor) -> Tensor:
        """Looks up directions (n, 3) of any length at real levels (n,), clamped to the chain: (n, 3)."""
        last = len(self.shapes) - 1
        level = level.clamp(0, last)
        fine = level.detach().floor().clamp(max=max(last - 1, 0)).long()
        part = (level - fine)[:, None]
        place = self._places(directions)
        found = self._linear(place, fine)
        return found if last == 0 else found + part * (self._linear(place, fine + 1) - found)

    def _places(self, directions: Tensor) -> tuple[Tensor, Tensor]:
        """Returns face and texture coordinates of directions: (n,), (n, 2)."""
        if self.is_cube:
            return _cube_places(directions)
        uv = equirect_uv(directions)
        return torch.zeros_like(uv[:, 0], dtype=torch.long), uv

    def _linear(self, place: tuple[Tensor, Tensor], level: Tensor) -> Tensor:
        face, uv = place
        table = _chain(self.shapes, uv.device)
        position = uv * table.sizes[level] - 0.5
        low = position.detach().floor()
        part = position - low
        column, row = low.long().unbind(-1)
        # The index of each level has a texel more on each side.
        across = table.sizes[level, 0] + 2
        first = table.starts[level] + (face * (table.sizes[level, 1] + 2) + row + 1) * across + column + 1
        right, down = part[:, :1], part[:, 1:]

        def texel(index: Tensor) -> Tensor:
            return self.texels.index_select(0, table.index[index])

        top = texel(first) * (1 - right) + texel(first + 1) * right
        bottom = texel(first + across) * (1 - right) + texel(first + across + 1) * right
        return top * (1 - down) + bottom * down


class _Chain:
    """Indices of the texels of all levels, each with a border of the texels beyond its edges."""

    def __init__(self, shapes: tuple[tuple[int, ...], ...], device: torch.device):
        indices, starts, first, texel_count = [], [], 0, 0
        for shape in shapes:
            is_cube = len(shape) == 4
            index = _cube_index(shape[1], device)[0] if is_cube else _equirect_index(shape, device)
            indices.append(index.reshape(-1) + texel_count)
            starts.append(first)
            first += index.numel()
            texel_count += math.prod(shape[:-1]) + (8 if is_cube else 0)
        self.index = torch.cat(indices)
        self.starts = torch.tensor(starts, device=device)
        self.sizes = torch.tensor([[shape[-2], shape[-3]] for shape in shapes], device=device)


@lru_cache(maxsize=16)
def _chain(shapes: tuple[tuple[int, ...], ...], device: torch.device) -> _Chain:
    return _Chain(shapes, device)


def _equirect_index(shape: Sequence[int], device: torch.device) -> Tensor:
    """Returns the index of each texel and of the border: u wraps, v clamps."""
    height, width = shape[:2]
    rows = torch.arange(-1, height + 1, device=device).clamp(0, height - 1)
    columns = torch.arange(-1, width + 1, device=device) % width
    return rows[:, None] * width + columns


@lru_cache(maxsize=32)
def _cube_index(side: int, device: torch.device) -> tuple[Tensor, Tensor]:
    """Returns the index of each texel and of the border, (6, side + 2, side + 2), and the three texels of each corner, (8, 3).

    A texel one step outside a face, seen from the centre, is in the outermost row of the next face.
    """
    centres = (torch.arange(-1, side + 1, dtype=torch.float64, device=device) + 0.5) / side
    v, u = torch.meshgrid(centres, centres, indexing="ij")
    points = _on_faces(2 * u - 1, 2 * v - 1)
    face, uv = _cube_places(points.reshape(-1, 3))
    column, row = (uv * side).floor().long().clamp(0, side - 1).unbind(-1)
    index = ((face * side + row) * side + column).reshape(6, side + 2, side + 2)
    # The corners of the cube are behind the texels, in the order of their signs.
    is_end = torch.zeros(side + 2, dtype=torch.bool, device=device)
    is_end[[0, -1]] = True
    is_corner = (is_end[:, None] & is_end).expand(6, -1, -1)
    corner = ((points > 0) * torch.tensor([1, 2, 4], device=device)).sum(-1)
    beside = index[:, [1, 1, -2, -2], [1, -2, 1, -2]].reshape(-1)
    corner_of = corner[:, [0, 0, -1, -1], [0, -1, 0, -1]].reshape(-1)
    corners = torch.stack([beside[corner_of == k] for k in range(8)])
    return torch.where(is_corner, 6 * side * side + corner, index), corners


def _cube_places(directions: Tensor) -> tuple[Tensor, Tensor]:
    """Returns face and texture coordinates of directions of any length: (n,), (n, 2)."""
    x, y, z = directions.unbind(-1)
    a, b, c = directions.detach().abs().unbind(-1)
    is_x = (a >= b) & (a >= c)
    is_y = ~is_x & (b >= c)
    # Signs of the axes, +1 at 0.
    sx, sy, sz = (torch.where(values < 0, -1.0, 1.0).to(directions) for values in (x, y, z))
    major = torch.where(is_x, x * sx, torch.where(is_y, y * sy, z * sz)).clamp(min=SMALLEST)
    s = torch.where(is_x, -sx * z, torch.where(is_y, x, sz * x))
    t = torch.where(is_x, -y, torch.where(is_y, sy * z, -y))
    negative = torch.where(is_x, sx, torch.where(is_y, sy, sz)) < 0
    face = torch.where(is_x, 0, torch.where(is_y, 2, 4)) + negative.long()
    return face, 0.5 * (torch.stack([s, t], -1) / major[:, None] + 1)


def _on_faces(s: Tensor, t: Tensor) -> Tensor:
    """Returns the points of all faces at these coordinates: (6, ..., 3). The faces have distance 1."""
    one = torch.ones_like(s)
    faces = [(one, -t, -s), (-one, -t, s), (s, one, t), (s, -one, -t), (s, -t, one), (-s, -t, -one)]
    return torch.stack([torch.stack(face, -1) for face in faces])
