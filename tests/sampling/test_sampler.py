"""Samplers of pixels: uniform numbers, strata within each pair, independent pixels and pairs, unbiased averages."""

import math

import numpy as np
import pytest
import shadelab as sl
from scipy import stats

KINDS = ["independent", "stratified", "latin_hypercube", "multi_jittered", "r2", "halton", "sobol"]


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("samples", [1, 7, 16])
def test_every_number_is_uniform_over_pixels(kind, dtype, samples):
    s = sl.sampling.Sampler(kind, seed=1, samples=samples)
    pixel = np.arange(4096)
    # Of any sample, also beyond the planned ones, and any dimension: the 21 tests share a level of 1e-3.
    for sample in (0, samples - 1, samples + 2):
        for dimension in (0, 1, 2, 7, 40, 41, 1200):
            u = s.uniform(pixel, sample, dimension, dtype)
            assert u.dtype == dtype
            assert u.min() >= 0
            assert u.max() < 1
            assert stats.kstest(u, "uniform", method="asymp").pvalue > 1e-3 / 21


@pytest.mark.parametrize("kind", KINDS)
def test_pixels_dimensions_and_pairs_are_uncorrelated(kind):
    s = sl.sampling.Sampler(kind, seed=2, samples=16)
    u = s.uniform(np.arange(2048)[:, None, None], np.arange(4)[:, None], np.arange(6)) - 0.5
    u = u * np.sqrt(12)
    # Between one pixel and the next, of any sample and dimension: 576 scores; and between pairs of one sample.
    score = np.einsum("psd,pte->stde", u[:-1], u[1:]) / np.sqrt(len(u) - 1)
    assert np.abs(score).max() < 5
    for a, b in ((0, 2), (0, 3), (1, 2), (1, 5)):
        assert abs((u[:, 0, a] * u[:, 0, b]).sum() / np.sqrt(len(u))) < 4.5


def test_sobol_pairs_are_nets():
    s = sl.sampling.Sampler("sobol", seed=3)
    for k, pixel in ((4, 0), (6, 5), (8, 2**40)):
        u = s.uniform(pixel, np.arange(1 << k)[:, None], np.arange(8))
        for pair in range(0, 8, 2):
            for a in range(k + 1):
                cell = np.floor(u[:, pair] * 2**a) * 2 ** (k - a) + np.floor(u[:, pair + 1] * 2 ** (k - a))
                assert len(np.unique(cell)) == 1 << k


@pytest.mark.parametrize("kind", ["stratified", "multi_jittered"])
def test_grids_hold_one_sample_in_each_cell(kind):
    s = sl.sampling.Sampler(kind, seed=3, samples=64)
    for first in (0, 64):
        u = s.uniform(9, first + np.arange(64)[:, None], [4, 5])
        assert len(np.unique(np.floor(u * 8) @ [8, 1])) == 64
        if kind == "multi_jittered":
            assert (np.sort(np.floor(u * 64), axis=0) == np.arange(64)[:, None]).all()


def test_axes_are_stratified():
    for n in (7, 64):
        s = sl.sampling.Sampler("latin_hypercube", seed=3, samples=n)
        u = s.uniform(9, np.arange(n)[:, None], np.arange(5))
        assert (np.sort(np.floor(u * n), axis=0) == np.arange(n)[:, None]).all()


@pytest.mark.parametrize("n", [2, 3, 4, 5, 6])
def test_every_order_is_equally_likely(n):
    s = sl.sampling.Sampler("latin_hypercube", seed=1, samples=n)
    orders = np.floor(s.uniform(np.arange(24000)[:, None], np.arange(n)) * n)
    counts = np.unique(orders, axis=0, return_counts=True)[1]
    counts = np.pad(counts, (0, math.factorial(n) - len(counts)))
    assert stats.chisquare(counts).pvalue > 1e-3


def test_known_point_sets_are_drawn():
    i, d = np.arange(500)[:, None], np.arange(30)
    halton = sl.sampling.Sampler("halton", seed=6).uniform(0, i, d)
    assert np.array_equal(halton, sl.sampling.halton(500, 30, seed=6))
    independent = sl.sampling.Sampler("independent", seed=6).uniform(3, i, d)
    assert np.array_equal(independent, sl.sampling.Generator(6).uniform(3, i, d))
    turned = np.diff(sl.sampling.Sampler("r2", seed=6).uniform(3, i, [0, 1]), axis=0) % 1
    assert np.allclose(turned, np.diff(sl.sampling.r2(500), axis=0) % 1, rtol=0, atol=1e-15)


@pytest.mark.parametrize("kind", KINDS)
def test_averages_are_unbiased_and_no_worse_than_random(kind):
    s = sl.sampling.Sampler(kind, seed=5, samples=64)
    u = s.uniform(np.arange(1000)[:, None, None], np.arange(64)[:, None], [2, 3])
    means = (np.exp(u[..., 0]) * np.cos(3 * u[..., 1])).mean(1)
    exact = (np.e - 1) * np.sin(3) / 3
    assert abs(means.mean() - exact) < 4.5 * means.std() / np.sqrt(1000)
    x = (np.arange(2000) + 0.5) / 2000
    f = np.exp(x)[:, None] * np.cos(3 * x)
    random = f.std() / 8
    gain = {"independent": 0.9, "latin_hypercube": 1.2, "r2": 2.5, "halton": 4}.get(kind, 6)
    assert random / means.std() > gain


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="kind"):
        sl.sampling.Sampler("random")
    with pytest.raises(ValueError, match="samples"):
        sl.sampling.Sampler("sobol", samples=0)
    with pytest.raises(TypeError, match="pixel"):
        sl.sampling.Sampler("sobol").uniform(0.5)


def test_pairs_of_the_golden_ratio_know_nothing_of_each_other():
    u = sl.sampling.Sampler("r2", seed=5, samples=64).uniform(
        np.arange(1000)[:, None, None], np.arange(64)[:, None], [0, 2]
    )
    means = np.cos(2 * np.pi * (u[..., 0] - u[..., 1])).mean(1)
    # √½ over 8 if they are independent; √½ if they ran alike.
    assert means.std() < 1.3 * np.sqrt(0.5) / 8


def test_halton_numbers_of_one_prime_do_not_keep_step():
    """Dimension d + 1111 k has the base of d: numbers of the same sample are nevertheless independent."""
    sample = np.arange(1024)
    for d in (0, 3, 40):
        first, *later = (
            np.stack([sl.sampling.Sampler("halton", seed=s).uniform(0, sample, d + 1111 * k) for s in range(32)])
            for k in range(3)
        )
        for other in later:
            products = (first * other).mean(1)
            error = products.std(ddof=1) / np.sqrt(32)
            assert abs(products.mean() - 0.25) < 5 * error + 1e-4
            # As little alike as independent numbers: 7/144 is the variance of a product.
            assert products.std() < 2 * np.sqrt(7 / 144 / 1024)
