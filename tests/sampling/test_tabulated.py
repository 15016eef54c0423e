"""Tabulated densities: they give what their table says, invert, and hold at the extremes."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

DTYPES = [np.float32, np.float64]
UNLIKELY = 1e-5


def random(n, dtype, dimensions=1):
    u = sl.sampling.Generator(5).uniform(np.arange(n)[:, None], 0, np.arange(dimensions), dtype)
    return u if dimensions > 1 else u[:, 0]


@pytest.mark.parametrize("dtype", DTYPES)
def test_cells_come_as_often_as_their_weights_say(dtype):
    weights = np.random.default_rng(1).random(50).astype(dtype) ** 3
    weights[[0, 7, 8, 49]] = 0
    table = sl.sampling.Tabulated1D(weights)
    drawn = table.sample(random(1 << 16, dtype))
    assert drawn.point.dtype == drawn.pdf.dtype == dtype
    counts = np.bincount(drawn.cell, minlength=50)
    assert counts[weights == 0].sum() == 0
    kept = weights > 0
    expected = weights[kept].astype(float) / weights.sum(dtype=float) * len(drawn.cell)
    assert stats.chisquare(counts[kept], expected).pvalue > UNLIKELY
    within = drawn.point * 50 - drawn.cell
    assert stats.kstest(within, "uniform").pvalue > UNLIKELY


@pytest.mark.parametrize("dtype", DTYPES)
def test_densities_are_the_weights_over_their_mean(dtype):
    weights = np.random.default_rng(1).random(50).astype(dtype)
    table = sl.sampling.Tabulated1D(weights)
    x = (np.arange(50, dtype=dtype) + dtype(0.5)) / 50
    # A cell's probability is a difference of sums near 1.
    assert np.allclose(table.pdf(x), weights / weights.mean(dtype=float), atol=50 * np.finfo(dtype).eps)
    assert table.mean == pytest.approx(weights.mean(dtype=float), rel=1e-14)
    assert np.array_equal(table.pdf([-0.1, 1.1]), [0, 0]) and np.isnan(table.pdf(np.nan))


@pytest.mark.parametrize("dtype", DTYPES)
@pytest.mark.parametrize("n", [1, 2, 7, 1000, 70001])
def test_points_invert_and_have_the_density_of_their_cell(n, dtype):
    rng = np.random.default_rng(n)
    weights = (rng.random(n) * (rng.random(n) < 0.6) * 10.0 ** rng.uniform(-6, 6, n)).astype(dtype)
    weights[rng.integers(n)] = 1
    table = sl.sampling.Tabulated1D(weights)
    u = np.append(random(20000, dtype), np.array([0, np.nextafter(dtype(1), dtype(0)), 1], dtype))
    drawn = table.sample(u)
    assert (drawn.point >= 0).all() and (drawn.point < 1).all()
    assert (weights[drawn.cell] > 0).all()
    assert np.array_equal(table.pdf(drawn.point), drawn.pdf) and (drawn.pdf > 0).all()
    # A point's rounding, half an ulp of 1, times the density; and the sums' own.
    assert (np.abs(table.invert(drawn.point) - u) <= (2 + 2 * drawn.pdf) * np.finfo(dtype).eps).all()


@pytest.mark.parametrize("dtype", DTYPES)
def test_the_plane_is_sampled_as_its_picture_says(dtype):
    weights = np.random.default_rng(2).random((12, 20)).astype(dtype) ** 4
    weights[3] = 0
    weights[5, :7] = 0
    table = sl.sampling.Tabulated2D(weights)
    drawn = table.sample(random(1 << 16, dtype, 2))
    counts = np.zeros((12, 20))
    np.add.at(counts, (drawn.cell[:, 1], drawn.cell[:, 0]), 1)
    assert counts[weights == 0].sum() == 0
    expected = weights.astype(float) / weights.sum(dtype=float) * len(drawn.pdf)
    kept = expected > 5
    pooled = np.append(counts[kept], counts[~kept].sum()), np.append(expected[kept], expected[~kept].sum())
    assert stats.chisquare(*pooled).pvalue > UNLIKELY
    assert np.allclose(drawn.pdf, weights[drawn.cell[:, 1], drawn.cell[:, 0]] / weights.mean(), atol=1e-4)
    assert np.allclose(table.pdf(drawn.point), drawn.pdf)
    back = table.invert(drawn.point)
    assert (np.abs(back - random(1 << 16, dtype, 2)) <= 60 * np.finfo(dtype).eps).all()
    assert np.allclose(table.marginal.pdf((np.arange(12) + 0.5) / 12), weights.mean(1) / weights.mean(), atol=1e-5)
    row = table.conditional(5).pdf((np.arange(20) + 0.5) / 20)
    assert np.allclose(row, weights[5] / weights[5].mean(), atol=1e-5)
    assert np.allclose(table.conditional(3).pdf(random(9, dtype)), 1)  # no weight: even


def test_scipy_draws_alike():
    weights = np.array([1.0, 4.0, 0.0, 2.0])
    theirs = stats.rv_histogram((weights, np.linspace(0, 1, 5)))
    u = np.linspace(0.01, 0.99, 37)
    table = sl.sampling.Tabulated1D(weights)
    assert np.allclose(table.sample(u).point, theirs.ppf(u), atol=1e-14)
    assert np.allclose(table.pdf(u), theirs.pdf(u))
    assert np.allclose(table.invert(u), theirs.cdf(u))


@pytest.mark.parametrize("dtype", DTYPES)
def test_estimates_are_unbiased_beside_a_sun(dtype):
    """The mean of f / pdf is the integral, also where the sums round the cells' probabilities."""
    weights = np.random.default_rng(3).random(4096).astype(dtype)
    weights[1000] = 1e5
    table = sl.sampling.Tabulated1D(weights)
    u = (np.arange(1 << 18) + 0.5) / (1 << 18)
    drawn = table.sample(u.astype(dtype))
    f = weights[drawn.cell].astype(float) / drawn.pdf
    # Stratified u: what remains is the cut of cells by strata, some 1e-3 of the dim part (2 %).
    assert f.mean() == pytest.approx(weights.mean(dtype=float), rel=1e-4)


@pytest.mark.parametrize("bad", [-1.0, np.nan, np.inf])
def test_weights_are_checked_and_named(bad):
    with pytest.raises(ValueError, match="weights: expected finite numbers of at least 0, got another at 2"):
        sl.sampling.Tabulated1D([1, 2, bad])
    with pytest.raises(ValueError, match=r"weights: .* at \(1, 0\)"):
        sl.sampling.Tabulated2D([[1, 2], [bad, 0]])
    with pytest.raises(ValueError, match="weights: expected a positive one"):
        sl.sampling.Tabulated1D([0.0, 0.0])
    with pytest.raises(ValueError, match="weights: expected 1 to"):
        sl.sampling.Tabulated1D([])
    with pytest.raises(ValueError, match=r"weights: expected shape \(H, W\)"):
        sl.sampling.Tabulated2D([1.0, 2.0])


def test_numbers_outside_the_domain_are_marked():
    drawn = sl.sampling.Tabulated1D([1.0, 1.0]).sample([-0.1, np.nan, 1.1, 0.25])
    assert np.isnan(drawn.point[:3]).all() and np.array_equal(drawn.cell, [-1, -1, -1, 0])
    drawn = sl.sampling.Tabulated2D([[1.0, 1.0]]).sample([[np.nan, 0.5], [0.5, 2.0], [0.5, 0.5]])
    assert np.isnan(drawn.point[:2]).all() and np.array_equal(drawn.cell, [[-1, -1], [-1, -1], [1, 0]])


def test_threads_change_nothing():
    weights = np.random.default_rng(4).random((300, 1000))
    u = random(50000, np.float64, 2)
    results = []
    for threads in (1, 2, 3):
        sl.set_threads(threads)
        results.append(sl.sampling.Tabulated2D(weights).sample(u).point)
    sl.set_threads(None)
    assert np.array_equal(results[0], results[1]) and np.array_equal(results[0], results[2])
