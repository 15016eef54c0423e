"""Star discrepancies: brute force over all boxes in rationals, closed forms, ties and faces."""

import itertools
from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st


def brute_force(points):
    points = [[Fraction(float(x)) for x in p] for p in points]
    n, best = len(points), Fraction(0)
    ends = [sorted({p[d] for p in points} | {Fraction(1)}) for d in range(len(points[0]))]
    for box in itertools.product(*ends):
        volume = Fraction(1)
        for side in box:
            volume *= side
        within = sum(all(x <= b for x, b in zip(p, box, strict=True)) for p in points)
        below = sum(all(x < b for x, b in zip(p, box, strict=True)) for p in points)
        best = max(best, Fraction(within, n) - volume, volume - Fraction(below, n))
    return float(best)


coordinates = st.one_of(st.integers(0, 4).map(lambda i: i / 4), st.floats(0, 1))


@settings(max_examples=60, deadline=None)
@given(
    st.integers(1, 4).flatmap(lambda d: st.lists(st.lists(coordinates, min_size=d, max_size=d), min_size=1, max_size=6))
)
def test_it_is_the_largest_over_all_boxes(points):
    assert abs(sl.sampling.star_discrepancy(points) - brute_force(points)) < 1e-15


@pytest.mark.parametrize("d", [2, 3])
def test_it_is_the_largest_over_many_points(d):
    rng = np.random.default_rng(d)
    n = {2: 24, 3: 12}[d]
    for points in (rng.uniform(size=(n, d)), sl.sampling.sobol(n, d), rng.integers(0, 5, (n, d)) / 4):
        assert abs(sl.sampling.star_discrepancy(points) - brute_force(points)) < 1e-15


def test_one_axis_has_a_closed_form():
    x = np.sort(np.random.default_rng(1).uniform(size=1000))
    # Niederreiter 1992, theorem 2.6.
    expected = 1 / 2000 + np.abs(x - (np.arange(1000) + 0.5) / 1000).max()
    assert abs(sl.sampling.star_discrepancy(x[:, None]) - expected) < 1e-15


def test_a_plain_sweep_of_many_points_agrees():
    p = sl.sampling.sobol(2000, 2, seed=3)
    p = p[np.argsort(p[:, 0])]
    levels, best = np.append(np.sort(p[:, 1]), 1), 0
    for i, x in enumerate(np.append(p[:, 0], 1)):
        y = np.sort(p[:i, 1])
        best = max(best, (x * levels - np.searchsorted(y, levels, "left") / 2000).max())
        y = np.sort(p[: i + 1, 1])
        best = max(best, (np.searchsorted(y, levels, "right") / 2000 - x * levels).max())
    assert abs(sl.sampling.star_discrepancy(p) - best) < 1e-15


def test_sequences_are_more_even_than_random_points():
    n = 4096
    random = sl.sampling.star_discrepancy(np.random.default_rng(0).uniform(size=(n, 2)))
    for points in (sl.sampling.sobol(n), sl.sampling.halton(n), sl.sampling.hammersley(n), sl.sampling.r2(n)):
        assert sl.sampling.star_discrepancy(points) < random / 5
    # A (0, 12, 2)-net in base 2: at most (12 / 2 + 3 / 2) / n (Niederreiter 1992, theorem 4.6), about.
    assert sl.sampling.star_discrepancy(sl.sampling.sobol(n, scramble=None)) < 7.5 / n


def test_bad_points_are_named():
    for bad in ([[0.5, 1.5]], [[np.nan, 0.5]], [0.5, 0.5], np.empty((0, 2))):
        with pytest.raises(ValueError, match="points: expected"):
            sl.sampling.star_discrepancy(bad)
