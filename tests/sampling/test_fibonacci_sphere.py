"""Fibonacci's sphere: unit directions, equal areas, distances of a lattice, exact angles far along the spiral."""

import mpmath
import numpy as np
import pytest
import shadelab as sl
from scipy.spatial import SphericalVoronoi, cKDTree


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_directions_follow_the_definition(dtype):
    n = 3_000_017
    p = sl.sampling.fibonacci_sphere(n, rotation=0.7, dtype=dtype)
    unit = np.finfo(dtype).eps / 2
    assert p.dtype == dtype
    assert np.abs(np.linalg.norm(p[::1000].astype(np.float64), axis=1) - 1).max() < 4 * unit
    with mpmath.workdps(50):
        for i in (0, 1, 2, 1_000_000, 2_999_999, n - 1):
            z = 1 - mpmath.mpf(2 * i + 1) / n
            angle = mpmath.mpf(0.7) + 2 * mpmath.pi * i / mpmath.phi**2
            r = mpmath.sqrt(1 - z * z)
            exact = [r * mpmath.cos(angle), r * mpmath.sin(angle), z]
            # The angle's own rounding is up to three units of 1; its radius makes it less.
            assert max(abs(float(g - e)) for g, e in zip(map(float, p[i]), exact, strict=True)) < 6 * unit


def test_areas_are_equal_and_neighbours_far():
    n = 1000
    p = sl.sampling.fibonacci_sphere(n)
    areas = SphericalVoronoi(p).calculate_areas() * n / (4 * np.pi)
    assert 0.85 < areas.min()
    assert areas.max() < 1.15
    nearest = cKDTree(p).query(p, 2)[0][:, 1]
    # The densest packing on the sphere has √(8π/√3 / n); random points come as near as 1 / n.
    assert nearest.min() > 0.7 * np.sqrt(8 * np.pi / np.sqrt(3) / n)


def test_averages_are_those_of_the_sphere():
    x, y, z = sl.sampling.fibonacci_sphere(4096).T
    assert abs(np.mean(np.exp(x + 2 * y - z)) - np.sinh(6**0.5) / 6**0.5) < 1e-4
    assert sl.sampling.fibonacci_sphere(0).shape == (0, 3)
    with pytest.raises(ValueError, match="rotation"):
        sl.sampling.fibonacci_sphere(3, rotation=np.nan)
