"""Mip chains: means are kept at every size, least and greatest are bounds, powers of two are plain averages."""

import itertools

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

sizes = st.tuples(st.integers(1, 70), st.integers(1, 70))


@given(sizes, st.sampled_from([None, 1, 3]), st.sampled_from([np.float32, np.float64]))
@settings(max_examples=60, deadline=None)
def test_every_level_has_the_mean_of_the_picture(size, channels, dtype):
    image = np.random.default_rng(1).random(size if channels is None else (*size, channels)).astype(dtype)
    chain = sl.image.mip_chain(image)
    assert chain[0] is image or np.array_equal(chain[0], image)
    assert chain[-1].shape[:2] == (1, 1)
    for fine, coarse in itertools.pairwise(chain):
        assert coarse.shape[:2] == tuple(max(n // 2, 1) for n in fine.shape[:2])
        assert coarse.dtype == dtype
        # Wide sums, since those of NumPy along the first axes are plain; a rounding or two a level is ours.
        means = [level.astype(np.longdouble).mean((0, 1)) for level in (coarse, image)]
        np.testing.assert_allclose(*means, rtol=10 * np.finfo(dtype).eps)


@given(sizes)
@settings(max_examples=30, deadline=None)
def test_least_and_greatest_are_bounds_of_all_that_is_covered(size):
    image = np.random.default_rng(2).random(size)
    low, high = sl.image.mip_chain(image, "min"), sl.image.mip_chain(image, "max")
    assert low[-1].item() == image.min() and high[-1].item() == image.max()
    # Every pixel is within the pixel of the next level that its centre falls in.
    for chain, within in ((low, np.less_equal), (high, np.greater_equal)):
        for fine, coarse in itertools.pairwise(chain):
            rows, columns = (
                ((np.arange(n) + 0.5) * m / n).astype(int) for n, m in zip(fine.shape, coarse.shape, strict=True)
            )
            assert within(coarse[np.ix_(rows, columns)], fine).all()


def test_even_sides_are_plain_averages():
    image = np.random.default_rng(3).random((64, 32))
    level = sl.image.mip_chain(image)[1]
    np.testing.assert_allclose(level, image.reshape(32, 2, 16, 2).mean((1, 3)), rtol=1e-15)


def test_nan_spreads_and_errors_name_the_argument():
    image = np.ones((4, 4))
    image[3, 0] = np.nan
    for fold in ("mean", "min", "max"):
        level = sl.image.mip_chain(image, fold)[1]
        assert np.isnan(level[1, 0]) and np.isfinite(level[0]).all()
    with pytest.raises(ValueError, match="image"):
        sl.image.mip_chain(np.ones((0, 4)))
    with pytest.raises(ValueError, match="fold"):
        sl.image.mip_chain(image, "median")
