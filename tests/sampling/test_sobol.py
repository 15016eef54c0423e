"""Sobol' points: SciPy's sequence, nets that survive scrambling, and scrambles as random as Owen's."""

import functools
import itertools
import operator
from pathlib import Path

import numpy as np
import pytest
import scipy
import shadelab as sl
from scipy.stats import qmc


def test_plain_points_are_scipys():
    i = np.arange(1 << 10)
    expected = qmc.Sobol(1111, scramble=False, bits=32).random(len(i))
    got = sl.sampling.sobol(len(i), 1111, scramble=None)
    assert np.array_equal(got[i ^ (i >> 1)], expected)


@pytest.mark.parametrize("scramble", [None, "owen"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_every_elementary_interval_holds_one_point(scramble, dtype):
    k = 10
    for start, seed in itertools.product([0, 3 << k], range(8)):
        p = sl.sampling.sobol(1 << k, 2, scramble=scramble, seed=seed, start=start, dtype=dtype).astype(np.float64)
        for a in range(k + 1):
            cell = np.floor(p[:, 0] * 2**a) * 2 ** (k - a) + np.floor(p[:, 1] * 2 ** (k - a))
            assert len(np.unique(cell)) == 1 << k


def test_every_dimension_is_stratified():
    p = sl.sampling.sobol(256, 256, seed=5)
    assert all(len(np.unique(column)) == 256 for column in np.floor(p * 256).T)


def test_scrambling_flips_each_node_of_the_tree_independently():
    # Flips of the 63 nodes of the first six digits in two dimensions, over 4096 seeds.
    seeds, depth = 4096, 6
    plain = sl.sampling.sobol(1 << depth, 2, scramble=None)
    order = np.argsort(plain, axis=0)
    flips = []
    for seed in range(seeds):
        digits = (sl.sampling.sobol(1 << depth, 2, seed=seed) * 2**depth).astype(int)
        sorted_digits = np.take_along_axis(digits, order, 0)
        row = []
        for level in range(depth):
            # The digit below a node of this level, of the first point under it; unscrambled it is zero.
            row.append(sorted_digits[:: 1 << (depth - level)] >> (depth - 1 - level) & 1)
        flips.append(np.concatenate(row).T.ravel())
    bits = np.array(flips) * 2.0 - 1
    n = bits.shape[1]
    assert n == 126
    correlation = bits.T @ bits / seeds
    np.fill_diagonal(correlation, bits.mean(0))
    # Of 8001 standard normal scores the largest exceeds 5.5 with chance 3e-4; the mean square is 1 ± 0.016.
    scores = correlation[np.triu_indices(n)] * np.sqrt(seeds)
    assert np.abs(scores).max() < 5.5
    assert abs(np.mean(scores**2) - 1) < 0.1
    # Triples on one path and across siblings: no parity is preferred.
    rng = np.random.default_rng(0)
    triples = rng.integers(0, n, (3, 4000))
    triples = triples[:, (triples[0] != triples[1]) & (triples[1] != triples[2]) & (triples[0] != triples[2])]
    scores = (bits[:, triples[0]] * bits[:, triples[1]] * bits[:, triples[2]]).mean(0) * np.sqrt(seeds)
    assert np.abs(scores).max() < 5.5


def test_scrambled_averages_are_unbiased_and_converge_fast():
    def error(n):
        values = []
        for seed in range(64):
            x, y = sl.sampling.sobol(n, 2, seed=seed).T
            values.append(np.mean(np.exp(x) * np.cos(3 * y)))
        exact = (np.e - 1) * np.sin(3) / 3
        return np.mean(values) - exact, np.std(values)

    (bias, small), (_, large) = error(64), error(1024)
    assert abs(bias) < 5 * small / 8
    # n^(-3/2) over a factor of 16 is 64; independent samples give 4.
    assert small / large > 30


def test_going_on_later_gives_the_same_points():
    whole = sl.sampling.sobol(1000, 3, seed=4)
    assert np.array_equal(whole[357:], sl.sampling.sobol(643, 3, seed=4, start=357))
    assert sl.sampling.sobol(0, 3).shape == (0, 3)


@functools.lru_cache
def columns(dimensions):
    """Direction numbers by the definition, from SciPy's copy of the published initial numbers, of 64 bits."""
    table = np.load(Path(scipy.__file__).parent / "stats/_sobol_direction_numbers.npz")
    found = []
    for polynomial, m in zip(*(table[k][:dimensions].tolist() for k in ("poly", "vinit")), strict=True):
        s = polynomial.bit_length() - 1
        v = [m[k] << (63 - k) for k in range(s)] if found else [1 << (63 - k) for k in range(64)]
        for k in range(len(v), 64):
            x = v[k - s] ^ (v[k - s] >> s)
            for j in range(1, s):
                x ^= v[k - j] if polynomial >> (s - j) & 1 else 0
            v.append(x)
        found.append(v)
    return found


def reference(index, dimensions):
    """Points as fractions of 2^64."""
    digits = [k for k in range(64) if index >> k & 1]
    return [functools.reduce(operator.xor, (v[k] for k in digits), 0) for v in columns(dimensions)]


@pytest.mark.parametrize("start", [2**32 - 2, 2**32 + 5, 3 * 2**40 + 77, 2**63 - 1, 2**64 - 4])
def test_points_beyond_four_billion_follow_the_definition(start):
    got = sl.sampling.sobol(4, 1111, scramble=None, start=start)
    expected = [[(x >> 11) * 2.0**-53 for x in reference(start + i, 1111)] for i in range(4)]
    assert np.array_equal(got, expected)


def test_scrambled_points_beyond_four_billion_go_on_as_nets():
    k = 12
    for start in (2**32 - 2**k, 2**32, 5 * 2**40, 2**64 - 2**k):
        p = sl.sampling.sobol(1 << k, 2, seed=3, start=start)
        for a in range(k + 1):
            cell = np.floor(p[:, 0] * 2**a) * 2 ** (k - a) + np.floor(p[:, 1] * 2 ** (k - a))
            assert len(np.unique(cell)) == 1 << k
    # The 33rd digit tells apart what 32 cannot: indices 2^32 apart share them in the first dimension.
    a, b = (sl.sampling.sobol(64, 1, seed=3, start=s)[:, 0] for s in (0, 2**32))
    assert np.array_equal(np.floor(a * 2**32), np.floor(b * 2**32))
    assert np.array_equal(np.floor(a * 2**33).astype(int) ^ 1, np.floor(b * 2**33).astype(int))


def test_the_last_point_is_reached_and_none_beyond():
    last = sl.sampling.sobol(2, 1, scramble=None, start=2**64 - 2)
    assert np.array_equal(last[:, 0], [0.5 - 2.0**-53, 1 - 2.0**-53])
    with pytest.raises(ValueError, match="start: expected start"):
        sl.sampling.sobol(2, 1, start=2**64 - 1)
    with pytest.raises(ValueError, match="dimensions: expected an integer from 1 to 1111, got 1112"):
        sl.sampling.sobol(2, 1112)
    with pytest.raises(ValueError, match="scramble: expected one of 'owen'"):
        sl.sampling.sobol(2, 2, scramble="random")


@pytest.mark.parametrize("start", [0, 1, 63, 64, 100, 2**32 - 65])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_any_start_and_length_cuts_the_same_sequence(start, dtype):
    for n, dimensions in ((1, 1), (5, 7), (64, 2), (200, 3)):
        whole = sl.sampling.sobol(300, dimensions, seed=9, start=start - start % 64, dtype=dtype)
        part = sl.sampling.sobol(n, dimensions, seed=9, start=start, dtype=dtype)
        assert np.array_equal(part, whole[start % 64 :][:n])


def test_single_is_double_rounded_down():
    a = sl.sampling.sobol(1000, 5, seed=2)
    b = sl.sampling.sobol(1000, 5, seed=2, dtype=np.float32)
    assert np.array_equal(np.floor(a * 2**24) * 2.0**-24, b)


@pytest.mark.parametrize("dimensions", [1, 2, 4])
def test_the_rate_on_a_smooth_integrand_is_three_halves(dimensions):
    exponents = np.arange(4, 12)
    spread = []
    for k in exponents:
        values = [
            np.prod(1 + np.sin(3 * sl.sampling.sobol(1 << k, dimensions, seed=s)), axis=1).mean() for s in range(48)
        ]
        spread.append(np.std(values))
    slope = np.polyfit(exponents, np.log2(spread), 1)[0]
    # Owen 1997: n^(-3/2) up to logarithms, which hold it up in more dimensions; each point is known to 10 %.
    assert {1: -1.65, 2: -1.65, 4: -1.6}[dimensions] < slope < {1: -1.4, 2: -1.35, 4: -1.15}[dimensions]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("scramble", [None, "owen"])
@pytest.mark.parametrize("start", [0, 37, 2**32 - 50])
def test_long_rows_begin_as_short_ones(dtype, scramble, start):
    """Long rows are written by lines of several numbers, short ones by columns."""
    rows = [sl.sampling.sobol(150, d, scramble=scramble, seed=2, start=start, dtype=dtype) for d in (150, 83, 64, 63)]
    for short in rows[1:]:
        assert np.array_equal(rows[0][:, : short.shape[1]], short)
