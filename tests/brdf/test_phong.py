"""Highlights by powers: the shading they come from, normalisation, draws."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

MODELS = [brdf.Phong, brdf.BlinnPhong]


def test_the_classic_forms_are_shading():
    wi, wo = common.directions(300, 1), common.directions(300, 2)
    mirror = wi * [-1, -1, 1]
    half = wi + wo
    half /= np.linalg.norm(half, axis=-1, keepdims=True)
    for model, cosine in ((brdf.Phong, (mirror * wo).sum(-1).clip(0)), (brdf.BlinnPhong, half[:, 2])):
        shaded = model(0.3, 0.7, 12.0, normalized=False).eval(wi, wo)[:, 0] * wi[:, 2]
        np.testing.assert_allclose(shaded, 0.3 / np.pi * wi[:, 2] + 0.7 * cosine**12, rtol=1e-11)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("exponent", [0.0, 1.0, 10.0, 200.0])
def test_the_normalised_highlight_gives_back_its_part(model, exponent):
    highlight = model(0.0, 0.5, exponent)
    wo = np.stack([common.at(c) for c in (1.0, 0.8, 0.5, 0.2, 0.02)])
    albedo = brdf.directional_albedo(highlight, wo, 1 << 15)[:, 0]
    assert albedo[0] == pytest.approx(0.5, abs=3e-3) and albedo.max() < 0.5 + 3e-3


@pytest.mark.parametrize("model", MODELS)
def test_reciprocity_of_the_normalised(model):
    wi, wo = common.directions(1000, 3), common.directions(1000, 4)
    a = model(0.3, 0.5, 30.0)
    np.testing.assert_allclose(a.eval(wi, wo), a.eval(wo, wi), rtol=1e-10)


@pytest.mark.parametrize("model", MODELS)
@pytest.mark.parametrize("cosine", [0.95, 0.4])
@pytest.mark.parametrize("exponent", [2.0, 20.0])
def test_draws_follow_the_density(model, cosine, exponent):
    a = model(0.3, 0.5, exponent)
    assert common.samples_follow(a, common.at(cosine, 0.4)) > 1e-4
    if model is brdf.Phong:
        assert common.total(lambda w: a.pdf(w, common.at(cosine))) == pytest.approx(1, abs=1e-3)


def test_large_exponents_stay_finite():
    wo = common.directions(100, 6, np.float32)
    u = np.random.default_rng(1).random((100, 3), np.float32)
    for model in MODELS:
        draws = model(0.0, 1.0, 1e6).sample(wo, u)
        assert np.isfinite(draws.weight).all() and np.isfinite(draws.pdf).all()


def test_an_exponent_of_zero_is_half_of_all_directions():
    """About the mirror direction, none beyond a right angle from it."""
    model = brdf.Phong(0.0, 0.7, 0.0)
    wo = np.array([np.sqrt(1 - 0.1**2), 0, 0.1])
    n = 400
    z, phi = 1 - 2 * (np.arange(n) + 0.5) / n, 2 * np.pi * (np.arange(n) + 0.5) / n
    r = np.sqrt(1 - z * z)[:, None]
    wi = np.stack(np.broadcast_arrays(r * np.cos(phi), r * np.sin(phi), z[:, None]), -1)
    weight = 4 * np.pi / n**2
    assert model.pdf(wi, wo).sum() * weight == pytest.approx(1, abs=0.01)
    exact = (model.eval(wi, wo)[..., 0] * np.maximum(wi[..., 2], 0)).sum() * weight
    assert brdf.directional_albedo(model, wo, 1 << 14)[0] == pytest.approx(exact, rel=0.02)
