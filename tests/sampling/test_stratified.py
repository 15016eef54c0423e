"""Strata: one point a cell, uniform within it."""

import numpy as np
import pytest
import shadelab as sl
from scipy import stats


@pytest.mark.parametrize("counts", [7, (4, 4), (3, 1, 5), (2, 3, 2, 3)])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_one_point_lies_in_each_cell(counts, dtype):
    p = sl.sampling.stratified(counts, seed=3, dtype=dtype)
    shape = np.atleast_1d(counts)
    cells = np.floor(p * shape.astype(dtype)).astype(int)
    assert p.dtype == dtype
    assert np.array_equal(cells, np.stack(np.unravel_index(np.arange(shape.prod()), shape), -1))


def test_jitter_is_uniform_and_independent():
    p = sl.sampling.stratified((200, 200), seed=1) * 200 % 1
    assert stats.kstest(p.ravel(), "uniform", method="asymp").pvalue > 1e-3
    assert abs(np.corrcoef(p.T)[0, 1]) < 4 / 200
    assert np.array_equal(sl.sampling.stratified((3, 3), jitter=False) * 6 % 2, np.ones((9, 2)))
    assert not np.array_equal(p, sl.sampling.stratified((200, 200), seed=2) * 200 % 1)


def test_bad_arguments_are_named():
    with pytest.raises(ValueError, match="counts: expected an integer from 1"):
        sl.sampling.stratified((3, 0))
    with pytest.raises(ValueError, match="counts: expected at least one axis"):
        sl.sampling.stratified(())
    with pytest.raises(ValueError, match="out: expected shape"):
        sl.sampling.stratified((2, 2), out=np.empty((3, 2)))
