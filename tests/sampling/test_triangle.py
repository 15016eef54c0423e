"""The triangle: uniform, inside, and inverted."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

METHODS = ["fold", "root"]


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_points_are_uniform_over_the_triangle(method, dtype):
    u = sl.sampling.Generator(1).uniform(np.arange(1 << 16)[:, None], 0, [0, 1], dtype)
    p = sl.sampling.square_to_triangle(u, method)
    assert p.dtype == dtype and (p >= 0).all() and (p.sum(-1) <= 1).all()
    # Triangles of a grid: the cell, and which side of its diagonal. Chance of failing 1e-6.
    n = 16
    cell = np.minimum((p * n).astype(int), n - 1)
    upper = ((p * n - cell).sum(-1) > 1).astype(int)
    counts = np.zeros((n, n, 2))
    np.add.at(counts, (cell[:, 0], cell[:, 1], upper), 1)
    i, j = np.indices((n, n))
    inside = np.stack([i + j < n, i + j < n - 1], -1)
    assert counts[~inside].sum() == 0
    assert stats.chisquare(counts[inside]).pvalue > 1e-6


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_inverse_returns_to_the_square(method, dtype):
    u = np.random.default_rng(3).random((10000, 2)).astype(dtype)
    p = sl.sampling.square_to_triangle(u, method)
    error = np.abs(sl.sampling.triangle_to_square(p, method) - u)
    if method == "root":
        # t is lost where all t meet.
        error[:, 1] *= np.sqrt(u[:, 0])
    assert error.max() < 2 * np.finfo(dtype).eps


def test_density_is_two_inside_and_integrates_to_one():
    grid = (np.indices((200, 200)).reshape(2, -1).T + 0.5) / 200
    # Cells cut by the diagonal are counted whole: half of 200 of 40000 cells too many, times two.
    assert sl.sampling.square_to_triangle_pdf(grid).mean() == pytest.approx(1, abs=0.006)
    assert np.isnan(sl.sampling.square_to_triangle_pdf([np.nan, 0.1]))
    assert np.array_equal(sl.sampling.square_to_triangle_pdf([[-0.1, 0.5], [0.6, 0.6], [0.3, 0.3]]), [0, 0, 2])


def test_nan_stays_in_its_row():
    p = sl.sampling.square_to_triangle([[np.nan, 0.5], [0.5, 0.5]])
    assert np.isnan(p[0]).any() and np.array_equal(p[1], [0.25, 0.25])


def test_points_beyond_the_square_are_nan_alone():
    got = sl.sampling.square_to_triangle([[2.0, 0.5], [-1.0, 0.5], [0.5, np.nan], [0.5, 0.25]])
    assert np.isnan(got[:3]).all() and np.isfinite(got[3]).all()


def test_mitsuba_maps_alike():
    mitsuba = pytest.importorskip("mitsuba")
    mitsuba.set_variant("scalar_rgb")
    for u, v in np.random.default_rng(2).random((50, 2)):
        # The first number runs the other way; single precision.
        theirs = np.array(mitsuba.warp.square_to_uniform_triangle([1 - u, v]))
        assert np.allclose(sl.sampling.square_to_triangle([u, v], "root"), theirs, atol=1e-6)
