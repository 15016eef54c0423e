"""Schlick's reflectance: its ends, and how far it is from Fresnel's equations."""

import numpy as np
import pytest
import shadelab as sl


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
