"""Wrong input raises errors that say what is wrong and what was expected."""

from pathlib import Path

import numpy as np
import pytest
import splitsum

IMAGE = np.ones((8, 16, 3), np.float32)
NOT_A_NUMBER = IMAGE.copy()
NOT_A_NUMBER[2, 5, 0] = np.nan
N, V = [0, 1, 0], [0, 0.8, 0.6]
BAKE = Path(__file__).parents[2] / "tests/golden/env_analytic.exr"


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (
            lambda: splitsum.prefilter(IMAGE[..., :2], 0.5),
            r"environment: its shape is \(8, 16, 2\); expected a float32",
        ),
        (
            lambda: splitsum.prefilter(IMAGE.astype(float), 0.5),
            "environment: it is of type float64; expected a float32",
        ),
        (lambda: splitsum.sh9(IMAGE[:0]), r"its shape is \(0, 16, 3\)"),
        (lambda: splitsum.prefilter(NOT_A_NUMBER, 0.5), "1 NaN channel values, the first at column 5, row 2: R = NaN"),
        (lambda: splitsum.sh9(-IMAGE), "384 negative channel values"),
        (lambda: splitsum.prefilter(IMAGE, 1.5), r"alpha: 1.5 is outside \[0, 1\]"),
        (lambda: splitsum.prefilter(IMAGE, np.nan), "alpha: nan is outside"),
        (lambda: splitsum.prefilter(IMAGE), "alpha, levels: expected one of them"),
        (lambda: splitsum.prefilter(IMAGE, levels=1), "prefilter_level_count is 1; expected at least 2"),
        (
            lambda: splitsum.prefilter(IMAGE, [0, 0.5, 1], size=(2, 2)),
            "size: 2x2; expected square faces, 4 or more texels",
        ),
        (
            lambda: splitsum.prefilter(IMAGE, 0.5, size=(16, 8)),
            "size: 16x8; expected square faces, 1 or more texels a side",
        ),
        (lambda: splitsum.prefilter(IMAGE, 0.5, size=(1 << 14, 1 << 14)), "at most 11184810 in all"),
        (lambda: splitsum.prefilter(IMAGE, 0.5, layout="sphere"), '"sphere" is not a layout'),
        (lambda: splitsum.prefilter(IMAGE, 0.5, model="gxg"), 'did you mean "ggx"'),
        (lambda: splitsum.dfg([0.5, 0], 0.5), r"row 1: n_dot_v: 0.0 is outside \(0, 1\]"),
        (lambda: splitsum.dfg(0.5, 1e-5), "row 0: alpha: 1e-05 is below 0.0001, the narrowest lobe"),
        (lambda: splitsum.dfg_table(0), "side: 0 is outside"),
        (lambda: splitsum.lobes(0.5, 2), r"alpha: 2.0 is outside \[0.0001, 1\]"),
        (lambda: splitsum.lobes(np.nan, 0.5), "n_dot_v: nan is outside"),
        (lambda: splitsum.taps(3), "count: 3; expected 1, 2 or 4 taps"),
        (lambda: splitsum.taps(2, levels=-1), "levels: -1; expected at least 2"),
        (lambda: splitsum.prefilter(IMAGE, 0.5, size=(-8, -8)), "size: 0x0; expected square faces, 1 or more"),
        (lambda: splitsum.taps(2, levels=99), "prefilter_level_count is 99"),
        (lambda: splitsum.taps(2, levels=5, mapping=[0.1, 1]), "levels: 5, but mapping lists 2 levels"),
        (lambda: splitsum.taps(2, mapping=[0.5, 0.1, 1]), r"level_mapping: \[0.5, 0.1, 1.0\]; expected the roughness"),
        (lambda: splitsum.dfg_table(8, axes="x"), 'axes: "x"; expected "centres" or "fourth-roots"'),
        (lambda: splitsum.lookup_taps(np.ones((17, 17, 4), np.float32), 0.5, 0.5), "expected a table of splitsum.taps"),
        (lambda: splitsum.sh9(np.broadcast_to(IMAGE[0, 0], (2**20, 2**20, 3))), "expected at most 134217728 pixels"),
        (lambda: splitsum.fit_taps(lambda l: l[:, 2], 1, 0.5), "n_dot_v: 1, where the mirror direction is the normal"),
        (lambda: splitsum.check_bake([], "builtin:sky"), "files: expected at least one file or folder"),
        (lambda: splitsum.check_bake("x", "builtin:sky", fail_above=-1), "fail_above: -1; expected a number of at least 0"),
        (lambda: splitsum.fit_taps(lambda l: l, 0.5, 0.5), r"lobe: expected \d+ finite values of at least 0"),
        (lambda: splitsum.fit_taps(lambda l: -l[:, 2], 0.5, 0.5), "lobe: expected"),
        (lambda: splitsum.fit_taps(lambda l: l[:, 2], 0.5, 1e-4), "alpha: 0.0001 is level 0.040 of the map"),
        (lambda: splitsum.integrate(IMAGE, n=N, v=V, alpha=[0.5, 1.5], f0=1), "row 1: alpha: 1.5 is outside"),
        (lambda: splitsum.integrate(IMAGE, n=N, v=V, alpha=0.5, f0=np.nan), "row 0: f0: .* is not a finite number"),
        (lambda: splitsum.integrate(IMAGE, n=N, v=[0, -1, 0], alpha=0.5, f0=1), "v is not above the horizon"),
        (
            lambda: splitsum.integrate(IMAGE, n=[0, 1], v=V, alpha=0.5, f0=1),
            r"n: its shape is \(2,\); expected \(..., 3\)",
        ),
        (lambda: splitsum.integrate(IMAGE, n=N, v=V, alpha=0.5), "f0: the column is missing"),
        (lambda: splitsum.integrate(n=N, v=V, alpha=0.5, f0=1), "environment: the column is missing"),
        (lambda: splitsum.integrate(IMAGE, kind="shadow"), "is not a kind of query"),
        (lambda: splitsum.integrate(IMAGE, kind="sh9", tolerance=1), r"tolerance: 1 is outside \[1e-9, 0.1\]"),
        (lambda: splitsum.relmse(IMAGE, IMAGE[:4]), "8x16|16x8 pixels, but the reference is 16x4"),
        (lambda: splitsum.relmse(IMAGE, IMAGE, mask=IMAGE[..., 0]), "mask: expected a bool array"),
        (lambda: splitsum.relmse(IMAGE, NOT_A_NUMBER), "NaN, infinite or negative value"),
        (lambda: splitsum.relmse(IMAGE, IMAGE, environment_mean=0), "environment_mean: 0 is not"),
        (lambda: splitsum.check_bake(BAKE, IMAGE, "splitsum", fail_abov=1), "unknown field `fail_abov`"),
        (lambda: splitsum.check_bake(BAKE, IMAGE, "splitsun"), 'did you mean "splitsum"'),
        (lambda: splitsum.check_bake(BAKE, IMAGE, {"axis": "+x+y+z"}), "unknown field `axis`"),
    ],
)
def test_values(call, words):
    with pytest.raises(ValueError, match=words):
        call()


@pytest.mark.parametrize(
    "call",
    [
        lambda: splitsum.prefilter("absent.hdr", 0.5),
        lambda: splitsum.sh9("absent.exr#layer"),
        lambda: splitsum.check_bake("absent.ktx2", "builtin:sky"),
        lambda: splitsum.check_bake("specular=absent.ktx2", "builtin:sky"),
        lambda: splitsum.read_exr("absent.exr"),
        lambda: splitsum.read_run("absent"),
    ],
)
def test_missing_files(call):
    with pytest.raises(FileNotFoundError, match="absent"):
        call()


def test_warnings():
    with pytest.warns(UserWarning, match="8x8 .*an equirectangular map is 2:1"):
        splitsum.sh9(IMAGE[:, :8])
