"""Spherical harmonics of equirectangular maps: analysis, and synthesis at the texels of a map.

A twin of src/base/math/harmonics, which derives the formulas: the analysis is exact for the bilinear map. The functions
are P_lm(cos θ) exp(i m φ), orthonormal, with φ = 2π u and θ = π v; orders m < 0 are conjugates and not stored.
Coefficients are a complex tensor (orders, degrees, 3), zero where l < m.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, Callable

import torch
from torch import Tensor

BLOCK_BYTES = 32 << 20
"""Size of the Legendre functions that are in memory at once."""
KEPT_BYTES = 128 << 20
"""A transform of at most this size keeps its functions for the next call."""


class Linear(torch.autograd.Function):
    """Applies a linear map, given as a pair of functions: itself and its transpose. Autograd keeps no intermediate of it."""

    @staticmethod
    def forward(ctx: Any, values: Tensor, itself: Callable, transpose: Callable) -> Tensor:
        ctx.pair = itself, transpose
        return itself(values)

    @staticmethod
    def backward(ctx: Any, gradient: Tensor) -> tuple:
        itself, transpose = ctx.pair
        return Linear.apply(gradient, transpose, itself), None, None


class LegendreTransform:
    """Sums with P_lm over the rows at θ = π (i + 1/2) / rows, or over the degrees: each is the other's transpose."""

    def __init__(self, degree: int, rows: int, device: torch.device):
        self.degree = degree
        theta = (torch.arange(rows, dtype=torch.float64, device=device) + 0.5) * (math.pi / rows)
        self.cos, self.sin = theta.cos(), theta.sin()
        bytes_of_order = 8 * rows * (degree + 1)
        self.orders_in_block = max(1, BLOCK_BYTES // bytes_of_order)
        is_kept = bytes_of_order * (degree + 1) <= KEPT_BYTES
        self.block = lru_cache(maxsize=None)(self._block) if is_kept else self._block

    def over_rows(self, values: Tensor) -> Tensor:
        """Sums (orders, rows, n) over rows: (orders, degrees, n)."""
        found = values.new_zeros(values.shape[0], self.degree + 1, values.shape[2])
        for first, last in self._blocks():
            found[first:last, first:] = self.block(first, last) @ values[first:last]
        return found

    def over_degrees(self, values: Tensor) -> Tensor:
        """Sums (orders, degrees, n) over degrees: (orders, rows, n)."""
        found = values.new_empty(values.shape[0], len(self.cos), values.shape[2])
        for first, last in self._blocks():
            found[first:last] = self.block(first, last).transpose(1, 2) @ values[first:last, first:]
        return found

    def _blocks(self) -> list[tuple[int, int]]:
        count, step = self.degree + 1, self.orders_in_block
        return [(first, min(first + step, count)) for first in range(0, count, step)]

    def _block(self, first: int, last: int) -> Tensor:
        """Computes P_lm of the orders `first` to `last` - 1 for degrees from `first` on: (orders, degrees, rows).

        P_lm = a_l (cos θ P_l-1,m - P_l-2,m / a_l-1) with a_l² = (4 l² - 1) / (l² - m²), from P_mm = c_m sin^m θ.
        """
        m = torch.arange(first, last, dtype=torch.float64, device=self.cos.device)
        # c_m by its logarithm: c_m² = (2m + 1) / 4π Π (2k - 1) / 2k, k from 1 to m.
        halves = torch.lgamma(m + 0.5) - torch.lgamma(m + 1) - 0.5 * math.log(math.pi)
        logarithm = 0.5 * (((2 * m + 1) / (4 * math.pi)).log() + halves)
        start = (logarithm[:, None] + m[:, None] * self.sin.log()).exp()
        found = start.new_zeros(last - first, self.degree + 1 - first, len(self.cos))
        # l² - m² is 0 at the start of an order, where the factor of P_l-1 vanishes, too.
        inverse = torch.zeros_like(m)
        for i in range(found.shape[1]):
            degree = first + i
            last_inverse, inverse = inverse, ((degree**2 - m**2).clamp(min=0) / (4 * degree**2 - 1)).abs().sqrt()
            factor = torch.where(inverse > 0, 1 / inverse, torch.zeros_like(m))
            if i > 0:
                found[:, i] = (factor[:, None] * self.cos) * found[:, i - 1]
            if i > 1:
                found[:, i] -= (factor * last_inverse)[:, None] * found[:, i - 2]
            if degree < last:
                found[i, i] = start[i]
        return found


@lru_cache(maxsize=8)
def _transform(degree: int, rows: int, device: torch.device) -> LegendreTransform:
    return LegendreTransform(degree, rows, device)


def _apply(values: Tensor, itself: Callable, transpose: Callable) -> Tensor:
    """Applies a real linear map of the last axis to complex values (orders, n, 3)."""
    parts = torch.view_as_real(values).reshape(*values.shape[:2], 6)
    found = Linear.apply(parts, itself, transpose)
    return torch.view_as_complex(found.reshape(*found.shape[:2], 3, 2))


def spherical_harmonics(degree: int, size: tuple[int, int]) -> Tensor:
    """Evaluates the real, orthonormal spherical harmonics up to a degree at the texels of an equirectangular map of this size.

    Returns float64, ((degree + 1)², h, w): Y_lm has the index l (l + 1) + m, and y, up, is the polar axis. With φ = 2π u
    and θ = π v, orders m > 0 are √2 P_lm(cos θ) cos(m φ), orders m < 0 have the sine of |m| φ in place of the cosine. A
    light of coefficients c, one a channel, is `torch.einsum("kc,khw->hwc", c, found)`.
    """
    width, height = size
    if degree < 0 or min(size) < 1:
        raise ValueError(f"degree {degree}, size {width}x{height}: expected a degree from 0 on and one texel or more")
    orders = torch.arange(degree + 1, dtype=torch.float64)
    legendre = LegendreTransform(degree, height, orders.device).block(0, degree + 1)
    phi = orders[:, None] * ((torch.arange(width, dtype=torch.float64) + 0.5) * (2 * math.pi / width))
    found = torch.empty((degree + 1) ** 2, height, width, dtype=torch.float64)
    for m in range(degree + 1):
        middle = torch.arange(m, degree + 1).square() + torch.arange(m, degree + 1)
        rows = (2**0.5 if m else 1.0) * legendre[m, m:, :, None]
        found[middle - m] = rows * phi[m].sin()
        found[middle + m] = rows * phi[m].cos()
    return found


def analyse(image: Tensor, degree: int) -> Tensor:
    """Computes the coefficients of a map (h, w, 3) up to a degree."""
    rows = _weighted_rows(_row_spectra(image, degree), degree)
    transform = _transform(degree, rows.shape[1], image.device)
    return _apply(rows, transform.over_rows, transform.over_degrees)


def synthesise(harmonics: Tensor, factors: Tensor, width: int, height: int) -> Tensor:
    """Computes the texels (h, w, 3) of a map convolved with a kernel of these factors k_l, one for each degree."""
    count = min(len(factors), len(harmonics))
    orders = _orders(count - 1, harmonics)
    scaled = harmonics[:count, :count] * factors[None, :count, None]
    transform = _transform(count - 1, height, harmonics.device)
    rows = _apply(scaled, transform.over_degrees, transform.over_rows)
    # Column centres are half a column on; an order m > 0 stands for -m, too.
    turns = torch.polar(torch.where(orders > 0, 2.0, 1.0).to(orders), orders * (math.pi / width))
    spectrum = rows * turns[:, None, None]
    # Orders beyond the columns' rate fold back.
    folds = -(-count // width)
    spectrum = torch.cat([spectrum, spectrum.new_zeros(folds * width - count, *spectrum.shape[1:])])
    spectrum = spectrum.reshape(folds, width, *spectrum.shape[1:]).sum(0)
    return torch.fft.ifft(spectrum, dim=0, norm="forward").real.permute(1, 0, 2)


def _orders(degree: int, like: Tensor) -> Tensor:
    return torch.arange(degree + 1, dtype=torch.float64, device=like.device)


def _row_spectra(image: Tensor, degree: int) -> Tensor:
    """Integrates each row over φ against exp(-i m φ), with the map linear between columns: (orders, h, 3)."""
    width = image.shape[1]
    orders = _orders(degree, image)
    bins = torch.fft.fft(image, dim=1).permute(1, 0, 2)[orders.long() % width]
    factors = torch.polar(2 * math.pi / width * torch.sinc(orders / width) ** 2, orders * (-math.pi / width))
    return bins * factors[:, None, None]


def _weighted_rows(spectra: Tensor, degree: int) -> Tensor:
    """Converts the rows of a map, linear between them, to the rows of the quadrature: (orders, count, 3).

    On the whole circle of θ, g |sin θ| has a Fourier series in closed form. It is cut at the degree and summed on one row
    more, where the sum over rows times P_lm is the integral.
    """
    height = spectra.shape[1]
    count = _smooth_even(degree + 1)
    k = _orders(degree + 1, spectra)
    # S = g sgn θ on the circle, even for odd orders.
    is_odd = (_orders(degree, spectra).long() % 2 == 1)[:, None, None]
    sign = torch.where(is_odd, 1.0, -1.0).to(spectra.real)
    line = torch.fft.fft(torch.cat([spectra, sign * spectra.flip(1)], 1), dim=1)
    sinc = torch.sinc(k / (2 * height))
    linear = torch.polar(0.5 / height * sinc**2, k * (-0.5 * math.pi / height))
    series = line[:, k.long() % (2 * height)] * linear[:, None]
    # The step at the poles: constant up to the first row, beyond the linear ramp there.
    step = torch.complex(torch.zeros_like(k), torch.where(k > 0, (sinc - 1) / (math.pi * k.clamp(min=1)), 0 * k))
    south = torch.where(k.long() % 2 == 1, 1.0, -1.0).to(k)[:, None]
    poles = spectra[:, :1] + south * spectra[:, -1:]
    series = series + torch.where(is_odd, 0.0, 1.0).to(k) * step[:, None] * poles
    # W_k = (S_k-1 - S_k+1) / 2i, and W_-k = -sign W_k.
    before = torch.cat([sign * series[:, 1:2], series[:, :-2]], 1)
    turn = torch.polar(torch.full_like(k, math.pi / count), k * (0.5 * math.pi / count))[:-1, None]
    weighted = (before - series[:, 1:]) * -0.5j
    mirrored = -sign * (weighted * turn.conj())[:, 1:].flip(1)
    gap = weighted.new_zeros(len(weighted), 2 * count - 2 * degree - 1, 3)
    found = torch.fft.ifft(torch.cat([weighted * turn, gap, mirrored], 1), dim=1, norm="forward")
    return found[:, :count].contiguous()


def _smooth_even(least: int) -> int:
    """Returns the smallest even number from `least` on without a prime factor above 5, for fast FFTs."""
    number = least + least % 2
    while True:
        rest = number
        for prime in (2, 3, 5):
            while rest % prime == 0:
                rest //= prime
        if rest == 1:
            return number
        number += 2


STENCIL = 8
"""Points of the interpolation along each axis."""


class SmoothMap:
    """Interpolates a function that is smooth between the texels of a map, by Lagrange's polynomials across seam and poles."""

    def __init__(self, uv: Tensor, height: int):
        """`uv`: texture coordinates of the points, (n, 2). The maps have `height` rows and twice as many columns."""
        size = torch.tensor([2 * height, height], dtype=uv.dtype, device=uv.device)
        position = uv * size - 0.5
        floor = position.floor()
        self.height = height
        self.columns, self.rows = (floor + 1).long().unbind(-1)
        self.weights = _lagrange(position - floor)

    @staticmethod
    def rows_for(degree: int) -> int:
        """Returns the rows of a map for a degree: one and a half times its rate."""
        return _smooth_even(max(2 * STENCIL, 3 * (degree + 1) // 2))

    def values(self, image: Tensor) -> Tensor:
        """Interpolates a map (h, w, 3): (n, 3)."""
        padded = _padded(image)
        shape = padded.shape
        return Linear.apply(padded.reshape(-1, 3), self._gather, lambda values: self._scatter(values, shape))

    def _taps(self) -> Any:
        across = 2 * self.height + STENCIL
        for j in range(STENCIL):
            for i in range(STENCIL):
                index = (self.rows + j) * across + self.columns + i
                yield index, (self.weights[j, :, 1] * self.weights[i, :, 0])[:, None]

    def _gather(self, texels: Tensor) -> Tensor:
        found = texels.new_zeros(len(self.rows), 3)
        for index, weight in self._taps():
            found += weight * texels[index]
        return found

    def _scatter(self, values: Tensor, shape: tuple) -> Tensor:
        found = values.new_zeros(shape[0] * shape[1], 3)
        for index, weight in self._taps():
            found.index_add_(0, index, weight * values)
        return found


def _padded(image: Tensor) -> Tensor:
    """Adds half a stencil on each side. Beyond a pole the rows go on at the other side."""
    half = STENCIL // 2
    other = image.roll(image.shape[1] // 2, 1)
    tall = torch.cat([other[:half].flip(0), image, other[-half:].flip(0)])
    return torch.cat([tall[:, -half:], tall, tall[:, :half]], 1)


def _lagrange(part: Tensor) -> Tensor:
    """Returns the weights of the points at a position between the two in the middle: (points, n, 2)."""
    t = part + (STENCIL // 2 - 1)
    weights = []
    for i in range(STENCIL):
        weight = torch.ones_like(t)
        for j in range(STENCIL):
            if j != i:
                weight = weight * ((t - j) / (i - j))
        weights.append(weight)
    return torch.stack(weights)
