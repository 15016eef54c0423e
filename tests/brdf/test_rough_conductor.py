"""Rough metal: Mitsuba's values, reciprocity, energy, and draws that follow their density."""

import importlib.util
from pathlib import Path

import numpy as np
import pytest
from shadelab import brdf

spec = importlib.util.spec_from_file_location("brdf_common", Path(__file__).with_name("common.py"))
common = importlib.util.module_from_spec(spec)
spec.loader.exec_module(common)

ETA, K = (0.2, 0.92, 1.1), (3.91, 2.45, 2.14)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize(("alpha", "alpha_y"), [(0.05, 0.05), (0.3, 0.3), (0.1, 0.5), (1.0, 1.0)])
def test_values_are_mitsubas(distribution, alpha, alpha_y):
    pytest.importorskip("mitsuba")
    wi, wo = common.directions(200, 1, np.float32, 0.05), common.directions(200, 2, np.float32, 0.05)
    model = brdf.RoughConductor(alpha, ETA, K, alpha_y=alpha_y, distribution=distribution, masking="separable")
    # Half of the pairs where the lobe is.
    wi[:100] = model.sample(wo[:100], np.random.default_rng(3).random((100, 3)).astype(np.float32)).wi
    keep = wi[:, 2] > 0.02
    wi, wo = wi[keep].astype(float), wo[keep].astype(float)
    rgb = {n: {"type": "rgb", "value": list(v)} for n, v in (("eta", ETA), ("k", K))}
    description = {"type": "roughconductor", "distribution": distribution, "alpha_u": alpha, "alpha_v": alpha_y, **rgb}
    # Mitsuba's half vector is normalised in single precision: 1e-7 of slope over alpha, doubled by the lobe. Its pdf
    # of Beckmann's visible normals is by the rational masking, 0.35 % off; ours by the exact one.
    rtol = 1e-5 + 2e-6 / min(alpha, alpha_y)
    common.agrees_with_mitsuba(model, description, wi, wo, rtol, 4e-3 if distribution == "beckmann" else rtol)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("masking", ["height_correlated", "separable", "schlick", "v_cavity"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_model_is_reciprocal(distribution, masking, dtype):
    wi, wo = common.directions(1000, 3, dtype), common.directions(1000, 4, dtype)
    model = brdf.RoughConductor(0.3, ETA, K, alpha_y=0.6, distribution=distribution, masking=masking)
    a, b = model.eval(wi, wo), model.eval(wo, wi)
    assert a.dtype == dtype and a.any()
    np.testing.assert_allclose(a, b, rtol=40 * np.finfo(dtype).eps)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("cosine", [1.0, 0.5, 0.1])
def test_the_density_integrates_to_one(distribution, cosine):
    model = brdf.RoughConductor(0.3, ETA, K, alpha_y=0.5, distribution=distribution)
    sum_ = common.total(lambda w: model.pdf(w, common.at(cosine, 0.4)))
    assert sum_ == pytest.approx(1, abs=2e-4)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize(("alpha", "alpha_y"), [(0.25, 0.25), (0.2, 0.7), (1.0, 1.0)])
@pytest.mark.parametrize("cosine", [0.95, 0.3])
def test_draws_follow_the_density(distribution, alpha, alpha_y, cosine):
    model = brdf.RoughConductor(alpha, ETA, K, alpha_y=alpha_y, distribution=distribution)
    assert common.samples_follow(model, common.at(cosine, 0.7)) > 1e-4


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("cosine", [0.95, 0.3, 0.05])
def test_draws_of_v_cavities_follow_the_density(distribution, cosine):
    """Of glass, which draws nothing below the horizon, where the density has a pole (against the beam)."""
    model = brdf.RoughDielectric(0.3, alpha_y=0.6, distribution=distribution, masking="v_cavity")
    assert common.samples_follow(model, common.at(cosine, 0.7)) > 1e-4


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("alpha", [1e-4, 0.1, 1.0])
def test_weights_are_bounded(distribution, dtype, alpha):
    """Of normals that are seen by one, of Beckmann's rational masking by 1.004; of V-cavities' normals by two."""
    rng = np.random.default_rng(5)
    z, phi = 10 ** rng.uniform(-7, 0, 50_000), rng.uniform(0, 2 * np.pi, 50_000)
    s = np.sqrt(1 - z * z)
    wo = np.stack([s * np.cos(phi), s * np.sin(phi), z], -1).astype(dtype)
    u = np.minimum(rng.random((50_000, 3)), 1 - 2**-24).astype(dtype)
    for masking, most in (("height_correlated", 1.004), ("separable", 1.004), ("v_cavity", 2)):
        mirrors = brdf.RoughConductor(alpha, 1e-9, 1e9, distribution=distribution, masking=masking)
        assert mirrors.sample(wo, u).weight.max() < most + 1e-4


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("masking", ["height_correlated", "separable", "schlick", "v_cavity"])
@pytest.mark.parametrize("alpha", [1e-9, 1e-3, 0.55, 1.0])
def test_compensation_never_takes_light(distribution, masking, alpha):
    """The table is an approximation from both sides; what it would take away is cut off."""
    mirrors = {"distribution": distribution, "masking": masking}
    assert brdf.albedo_table(**mirrors).albedo.max() <= 1
    rng = np.random.default_rng(6)
    wi, wo = common.directions(20_000, 7, lowest=1e-7), common.directions(20_000, 8, lowest=1e-7)
    model = brdf.RoughConductor(alpha, 1e-9, 1e9, **mirrors, compensation="kulla_conty")
    draws = model.sample(wo, rng.random((20_000, 3)))
    for x in (model.eval(wi, wo), model.pdf(wi, wo), draws.weight, draws.pdf):
        assert np.isfinite(x).all() and x.min() >= 0


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
def test_the_narrowest_lobes_are_numbers(dtype, distribution):
    wo, u = np.array([0.6, 0, 0.8], dtype), np.array([0.3, 0.4, 0.5], dtype)
    for model in (brdf.RoughConductor, brdf.RoughDielectric):
        draw = model(1e-9, distribution=distribution).sample(wo, u)
        assert np.isfinite(draw.weight).all() and draw.weight.max() > 0.4 and 0 < draw.pdf < np.inf


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("model", [brdf.RoughConductor, brdf.RoughDielectric, brdf.Plastic])
@pytest.mark.parametrize("lane", [0, 1, 2])
def test_no_number_gives_none(model, distribution, lane):
    u = np.full((2, 3), 0.4)
    u[1, lane] = np.nan
    options = {} if model is brdf.Plastic else {"alpha": 0.3, "distribution": distribution}
    draws = model(**options).sample(np.array([0.6, 0, 0.8]), u)
    assert np.isfinite(draws.weight[0]).all()
    for x in (draws.wi, draws.weight, draws.pdf, draws.eta):
        assert np.isnan(x[1]).all()


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("masking", ["height_correlated", "separable", "v_cavity"])
def test_no_more_comes_back_than_came(distribution, masking):
    for alpha in (0.05, 0.3, 1.0):
        for cosine in (1.0, 0.4, 0.05):
            model = brdf.RoughConductor(alpha, 1e-9, 1e9, distribution=distribution, masking=masking)
            u = np.random.default_rng(1).random((20000, 3))
            weight = model.sample(np.broadcast_to(common.at(cosine), (20000, 3)), u).weight
            # Three deviations of the mean.
            assert weight.mean() <= 1 + 3 * weight.std() / np.sqrt(20000) + 1e-5
            # Of normals that are seen no draw brings more; Beckmann's masking is rational, 0.35 % off.
            if masking != "v_cavity":
                assert weight.max() <= (1.004 if distribution == "beckmann" else 1 + 1e-9)


@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("cosine", [1.0, 0.5, 1e-3, 1e-6])
def test_draws_at_the_ends_are_directions(distribution, dtype, cosine):
    last = 1 - np.finfo(dtype).epsneg
    u = np.array([[a, b, 0.5] for a in (0, 0.5, last) for b in (0, 1e-30, 0.5, last)], dtype)
    for alpha in (0.05, 1.0):
        model = brdf.RoughConductor(alpha, ETA, K, distribution=distribution)
        draws = model.sample(np.broadcast_to(common.at(cosine).astype(dtype), (len(u), 3)), u)
        # Some lie below the horizon, and weigh nothing.
        assert np.isfinite(draws.weight).all() and not np.isnan(draws.pdf).any()
        np.testing.assert_allclose(np.linalg.norm(draws.wi, axis=-1), 1, rtol=20 * np.finfo(dtype).eps)


@pytest.mark.parametrize("model", [brdf.RoughConductor, brdf.RoughDielectric])
@pytest.mark.parametrize("distribution", ["ggx", "beckmann"])
def test_single_precision_keeps_the_light_where_it_says_so(model, distribution):
    every = (1e-7, 1e-5, 1e-3, 0.1, 1.0)
    # Of Beckmann's: facets of 0.01 and wider anywhere, and narrower ones down to cosines of 1e-3.
    cases = {alpha: every for alpha in (0.01, 0.1)} | {1e-3: every[2:], 1e-5: every[2:]}
    for alpha, cosines in cases.items() if distribution == "beckmann" else [(a, every) for a in cases]:
        index = (1.5,) if model is brdf.RoughDielectric else (1e-9, 1e9)
        some = model(alpha, *index, distribution=distribution)
        single, double = (
            brdf.directional_albedo(some, np.stack([common.at(c) for c in cosines]).astype(dtype), 2048)
            for dtype in (np.float32, np.float64)
        )
        # Draws at the edge of the horizon fall to either side: some of 2048.
        np.testing.assert_allclose(single, double, atol=1.5e-3)


def test_each_element_may_have_its_own_parameters():
    wi, wo = common.directions(6, 3), common.directions(6, 4)
    alpha = np.linspace(0.1, 0.9, 6)
    together = brdf.RoughConductor(alpha, ETA, K).eval(wi, wo)
    alone = [brdf.RoughConductor(float(a), ETA, K).eval(i, o) for a, i, o in zip(alpha, wi, wo, strict=True)]
    assert np.array_equal(together, alone)
    table = brdf.RoughConductor(alpha[:2, None], ETA, K).eval(wi, wo)
    assert np.array_equal(table[1], brdf.RoughConductor(float(alpha[1]), ETA, K).eval(wi, wo))
