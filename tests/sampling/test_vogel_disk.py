"""Vogel's disk: radii and angles by the definition, equal areas, distances of a sunflower."""

import mpmath
import numpy as np
import pytest
import shadelab as sl
from scipy.spatial import cKDTree


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_points_follow_the_definition(dtype):
    n = 1_000_003
    p = sl.sampling.vogel_disk(n, rotation=-0.4, dtype=dtype)
    assert p.dtype == dtype
    with mpmath.workdps(50):
        for i in (0, 1, 2, 500_000, n - 1):
            r, angle = mpmath.sqrt((i + mpmath.mpf("0.5")) / n), mpmath.mpf(-0.4) + 2 * mpmath.pi * i / mpmath.phi**2
            exact = [r * mpmath.cos(angle), r * mpmath.sin(angle)]
            # The angle's own rounding is up to three units of 1.
            assert (
                max(abs(float(g - e)) for g, e in zip(map(float, p[i]), exact, strict=True)) < 3 * np.finfo(dtype).eps
            )


def test_equal_rings_hold_equally_many_and_neighbours_are_far():
    p = sl.sampling.vogel_disk(1000)
    assert (np.bincount((np.square(p).sum(1) * 10).astype(int)) == 100).all()
    assert cKDTree(p).query(p, 2)[0][:, 1].min() * np.sqrt(1000) > 1.2
    assert abs(np.mean(p, axis=0)).max() < 2e-3
    assert sl.sampling.vogel_disk(0).shape == (0, 2)
