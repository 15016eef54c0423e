"""Balls and frusta: by distances to the planes, and never wrong within rounding of them."""

from fractions import Fraction

import numpy as np
import pytest
from shadelab import geometry, transform


def planes_of(dtype=np.float64):
    view = transform.look_at([3, 2, 5.0], [0, 1, 0])
    m = (transform.perspective(fov_y=1.0, near=0.5, far=30.0) @ view).astype(dtype)
    return m, geometry.frustum_planes(m)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_balls_at_the_border_are_never_told_wrong(dtype):
    rng = np.random.default_rng(1)
    n = 400
    m, planes = planes_of(dtype)
    center = (rng.normal(size=(n, 3)) * 4).astype(dtype)
    k = rng.integers(0, 6, n)
    height = (center.astype(float) * planes[k, :3]).sum(-1) + planes[k, 3]
    radius = (np.abs(height) + rng.integers(-2, 3, n) * np.spacing(np.abs(center).max(-1))).clip(0).astype(dtype)
    got = geometry.frustum_sphere(planes, center, radius)
    # Rows of the matrix as rationals: the ball crosses a plane where height² <= radius² |normal|².
    rows = [[Fraction(float(x)) for x in row] for row in m]
    w = rows[3]
    exact = [[a + s * b for a, b in zip(w, rows[i], strict=True)] for i in range(3) for s in (1, -1)]
    for c, r, side in zip(center, radius, got, strict=True):
        c, r = [Fraction(float(x)) for x in c], Fraction(float(r))
        signed = []
        for n0, n1, n2, d in exact:
            h = n0 * c[0] + n1 * c[1] + n2 * c[2] + d
            clear = h * h > r * r * (n0 * n0 + n1 * n1 + n2 * n2)
            signed.append((1 if h > 0 else -1) if clear else 0)
        assert side != -1 or min(signed) == -1
        assert side != 1 or min(signed) == 1
    assert (np.bincount(got + 1) > 10).all()


def test_distances_tell():
    rng = np.random.default_rng(2)
    _, planes = planes_of()
    center, radius = rng.normal(size=(5000, 3)) * 6, rng.exponential(1.5, 5000)
    heights = center @ planes[:, :3].T + planes[:, 3]
    got = geometry.frustum_sphere(planes, center, radius, full_output=True)
    low = (heights - radius[:, None]).min(1)
    expected = np.where(low > 0, 1, np.where((heights < -radius[:, None]).any(1), -1, 0))
    assert np.array_equal(got.side, expected) and (np.bincount(got.side + 1) > 50).all()
    # Planes of other lengths tell the same.
    assert np.array_equal(geometry.frustum_sphere(7 * planes, center, radius), expected)


def test_the_missing_far_plane_makes_large_balls_no_less_inside():
    planes = geometry.frustum_planes(transform.perspective(fov_y=1.0, near=0.5, far=np.inf))
    assert geometry.frustum_sphere(planes, [0, 0, -1e4], 1e3) == 1


def test_nan_and_negative_radii_are_not_lost():
    _, planes = planes_of()
    assert geometry.frustum_sphere(planes, [99.0, 99, 99], [1, np.nan, -1]).tolist() == [-1, 0, 0]
