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


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("nonlinear", [False, True])
@pytest.mark.parametrize("eta", [1.0, 1 + 1e-7, 1.5, 30.0, 1e3, 1e6, 1e9])
def test_any_index_keeps_its_digits(dtype, nonlinear, eta):
    """Against the formula with 40 digits: little passes a coat of a large index, and no difference may make it."""
    mpmath = pytest.importorskip("mpmath")
    wi, wo = common.directions(5, 3, dtype, 0.05), common.directions(5, 4, dtype, 0.05)
    model = brdf.Plastic((0.2, 0.5, 1.0), eta, nonlinear)
    with mpmath.workdps(40):
        n = mpmath.mpf(eta) if dtype == np.float64 else mpmath.mpf(float(np.float32(eta)))

        def passed(c):
            c = mpmath.mpf(float(c))
            g = mpmath.sqrt(n * n - 1 + c * c)
            return 1 - (((c - g) / (c + g)) ** 2 + ((n * n * c - g) / (n * n * c + g)) ** 2) / 2

        # Across its bend near c ~ 1/η the average is by pieces.
        ends = [0, *(mpmath.mpf(100) ** -k for k in range(5, 0, -1)), 1]
        passes = mpmath.quad(lambda c: 2 * c * passed(c), ends)
        inner = 1 - passes / (n * n)
        expected = np.array(
            [
                [float(d * passed(i) * passed(o) / (n * n * mpmath.pi * (1 - inner * (d if nonlinear else 1))))
                 for d in map(mpmath.mpf, (0.2, 0.5, 1.0))]
                for i, o in zip(wi[:, 2], wo[:, 2], strict=True)
            ]
        )  # fmt: skip
    got = model.eval(wi, wo)
    # The average in double is 1 less its closed form, whose last digits count η / 5 times.
    loose = 40 * np.finfo(dtype).eps + 1e-14 * eta
    np.testing.assert_allclose(got, expected, rtol=max(loose, 1e-9 if dtype == np.float64 else 0))
    draws = model.sample(wo, np.random.default_rng(1).random((5, 3)).astype(dtype))
    assert np.isfinite(draws.weight).all() and np.isfinite(draws.pdf).all()
