"""Smooth glass: Snell's law, Fresnel's split, radiance's factor."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

ETAS = [1.5, 1 / 1.5, 1.0, 1 + 1e-7, 2.4]


@pytest.mark.parametrize("eta", ETAS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_what_passes_obeys_snell(eta, dtype):
    wo = common.both_sides(2000, 3, dtype)
    u = np.random.default_rng(1).random((2000, 3)).astype(dtype)
    draws = brdf.Dielectric(eta).sample(wo, u)
    assert draws.wi.dtype == dtype and draws.specular.all()
    eps = np.finfo(dtype).eps
    np.testing.assert_allclose((draws.wi.astype(float) ** 2).sum(-1), 1, atol=8 * eps)
    inside = np.where(wo[:, 2] > 0, eta, 1 / eta)
    crossed = draws.wi[:, 2] * wo[:, 2] < 0
    expected = np.where(crossed, inside, 1)
    np.testing.assert_allclose(draws.eta, expected, rtol=2 * eps)
    # η sin θ stays along the ray; nothing turns out of the plane.
    np.testing.assert_allclose(draws.wi[:, :2] * draws.eta[:, None], -wo[:, :2], atol=4 * eps)
    np.testing.assert_allclose(draws.weight[:, 0], 1 / draws.eta**2, rtol=4 * eps)


def test_the_split_is_fresnels():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    wo = common.both_sides(200, 5)
    for eta in (1.5, 1.1, 0.7):
        expected = np.array([mi.fresnel(float(z), eta)[0] for z in wo[:, 2]])
        got = brdf.Dielectric(eta).sample(wo, np.zeros(3))
        reflected = got.wi[:, 2] * wo[:, 2] > 0
        np.testing.assert_allclose(np.where(reflected, got.pdf, 1 - got.pdf), expected, rtol=1e-5, atol=1e-7)


def test_all_is_reflected_beyond_the_critical_angle():
    wo = np.array([0.8, 0.0, -0.6])
    u = np.stack([np.zeros(50), np.zeros(50), np.linspace(0, 1, 50, endpoint=False)], -1)
    draws = brdf.Dielectric(1.5).sample(wo, u)
    assert (draws.wi == wo * [-1, -1, 1]).all() and (draws.pdf == 1).all()
