"""Rough glass: Mitsuba's values, Helmholtz's symmetry with the index, energy, and draws that follow their density."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("alpha", [0.1, 0.4, 1.0])
@pytest.mark.parametrize("eta", [1.5, 1.1, 1 / 1.33])
def test_values_are_mitsubas(distribution, alpha, eta):
    pytest.importorskip("mitsuba")
    wi, wo = common.both_sides(200, 1), common.both_sides(200, 2)
    model = brdf.RoughDielectric(alpha, eta, distribution=distribution)
    description = {
        "type": "roughdielectric",
        "distribution": distribution,
        "alpha": alpha,
        "int_ior": eta,
        "ext_ior": 1.0,
        "sample_visible": True,
    }
    value, density = common.mitsuba_bsdf(description, wi, wo)
    own = (model.eval(wi, wo) * np.abs(wi[:, 2:])).mean(-1)
    # Mitsuba's half vector in single precision, 1e-7 / (η - 1) off in slope.
    rtol = 1e-5 + 1e-6 / (alpha * abs(eta - 1))
    np.testing.assert_allclose(own, value.mean(-1), rtol=rtol, atol=1e-6 * value.max())
    # Mitsuba's density of Beckmann's visible normals is by the rational masking, 0.35 % off; ours by the exact one.
    rtol = 4e-3 if distribution == "beckmann" else rtol
    np.testing.assert_allclose(model.pdf(wi, wo), density, rtol=rtol, atol=1e-6 * density.max())


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("eta", [1.5, 0.75])
def test_radiance_over_the_square_of_the_index_is_symmetric(distribution, eta):
    wi, wo = common.both_sides(2000, 3), common.both_sides(2000, 5)
    model = brdf.RoughDielectric(0.5, eta, alpha_y=0.3, distribution=distribution)

    def squared(w):
        return np.where(w[:, 2:] > 0, 1, eta * eta)

    there, back = model.eval(wi, wo) * squared(wi), model.eval(wo, wi) * squared(wo)
    assert np.count_nonzero(there) > 1000
    np.testing.assert_allclose(there, back, rtol=1e-9, atol=1e-13)


@pytest.mark.parametrize("eta", [1.5, 0.7])
@pytest.mark.parametrize("cosine", [0.9, 0.3, -0.9, -0.4])
@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
def test_draws_follow_the_density(eta, cosine, distribution):
    model = brdf.RoughDielectric(0.4, eta, distribution=distribution)
    assert common.samples_follow(model, common.at(cosine, 0.5)) > 1e-4


@pytest.mark.parametrize("cosine", [0.9, 0.2, -0.9, -0.3])
def test_density_and_energy_stay_within_one(cosine):
    model = brdf.RoughDielectric(0.3, 1.5)
    wo = common.at(cosine)
    assert common.total(lambda w: model.pdf(w, wo)) <= 1 + 1e-3
    draws = model.sample(np.broadcast_to(wo, (20000, 3)), np.random.default_rng(1).random((20000, 3)))
    # Flux rather than radiance: times the square of the index ratio.
    flux = draws.weight[:, 0] * draws.eta**2
    assert flux.max() <= 1 + 1e-9 and flux.mean() > 0.7


def test_equal_indices_pass_light_straight():
    wo = common.both_sides(50, 1)
    draws = brdf.RoughDielectric(0.5, 1.0).sample(wo, np.full(3, 0.5))
    assert np.array_equal(draws.wi, -wo) and draws.specular.all() and (draws.weight == 1).all()


@pytest.mark.parametrize("eta", [1e9, 1e-9])
def test_nothing_is_negative_where_all_is_reflected(eta):
    """In float32 Fresnel's average rounds to above one."""
    wi, wo = common.both_sides(4000, 3, np.float32), common.both_sides(4000, 1, np.float32)
    model = brdf.RoughDielectric(0.5, eta)
    assert (model.eval(wi, wo) >= 0).all() and (model.pdf(wi, wo) >= 0).all()


@pytest.mark.parametrize(
    ("roughness", "outside", "within"), [(0.25, 0.005, 0.015), (0.5, 0.03, 0.14), (0.75, 0.11, 0.36), (1.0, 0.25, 0.56)]
)
@pytest.mark.parametrize("make", ["RoughDielectric", "Principled"])
def test_what_facets_send_on_to_each_other_is_lost(make, roughness, outside, within):
    """As much as the docstring says, of both models of rough glass."""
    model = (
        brdf.RoughDielectric(roughness**2, 1.5)
        if make == "RoughDielectric"
        else brdf.Principled((1, 1, 1), roughness=roughness, spec_trans=1.0, form="2015")
    )
    for side, expected in ((1, outside), (-1, within)):
        assert common.lost_flux(model, side, 1024) == pytest.approx(expected, abs=0.005)
