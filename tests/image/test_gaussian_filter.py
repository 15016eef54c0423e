"""The Gaussian filter against SciPy, border for border; constants stay constant."""

import numpy as np
import pytest
import scipy.ndimage
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st


@given(
    st.integers(1, 90),
    st.integers(1, 60),
    st.sampled_from([None, 1, 3, 4]),
    st.sampled_from([(0.0, 0.0), (0.4, 0.4), (2.0, 0.0), (0.0, 1.3), (5.0, 7.0)]),
    st.sampled_from(["nearest", "reflect", "wrap"]),
    st.sampled_from([3.0, 4.0]),
    st.sampled_from([np.float32, np.float64]),
)
@settings(max_examples=80, deadline=None)
def test_agrees_with_scipy(height, width, channels, sigma, border, truncate, dtype):
    shape = (height, width) if channels is None else (height, width, channels)
    image = np.random.default_rng(1).random(shape).astype(dtype)
    blurred = sl.image.gaussian_filter(image, sigma, truncate=truncate, border=border)
    assert blurred.dtype == dtype and blurred.shape == shape
    across, down = sigma
    each = (down, across) if channels is None else (down, across, 0.0)
    peer = scipy.ndimage.gaussian_filter(image.astype(np.float64), each, mode=border, truncate=truncate)
    # Up to 60 terms of up to 1 with weights that sum to 1, twice.
    np.testing.assert_allclose(blurred, peer, rtol=0, atol=6 * np.finfo(dtype).eps)


def test_a_constant_stays_and_energy_is_kept():
    assert np.allclose(sl.image.gaussian_filter(np.full((40, 50), 3.0), 6.0), 3.0, rtol=1e-15)
    image = np.random.default_rng(2).random((64, 64))
    assert sl.image.gaussian_filter(image, 5.0, border="wrap").mean() == pytest.approx(image.mean(), rel=1e-14)


def test_the_same_for_any_number_of_threads_and_in_place():
    image = np.random.default_rng(3).random((700, 33), np.float32)
    results = []
    for n in (1, 2, 3):
        sl.set_threads(n)
        results.append(sl.image.gaussian_filter(image, 3.0))
    sl.set_threads(None)
    assert all(np.array_equal(results[0], r) for r in results[1:])
    assert np.array_equal(sl.image.gaussian_filter(image, 3.0, out=image), results[0])


def test_errors_name_the_argument():
    image = np.ones((4, 4))
    for name, kwargs in (("sigma", {"sigma": -1}), ("sigma", {"sigma": 1e4}), ("sigma", {"sigma": (1, 2, 3)})):
        with pytest.raises(ValueError, match=name):
            sl.image.gaussian_filter(image, **kwargs)
    with pytest.raises(ValueError, match="border"):
        sl.image.gaussian_filter(image, 1.0, border="mirror")
    with pytest.raises(ValueError, match="truncate"):
        sl.image.gaussian_filter(image, 1.0, truncate=-1)
    with pytest.raises(ValueError, match="truncate: expected a reach"):
        sl.image.gaussian_filter(image, 1.0, truncate=1e9)
    with pytest.raises(ValueError, match="sigma: expected a reach"):
        sl.image.gaussian_filter(image, 1e9)
    with pytest.raises(TypeError, match="image"):
        sl.image.gaussian_filter(np.ones((4, 4), np.uint8), 1.0)
