"""Averages over the hemisphere against adaptive quadrature of the reflectances themselves."""

from itertools import pairwise

import numpy as np
import pytest
from scipy import integrate
from shadelab import brdf


def average(reflectance):
    """By halves at the bend near grazing."""
    ends = [0.0, 1e-6, 1e-4, 1e-2, 0.1, 0.5, 1.0]
    f = lambda c: 2 * c * float(reflectance(c))  # noqa: E731
    return sum(integrate.quad(f, a, b, epsabs=1e-13)[0] for a, b in pairwise(ends))


@pytest.mark.parametrize("eta", [1.0, 1 + 1e-7, 1.001, 1.019, 1.021, 1.33, 1.5, 2.4, 10.0])
def test_clear_bodies(eta):
    expected = average(lambda c: brdf.fresnel(c, eta))
    assert float(brdf.fresnel_average(eta)) == pytest.approx(expected, abs=1e-9)


@pytest.mark.parametrize("eta", [0.99, 0.75, 0.4])
def test_what_comes_out_is_what_goes_in(eta):
    critical = np.sqrt(1 - eta * eta)
    f = lambda c: 2 * c * float(brdf.fresnel(c, eta))  # noqa: E731
    expected = critical**2 + integrate.quad(f, critical, 1, epsabs=1e-12, limit=200)[0]
    assert float(brdf.fresnel_average(eta)) == pytest.approx(expected, abs=1e-8)


@pytest.mark.parametrize(("eta", "k"), [(0.2, 3.9), (1.1, 2.1), (2.9, 3.1), (0.05, 5.0), (10.0, 50.0)])
def test_metals(eta, k):
    expected = average(lambda c: brdf.fresnel(c, eta, k))
    assert float(brdf.fresnel_average(eta, k)) == pytest.approx(expected, abs=1e-7)


def test_schlicks_polynomial():
    for f0 in (0.04, 0.5):
        expected = average(lambda c, f0=f0: brdf.fresnel_schlick(c, f0))
        assert float(brdf.fresnel_average(f0=f0)) == pytest.approx(expected, abs=1e-12)
    with pytest.raises(ValueError, match="either an index or f0"):
        brdf.fresnel_average()


@pytest.mark.parametrize(("eta", "k"), [(0.5, 0.01), (0.5, 0.0), (0.9, 1e-3), (1e-3, 1e-3)])
def test_thin_media_that_absorb_little_have_their_bend(eta, k):
    """Against a midpoint rule over many cosines."""
    c = (np.arange(1 << 20) + 0.5) / (1 << 20)
    exact = (2 * c * brdf.fresnel(c, eta, k)).mean()
    assert float(brdf.fresnel_average(eta, k)) == pytest.approx(exact, abs=1e-5)
