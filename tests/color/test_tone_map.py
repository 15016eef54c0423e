"""Tone maps: bounds, order, published values, limits."""

import numpy as np
import pytest
import shadelab as sl

METHODS = ["clip", "reinhard", "reinhard_extended", "aces"]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("method", METHODS)
def test_maps_all_light_into_zero_to_one_in_order(dtype, method):
    x = np.concatenate([[0.0], np.logspace(-30, 30, 4001), [np.finfo(dtype).max, np.inf]]).astype(dtype)
    y = sl.color.tone_map(x, method)
    assert y.dtype == dtype and y[0] == 0 and (y >= 0).all() and (y <= 1).all() and y[-1] > 0.999
    # Not decreasing, up to the rounding of a quotient of two rounded sums.
    assert (np.diff(y) >= -4 * np.finfo(dtype).eps).all()


@pytest.mark.parametrize("method", METHODS)
def test_negative_is_black_and_nan_stays_alone(method):
    y = sl.color.tone_map([-np.inf, -1.0, np.nan, 0.25], method)
    assert np.array_equal(y[:2], [0, 0]) and np.isnan(y[2]) and 0 < y[3] < 1


def test_published_values():
    assert sl.color.tone_map(1.0, "reinhard") == 0.5
    # Narkowicz's fit at one: (2.51 + 0.03) / (2.43 + 0.59 + 0.14).
    assert np.isclose(sl.color.tone_map(1.0, "aces"), 2.54 / 3.16, rtol=1e-15)
    assert sl.color.tone_map(6.0, "reinhard_extended", white=6.0) == 1.0
    assert np.isclose(sl.color.tone_map(2.0, "reinhard_extended", white=6.0), 2 * (1 + 2 / 36) / 3, rtol=1e-15)


def test_exposure_counts_stops():
    x = np.linspace(0, 3, 50)
    assert np.array_equal(sl.color.tone_map(x, exposure=2.0), sl.color.tone_map(4 * x))


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="method: expected one of"):
        sl.color.tone_map([1.0], "filmic")
    with pytest.raises(ValueError, match="white: expected"):
        sl.color.tone_map([1.0], "reinhard_extended", white=0.0)
    with pytest.raises(ValueError, match="exposure: expected"):
        sl.color.tone_map([1.0], exposure=float("nan"))
