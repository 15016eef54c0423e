"""Error metrics: against NumPy in long double, a peer, and by property."""

import numpy as np
import pytest
import shadelab as sl
from skimage.metrics import mean_squared_error

DTYPES = [np.float32, np.float64]


@pytest.fixture(params=DTYPES)
def pair(request):
    rng = np.random.default_rng(3)
    a, b = rng.lognormal(0, 2, (2, 67, 91, 3)).astype(request.param)
    return a, b


def test_rmse_agrees_with_scikit_image(pair):
    a, b = pair
    # The peer sums in double without compensation: 1e-12 relative covers its 18k terms.
    assert np.isclose(sl.image.rmse(a, b) ** 2, mean_squared_error(a.astype(float), b.astype(float)), rtol=1e-12)


def test_formulas_over_a_mask(pair):
    a, b = pair
    mask = np.random.default_rng(4).random(a.shape[:2]) < 0.1
    x, r = a[mask].astype(np.longdouble), b[mask].astype(np.longdouble)
    assert np.isclose(sl.image.rmse(a, b, mask), float(np.sqrt(((x - r) ** 2).mean())), rtol=1e-12)
    assert np.isclose(sl.image.relative_mse(a, b, mask), float(((x - r) ** 2 / (r**2 + 0.01)).mean()), rtol=1e-12)
    assert np.isclose(sl.image.smape(a, b, mask), float((abs(x - r) / (abs(x) + abs(r))).mean()), rtol=1e-12)


def test_pixels_outside_the_mask_do_not_matter(pair):
    a, b = pair
    mask = np.zeros(a.shape[:2], bool)
    mask[10:20] = True
    spoiled = a.copy()
    spoiled[~mask] = np.nan
    assert sl.image.rmse(spoiled, b, mask) == sl.image.rmse(a, b, mask)
    assert np.isnan(sl.image.rmse(spoiled, b))


def test_large_sums_lose_nothing():
    """One large term among 4 million small ones: plain float32 summation loses the small ones altogether."""
    a = np.full((2048, 2048), 1e-4, np.float32)
    a[0, 0] = 1e6
    exact = np.sqrt((float(np.float32(1e-4)) ** 2 * (a.size - 1) + 1e12) / a.size)
    assert abs(sl.image.rmse(a, np.zeros_like(a)) / exact - 1) < 1e-12


def test_equal_pictures_differ_by_nothing(pair):
    a, _ = pair
    assert sl.image.rmse(a, a) == sl.image.relative_mse(a, a) == sl.image.smape(a, a) == 0
    zero = np.zeros((3, 3))
    assert sl.image.smape(zero, zero) == 0


@pytest.mark.parametrize("n", [1, 2, 5])
def test_threads_change_nothing(pair, n):
    a, b = pair
    expected = sl.image.rmse(a, b)
    try:
        sl.set_threads(n)
        assert sl.image.rmse(a, b) == expected
    finally:
        sl.set_threads(None)


def test_bad_arguments_are_named():
    a = np.zeros((4, 5, 3))
    with pytest.raises(TypeError, match=r"image: .*decode_transfer"):
        sl.image.rmse(a.astype(np.uint8), a)
    with pytest.raises(ValueError, match="reference: expected the shape of image"):
        sl.image.rmse(a, a[:3])
    with pytest.raises(ValueError, match="mask: selects no pixel"):
        sl.image.rmse(a, a, np.zeros((4, 5), bool))
    with pytest.raises(TypeError, match="mask: expected booleans"):
        sl.image.rmse(a, a, np.ones((4, 5)))
    with pytest.raises(ValueError, match="image: expected at least one value"):
        sl.image.rmse(a[:0], a[:0])


def test_flip_sees_differences_and_only_those():
    rng = np.random.default_rng(5)
    a = rng.random((32, 48, 3)).astype(np.float32)
    b = a.copy()
    b[8:16, 8:16] += 0.5
    same, other = sl.image.flip_error(a, a), sl.image.flip_error(b, a)
    assert same.mean == 0 and same.map.shape == (32, 48)
    # The filters of FLIP reach some pixels beyond the square; far from it nothing is seen.
    assert other.map[8:16, 8:16].mean() > 10 * other.map[:, 40:].mean() and other.mean > 0
    with pytest.raises(ValueError, match=r"image: expected values in \[0, 1\]"):
        sl.image.flip_error(b, a, dynamic_range="ldr")
    black = np.zeros_like(a)
    assert sl.image.flip_error(black, black).mean == 0
    with pytest.raises(ValueError, match="reference: expected light"):
        sl.image.flip_error(a, black)
    with pytest.raises(ValueError, match="image: expected finite values"):
        sl.image.flip_error(a - 1, a)
