"""splitsum.torch against the library, the program and finite differences. Skipped without torch."""

import numpy as np
import pytest
import splitsum
from conftest import MAP, directions

torch = pytest.importorskip("torch")
import splitsum.torch as st

NVDIFFREC = [0.08, 0.185, 0.29, 0.395, 0.5, 1.0]


def random(*shape, seed=1):
    """Returns float64 values in [0.1, 1.1) that require gradients."""
    generator = torch.Generator().manual_seed(seed)
    return (torch.rand(*shape, dtype=torch.float64, generator=generator) + 0.1).requires_grad_()


def golden_map():
    return torch.from_numpy(splitsum.read_exr(MAP)[0])


def sphere(side, dtype=torch.float32):
    """Returns normals of the renderer's orthographic sphere, and the mask."""
    places = (torch.arange(side, dtype=dtype) + 0.5) / side * 2.1 - 1.05
    y, x = torch.meshgrid(-places, places, indexing="ij")
    rest = 1 - x * x - y * y
    return torch.stack([x, y, rest.clamp(min=0).sqrt()], -1), rest > 0


@pytest.mark.parametrize(
    "options",
    [
        {"levels": 4, "size": (64, 64)},
        {"levels": 4, "size": (96, 48), "layout": "equirect"},
        {"mapping": NVDIFFREC, "size": (64, 64), "model": "beckmann", "weight": "masking"},
        # More orders than columns.
        {"alpha": [0.05, 0.1], "size": (32, 16), "layout": "equirect"},
    ],
)
def test_levels_of_the_library(options):
    expected = splitsum.prefilter(MAP, **options)
    alphas = options.pop("alpha", None)
    for level, found in zip(expected, st.prefilter(golden_map(), alphas, **options)):
        np.testing.assert_allclose(found.numpy().reshape(level.shape), level, rtol=1e-6, atol=1e-6 * level.max())


def test_levels_of_a_cube():
    """A smooth map is the same light as a cube and as an equirectangular map."""
    (smooth,) = st.prefilter(golden_map(), 0.3, layout="equirect", size=(256, 128))
    (cube,) = st.prefilter(golden_map(), 0.3, size=(64, 64))
    for of_cube, of_map in zip(
        st.prefilter(cube, [0.2, 0.6], size=(16, 16)), st.prefilter(smooth, [0.2, 0.6], size=(16, 16))
    ):
        assert (of_cube - of_map).abs().max() < 2e-3 * of_map.max()


def test_spherical_harmonics():
    """The addition theorem for every degree, and the first harmonics. The prefilter only scales each."""
    found = st.spherical_harmonics(5, (16, 8)).flatten(1)
    d = torch.from_numpy(directions(8, 16).reshape(-1, 3))
    cos = d @ d.T
    before, legendre = torch.zeros_like(cos), torch.ones_like(cos)
    for l in range(6):
        one = found[l * l : (l + 1) ** 2]
        torch.testing.assert_close(one.T @ one, (2 * l + 1) / (4 * np.pi) * legendre)
        before, legendre = legendre, ((2 * l + 1) * cos * legendre - l * before) / (l + 1)
    x, y, z = (3 / (4 * np.pi)) ** 0.5 * d.T
    torch.testing.assert_close(found[1:4], torch.stack([x, y, -z]))
    wide = st.spherical_harmonics(3, (512, 256))
    for k in (2, 6, 11, 13):
        (level,) = st.prefilter(1 + 0.3 * wide[k][..., None].expand(-1, -1, 3), 0.2, layout="equirect", size=(16, 8))
        expected = found[k]
        factor = (level[..., 0].flatten() - 1) @ expected / (0.3 * expected @ expected)
        assert 0.5 < factor < 1
        torch.testing.assert_close(level[..., 0].flatten(), 1 + 0.3 * factor * expected, atol=1e-3, rtol=0)


@pytest.mark.parametrize("layout", ["cube", "equirect"])
@pytest.mark.parametrize("shape", [(8, 16, 3), (6, 4, 4, 3)])
def test_gradients_of_levels(layout, shape):
    size = (8, 8) if layout == "cube" else (16, 8)

    def levels(environment):
        return tuple(st.prefilter(environment, [0, 0.3, 0.8], layout=layout, size=size))

    assert torch.autograd.gradcheck(levels, random(*shape), fast_mode=True)
    (single,) = st.prefilter(random(*shape), 0.3, layout=layout, size=(size[0] // 2, size[1] // 2))
    torch.testing.assert_close(
        st.prefilter(random(*shape), [0.8, 0.3], layout=layout, size=[size, (size[0] // 2, size[1] // 2)])[1], single
    )
    first, second = random(*shape), random(*shape, seed=2)
    for one, other, both in zip(levels(first), levels(second), levels(first + 2 * second)):
        torch.testing.assert_close(both, one + 2 * other)


@pytest.mark.parametrize("method", st.METHODS)
@pytest.mark.parametrize("mapping", ["quadratic", NVDIFFREC])
@pytest.mark.parametrize("layout", ["cube", "equirect"])
def test_gradients_of_pixels(method, mapping, layout):
    tables = st.Tables(6 if isinstance(mapping, str) else None, mapping, dfg_side=16)
    sizes = [8, 4, 4, 2, 2, 1]
    levels = [random(*((6, s, s, 3) if layout == "cube" else (s, 2 * s, 3)), seed=k) for k, s in enumerate(sizes)]
    n = (random(5, 3, seed=3) - torch.tensor([0.3, 0.9, 0.1])).detach().requires_grad_()
    v = (n + random(5, 3, seed=4) - 0.5).detach().requires_grad_()
    roughness = (0.1 + 0.7 * random(5, 1, seed=5)).detach().requires_grad_()

    pixels = n, v, roughness, (random(5, 3, seed=6) / 2).detach().requires_grad_()
    assert torch.autograd.gradcheck(lambda *pixels: st.shade(levels, *pixels, method, tables), pixels)
    assert torch.autograd.gradcheck(lambda *levels: st.shade(levels, *pixels, method, tables), levels, fast_mode=True)


@pytest.mark.parametrize(
    ("layout", "masking", "mapping", "roughnesses"),
    [
        ("cube", "correlated", "linear", (0.5, 0.8)),
        ("equirect", "separable", "linear", (0.5, 0.8)),
        # The first level of the list has a width, so its filter is the same.
        ("cube", "correlated", [0.1, 0.4, 0.6, 1.0], (0.12, 0.2, 0.7)),
    ],
)
def test_pixels_of_the_program(program, tmp_path, layout, masking, mapping, roughnesses):
    """The same maps in the renderer, whose levels are these; its mirror is another filter."""
    side, size = 48, (64, 64) if layout == "cube" else (128, 64)
    n, mask = sphere(side)
    levels = st.prefilter(golden_map(), levels=4, mapping=mapping, layout=layout, size=size)
    tables = st.Tables(4, mapping, masking=masking)
    flags = ["--environment", MAP, "--layout", layout, "--masking", masking, "--size", f"{side}x{side}"]
    flags += ["--prefilter-size", f"{size[0]}x{size[1]}", "--prefilter-level-count", "4", "--diffuse", "none"]
    flags += ["--level-mapping", mapping if isinstance(mapping, str) else ":".join(map(str, mapping))]
    for method in st.METHODS:
        for roughness, f0 in zip(roughnesses, (1.0, 0.04, 0.5)):
            shading = [
                "--method",
                method,
                "--perceptual-roughness",
                roughness,
                "--f0",
                f0,
                "--metallic",
                0,
                "--albedo",
                0,
            ]
            program("render", *flags, *shading, "--out", tmp_path / "ball.exr")
            expected, alpha = splitsum.read_exr(tmp_path / "ball.exr")
            np.testing.assert_array_equal(alpha > 0, mask.numpy())
            found = st.shade(levels, n, torch.tensor([0.0, 0, 1]), roughness, f0, method, tables).numpy()
            assert np.abs(found - expected)[mask].max() < 1e-4 * expected[mask].max()


def test_the_textbook_in_closed_form():
    """Under constant light all lookups give f0 A + B; n and v of any length; grey and colour broadcast."""
    levels = [torch.full((6, side, side, 3), 2.0, dtype=torch.float64) for side in (16, 8, 4, 2, 1)]
    n = torch.tensor([[0.0, 0, 1], [0, 3, 0]], dtype=torch.float64)
    v = torch.tensor([[0.6, 0, 0.8], [0.8, 0.6, 0]], dtype=torch.float64)
    roughness = torch.tensor([0.4, 0.9], dtype=torch.float64)
    a, b = splitsum.dfg([0.8, 0.6], roughness.numpy() ** 2).T
    f0 = torch.tensor([0.9, 0.5, 0.1], dtype=torch.float64)
    expected = 2 * (f0.numpy() * a[:, None] + b[:, None])
    for method in st.METHODS:
        for value in (roughness, roughness[:, None]):
            np.testing.assert_allclose(st.shade(levels, n, v, value, f0, method), expected, rtol=1e-3)
        colour = st.shade(levels, n, v, roughness, f0[:1], method)
        np.testing.assert_allclose(colour, expected[:, :1].repeat(3, 1), rtol=1e-3)
        single = st.shade(
            [level.float() for level in levels], n.float(), v.float(), roughness.float(), f0.float(), method
        )
        assert single.dtype == torch.float32
        np.testing.assert_allclose(single, expected, rtol=1e-3)


def test_lookups_cross_edges_and_corners():
    cube = random(6, 4, 4, 3).detach()
    lookup = st.prepare([cube, cube[:, :2, :2]]).lookup
    level = torch.zeros(2, dtype=torch.float64)
    corner = lookup(torch.ones(1, 3, dtype=torch.float64), level[:1])
    torch.testing.assert_close(corner[0], (cube[0, 0, 0] + cube[2, 3, 3] + cube[4, 0, 3]) / 3)
    for edge in ([1, 1, 0.3], [-1, 0.7, 1], [0.2, -1, -1], [0.9, 1, -1]):
        beside = torch.tensor([edge, edge], dtype=torch.float64)
        beside[0] *= torch.tensor([1 + 1e-9, 1, 1 - 1e-9])
        beside[1] *= torch.tensor([1 - 1e-9, 1, 1 + 1e-9])
        first, second = lookup(beside, level)
        torch.testing.assert_close(first, second)


def test_zero_vectors_have_finite_gradients():
    """Pixels without a surface have n = 0."""
    levels = [random(6, side, side, 3) for side in (16, 8, 4, 2, 1)]
    n, v = torch.zeros(2, 3, dtype=torch.float64, requires_grad=True), torch.zeros(2, 3, dtype=torch.float64)
    for method in st.METHODS:
        found = st.shade(levels, n, v, 0.5, 0.5, method)
        (found * torch.zeros(2, 1)).sum().backward()
        assert torch.isfinite(found).all() and torch.isfinite(n.grad).all()


def nvdiffrec_level(roughness, count):
    """The formula of its `get_mip`."""
    if roughness < 0.5:
        return (max(roughness, 0.08) - 0.08) / 0.42 * (count - 2)
    return (roughness - 0.5) / 0.5 + count - 2


def test_environment_light():
    light = st.EnvironmentLight(torch.full((6, 64, 64, 3), 0.5), "split-sum-two")
    with pytest.raises(ValueError, match=r"call build_mips\(\) first"):
        light.shade(*[torch.ones(1, 3)] * 5)
    light.build_mips(cutoff=0.99)
    assert [tuple(level.shape) for level in light.specular] == [(6, s, s, 3) for s in (64, 32, 16)]
    roughness = torch.tensor([0.0, 0.08, 0.2, 0.49, 0.5, 0.7, 1.0])
    expected = [nvdiffrec_level(r, 3) for r in roughness.tolist()]
    np.testing.assert_allclose(light.get_mip(roughness), expected, atol=1e-6)
    position, eye = torch.zeros(1, 1, 2, 3), torch.tensor([0.0, 0, 5])
    normal = torch.tensor([[[[0.0, 0, 1], [0.6, 0, 0.8]]]])
    kd, ks = torch.tensor([0.8, 0.4, 0.2]).expand_as(normal), torch.tensor([0.25, 0.6, 0.5]).expand_as(normal)
    found = light.shade(position, normal, kd, ks, eye)
    a, b = splitsum.dfg([1, 0.8], 0.36, masking="correlated").T
    f0 = 0.02 + 0.5 * kd.numpy()
    expected = 0.75 * 0.5 * (0.5 * kd.numpy() + f0 * a[:, None] + b[:, None])
    np.testing.assert_allclose(found.detach(), expected, rtol=2e-3)
    found.sum().backward()
    assert light.base.grad.abs().sum() > 0
    white = light.shade(position, normal, kd, ks, eye, specular=False)
    np.testing.assert_allclose(white.detach(), 0.75 * 0.5 * kd, rtol=1e-5)


def test_an_environment_light_turns_and_filters_wholly():
    base = st.prefilter(golden_map(), 0.1, size=(64, 64))[0]
    (smooth,) = st.prefilter(golden_map(), 0.1, layout="equirect", size=(256, 128))
    light = st.EnvironmentLight(base, "split-sum")
    light.build_mips()
    # The last is also the irradiance map.
    for level, alpha in zip([*light.specular, light.diffuse], (0.08**2, 0.25, 1, 1)):
        side = level.shape[1]
        exact = splitsum.prefilter(smooth.numpy(), alpha, size=(side, side))
        error = level.detach().numpy().reshape(exact.shape) - exact
        assert np.sqrt((error**2).mean()) < 0.005 * exact.std()
    pixels = [torch.zeros(1, 3), torch.tensor([[0.0, 0, 1]]), torch.ones(1, 3), torch.tensor([[0, 0.5, 1.0]])]
    straight = light.shade(*pixels, torch.tensor([0.0, 0, 3]))
    # A turn that maps the world's x to the light's z.
    light.xfm([[0.0, 0, -1, 0], [0, 1, 0, 0], [1, 0, 0, 0], [0, 0, 0, 1]])
    pixels[1] = torch.tensor([[1.0, 0, 0]])
    turned = light.shade(*pixels, torch.tensor([3.0, 0, 0]))
    torch.testing.assert_close(turned, straight)
    copy = light.clone()
    copy.clamp_(max=0.1)
    assert copy.base.max() == torch.tensor(0.1) and light.base.max() > 0.2
    assert copy.regularizer() < light.regularizer()


LEVELS = [torch.ones(6, s, s, 3) for s in (8, 4, 2, 1)]
UP = torch.tensor([[0.0, 0, 1]])
NAN_MAP = torch.ones(8, 16, 3)
NAN_MAP[2, 5, 0] = float("nan")


@pytest.mark.parametrize(
    ("call", "words"),
    [
        (lambda: st.shade(LEVELS, UP, UP, 1.5, 1.0), r"roughness: 1.5 is outside \[0, 1\]"),
        (lambda: st.shade(LEVELS, UP, UP, float("nan"), 1.0), "roughness: nan is outside"),
        (
            lambda: st.shade(LEVELS, UP, UP, 0.05, 1.0, tables=st.Tables(mapping=[0.08, 0.3, 0.5, 1])),
            r"roughness: 0.05 is outside \[0.08, 1\]",
        ),
        (
            lambda: st.shade(LEVELS, UP, UP, 0.5, 1.0, tables=st.Tables(5)),
            "tables: made for 5 levels, but the map has 4",
        ),
        (lambda: st.shade(LEVELS, UP, UP, 0.5, 1.0, "sampled-vndf"), 'method: "sampled-vndf" has no gradients here'),
        (
            lambda: st.shade([NAN_MAP, NAN_MAP], UP, UP, 0.5, 1.0),
            r"levels\[0\]: 1 NaN or infinite values, the first at \[2, 5",
        ),
        (lambda: st.shade(LEVELS[:1], UP, UP, 0.5, 1.0), "levels: 1 of them; expected two or more"),
        (lambda: st.shade(LEVELS, UP, UP[:, :2], 0.5, 1.0), r"v: its shape is \(1, 2\); expected"),
        (lambda: st.shade(LEVELS, UP.expand(4, 3), UP, torch.ones(5), 1.0), "do not broadcast"),
        (lambda: st.shade(LEVELS, UP.half(), UP, 0.5, 1.0), "n: it is of type torch.float16; expected"),
        (lambda: st.shade(LEVELS, UP, UP, 0.5, float("nan")), r"f0: 1 NaN or infinite values, the first at \[0\]; expected"),
        (lambda: st.shade(LEVELS, UP * float("nan"), UP, 0.5, 1.0), "n: 3 NaN or infinite values, .* expected finite numbers"),
        (
            lambda: st.shade(
                st.prefilter(LEVELS[0], mapping=[0.1, 0.5, 1], size=(8, 8)), UP, UP, 0.5, 1.0, tables=st.Tables(3)
            ),
            "tables: made for levels of roughness 0, 0.5, 1, but the map has 0.1, 0.5, 1; expected Tables of its levels",
        ),
        (lambda: st.prefilter(NAN_MAP, 0.5), r"environment: 1 NaN or infinite values, the first at \[2, 5, 0\]"),
        (lambda: st.prefilter(NAN_MAP[..., :2], 0.5), r"environment: its shape is \(8, 16, 2\)"),
        (
            lambda: st.prefilter(np.ones((8, 16, 3), np.float32), 0.5),
            "environment: it is of type ndarray; expected a tensor",
        ),
        (lambda: st.prefilter(LEVELS[0], 1.5), r"alphas: 1.5 is outside \[0, 1\]"),
        (lambda: st.prefilter(LEVELS[0]), "alphas, levels: expected one of them"),
        (
            lambda: st.prefilter(LEVELS[0], 0.5, layout="octahedral"),
            'layout: "octahedral"; expected "cube" or "equirect"',
        ),
        (
            lambda: st.prefilter(LEVELS[0], [0.1, 0.5], size=(1, 1)),
            "size: a level of 0x0; expected square faces, 1 or more",
        ),
        (lambda: st.prefilter(LEVELS[0], [0.1, 0.5], size=[(4, 4)]), "size: 1 sizes, but 2 levels"),
        (lambda: st.Tables(4, [0.1, 1.0]), "levels: 4, but mapping lists 2 levels"),
        (
            lambda: st.Tables(mapping=[0.5, 0.2, 1.0]),
            r"level_mapping: \[0.5, 0.2, 1.0\]; expected the roughness of two or more",
        ),
        (
            lambda: st.EnvironmentLight(torch.ones(6, 32, 32, 3)),
            r"base: its shape is \(6, 32, 32, 3\); expected a cube",
        ),
        (
            lambda: st.EnvironmentLight(torch.full((6, 64, 64, 3), float("nan"))),
            r"base: 73728 NaN or infinite values, the first at \[0, 0, 0, 0\]",
        ),
        (lambda: st.EnvironmentLight(torch.ones(6, 64, 64, 3), "reference"), 'method: "reference" has no gradients here'),
        (lambda: st.spherical_harmonics(-1, (8, 4)), "degree -1, size 8x4: expected a degree from 0 on"),
    ],
)
def test_bad_input(call, words):
    with pytest.raises(ValueError, match=words):
        call()
