"""The hemisphere: uniform, above the horizon, inverted, and as Mitsuba maps it."""

import numpy as np
import pytest
import shadelab as sl

from . import _warps as warps

DTYPES = [np.float32, np.float64]
METHODS = ["concentric", "polar"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
def test_directions_are_uniform(method, dtype):
    d = sl.sampling.square_to_hemisphere(warps.numbers(1 << 16, dtype), method)
    assert d.dtype == dtype
    assert warps.fits(warps.sphere_cells(d), warps.density_cells(sl.sampling.square_to_hemisphere_pdf, len(d)))


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
def test_directions_are_unit_and_never_below_the_horizon(method, dtype):
    d = sl.sampling.square_to_hemisphere(warps.ends(dtype), method).astype(np.float64)
    assert (d[:, 2] >= 0).all()
    assert np.abs(np.linalg.norm(d, axis=-1) - 1).max() < 4 * np.finfo(dtype).eps


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
def test_the_inverse_returns_to_the_square(method, dtype):
    u = warps.numbers(10000, dtype)
    d = sl.sampling.square_to_hemisphere(u, method)
    error = np.abs(sl.sampling.hemisphere_to_square(d, method) - u)
    if method == "polar":
        error[:, 1] = np.minimum(error[:, 1], 1 - error[:, 1]) * np.hypot(d[:, 0], d[:, 1])
    assert error.max() < 6 * np.finfo(dtype).eps


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u in np.random.default_rng(2).random((50, 2)):
        theirs = np.array(mitsuba.warp.square_to_uniform_hemisphere(u.tolist()))
        assert np.allclose(sl.sampling.square_to_hemisphere(u), theirs, atol=1e-6)  # single precision


def test_density_is_zero_below():
    assert sl.sampling.square_to_hemisphere_pdf([0.0, 0.6, -0.8]) == 0
    assert np.isnan(sl.sampling.square_to_hemisphere_pdf([np.nan, 0, 1]))
