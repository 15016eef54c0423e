"""Latin hypercubes: one point a stratum of every axis, axes combined at random, variances as McKay's."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


@pytest.mark.parametrize("n", [0, 1, 2, 5, 64, 1000])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_one_point_lies_in_each_stratum(n, dtype):
    p = sl.sampling.latin_hypercube(n, 5, seed=4, dtype=dtype)
    assert p.dtype == dtype
    assert (np.sort(np.floor(p * dtype(n)), axis=0) == np.arange(n)[:, None]).all()


def test_axes_are_combined_at_random():
    # Which stratum of the second axis goes with the first of the first, and rank correlations.
    partners, correlations = [], []
    for seed in range(1500):
        p = np.floor(sl.sampling.latin_hypercube(8, 2, seed=seed) * 8).astype(int)
        partners.append(p[p[:, 0] == 0, 1][0])
        correlations.append(np.corrcoef(p.T)[0, 1])
    assert stats.chisquare(np.bincount(partners, minlength=8)).pvalue > 1e-3
    # Of random orders of 8 the correlation has variance 1 / 7.
    assert abs(np.var(correlations) * 7 - 1) < 0.2
    assert abs(np.mean(correlations)) < 4 / np.sqrt(7 * 1500)


def test_additive_integrands_lose_their_variance():
    values = [np.sin(3 * sl.sampling.latin_hypercube(64, 6, seed=s)).sum(1).mean() for s in range(64)]
    random = np.sqrt(6 * np.var(np.sin(3 * (np.arange(10000) + 0.5) / 10000)) / 64)
    # Each axis keeps its error within strata: 1 / n of the random one, times a constant.
    assert np.std(values) < random / 30
    assert abs(np.mean(values) - 6 * (1 - np.cos(3)) / 3) < 5 * np.std(values) / 8


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="n: expected an integer from 0"):
        sl.sampling.latin_hypercube(-1)
    with pytest.raises(ValueError, match="dimensions"):
        sl.sampling.latin_hypercube(3, 0)
