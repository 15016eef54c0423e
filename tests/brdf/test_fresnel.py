"""Schlick's reflectance: its ends, and how far it is from Fresnel's equations."""

import numpy as np
import pytest
import shadelab as sl
from shadelab import brdf


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_ends_are_f0_and_f90(dtype):
    f0 = np.array([0.0, 0.04, 0.9, 1.0], dtype)
    got = sl.brdf.fresnel_schlick(np.array([[1.0], [0.0]], dtype), f0, 1.0)
    assert (
        got.dtype == dtype and np.array_equal(got[0], f0) and np.allclose(got[1], 1, rtol=0, atol=np.finfo(dtype).eps)
    )


def test_glass_is_within_four_hundredths_of_fresnels_equations():
    c = np.linspace(0, 1, 1001)
    t = np.sqrt(1 - (1 - c * c) / 1.5**2)
    exact = (((c - 1.5 * t) / (c + 1.5 * t)) ** 2 + ((1.5 * c - t) / (1.5 * c + t)) ** 2) / 2
    assert np.abs(sl.brdf.fresnel_schlick(c, 0.04) - exact).max() < 0.04


def test_cosines_out_of_domain_give_nan():
    assert np.array_equal(np.isnan(sl.brdf.fresnel_schlick([-0.1, np.nan, 0.5, 1.1])), [True, True, False, True])
    with pytest.raises(ValueError, match=r"f0: expected a number in \[0, 1\], got 2"):
        sl.brdf.fresnel_schlick([0.5], 2.0)


def test_glass_and_metal_are_mitsubas():
    mi = pytest.importorskip("mitsuba")
    mi.set_variant("scalar_rgb")
    cosines = np.linspace(0, 1, 41)
    for eta in (1.5, 1.1, 1 / 1.5):
        expected = np.array([mi.fresnel(float(c), eta) for c in cosines])
        got = brdf.fresnel(cosines, eta, full_output=True)
        np.testing.assert_allclose(got.unpolarized, expected[:, 0], rtol=1e-5, atol=1e-7)
        np.testing.assert_allclose(got.cos_t, np.abs(expected[:, 1]), rtol=1e-5, atol=1e-3)
    for eta, k in ((0.2, 3.9), (1.1, 2.1), (2.9, 3.1)):
        expected = [mi.fresnel_conductor(float(c), mi.Complex2f(eta, k)) for c in cosines[1:]]
        np.testing.assert_allclose(brdf.fresnel(cosines[1:], eta, k), expected, rtol=1e-5)


def test_brewsters_angle_and_total_reflection():
    c = np.cos(np.arctan(1.5))
    assert float(brdf.fresnel(c, 1.5, full_output=True).p) < 1e-30
    inside = brdf.fresnel([0.74, 0.5, 0.0], 1 / 1.5, full_output=True)
    assert np.array_equal(inside.s, [1, 1, 1]) and not inside.cos_t.any()


def test_schlicks_largest_error():
    """0.036 of glass of 1.5."""
    c = np.linspace(0, 1, 100001)
    off = np.abs(brdf.fresnel_schlick(c, 0.04) - brdf.fresnel(c, 1.5))
    assert off.max() == pytest.approx(0.036, abs=5e-4)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_indices_near_one_keep_their_digits(dtype):
    """Along the normal ((η − 1)/(η + 1))², however small."""
    for step in (1e-3, 1e-6):
        eta = np.array(1 + step, dtype)
        exact = ((float(eta) - 1) / (float(eta) + 1)) ** 2
        assert float(brdf.fresnel(np.array(1, dtype), eta)) == pytest.approx(exact, rel=16 * float(np.finfo(dtype).eps))
    assert not brdf.fresnel(np.linspace(0, 1, 11, dtype=dtype), 1.0).any()


def test_a_metal_without_extinction_is_a_clear_body():
    c = np.linspace(0.01, 1, 50)
    for eta in (1.5, 0.7):
        np.testing.assert_allclose(brdf.fresnel(c, eta, 0.0), brdf.fresnel(c, eta), rtol=1e-9, atol=1e-15)


def test_huge_indices_are_out_of_the_domain():
    cosines = np.linspace(0, 1, 9)
    for dtype in (np.float32, np.float64):
        mirror = brdf.fresnel(cosines.astype(dtype), 1e9, 1e9)
        assert np.isfinite(mirror).all() and mirror.min() > 0.99
        assert np.isfinite(brdf.fresnel(cosines.astype(dtype), 1e9)).all()
    for given in ((1e300,), (1e10, 0.0), (1.5, 1e160), (1.5, -1.0)):
        assert np.isnan(brdf.fresnel(cosines, *given)).all()
