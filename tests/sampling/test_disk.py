"""The disk: uniform, inside, and inverted."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

METHODS = ["concentric", "polar"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_points_are_uniform_over_the_disk(method, dtype):
    u = sl.sampling.Generator(1).uniform(np.arange(1 << 16)[:, None], 0, [0, 1], dtype)
    p = sl.sampling.square_to_disk(u, method)
    assert p.dtype == dtype
    # Rings of equal area times sectors; chance of failing 1e-6, the seed is fixed.
    r2, angle = (p**2).sum(-1), np.arctan2(p[:, 1], p[:, 0])
    counts, *_ = np.histogram2d(r2, angle, (16, 32), [(0, 1.0001), (-np.pi, np.pi)])
    assert counts.sum() == len(p)
    assert stats.chisquare(counts.ravel()).pvalue > 1e-6


@pytest.mark.parametrize("method", METHODS)
def test_areas_keep_their_proportion_everywhere(method):
    u = np.random.default_rng(2).uniform(0.01, 0.99, (2000, 2))
    # Away from the seams, where the map has no derivative.
    if method == "concentric":
        u = u[(np.abs(np.abs(u[:, 0] - 0.5) - np.abs(u[:, 1] - 0.5)) > 1e-3)]
    h = 1e-6
    dx, dy = (
        (sl.sampling.square_to_disk(u + e, method) - sl.sampling.square_to_disk(u - e, method)) / (2 * h)
        for e in np.eye(2) * h
    )
    area = dx[:, 0] * dy[:, 1] - dx[:, 1] * dy[:, 0]
    # Central differences at h = 1e-6: 1e-10 of rounding over h, 1e-4 relative near the centre.
    assert np.allclose(
        np.abs(area) * sl.sampling.square_to_disk_pdf(sl.sampling.square_to_disk(u, method)), 1, atol=1e-4
    )


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_inverse_returns_to_the_square(method, dtype):
    u = np.random.default_rng(3).random((10000, 2)).astype(dtype)
    back = sl.sampling.disk_to_square(sl.sampling.square_to_disk(u, method), method)
    # The angle is worth 1/r near the centre, in both maps.
    r = np.hypot(*sl.sampling.square_to_disk(u, method).T)
    wrap = np.abs(back - u)
    error = np.minimum(wrap, 1 - wrap) if method == "polar" else wrap
    assert (error[:, 0] < 4 * np.finfo(dtype).eps).all()
    assert (error[:, 1] * (r if method == "polar" else 1) < 4 * np.finfo(dtype).eps).all()


def test_nan_stays_in_its_row():
    p = sl.sampling.square_to_disk([[np.nan, 0.5], [1.0, 0.5]])
    assert np.isnan(p[0]).any() and np.array_equal(p[1], [1, 0])
    assert np.isnan(sl.sampling.square_to_disk_pdf([[np.nan, 0.0]])).all()


def test_unknown_methods_are_named():
    with pytest.raises(ValueError, match="method: expected one of 'concentric', 'polar', got 'square'"):
        sl.sampling.square_to_disk([0.5, 0.5], "square")


def test_points_beyond_the_square_are_nan_alone():
    got = sl.sampling.square_to_disk([[2.0, 0.5], [-1.0, 0.5], [0.5, np.nan], [0.5, 0.25]])
    assert np.isnan(got[:3]).all() and np.isfinite(got[3]).all()


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u, v in np.random.default_rng(2).random((50, 2)):
        # The radius comes from the first number here, from the second there; single precision.
        theirs = np.array(mitsuba.warp.square_to_uniform_disk([v, u]))
        assert np.allclose(sl.sampling.square_to_disk([u, v], "polar"), theirs, atol=1e-6)
        theirs = np.array(mitsuba.warp.square_to_uniform_disk_concentric([u, v]))
        assert np.allclose(sl.sampling.square_to_disk([u, v], "concentric"), theirs, atol=1e-6)
