"""The additive sequence of the golden ratio: exact at every index, and evenly spaced."""

import decimal
from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl


def golden(dimensions):
    """The root by bisection in fractions of 2^200."""
    low, high = Fraction(1), Fraction(2)
    for _ in range(220):
        middle = (low + high) / 2
        middle = Fraction(int(middle * 2**240), 2**240)
        low, high = (middle, high) if middle ** (dimensions + 1) < middle + 1 else (low, middle)
    return low


@pytest.mark.parametrize("dimensions", [1, 2, 3, 20])
@pytest.mark.parametrize("start", [0, 10**6, 2**32 - 1, 2**53, 2**64 - 8])
def test_points_are_exact(dimensions, start):
    got = sl.sampling.r2(8, dimensions, start=start)
    phi = golden(dimensions)
    for i in range(8):
        for d in range(dimensions):
            x = (Fraction(1, 2) + (start + i) / phi ** (d + 1)) % 1
            # Rounded down at 2^-53; an exact value within 2^-60 of a step may fall on either side.
            error = (x - Fraction(float(got[i, d]))) * 2**53
            assert -0.01 < error < 1.01
    single = sl.sampling.r2(8, dimensions, start=start, dtype=np.float32)
    assert np.array_equal(single, np.floor(got * 2**24) * 2.0**-24)


def test_constants_are_the_published_ones():
    # Roberts 2018: φ₁ = 1.6180339887…, φ₂ = 1.32471795724474602596
    assert (
        abs(
            decimal.Decimal(2**128) / sl.sampling.sequences.golden_steps(2)[0]
            - decimal.Decimal("1.32471795724474602596")
        )
        < 1e-19
    )
    assert sl.sampling.sequences.golden_steps(1)[0] >> 64 == 0x9E3779B97F4A7C15


def test_points_keep_their_distance():
    for n in (100, 1000):
        p = sl.sampling.r2(n)
        d = np.abs(p[:, None] - p)
        d = np.hypot(*np.moveaxis(np.minimum(d, 1 - d), -1, 0))[np.triu_indices(n, 1)].min()
        # Random points come as near as 1 / n.
        assert d * np.sqrt(n) > 0.5


def test_a_random_offset_turns_the_torus():
    a, b = sl.sampling.r2(50, 3, offset="random", seed=1), sl.sampling.r2(50, 3, offset="random", seed=2)
    turn = (a - b) % 1
    assert np.allclose(turn, turn[0], rtol=0, atol=1e-15)
    assert len(np.unique(np.round(turn[0], 6))) == 3
    assert np.array_equal(sl.sampling.r2(50, 3, offset=0)[0], np.zeros(3))


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="offset"):
        sl.sampling.r2(3, offset=1.0)
    with pytest.raises(ValueError, match="offset"):
        sl.sampling.r2(3, offset="seed")
