"""Rough diffusers: the source's formula, energy, reciprocity."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


def test_the_qualitative_form_is_the_sources():
    wi, wo = common.directions(500, 1), common.directions(500, 2)
    sigma, albedo = 0.4, 0.7
    ti, to = np.arccos(wi[:, 2]), np.arccos(wo[:, 2])
    phi = np.arctan2(wi[:, 1], wi[:, 0]) - np.arctan2(wo[:, 1], wo[:, 0])
    a, b = 1 - 0.5 * sigma**2 / (sigma**2 + 0.33), 0.45 * sigma**2 / (sigma**2 + 0.09)
    expected = a + b * np.cos(phi).clip(0) * np.sin(np.maximum(ti, to)) * np.tan(np.minimum(ti, to))
    got = brdf.OrenNayar(albedo, sigma, form="qualitative").eval(wi, wo)[:, 0]
    np.testing.assert_allclose(got, albedo / np.pi * expected, rtol=1e-9)


@pytest.mark.parametrize("sigma", [0.0, 0.1, 0.5, 1.0])
def test_an_albedo_of_one_gives_all_back(sigma):
    wo = np.stack([common.at(c) for c in (1.0, 0.7, 0.3, 0.05)])
    albedo = brdf.directional_albedo(brdf.OrenNayar(1.0, sigma), wo, 1 << 14)
    np.testing.assert_allclose(albedo, 1, atol=2e-3)


@pytest.mark.parametrize("sigma", [0.3, 1.0])
def test_the_qualitative_form_loses_light(sigma):
    assert brdf.white_furnace(brdf.OrenNayar(1.0, sigma, form="qualitative")).min() > 0.03


@pytest.mark.parametrize("form", ["qualitative", "energy_preserving"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_reciprocity(form, dtype):
    wi, wo = common.directions(1000, 3, dtype), common.directions(1000, 4, dtype)
    model = brdf.OrenNayar((0.2, 0.5, 1.0), 0.7, form=form)
    there, back = model.eval(wi, wo), model.eval(wo, wi)
    assert there.dtype == dtype and (there >= 0).all()
    np.testing.assert_allclose(there, back, rtol=20 * np.finfo(dtype).eps)


def test_no_roughness_is_lambert():
    wi, wo = common.directions(100, 5), common.directions(100, 6)
    for form in ("qualitative", "energy_preserving"):
        np.testing.assert_allclose(brdf.OrenNayar(0.6, 0.0, form=form).eval(wi, wo), 0.6 / np.pi, rtol=1e-12)


def test_draws_follow_the_density():
    assert common.samples_follow(brdf.OrenNayar(0.6, 0.7), common.at(0.4)) > 1e-4
