"""Prefiltered maps, BRDF tables and exact integrals of image-based lighting.

An image is a float32 array of shape (h, w, 3): linear RGB with the primaries of Rec.709, row 0 at the top. An
environment is an image, the path of an .hdr or .exr file, or a name such as "builtin:sky"; it is equirectangular, y is
up. `alpha` is the microfacet width, the square of an engine's roughness. `model` is "ggx", "beckmann" or "phong";
`masking` is "separable", "correlated", "schlick" or "smith-exact".

Wrong input raises ValueError, a missing file FileNotFoundError. Computations release the GIL and use all cores.
"""

from __future__ import annotations

import json
import os
import re
from collections.abc import Sequence
from typing import Any, Callable, NamedTuple, Union

import numpy as np
from numpy.typing import ArrayLike, NDArray

from . import _native
from ._native import ALPHA_MIN
from .run import read_exr, read_run

__all__ = [
    "ALPHA_MIN", "Environment", "Fit", "Lobes", "check_bake", "dfg", "dfg_table", "fit_taps", "integrate", "lobes",
    "lookup_taps", "prefilter", "read_exr", "read_run", "relmse", "sh9", "taps", "write_exr",
]  # fmt: skip

Environment = Union[str, "os.PathLike[str]", NDArray[np.float32]]

Mapping = Union[str, Sequence[float]]
"""Spacing of levels: "linear", "quadratic", "unity", or the roughness of each level, ascending."""


class Lobes(NamedTuple):
    """Integrals of lobes: BRDF times n·l for Schlick's Fresnel term, split into `f0 a + b`."""

    a: NDArray[np.float64]
    b: NDArray[np.float64]
    moment_a: NDArray[np.float64]
    """First moment of the part `a` over its integral, (..., 2): shares of the mirror direction and of the normal."""
    moment_b: NDArray[np.float64]


class Fit(NamedTuple):
    """Lookups of a prefiltered map that replace a lobe; arrays have shape (count,)."""

    place: NDArray[np.float64]
    """s: the lookup's direction is along (1 - s) n + s r."""
    level: NDArray[np.float64]
    alpha: NDArray[np.float64]
    """Width of the level."""
    weight: NDArray[np.float64]
    objective: float
    """Squared differences from the lobe and its moment, in units of the lobe (docs/research.md#taps)."""
    textbook_objective: float
    """The same for one lookup along r at the surface's alpha."""


def prefilter(
    environment: Environment,
    alpha: float | Sequence[float] | None = None,
    *,
    model: str = "ggx",
    layout: str = "cube",
    levels: int | None = None,
    size: tuple[int, int] | None = None,
    weight: str = "cosine",
    masking: str = "separable",
    mapping: Mapping = "linear",
) -> Any:
    """Averages an environment over lobes of width `alpha`, without noise.

    A number gives one image. Several numbers, or the levels of a `mapping` ("linear", "quadratic" or "unity" with
    `levels`, or a list of each level's roughness), give a list of images, each half the size of the one before. `size` is
    width and height of a face of the first. The faces of the layout "cube" (+x, -x, +y, -y, +z, -z) are below each other;
    the others, "octahedral" and "equirect", have one face.
    Alpha 0 averages the environment over each texel. `weight` is "cosine" (n·l), "masking" (G1) or "none".
    """
    if (alpha is None) == (levels is None and isinstance(mapping, str)):
        raise ValueError("alpha, levels: expected one of them")
    alphas = _level_alphas(mapping, levels) if alpha is None else np.atleast_1d(alpha).tolist()
    for number in alphas:
        if not 0 <= number <= 1:
            raise ValueError(f"alpha: {number} is outside [0, 1]")
    maps = _native.prefilter(_environment(environment), alphas, size, layout, (model, weight, masking))
    return maps[0] if alpha is not None and np.ndim(alpha) == 0 else maps


def dfg(n_dot_v: ArrayLike, alpha: ArrayLike, *, model: str = "ggx", masking: str = "separable") -> NDArray[np.float64]:
    """Integrates (A, B), within a relative error of 5e-7: a lobe's directional albedo is `f0 A + B`. Returns an array (..., 2)."""
    found = integrate(kind="dfg", n_dot_v=n_dot_v, alpha=alpha, model=model, masking=masking)
    return np.stack([found["f0_scale"], found["f90_scale"]], -1)


def dfg_table(
    side: int = 64, *, axes: str = "centres", model: str = "ggx", masking: str = "separable"
) -> NDArray[np.float32]:
    """Makes a table of (A, B): an array (side, side, 2), n·v along x, roughness along y. The integrals are within 2e-4.

    With the axes "centres", as `splitsum bake` writes it, texel centres are at (i + 0.5) / side and row 0 is the smoothest.
    With "fourth-roots", as `splitsum render` reads it, texels are even in the fourth roots of n·v and alpha, both ends
    included.
    """
    if not 2 <= side <= 1024:
        raise ValueError(f"side: {side} is outside [2, 1024]")
    return _native.dfg_table(side, axes, (model, masking))


def lobes(n_dot_v: ArrayLike, alpha: ArrayLike, *, model: str = "ggx", masking: str = "separable") -> Lobes:
    """Integrates A, B and first moments of lobes over 512 directions.

    `n_dot_v` is in (0, 1], `alpha` in [0.0001, 1]. At n·v = 1 the mirror direction is the normal, and moments are NaN.
    `dfg` has A and B with an error bound, and takes about 100 times as long.
    """
    views, shape = _views(n_dot_v=n_dot_v, alpha=alpha)
    found = _native.lobes(*views, (model, masking)).reshape(-1, 6)
    found[views[0] == 1, 2:] = np.nan
    found = found.reshape(*shape, 6)
    return Lobes(found[..., 0], found[..., 1], found[..., 2:4], found[..., 4:])


def taps(
    count: int = 2,
    *,
    model: str = "ggx",
    masking: str = "separable",
    levels: int | None = None,
    mapping: Mapping = "linear",
    weight: str = "cosine",
) -> NDArray[np.float32]:
    """Fits the table of one, two or four lookups (docs/research.md) for the levels of a prefiltered map.

    `mapping` is the name of a mapping for `levels` levels (5 by default), or a list of each level's roughness. Returns the
    table's texels, an array (height, 17, 4), as the files `taps_..._ggx.exr` of `splitsum bake` have them.
    """
    return _native.taps(count, *_spacing(mapping, levels), (model, weight, masking))


def lookup_taps(
    table: NDArray[np.float32],
    n_dot_v: ArrayLike,
    alpha: ArrayLike,
    f0: ArrayLike = 1.0,
    *,
    model: str = "ggx",
    masking: str = "separable",
) -> NDArray[np.float64]:
    """Looks up a table of `taps`. Returns place, level and weight of each lookup, an array (..., count, 3).

    A place s is the direction along (1 - s) n + s r, r the mirror direction of the view. The weights add up to 1.
    """
    views, shape = _views(n_dot_v=n_dot_v, alpha=alpha, f0=f0)
    found = _native.lookup_taps(_float32("table", table, 4), *views, (model, masking))
    return found.reshape(*shape, *found.shape[1:])


def fit_taps(
    lobe: Callable[[NDArray[np.float64]], ArrayLike],
    n_dot_v: float,
    alpha: float,
    *,
    count: int = 1,
    levels: int | None = None,
    mapping: Mapping = "linear",
    model: str = "ggx",
    weight: str = "cosine",
    masking: str = "separable",
) -> Fit:
    """Fits one, two or four lookups of a prefiltered map to a lobe of your own, by the objective of `taps`.

    `lobe` gets unit directions l, an array (n, 3) above the horizon, and returns BRDF times n·l of any scale, an array
    (n,). The normal is +z, the view is (sin θ, 0, cos θ). `alpha` is the surface's width, where the fit starts. `levels`,
    `mapping`, `model`, `weight` and `masking` are the map's, as for `taps`.
    """

    def densities(directions: NDArray[np.float64]) -> NDArray[np.float64]:
        above = directions[:, 2] > 0
        values = np.zeros(len(directions))
        found = np.asarray(lobe(directions[above]), np.float64)
        if found.shape != (above.sum(),) or not (np.isfinite(found).all() and (found >= 0).all() and found.any()):
            raise ValueError(f"lobe: expected {above.sum()} finite values of at least 0, an array (n,)")
        values[above] = found
        return values

    views, _ = _views(n_dot_v=n_dot_v, alpha=alpha)
    view = [values.item() for values in views]
    if view[0] == 1:
        raise ValueError("n_dot_v: 1, where the mirror direction is the normal; expected less")
    found, errors = _native.fit_taps(densities, view, count, *_spacing(mapping, levels), (model, weight, masking))
    return Fit(*found.T, *errors)


def integrate(
    environment: Environment | None = None, *, kind: str = "shading", tolerance: float = 1e-5, **columns: Any
) -> dict[str, NDArray[np.float64]]:
    """Integrates exactly, in float64, with a bound of each absolute error: `splitsum integrate` (its --help has the ranges).

    `columns` broadcast: `n`, `v` and `r` are unit vectors (..., 3), the others numbers or names. A colour `f0` is (..., 3),
    with as many axes as the vectors. Every kind but irradiance and sh9 also takes `model` and `masking`.

    | kind | columns | answers |
    |---|---|---|
    | shading | n, v, alpha, f0 | specular, specular_white (F = 1), diffuse (1 - F inside), lambert (irradiance over pi) |
    | ladder | n, v, alpha, f0, levels | reference, ladder_fresnel, ladder_masking, ladder_view, ladder_levels |
    | prefilter | r, alpha, weight | prefiltered |
    | irradiance | n | irradiance (not divided by pi) |
    | dfg | n_dot_v, alpha | f0_scale (A), f90_scale (B), albedo, error |
    | sh9 | | l00, l1m1, l10, l11, l2m2, l2m1, l20, l21, l22 |

    Radiance has shape (..., 3) and the units of the map. The bound of an answer `x` is `x_error`.
    """
    if not 1e-9 <= tolerance <= 0.1:
        raise ValueError(f"tolerance: {tolerance} is outside [1e-9, 0.1]")
    columns = {("brdf" if name == "model" else name): np.asarray(value) for name, value in columns.items()}
    if "brdf" in _native.kind_columns(kind):
        columns.setdefault("brdf", np.asarray("ggx"))
    if environment is not None:
        columns["environment"] = np.asarray("builtin:constant")  # a name for the first argument
    vectors = columns.keys() & {"n", "v", "r"}
    if "f0" in columns and columns["f0"].ndim == max((columns[name].ndim for name in vectors), default=0):
        vectors = vectors | {"f0"}
    for name in vectors:
        if columns[name].shape[-1:] != (3,):
            raise ValueError(f"{name}: its shape is {columns[name].shape}; expected (..., 3)")
    shape = np.broadcast_shapes(*(array.shape[: -1 if name in vectors else None] for name, array in columns.items()))
    cells: dict[str, Any] = {}
    for name, array in columns.items():
        if name not in vectors:
            cells[name] = np.broadcast_to(array, shape).ravel().tolist()
            continue
        rows = np.broadcast_to(array, (*shape, 3)).reshape(-1, 3)
        if name == "f0":
            cells[name] = [":".join(map(str, color)) for color in rows.tolist()]
        else:
            cells.update(zip([name + axis for axis in "xyz"], rows.T.tolist()))
    table = "\n".join(",".join(map(str, row)) for row in [cells, *zip(*cells.values())])
    try:
        names, numbers = _native.integrate(table, kind, _environment(environment), tolerance)
    except ValueError as error:
        raise ValueError(re.sub(r"^queries:(\d+):", _row, str(error), flags=re.MULTILINE)) from None
    if not names[0].endswith("_r"):
        return {name: numbers[:, i].reshape(shape) for i, name in enumerate(names)}
    colors = numbers.reshape(*shape, len(names) // 3, 3)
    return {name[:-2]: colors[..., i, :] for i, name in enumerate(names[::3])}


def sh9(environment: Environment) -> NDArray[np.float64]:
    """Projects radiance onto nine spherical harmonics, within 1e-9. Returns an array (9, 3).

    L_lm = ∫ L Y_lm in the order Y00, Y1-1 (y), Y10 (z), Y11 (x), Y2-2 (xy), Y2-1 (yz), Y20, Y21 (xz), Y22; without the
    Condon-Shortley sign.
    """
    found = integrate(environment, kind="sh9")
    return np.stack([values for name, values in found.items() if not name.endswith("_error")])


def check_bake(
    files: str | os.PathLike[str] | Sequence[str | os.PathLike[str]],
    environment: Environment | None = None,
    preset: str | dict[str, Any] | None = None,
    *,
    model: str = "ggx",
    **limits: Any,
) -> dict[str, Any]:
    """Judges tables baked by any tool: the dictionary of `splitsum check-bake --json` (docs/bakes.md).

    `files` are the files and folders of one bake. `environment` is the baked map; a DFG table alone needs none. `preset`
    is a tool's name or a dictionary of conventions.
    `limits` are fail_above, fail_between_above, fail_table_above, fail_on_warning and fail_on_wrong; the keys "passes" and
    "failures" depend on them.
    """
    paths = [files] if isinstance(files, (str, os.PathLike)) else [*files]
    if not paths:
        raise ValueError("files: expected at least one file or folder")
    for name, limit in limits.items():
        if not isinstance(limit, (bool, str)) and limit is not None and not limit >= 0:
            raise ValueError(f"{name}: {limit}; expected a number of at least 0")
    source = _environment(environment)
    named = json.dumps({"name": "own", **preset}) if isinstance(preset, dict) else preset
    scores = _native.check_bake([*map(os.fspath, paths)], source, named, model, json.dumps(limits))
    return json.loads(scores)


def relmse(
    test: NDArray[np.float32],
    reference: NDArray[np.float32],
    *,
    mask: NDArray[np.bool_] | None = None,
    environment_mean: float = 1.0,
) -> float:
    """Returns the mean of d² / (r² + 0.01 m²) over pixels and channels: d is the difference from the reference r.

    m is `environment_mean`, the mean luminance of the map. `mask`, a bool array (h, w), selects pixels; the default is all.
    """
    images = [_float32("test", test), _float32("reference", reference)]
    if mask is None:
        mask = np.ones(images[1].shape[:2], np.bool_)
    if not (isinstance(mask, np.ndarray) and mask.dtype == np.bool_ and mask.ndim == 2):
        raise ValueError("mask: expected a bool array of shape (h, w)")
    if not 0 < environment_mean < np.inf:
        raise ValueError(f"environment_mean: {environment_mean} is not a finite number above 0")
    return _native.relmse(*images, mask, environment_mean)


def write_exr(path: str | os.PathLike[str], image: NDArray[np.float32]) -> None:
    """Writes an image as OpenEXR: channels R, G, B and A = 1, 32-bit floats."""
    _native.write_exr(path, _float32("image", image))


def _environment(environment: Environment | None) -> str | NDArray[np.float32] | None:
    """Checks an environment: a path or an array."""
    if environment is None or isinstance(environment, np.ndarray):
        return None if environment is None else _float32("environment", environment)
    return os.fspath(environment)


def _spacing(mapping: Mapping, levels: int | None) -> tuple[int, str | list[float]]:
    """Checks the spacing of levels; returns their number and the mapping."""
    if isinstance(mapping, str):
        return 5 if levels is None else levels, mapping
    roughnesses = [float(roughness) for roughness in mapping]
    if levels not in (None, len(roughnesses)):
        raise ValueError(f"levels: {levels}, but mapping lists {len(roughnesses)} levels; leave one of them out")
    return len(roughnesses), roughnesses


def _level_alphas(mapping: Mapping, levels: int | None) -> list[float]:
    """Returns the width of each level."""
    count, mapping = _spacing(mapping, levels)
    return _native.level_alphas(mapping, count)


TEXELS_MAX = 2**27
"""Most pixels of an image: more are refused before they are copied."""


def _float32(name: str, array: Any, channels: int = 3) -> NDArray[np.float32]:
    """Checks dtype and shape."""
    if not isinstance(array, np.ndarray) or array.dtype != np.float32:
        found = f"it is of type {getattr(array, 'dtype', type(array).__name__)}"
    elif array.ndim != 3 or array.shape[2] != channels or not array.size:
        found = f"its shape is {array.shape}"
    elif array.size > channels * TEXELS_MAX:
        raise ValueError(f"{name}: its shape is {array.shape}; expected at most {TEXELS_MAX} pixels")
    else:
        return array
    raise ValueError(f"{name}: {found}; expected a float32 array of shape (h, w, {channels})")


def _views(**arrays: ArrayLike) -> tuple[list[NDArray[np.float64]], tuple[int, ...]]:
    """Checks ranges and broadcasts; returns flat arrays and their shape."""
    views = np.broadcast_arrays(*(np.asarray(array, np.float64) for array in arrays.values()))
    for name, values in zip(arrays, views):
        low = {"n_dot_v": 0, "alpha": ALPHA_MIN, "f0": 0}[name]
        is_inside = ((values > low) if name == "n_dot_v" else (values >= low)) & (values <= 1)
        if not is_inside.all():
            interval = f"({low}, 1]" if name == "n_dot_v" else f"[{low}, 1]"
            raise ValueError(f"{name}: {values[~is_inside].flat[0]} is outside {interval}")
    return [view.ravel() for view in views], views[0].shape


def _row(match: re.Match[str]) -> str:
    """Names the row of an array in a message that names the line of a table."""
    line = int(match[1])
    return f"row {line - 2}: " if line > 1 else ""
