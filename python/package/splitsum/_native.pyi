from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

ALPHA_MIN: float
SHADED_ALPHA_MIN: float
SHADED_COSINE_MIN: float
DIELECTRIC_F0: float

_Source = str | NDArray[np.float32]
_Names = Sequence[str]
_Mapping = str | Sequence[float]

def read_exr(path: Any, layer: str | None) -> tuple[NDArray[np.float32], NDArray[np.float32] | None]: ...
def write_exr(path: Any, array: NDArray[np.float32]) -> None: ...
def kind_columns(kind: str) -> list[str]: ...
def integrate(
    table: str, kind: str, source: _Source | None, tolerance: float
) -> tuple[list[str], NDArray[np.float64]]: ...
def check_bake(
    files: Sequence[str], source: _Source | None, preset: str | None, model: str, flags: Sequence[bool], limits: str
) -> str: ...
def relmse(
    test: NDArray[np.float32], reference: NDArray[np.float32], mask: NDArray[np.bool_], environment_mean: float
) -> float: ...
def level_alphas(mapping: _Mapping, levels: int) -> list[float]: ...
def level_bend(mapping: str) -> float: ...
def level_factors(alpha: float, degree: int, names: _Names) -> NDArray[np.float64]: ...
def prefilter(
    source: _Source, alphas: Sequence[float], size: Sequence[int] | None, layout: str, names: _Names
) -> list[NDArray[np.float32]]: ...
def dfg_table(side: int, axes: str, names: _Names) -> NDArray[np.float32]: ...
def lobes(n_dot_v: NDArray[np.float64], alpha: NDArray[np.float64], names: _Names) -> NDArray[np.float64]: ...
def taps(count: int, levels: int, mapping: _Mapping, names: _Names) -> NDArray[np.float32]: ...
def lookup_taps(
    table: NDArray[np.float32],
    n_dot_v: NDArray[np.float64],
    alpha: NDArray[np.float64],
    f0: NDArray[np.float64],
    names: _Names,
) -> NDArray[np.float64]: ...
def fit_taps(
    lobe: Callable[[NDArray[np.float64]], NDArray[np.float64]],
    view: Sequence[float],
    count: int,
    levels: int,
    mapping: _Mapping,
    names: _Names,
) -> tuple[NDArray[np.float64], Sequence[float]]: ...
