"""The fit of examples/recovery_light.py recovers what it was given, if the photos are images of the fitted method."""

import sys

import numpy as np
import pytest
from conftest import ROOT

torch = pytest.importorskip("torch")
sys.path.append(str(ROOT / "python" / "examples"))
import recovery_light as example


def a_light():
    """Returns the coefficients of three coloured lamps in a dim white world."""
    basis = example.st.spherical_harmonics(example.DEGREE, (64, 32))
    lamps = torch.stack([basis[:, 6, 10], basis[:, 12, 30], basis[:, 17, 50]], 1) @ (0.2 + torch.eye(3).double())
    light = (-((example.DEGREES[:, None] / 9) ** 2)).exp() * lamps
    light[0] += 0.2
    return light


def photos_of(method, materials, light):
    first, second = example.model(method, materials[0], example.KNOWN_F0), example.model(method, *materials[1:])
    return torch.cat([first @ light, second @ light])


@pytest.mark.parametrize("method", ["split-sum", "split-sum-two"])
def test_a_method_recovers_its_own_images(method):
    light, truth = a_light(), np.array([0.42, 0.71, 0.8])
    materials, found = example.fit(method, photos_of(method, truth, light))
    np.testing.assert_allclose(materials, truth, atol=0.01)
    judged = (example.DEGREE_JUDGED + 1) ** 2
    assert (found - light)[:judged].norm() < 0.03 * light[:judged].norm()


def test_another_method_is_not_absorbed_by_the_light():
    """Images of two lookups, explained by the textbook's: neither roughness comes back."""
    light, truth = a_light(), np.array([0.42, 0.71, 0.8])
    materials, _ = example.fit("split-sum", photos_of("split-sum-two", truth, light))
    assert np.abs(materials - truth)[:2].max() > 0.05
