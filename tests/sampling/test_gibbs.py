"""Gibbs' sampler: a bound pair of normals, a picture, and what it cannot reach."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


def test_two_bound_normals():
    rho = 0.8

    def given(i):
        def draw(state, u):
            return rho * state[:, 1 - i] + np.sqrt(1 - rho**2) * stats.norm.ppf(np.clip(u, 1e-15, 1 - 1e-15))

        return draw

    found = sl.sampling.gibbs([given(0), given(1)], 600, start=[0.0, 0.0], chains=80, burn_in=30, seed=1)
    x = found.samples.reshape(-1, 2)
    # An autoregression of rho², whose effective sample size follows.
    assert found.effective_sample_size[0] == pytest.approx(len(x) * (1 - rho**2) / (1 + rho**2), rel=0.15)
    assert np.corrcoef(x.T)[0, 1] == pytest.approx(rho, abs=0.02)
    assert stats.kstest(x[::10, 0], "norm").pvalue > 1e-5
    assert (found.r_hat < 1.01).all() and (found.acceptance == 1).all()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_pictures_are_visited_as_their_weights_say(dtype):
    picture = np.random.default_rng(2).random((6, 9)).astype(dtype) ** 2
    picture[2, 3:] = 0
    found = sl.sampling.gibbs(picture, 20000, chains=8, burn_in=20, seed=3)
    assert found.samples.dtype == dtype
    cell = np.floor(found.samples.reshape(-1, 2) * [9, 6]).astype(int)
    counts = np.zeros(picture.shape)
    np.add.at(counts, (cell[:, 1], cell[:, 0]), 1)
    assert counts[picture == 0].sum() == 0
    target = picture / picture.sum(dtype=float)
    # Five sigma of a share, with a quarter of the samples independent.
    assert (np.abs(counts / counts.sum() - target) < 5 * np.sqrt(target / 40000) + 1e-12).all()


def test_modes_without_a_common_row_or_column_are_never_exchanged():
    found = sl.sampling.gibbs(np.eye(2), 200, chains=2, start=[[0.1, 0.1], [0.9, 0.9]])
    sides = found.samples > 0.5
    assert not sides[0].any() and sides[1].all()
    assert (found.r_hat > 2).all()


def test_arguments_are_checked():
    with pytest.raises(ValueError, match="start: expected 2 numbers a chain"):
        sl.sampling.gibbs([lambda s, u: u, lambda s, u: u], 5, start=[0.0])
    with pytest.raises(ValueError, match="target: expected 4 numbers of callable 1"):
        sl.sampling.gibbs([lambda s, u: u, lambda s, u: u[:2]], 5, start=[0.0, 0.0])
    with pytest.raises(ValueError, match="start: expected 2 numbers in"):
        sl.sampling.gibbs(np.eye(2), 5, start=[2.0, 0.0])
