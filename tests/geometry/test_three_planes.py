"""Three planes: the point of rational arithmetic, however near to parallel."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry


def exact(planes):
    m = [[Fraction(float(x)) for x in p] for p in planes]

    def det(a, b, c):
        return (
            a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
        )

    whole = det(*(p[:3] for p in m))
    if whole == 0:
        return None
    return [det(*([-p[3] if i == k else p[i] for i in range(3)] for p in m)) / whole for k in range(3)]


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("nearness", [1.0, 1e-3, 0.0])
def test_the_point_is_that_of_rational_arithmetic(dtype, nearness):
    rng = np.random.default_rng(1)
    a, b = rng.normal(size=(2, 200, 4)).astype(dtype)
    # The third plane leans towards a plane of the others' pencil; with zero it is off by rounding alone.
    c = (0.3 * a - 1.7 * b + nearness * rng.normal(size=(200, 4)) * [1, 1, 1, 1]).astype(dtype)
    got = geometry.three_planes(a, b, c, full_output=True)
    assert got.point.dtype == dtype
    # 1e-13 as documented; one rounding in float32.
    tolerance = Fraction(1, 10**13) if dtype == np.float64 else Fraction(7, 10**8)
    for i in range(200):
        expected = exact([a[i], b[i], c[i]])
        if expected is None:
            assert np.isnan(got.point[i]).all() and got.volume[i] == 0
            continue
        for x, y in zip(got.point[i], expected, strict=True):
            assert abs(Fraction(float(x)) - y) <= tolerance * abs(y)


def test_volume_is_that_of_unit_normals():
    normals = np.random.default_rng(2).normal(size=(50, 3, 3))
    planes = np.concatenate([5 * normals, np.ones((50, 3, 1))], -1)
    unit = normals / np.linalg.norm(normals, axis=-1, keepdims=True)
    got = geometry.three_planes(*(planes[:, i] for i in range(3)), full_output=True)
    assert np.allclose(got.volume, np.linalg.det(unit), rtol=1e-12)


@pytest.mark.parametrize("size", [1e-30, 1e30])
def test_normals_of_any_length_serve(size):
    p = size * np.array([[1, 2, 3, -4], [2, 1, 0, 1], [0, 1, 5, 2.0]])
    one = geometry.three_planes(*(p / size))
    assert np.allclose(geometry.three_planes(*p), one, rtol=1e-13)


def test_parallel_planes_and_nan_touch_no_other():
    a = np.array([[1, 0, 0, 0], [1, 0, 0, 0], [np.nan, 0, 0, 0], [0, 0, 0, 1.0]])
    got = geometry.three_planes(a, [[0, 1, 0, 0], [2, 0, 0, 1], [0, 1, 0, 0], [0, 1, 0, 0]], [0, 0, 1.0, -1])
    assert np.array_equal(got[0], [0, 0, 1]) and np.isnan(got[1:]).all()
