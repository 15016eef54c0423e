"""The smooth metal: the mirror direction, and Mitsuba's reflectance."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


def test_it_mirrors():
    wo = common.directions(100, 1)
    draws = brdf.Conductor().sample(wo, np.zeros(3))
    assert np.array_equal(draws.wi, wo * [-1, -1, 1]) and draws.specular.all()
    assert (draws.weight >= 0).all() and (draws.weight <= 1).all()
    assert not brdf.Conductor().eval(draws.wi, wo).any() and not brdf.Conductor().pdf(draws.wi, wo).any()


def test_reflectance_is_mitsubas():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    eta, k = [0.2, 0.92, 1.1], [3.91, 2.45, 2.14]
    wo = common.directions(50, 2)
    weight = brdf.Conductor(eta, k).sample(wo, np.zeros(3)).weight
    indices = [mi.Complex2f(a, b) for a, b in zip(eta, k, strict=True)]
    expected = [[mi.fresnel_conductor(w[2], index) for index in indices] for w in wo.tolist()]
    np.testing.assert_allclose(weight, expected, rtol=1e-5)


def test_below_the_horizon_nothing_comes_back():
    assert np.isnan(brdf.Conductor().sample([0.6, 0.0, -0.8], [0.1, 0.2, 0.3]).weight).all()


def test_parameters_broadcast():
    eta = np.ones((4, 1, 3))
    draws = brdf.Conductor(eta, k=3.0).sample(common.directions(5, 1), np.zeros(3))
    assert draws.weight.shape == (4, 5, 3) and draws.specular.shape == (4, 5)
    with pytest.raises(ValueError, match="eta: expected a number in"):
        brdf.Conductor((0.0, 1.0, 1.0))
    eta[2, 0, 1] = -1
    bad = brdf.Conductor(eta, k=3.0).sample(common.directions(5, 1), np.zeros(3)).weight
    assert np.isnan(bad[2]).all() and np.isfinite(bad[[0, 1, 3]]).all()
