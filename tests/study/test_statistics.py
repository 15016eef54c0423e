"""The statistics of a study, on figures whose truth is known."""

import numpy as np
import pytest
from shadelab.study import statistics
from shadelab.study.statistics import Interval


@pytest.mark.parametrize("bias", [0.0, 0.02, 0.3])
def test_debiased_square_recovers_the_bias_under_a_noisy_reference(bias):
    rng = np.random.default_rng(1)
    shape, sigma = (200, 300), 0.2
    a, b = bias - sigma * rng.normal(size=(2, *shape))
    labels = statistics.tile_labels(shape)
    sums, counts = statistics.product_sums(a, b, labels, labels.max() + 1)
    # The product's standard deviation is below sigma² + 2·bias·sigma; five of it over the root of the count.
    allowed = 5 * (sigma**2 + 2 * bias * sigma) / np.sqrt(a.size)
    assert abs(sums.sum() / counts.sum() - bias**2) < allowed
    # The square against the mean of both halves keeps half of the noise: what debiasing is there to remove.
    assert abs(np.mean(((a + b) / 2) ** 2) - bias**2) > 3 * allowed


def test_tiles_cover_every_pixel_and_are_near_the_number_asked():
    for shape in [(1, 1), (7, 3), (360, 640), (1, 1000), (5000,)]:
        labels = statistics.tile_labels(shape, 256)
        assert labels.shape == shape and labels.min() == 0
        filled = len(np.unique(labels))
        assert filled <= 512 and (filled >= 200 or filled == np.prod(shape))


def test_bootstrap_interval_covers_the_mean_as_often_as_it_says():
    rng = np.random.default_rng(2)
    covered = 0
    for trial in range(200):
        sums = rng.exponential(size=200)
        interval = statistics.interval_of(statistics.bootstrap(sums, np.ones(200), seed=trial), float(sums.mean()))
        covered += interval.low <= 1.0 <= interval.high
    # 95 % nominal; a skewed sample of 200 covers a little less, and 200 trials spread by ±1.5 %.
    assert 0.89 <= covered / 200 <= 0.99


def test_empty_tiles_are_never_drawn():
    weights = statistics.resample(np.array([0.0, 3.0, 0.0, 1.0]))
    assert (weights[:, [0, 2]] == 0).all() and (weights.sum(1) == 2).all()


@pytest.mark.parametrize(("n", "cut"), [(3, 0), (5, 0), (6, 0), (9, 1), (20, 5)])
def test_median_interval_lies_between_the_binomial_order_statistics(n, cut):
    stats = pytest.importorskip("scipy.stats")
    interval = statistics.median_interval(np.arange(n)[::-1])
    assert (interval.value, interval.low, interval.high) == (np.median(np.arange(n)), cut, n - 1 - cut)
    assert stats.binom.cdf(cut + 1, n, 0.5) > 0.025  # one more could not have been cut
    assert cut == 0 or stats.binom.cdf(cut, n, 0.5) <= 0.025


def reps(error, spread, seed):
    return error + spread * np.random.default_rng(seed).normal(size=statistics.REPLICATES)


def times(value, spread=0.05):
    return Interval(value, value - spread, value + spread)


def test_front_keeps_what_no_other_beats_on_both_axes():
    errors = [reps(0.3, 0.01, 1), reps(0.1, 0.01, 2), reps(0.2, 0.01, 3)]
    assert statistics.nondominated(errors, [times(1), times(2), times(3)]) == [True, True, False]


def test_front_keeps_what_is_beaten_only_within_confidence():
    worse = [reps(0.10, 0.01, 1), reps(0.105, 0.01, 2)]
    assert statistics.nondominated(worse, [times(1), times(3)]) == [True, True]  # errors cannot be told apart
    clear = [reps(0.10, 0.01, 1), reps(0.2, 0.01, 2)]
    assert statistics.nondominated(clear, [times(1.0, 0.3), times(1.4, 0.3)]) == [True, True]  # times cannot


def test_paired_replicates_tell_apart_what_intervals_would_not():
    common = reps(0.1, 0.02, 1)
    assert statistics.nondominated([common, common * 1.02], [times(1), times(3)]) == [True, False]


def test_what_is_not_finite_is_never_on_the_front():
    assert statistics.nondominated([np.full(3, np.nan), np.full(3, 0.1)], [times(1), times(2)]) == [False, True]
