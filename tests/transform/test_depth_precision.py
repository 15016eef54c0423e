"""What a depth buffer tells apart: against the stored values themselves, in exact arithmetic."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab.transform import depth_precision, linear_depth, perspective

DEPTHS = ("standard", "zero_to_one", "reversed")
STEPS = {"unorm24": 2**24 - 1, "unorm16": 2**16 - 1}


def exact_step(z, near, far, depth, storage):
    """To the next stored value away from the eye, exactly; infinite where none is that near."""
    z, n = Fraction(z), Fraction(near)
    over = Fraction(1) if far == np.inf else Fraction(far) / (Fraction(far) - n)
    reversed_ = n / z if far == np.inf else n * (Fraction(far) - z) / ((Fraction(far) - n) * z)
    value, gain, away = {
        "standard": (1 - 2 * reversed_, 2 * n * over, 1),
        "zero_to_one": (1 - reversed_, n * over, 1),
        "reversed": (reversed_, n * over, -1),
    }[depth]
    if storage == "float32":
        stored = np.float32(float(value))
        step = abs(Fraction(float(np.nextafter(stored, np.float32(9 * away)))) - Fraction(float(stored)))
    else:
        step = Fraction(1, STEPS[storage]) * (2 if depth == "standard" else 1)
    # value = A -+ gain / z, so the value that lies `step` away is of the distance with gain / z' = gain / z - step.
    left = gain / z - step
    return float(gain / left - z) if left > 0 else np.inf


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("storage", ["float32", "unorm24", "unorm16"])
@pytest.mark.parametrize("depth", DEPTHS)
def test_the_step_is_that_to_the_next_stored_value(depth, storage, dtype):
    rng = np.random.default_rng(1)
    for near, far in ((0.1, 1000.0), (0.01, np.inf), (1e-3, 1e3), (1.0, 1.5)):
        near = dtype(near)
        far = dtype(far)
        z = np.exp(rng.uniform(np.log(near) + 1e-6, np.log(min(far, 1e5)) - 1e-6, 60)).astype(dtype)
        got = depth_precision(z, near, far, depth=depth, storage=storage)
        assert got.step.dtype == got.bits.dtype == dtype
        for x, step, bits in zip(z, got.step, got.bits, strict=True):
            exact = exact_step(float(x), float(near), float(far), depth, storage)
            if exact == np.inf:
                assert step > 1e6 * float(near) and bits < 1e-3
                continue
            # Rounding of 1 - r is magnified where a step is as far as the distance; the depth's own rounding can put
            # it into the binade beside, whose step is twice or half as large.
            slack = 8 * np.finfo(dtype).eps * (1 + exact / float(x))
            ratio = float(step) / exact
            near_by = [1.0, 0.5, 2.0] if storage == "float32" else [1.0]
            assert any(abs(ratio / k - 1) <= slack + abs(k - 1) * exact / float(x) for k in near_by)
            assert abs(bits - np.log2(1 + float(x) / float(step))) < 1e-4


def test_at_borders_of_binades_are_few():
    """The exact steps of the test above hold but for depths beside a power of two."""
    z = np.random.default_rng(2).uniform(1, 900, 2000)
    got = depth_precision(z, 0.1, 1000.0, depth="reversed").step
    exact = np.array([exact_step(x, 0.1, 1000.0, "reversed", "float32") for x in z])
    assert (np.abs(got / exact - 1) < 1e-12).mean() > 0.999


def test_it_is_what_linear_depth_sees():
    m = perspective(1.0, near=0.1, far=1000.0, depth="reversed")
    stored = np.geomspace(1e-3, 0.9, 100).astype(np.float32)
    here, there = (linear_depth(s.astype(float), m) for s in (stored, np.nextafter(stored, np.float32(0))))
    step = depth_precision(here, 0.1, 1000.0, depth="reversed").step
    # Differences of distances cancel.
    assert np.abs((there - here) / step - 1).max() < 1e-6


def test_reversed_depth_keeps_its_bits_and_standard_depth_loses_them():
    z = np.geomspace(0.1, 1e5, 50)
    reversed_ = depth_precision(z, 0.1, depth="reversed").bits
    assert reversed_.min() > 22.9 and reversed_.max() < 24.1
    standard = depth_precision(z, 0.1).bits
    # A bit for each doubling of the distance.
    lost = standard[20] - standard[40]
    assert abs(lost - np.log2(z[40] / z[20])) < 0.1
    # Equal steps gain nothing by reversing.
    for depth in DEPTHS:
        assert np.allclose(
            depth_precision(z, 0.1, depth=depth, storage="unorm24").step[:30],
            depth_precision(z, 0.1, storage="unorm24").step[:30],
        )


def test_beyond_the_planes_there_is_nothing_and_beyond_the_last_value_no_step():
    got = depth_precision([0.05, 0.1, 1000.0, 1001.0, np.nan, np.inf], 0.1, 1000.0)
    assert np.array_equal(np.isnan(got.step), [True, False, False, True, True, True])
    got = depth_precision(1e6, 1e-3, storage="unorm16")
    assert got.step == np.inf and got.bits == 0
    assert np.isnan(depth_precision(1.0, 2.0, 1.0).step)
    for bad in ({"depth": "inverse"}, {"storage": "float16"}):
        with pytest.raises(ValueError, match=next(iter(bad))):
            depth_precision(1.0, 0.1, **bad)
