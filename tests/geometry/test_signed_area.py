"""Areas: the exact sum, orientation, far from the origin."""

import numpy as np
import pytest
import shadelab as sl

from .rational import vector


def exact(polygon):
    corners = [vector(p) for p in polygon]
    return sum(a[0] * b[1] - a[1] * b[0] for a, b in zip(corners, corners[1:] + corners[:1], strict=True)) / 2


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0, 1e3, 1e6])
@pytest.mark.parametrize("n", [3, 50])
def test_area_is_the_exact_one(dtype, shift, n):
    polygons = (10 * np.random.default_rng(1).normal(size=(40, n, 2)) + shift).astype(dtype)
    area = sl.geometry.signed_area(polygons)
    eps = float(np.finfo(dtype).eps)
    for polygon, got in zip(polygons, area, strict=True):
        want = exact(polygon)
        size = float((polygon[:, 0].astype(float) * polygon[:, 1]).sum())
        assert abs(float(got) - want) <= 2 * eps * abs(want) + n * eps**2 * abs(size)


def test_orientation_repeats_and_double_turns():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2.0]])
    assert sl.geometry.signed_area(square) == 4 and sl.geometry.signed_area(square[::-1]) == -4
    assert sl.geometry.signed_area(np.repeat(square, 3, 0)) == 4
    assert sl.geometry.signed_area(np.tile(square, (2, 1))) == 8
    assert sl.geometry.signed_area([[0, 0], [1, 1], [2, 2]]) == 0


def test_agrees_with_the_triangle_of_cross_products():
    a, b, c = np.random.default_rng(2).normal(size=(3, 100, 2))
    want = 0.5 * ((b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0])
    assert np.allclose(sl.geometry.signed_area(np.stack([a, b, c], 1)), want, atol=1e-14)


def test_nan_and_shapes():
    polygons = np.random.default_rng(3).normal(size=(2, 5, 4, 2)).astype(np.float32)
    polygons[0, 1, 2, 0], polygons[1, 2, 3, 1] = np.nan, np.inf
    area = sl.geometry.signed_area(polygons)
    assert area.shape == (2, 5) and area.dtype == np.float32 and np.isnan(area).sum() == 2
    with pytest.raises(ValueError, match="polygon: expected shape"):
        sl.geometry.signed_area([1.0, 2.0])
