"""Sobol' points: SciPy's sequence, nets that survive scrambling, and scrambles as random as Owen's."""

import itertools

import numpy as np
import pytest
import shadelab as sl
from scipy.stats import qmc


def test_plain_points_are_scipys():
    i = np.arange(1 << 12)
    expected = qmc.Sobol(256, scramble=False, bits=32).random(len(i))
    got = sl.sampling.sobol(len(i), 256, scramble=None)
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


def test_the_last_point_is_reached_and_none_beyond():
    last = sl.sampling.sobol(2, 1, scramble=None, start=2**32 - 2)
    assert np.array_equal(last[:, 0], [0.5 - 2.0**-32, 1 - 2.0**-32])
    with pytest.raises(ValueError, match="start: expected start"):
        sl.sampling.sobol(2, 1, start=2**32 - 1)
    with pytest.raises(ValueError, match="dimensions: expected an integer from 1 to 256, got 257"):
        sl.sampling.sobol(2, 257)
    with pytest.raises(ValueError, match="scramble: expected one of 'owen'"):
        sl.sampling.sobol(2, 2, scramble="random")
