"""A light for inverse renderers with the calls of nvdiffrec's `render/light.py`."""

from __future__ import annotations

from typing import Any

import torch
from torch import Tensor

from . import checks
from .prefiltering import prefilter
from .shading import Tables, check_method, normalise, prepare, shade

ROUGHNESS_MIN = 0.08
ROUGHNESS_MAX = 0.5
SIDE_MIN = 16
"""Side of the roughest level."""
PLASTIC_F0 = 0.04


class EnvironmentLight(torch.nn.Module):
    """A trainable cube of radiance with prefiltered levels; replaces nvdiffrec's class of this name.

    `base` is a cube (6, s, s, 3), s a power of two of at least 64. Call `build_mips` after each change of `base`, then
    `shade`. Levels halve down to 16 texels, at roughness 0.08 to 0.5 evenly, and 1 for the last: 0.08, 0.185, 0.29, 0.395,
    0.5, 1 for s = 512. Unlike there, a level averages over the whole lobe, the integral of the BRDF is the table of
    `Tables` (height-correlated masking), and `method` may read the levels more than once.
    """

    def __init__(self, base: Tensor, method: str = "split-sum-two"):
        super().__init__()
        check_method(method)
        base = checks.map_level("base", base)
        side = base.shape[1]
        if base.ndim != 4 or side < 4 * SIDE_MIN or side & (side - 1):
            raise ValueError(
                f"base: its shape is {tuple(base.shape)}; expected a cube (6, s, s, 3), s a power of two of at least 64"
            )
        self.mtx: Any = None
        self.method = method
        self.base = torch.nn.Parameter(base.clone().detach())
        last = (side // SIDE_MIN).bit_length() - 1
        spread = ROUGHNESS_MAX - ROUGHNESS_MIN
        self.roughnesses = [ROUGHNESS_MIN + spread * k / (last - 1) for k in range(last)] + [1.0]
        self.tables = Tables(mapping=self.roughnesses, masking="correlated")
        self.specular: list[Tensor] = []
        self.diffuse: Tensor | None = None

    def xfm(self, mtx: Any) -> None:
        """Sets the matrix (3, 3) or (4, 4) that turns directions into the light's frame."""
        self.mtx = mtx

    def clone(self) -> EnvironmentLight:
        return EnvironmentLight(self.base, self.method)

    def clamp_(self, min: float | None = None, max: float | None = None) -> None:
        with torch.no_grad():
            self.base.clamp_(min, max)

    def regularizer(self) -> Tensor:
        """Returns the mean distance of the base from grey."""
        return (self.base - self.base.mean(-1, keepdim=True)).abs().mean()

    def get_mip(self, roughness: Tensor) -> Tensor:
        """Returns the level that a lookup for a roughness reads, clamped to the levels."""
        return self.tables.level(roughness)

    def build_mips(self, cutoff: float | None = None) -> None:
        """Makes the levels of the base. `cutoff` has no effect: levels use the whole lobe."""
        del cutoff
        side = self.base.shape[1]
        alphas = [roughness**2 for roughness in self.roughnesses]
        # The bilinear map between texels has the first zero of its spectrum at this degree.
        self.specular = prefilter(self.base, alphas, size=(side, side), degree=4 * side)
        # GGX of alpha 1 has a constant D: its level is the cosine lobe, irradiance over pi.
        self.diffuse = self.specular[-1]
        self._levels = prepare(self.specular)

    def shade(
        self, gb_pos: Tensor, gb_normal: Tensor, kd: Tensor, ks: Tensor, view_pos: Tensor, specular: bool = True
    ) -> Tensor:
        """Shades pixels: position, normal, base colour, (occlusion, roughness, metallic) and the eye's position, (..., 3) each.

        Roughness below 0.08 counts as 0.08. Without `specular`, `kd` is all diffuse.
        """
        if not self.specular:
            raise ValueError("EnvironmentLight: it has no levels; call build_mips() first")
        v, n = normalise(view_pos - gb_pos), gb_normal
        if self.mtx is not None:
            turn = torch.as_tensor(self.mtx, dtype=n.dtype, device=n.device)[:3, :3]
            v, n = v @ turn.T, n @ turn.T
        roughness, metallic = ks[..., 1:2], ks[..., 2:3]
        diffuse_colour = kd * (1 - metallic) if specular else kd
        found = self._irradiance_over_pi(n) * diffuse_colour
        if specular:
            f0 = PLASTIC_F0 * (1 - metallic) + kd * metallic
            roughness = roughness.clamp(self.roughnesses[0], 1.0)
            found = found + shade(self._levels, n, v, roughness, f0, self.method, self.tables)
        return found * (1 - ks[..., :1])

    def _irradiance_over_pi(self, n: Tensor) -> Tensor:
        directions = n.reshape(-1, 3)
        last = torch.full_like(directions[:, 0], len(self.specular) - 1)
        return self._levels.lookup(directions, last).reshape(n.shape)
