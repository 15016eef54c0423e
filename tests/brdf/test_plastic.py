"""Diffuser under a coat: Mitsuba's values, energy."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


@pytest.mark.parametrize("nonlinear", [False, True])
def test_values_are_mitsubas_but_for_the_inner_reflectance(nonlinear):
    """Mitsuba takes a fit of the inner reflectance; the shape over directions is free of it."""
    pytest.importorskip("mitsuba")
    wi, wo = common.directions(100, 1, np.float32, 0.05), common.directions(100, 2, np.float32, 0.05)
    description = {
        "type": "plastic",
        "int_ior": 1.5,
        "ext_ior": 1.0,
        "nonlinear": nonlinear,
        "diffuse_reflectance": {"type": "rgb", "value": [0.2, 0.5, 0.8]},
    }
    value, _ = common.mitsuba_bsdf(description, wi, wo)
    own = brdf.Plastic((0.2, 0.5, 0.8), nonlinear=nonlinear).eval(wi.astype(float), wo) * wi[:, 2:]
    ratio = own / value
    np.testing.assert_allclose(ratio / ratio[0], 1, rtol=1e-5)
    # The fit (Egan and Hilgeman's) is within 1 % of the exact average.
    np.testing.assert_allclose(ratio[0], 1, atol=0.01)


def test_a_white_diffuser_gives_all_back():
    wo = np.stack([common.at(c) for c in (1.0, 0.5, 0.1)])
    albedo = brdf.directional_albedo(brdf.Plastic(1.0, nonlinear=True), wo, 1 << 15)
    np.testing.assert_allclose(albedo, 1, atol=2e-3)


def test_draws_follow_the_density():
    assert common.samples_follow(brdf.Plastic(0.5), common.at(0.5)) > 1e-4
    model, wo = brdf.Plastic(0.5), common.at(0.3)
    draws = model.sample(np.broadcast_to(wo, (50000, 3)), np.random.default_rng(1).random((50000, 3)))
    through = common.total(lambda w: model.pdf(w, wo))
    assert draws.specular.mean() == pytest.approx(1 - through, abs=0.01)


def test_it_is_reciprocal():
    wi, wo = common.directions(500, 3), common.directions(500, 4)
    model = brdf.Plastic((0.2, 0.5, 0.8), 1.7)
    np.testing.assert_allclose(model.eval(wi, wo), model.eval(wo, wi), rtol=1e-12)
