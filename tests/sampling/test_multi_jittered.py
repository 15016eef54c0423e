"""Multi-jittered points: cells of the grid and strata of both axes hold one each; every point is uniform."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


@pytest.mark.parametrize("correlated", [True, False])
@pytest.mark.parametrize("grid", [(1, 1), (2, 2), (4, 8), (8, 3), (31, 17)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_grids_and_axes_are_stratified(correlated, grid, dtype):
    columns, rows = grid
    n = columns * rows
    for seed in range(4):
        p = sl.sampling.multi_jittered(grid, correlated=correlated, seed=seed, dtype=dtype)
        assert p.dtype == dtype
        p = p.astype(np.float64)
        assert len(np.unique(np.floor(p[:, 0] * columns) * rows + np.floor(p[:, 1] * rows))) == n
        assert (np.sort(np.floor(p * n), axis=0) == np.arange(n)[:, None]).all()


@pytest.mark.parametrize("correlated", [True, False])
@pytest.mark.parametrize("n", [6, 7, 13])
def test_every_point_is_uniform(correlated, n):
    p = np.array([sl.sampling.multi_jittered(n, correlated=correlated, seed=s) for s in range(1500)])
    for i in (0, n - 1):
        for axis in (0, 1):
            assert stats.kstest(p[:, i, axis], "uniform", method="asymp").pvalue > 1e-3 / 4
    assert (np.sort(np.floor(p[..., 1] * n), axis=1) == np.arange(n)).all()


def test_averages_gain_over_a_grid():
    def spread(points, f):
        return np.std([np.mean(f(*points(s).T)) for s in range(64)])

    def both(f):
        grid = spread(lambda s: sl.sampling.stratified((16, 16), seed=s), f)
        own = spread(lambda s: sl.sampling.multi_jittered((16, 16), correlated=False, seed=s), f)
        shared = spread(lambda s: sl.sampling.multi_jittered((16, 16), seed=s), f)
        return grid / own, grid / shared

    # What runs along the axes loses a factor of 16 in error; products keep some, more with orders that are shared.
    assert min(both(lambda x, y: np.exp(x) + np.cos(3 * y))) > 8
    assert both(lambda x, y: np.exp(x) * np.cos(3 * y))[0] > 1.8


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="n: expected a number or"):
        sl.sampling.multi_jittered((2, 2, 2))
    with pytest.raises(ValueError, match="n: expected an integer"):
        sl.sampling.multi_jittered((2, 0))
    assert sl.sampling.multi_jittered(0).shape == (0, 2)
