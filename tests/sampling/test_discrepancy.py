"""Mean-square discrepancies: SciPy's, and the definition as an integral."""

import numpy as np
import pytest
import shadelab as sl
from scipy.stats import qmc

KINDS = {"centered": "CD", "wraparound": "WD", "mixture": "MD", "star": "L2-star"}


@pytest.mark.parametrize("kind", KINDS)
@pytest.mark.parametrize(("n", "d"), [(1, 1), (2, 3), (65, 2), (500, 5), (130, 40)])
def test_it_is_scipys(kind, n, d):
    p = np.random.default_rng(n).uniform(size=(n, d))
    squared = kind != "star"
    expected = qmc.discrepancy(p, method=KINDS[kind])
    got = sl.sampling.discrepancy(p, kind, squared=squared)
    # Terms as large as these cancel; SciPy sums n² of them one by one.
    lead = {"centered": 13 / 12, "wraparound": 4 / 3, "mixture": 19 / 12, "star": 1}[kind] ** d
    assert abs(got - expected) < 1e-12 * expected + 1e-13 * lead
    assert np.isclose(sl.sampling.discrepancy(p, kind) ** 2, sl.sampling.discrepancy(p, kind, squared=True))


def test_the_star_is_an_integral():
    p = sl.sampling.halton(20, 2)
    x = (np.arange(1000) + 0.5) / 1000
    inside = (p[:, 0, None] < x)[:, :, None] & (p[:, 1, None] < x)[:, None, :]
    local = inside.mean(0) - x[:, None] * x
    # The midpoint rule misses jumps by a thousandth.
    assert abs(sl.sampling.discrepancy(p, "star") / np.sqrt(np.mean(local**2)) - 1) < 5e-3


def test_even_sets_have_less():
    n = 1024
    random = np.random.default_rng(0).uniform(size=(n, 3))
    for kind in KINDS:
        assert sl.sampling.discrepancy(sl.sampling.sobol(n, 3), kind) < sl.sampling.discrepancy(random, kind) / 5


@pytest.mark.parametrize("threads", [1, 3])
def test_threads_change_no_bit(threads):
    p = sl.sampling.sobol(3000, 4)
    try:
        sl.set_threads(threads)
        assert sl.sampling.discrepancy(p, squared=True) == sl.sampling.discrepancy(p, squared=True)
        sl.set_threads(2)
        two = sl.sampling.discrepancy(p, squared=True)
        sl.set_threads(threads)
        assert sl.sampling.discrepancy(p, squared=True) == two
    finally:
        sl.set_threads(None)


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="kind"):
        sl.sampling.discrepancy([[0.5]], "CD")
    with pytest.raises(ValueError, match="points: expected coordinates"):
        sl.sampling.discrepancy([[-0.5]])
