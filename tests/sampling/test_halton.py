"""Halton points: exact digits, SciPy's sequence, strata that survive scrambling, and any start."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from scipy import stats
from scipy.stats import qmc

PRIMES = [p for p in range(2, 8934) if all(p % q for q in range(2, int(p**0.5) + 1))]
SCRAMBLES = [None, "digits", "owen"]


def mirrored(index, base):
    number, power = 0, 1
    while index:
        index, digit = divmod(index, base)
        number, power = number * base + digit, power * base
    return Fraction(number, power)


def test_plain_points_are_scipys():
    expected = qmc.Halton(1111, scramble=False).random(2000)
    got = sl.sampling.halton(2000, 1111, scramble=None)
    # SciPy sums digits in doubles; ours are within two ulps.
    assert np.abs(got - expected).max() < 4e-15


@pytest.mark.parametrize("start", [0, 1000, 2**32 - 3, 2**53, 2**64 - 6])
@pytest.mark.parametrize("n", [6, 300])
def test_plain_points_are_exact_to_two_ulps(start, n):
    start = min(start, 2**64 - n)
    # Looked-up digits of small primes, and those of large ones that are counted.
    got = sl.sampling.halton(n, 1111, scramble=None, start=start)
    for i in {0, 1, n // 2, n - 1}:
        for d in (*range(40), 96, 97, 300, 1110):
            exact = mirrored(start + i, PRIMES[d])
            limit = 2 * np.spacing(float(exact)) if exact else 0
            assert abs(Fraction(float(got[i, d])) - exact) <= limit


@pytest.mark.parametrize("scramble", SCRAMBLES)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_axis_is_stratified_in_its_base(scramble, dtype):
    for d, base in enumerate(PRIMES[:12]):
        digits = int(np.log(4000) / np.log(base))
        n = base**digits
        p = sl.sampling.halton(n, d + 1, scramble=scramble, seed=4, start=3 * n, dtype=dtype)[:, d].astype(np.float64)
        # float32 rounds 1/3 and the like: a hair above keeps the stratum.
        cell = np.floor(p * n * (1 + 2e-7 if scramble is None else 1) + 1e-4 * (scramble is None))
        assert len(np.unique(np.minimum(cell, n - 1))) == n
        assert p.min() >= 0
        assert p.max() < 1


@pytest.mark.parametrize("scramble", ["digits", "owen"])
def test_boxes_of_two_bases_hold_one_point_each(scramble):
    p = sl.sampling.halton(2**5 * 3**3 * 5**2, 3, scramble=scramble, seed=8)
    cell = np.floor(p * [2**5, 3**3, 5**2]) @ [3**3 * 5**2, 5**2, 1]
    assert len(np.unique(cell)) == len(p)


@pytest.mark.parametrize("scramble", SCRAMBLES)
@pytest.mark.parametrize("start", [0, 77, 2**32 - 100])
def test_going_on_later_gives_the_same_points(scramble, start):
    whole = sl.sampling.halton(1000, 9, scramble=scramble, seed=4, start=start)
    part = sl.sampling.halton(300, 9, scramble=scramble, seed=4, start=start + 357)
    # Where looked-up digits end depends on n: plain and digit-scrambled sums round differently by an ulp.
    assert np.allclose(whole[357:657], part, rtol=0, atol=0 if scramble == "owen" else 3e-16)
    assert sl.sampling.halton(0, 3, scramble=scramble).shape == (0, 3)


@pytest.mark.parametrize("scramble", ["digits", "owen"])
def test_scrambled_points_are_uniform(scramble):
    # Points 0, 1 and 100 of dimensions 1 … 40 over 200 seeds: 24,000 uniform numbers in 100 cells.
    p = np.array([sl.sampling.halton(101, 40, scramble=scramble, seed=s)[[0, 1, 100]] for s in range(200)])
    counts = np.bincount((p.ravel() * 100).astype(int), minlength=100)
    assert stats.chisquare(counts).pvalue > 1e-3


def test_nested_permutations_are_independent_of_each_other():
    # Base 3: of two points that share no digit, and of two that share the first, the digits that follow.
    first, second = np.array([np.floor(sl.sampling.halton(9, 2, seed=s)[:, 1] * 9) for s in range(3000)]).T.astype(int)[
        [0, 1]
    ]
    counts = np.histogram2d(first % 3, second % 3, bins=3)[0]
    assert stats.chi2_contingency(counts).pvalue > 1e-3
    assert (first // 3 != second // 3).all()


def test_scrambled_averages_are_unbiased_and_better_than_random():
    values = {n: [] for n in (216, 6**3 * 36)}
    for n, means in values.items():
        for seed in range(64):
            x, y = sl.sampling.halton(n, 2, seed=seed).T
            means.append(np.mean(np.exp(x) * np.cos(3 * y)))
    exact = (np.e - 1) * np.sin(3) / 3
    assert abs(np.mean(values[216]) - exact) < 5 * np.std(values[216]) / 8
    # A factor of 36 in n: random points gain 6, n^-1 gains 36.
    assert np.std(values[216]) / np.std(values[6**3 * 36]) > 36


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="dimensions: expected an integer from 1 to 1111"):
        sl.sampling.halton(3, 1112)
    with pytest.raises(ValueError, match="scramble"):
        sl.sampling.halton(3, 2, scramble="linear")
    with pytest.raises(ValueError, match="start"):
        sl.sampling.halton(3, 2, start=2**64 - 2)


def test_hammersley_is_a_net_of_two_dimensions():
    p = sl.sampling.hammersley(256)
    for a in range(9):
        cell = np.floor(p[:, 0] * 2**a) * 2 ** (8 - a) + np.floor(p[:, 1] * 2 ** (8 - a))
        assert len(np.unique(cell)) == 256
    assert np.array_equal(p[:, 0], np.arange(256) / 256)
    assert np.array_equal(sl.sampling.hammersley(100, 4)[:, 1:], sl.sampling.halton(100, 3, scramble=None))
    q = sl.sampling.hammersley(100, 3, scramble="owen", seed=3, dtype=np.float32)
    assert q.dtype == np.float32
    assert np.array_equal(np.floor(q[:, 0].astype(np.float64) * 100), np.arange(100))
    assert sl.sampling.hammersley(5, 1).shape == (5, 1)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("scramble", [None, "digits", "owen"])
@pytest.mark.parametrize("start", [0, 37, 2**40 + 1])
def test_long_rows_begin_as_short_ones(dtype, scramble, start):
    """Long rows are written by lines of several numbers, short ones by columns."""
    rows = [sl.sampling.halton(150, d, scramble=scramble, seed=2, start=start, dtype=dtype) for d in (150, 83, 64, 63)]
    for short in rows[1:]:
        assert np.array_equal(rows[0][:, : short.shape[1]], short)
