"""The cone: uniform whatever its size, inverted, and as Mitsuba maps it."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

from . import _warps as warps

DTYPES = [np.float32, np.float64]
METHODS = ["concentric", "polar"]
ANGLES = [1e-15, 1e-6, 1e-3, 0.3, np.pi / 2, 2.0, 3.1, np.pi]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("angle", ANGLES)
def test_directions_are_uniform_whatever_the_angle(method, dtype, angle):
    d = sl.sampling.square_to_cone(warps.numbers(1 << 15, dtype), angle, method)
    assert d.dtype == dtype
    wide = d.astype(np.float64)
    # 1 - cos without its cancellation, over that of the rim: uniform, and so is the turn.
    squared = wide[:, 0] ** 2 + wide[:, 1] ** 2
    depth = np.where(wide[:, 2] > 0, squared / (1 + np.sqrt(np.maximum(1 - squared, 0))), 1 - wide[:, 2])
    share = depth / (2 * np.sin(angle / 2) ** 2)
    assert share.max() < 1 + 16 * np.finfo(dtype).eps
    counts, *_ = np.histogram2d(
        share.clip(0, 1), np.arctan2(wide[:, 1], wide[:, 0]), (16, 32), [(0, 1), (-np.pi, 3.1415927)]
    )
    assert counts.sum() == len(d)
    assert stats.chisquare(counts.ravel()).pvalue > warps.UNLIKELY
    assert np.allclose(sl.sampling.square_to_cone_pdf(d, angle) * 4 * np.pi * np.sin(angle / 2) ** 2, 1, rtol=1e-5)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
def test_ends_of_the_square_stay_in_the_cone(method, dtype):
    for angle in ANGLES:
        d = sl.sampling.square_to_cone(warps.ends(dtype), angle, method)
        assert np.abs(np.linalg.norm(d.astype(np.float64), axis=-1) - 1).max() < 4 * np.finfo(dtype).eps
        assert (sl.sampling.square_to_cone_pdf(d, angle) > 0).all()
    assert (sl.sampling.square_to_cone(warps.ends(dtype), dtype(np.pi / 2), method)[:, 2] >= -np.finfo(dtype).eps).all()


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("angle", [1e-15, 1e-3, 0.3, np.pi / 2])
def test_the_inverse_returns_to_the_square(method, dtype, angle):
    u = warps.numbers(10000, dtype)
    d = sl.sampling.square_to_cone(u, angle, method)
    error = np.abs(sl.sampling.cone_to_square(d, angle, method) - u)
    if method == "polar":
        error[:, 1] = np.minimum(error[:, 1], 1 - error[:, 1]) * np.sqrt(u[:, 0])
    assert error.max() < 8 * np.finfo(dtype).eps


def test_outside_the_density_is_zero():
    for angle in [1e-12, 1e-4, 1.0, 2.5]:
        rim = angle * np.array([0.99, 1.01])
        d = np.stack([np.sin(rim), 0 * rim, np.cos(rim)], -1).astype(np.float32)
        assert ((sl.sampling.square_to_cone_pdf(d, angle) > 0) == [True, False]).all()


def test_the_cone_of_a_right_angle_is_the_hemisphere():
    u = warps.numbers(1000, np.float64)
    got, wanted = sl.sampling.square_to_cone(u, np.pi / 2), sl.sampling.square_to_hemisphere(u)
    assert np.allclose(got, wanted, atol=1e-15)


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u in np.random.default_rng(2).random((50, 2)):
        theirs = np.array(mitsuba.warp.square_to_uniform_cone(u.tolist(), np.cos(0.4)))
        assert np.allclose(sl.sampling.square_to_cone(u, 0.4), theirs, atol=2e-6)  # single precision
        pdf = mitsuba.warp.square_to_uniform_cone_pdf(theirs.tolist(), np.cos(0.4))
        assert sl.sampling.square_to_cone_pdf([0, 0, 1], 0.4) == pytest.approx(pdf, rel=1e-5)


@pytest.mark.parametrize("angle", [0.0, -1.0, 3.2, np.inf])
def test_angles_out_of_domain_are_nan_alone(angle):
    d = sl.sampling.square_to_cone([0.5, 0.5], [angle, 1.0])
    assert np.isnan(d[0]).all() and np.array_equal(d[1], [0, 0, 1])
