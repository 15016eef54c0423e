"""The sphere: uniform, unit, inverted, and as Mitsuba maps it."""

import numpy as np
import pytest
import shadelab as sl

from . import _warps as warps

DTYPES = [np.float32, np.float64]


@pytest.mark.parametrize("dtype", DTYPES)
def test_directions_are_uniform(dtype):
    d = sl.sampling.square_to_sphere(warps.numbers(1 << 16, dtype))
    assert d.dtype == dtype
    assert warps.fits(warps.sphere_cells(d), warps.density_cells(sl.sampling.square_to_sphere_pdf, len(d)))


@pytest.mark.parametrize("dtype", DTYPES)
def test_directions_are_unit_also_at_the_ends(dtype):
    d = sl.sampling.square_to_sphere(warps.ends(dtype)).astype(np.float64)
    assert np.abs(np.linalg.norm(d, axis=-1) - 1).max() < 3 * np.finfo(dtype).eps


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_inverse_returns_to_the_square(dtype):
    u = warps.numbers(10000, dtype)
    d = sl.sampling.square_to_sphere(u)
    error = np.abs(sl.sampling.sphere_to_square(d) - u)
    error[:, 1] = np.minimum(error[:, 1], 1 - error[:, 1]) * np.hypot(d[:, 0], d[:, 1])
    assert error.max() < 4 * np.finfo(dtype).eps
    inside = sl.sampling.sphere_to_square(sl.sampling.square_to_sphere(warps.ends(dtype)))
    assert (inside >= 0).all() and (inside < 1).all()


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u, v in np.random.default_rng(2).random((50, 2)):
        theirs = np.array(mitsuba.warp.square_to_uniform_sphere([v, u]))
        assert np.allclose(sl.sampling.square_to_sphere([u, v]), theirs, atol=1e-6)  # single precision


def test_nan_stays_in_its_row():
    d = sl.sampling.square_to_sphere([[np.nan, 0.5], [2, 0], [0.5, 0.0]])
    assert np.isnan(d[:2]).any(-1).all() and np.allclose(d[2], [1, 0, 0])
    assert np.isnan(sl.sampling.square_to_sphere_pdf([np.nan, 0, 0]))
