"""Numbers of other programs and of independent quadratures (docs/architecture.md)."""

import json

import numpy as np
import pytest
import splitsum
from conftest import GOLDEN, MAP, directions, table, vectors


def assert_close(found, expected, tolerance):
    """Compares colours relative to their brightest channel."""
    assert (np.abs(found - expected) <= tolerance * expected.max(-1, keepdims=True)).all()


def test_shading():
    golden = table(GOLDEN / "queries.csv")
    answer = splitsum.integrate(
        MAP,
        n=vectors(golden, "n"),
        v=vectors(golden, "v"),
        alpha=golden["alpha"],
        f0=golden["f0"],
        model=golden["model"],
    )
    names = {"specular": "spec_schlick_", "specular_white": "spec_F1_", "diffuse": "diff_1mF_over_pi_"}
    for ours, theirs in {**names, "lambert": "lambert_over_pi_"}.items():
        expected = vectors(golden, theirs, "rgb")
        assert_close(answer[ours], expected, 2e-4)
        bound = answer[f"{ours}_error"]
        assert (bound >= 0).all() and (bound <= 2e-5 * expected.max(-1, keepdims=True)).all()


@pytest.mark.parametrize(
    ("variant", "model", "masking"),
    [
        ("ggx_smith_exact", "ggx", "separable"),
        ("ggx_karis_k_alpha_over_2", "ggx", "schlick"),
        ("beckmann_rational", "beckmann", "separable"),
        ("phong_rational", "phong", "separable"),
    ],
)
def test_dfg_and_lobes(variant, model, masking):
    golden = table(GOLDEN / "dfg.csv")
    rows = golden["variant"] == variant
    n_dot_v, alpha, a, b = (golden[name][rows] for name in ("NdotV", "alpha", "A", "B"))
    found = splitsum.dfg(n_dot_v, alpha, model=model, masking=masking)
    np.testing.assert_allclose(found, np.stack([a, b], -1), rtol=0, atol=1e-5)
    lobes = splitsum.lobes(n_dot_v, alpha, model=model, masking=masking)
    np.testing.assert_allclose(lobes.a, a, rtol=0, atol=2e-3)
    np.testing.assert_allclose(lobes.b, b, rtol=0, atol=2e-3)
    assert np.isnan(splitsum.lobes(1, 0.3, model=model).moment_a).all()


def test_prefiltered_directions():
    golden = table(GOLDEN / "prefilter.csv")
    answer = splitsum.integrate(
        MAP, kind="prefilter", r=vectors(golden, "r"), alpha=golden["alpha"], model=golden["model"]
    )
    assert_close(answer["prefiltered"], vectors(golden, "", "rgb"), 1e-3)


def test_prefiltered_map():
    found = splitsum.prefilter(MAP, 0.25, layout="equirect", size=(16, 8))
    assert found.shape == (8, 16, 3) and found.dtype == np.float32
    exact = splitsum.integrate(MAP, kind="prefilter", r=directions(8, 16), alpha=0.25)
    assert_close(found, exact["prefiltered"], 1e-3)


def test_sh9():
    golden = json.loads((GOLDEN / "sh9.json").read_text())["envs"]["analytic"]["L_bilinear"]
    image, _ = splitsum.read_exr(MAP)
    for environment in (MAP, image):
        np.testing.assert_allclose(splitsum.sh9(environment), golden, rtol=0, atol=1e-6 * golden[0][0])


def ggx(l, v, alpha):
    """Returns the BRDF of GGX times n·l for F = 1, up to a factor, and the weight of Schlick's term."""
    h = (l + v) / np.linalg.norm(l + v, axis=-1, keepdims=True)
    d = (1 + (alpha**2 - 1) * h[:, 2] ** 2) ** -2
    g1 = 2 * l[:, 2] / (l[:, 2] + np.sqrt(alpha**2 + (1 - alpha**2) * l[:, 2] ** 2))
    return d * g1, (1 - h @ v) ** 5


def test_moments_and_taps_of_a_lobe():
    # A node of the table of taps.
    n_dot_v, alpha = 0.25, 0.25
    v = np.array([np.sqrt(1 - n_dot_v**2), 0, n_dot_v])
    # By the midpoint rule over the upper half of a map whose pole is the normal.
    l = directions(800, 1600)[:400].reshape(-1, 3)[:, [0, 2, 1]]
    lobe, fc = ggx(l, v, alpha)
    lobes = splitsum.lobes(n_dot_v, alpha)
    for part, (of_r, of_n) in ((1 - fc, lobes.moment_a), (fc, lobes.moment_b)):
        weights = lobe * part * np.sqrt(1 - l[:, 2] ** 2)
        moment = (weights[:, None] * l).sum(0) / weights.sum()
        np.testing.assert_allclose(of_r * v * [-1, 0, 1] + [0, 0, of_n], moment, atol=2e-3)
    for count in (1, 2):
        fit = splitsum.fit_taps(lambda l: ggx(l, v, alpha)[0], n_dot_v, alpha, count=count)
        assert abs(fit.weight.sum() - 1) < 1e-6 and fit.objective < 0.5 * fit.textbook_objective
        # The fit of the table also draws each node to its neighbours.
        place, level, weight = splitsum.lookup_taps(splitsum.taps(count), n_dot_v, alpha).T
        np.testing.assert_allclose(fit.place @ fit.weight, place @ weight, atol=0.05)
        np.testing.assert_allclose(fit.level @ fit.weight, level @ weight, atol=0.1)


def test_taps_of_listed_levels():
    """A list with the roughness of a mapping's levels has the mapping's table; fits of other levels differ."""
    even = [k / 3 for k in range(4)]
    expected = splitsum.taps(1, levels=4, masking="correlated")
    np.testing.assert_allclose(splitsum.taps(1, mapping=even, masking="correlated"), expected, rtol=0, atol=1e-6)
    for level, alpha in zip(splitsum.prefilter(MAP, mapping=[0.1, 0.5, 1], size=(16, 16)), (0.01, 0.25, 1)):
        side = level.shape[1]
        np.testing.assert_array_equal(level, splitsum.prefilter(MAP, alpha, size=(side, side)))
    # A lobe of roughness 0.5 between the levels 0.4 and 0.8.
    fit = splitsum.fit_taps(lambda l: ggx(l, np.array([0.8, 0, 0.6]), 0.25)[0], 0.6, 0.25, mapping=[0.2, 0.4, 0.8])
    assert 1 < fit.level[0] < 1.5
    np.testing.assert_allclose(fit.alpha, (0.4 + 0.4 * (fit.level - 1)) ** 2, rtol=1e-6)
