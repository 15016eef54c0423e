"""Rays and planes: the exact parameter, for flat rays and far planes too."""

import numpy as np
import pytest
import shadelab as sl
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import dot, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def exact(o, d, plane):
    o, d, (*n, offset) = vector(o), vector(d), vector(plane)
    return dot(n, o) + offset, dot(n, d)


@PRECISIONS
@pytest.mark.parametrize("shift", [0, 1e6])
@pytest.mark.parametrize("length", [1, 1e-20, 1e20])
@pytest.mark.parametrize("flat", [1, 1e-5])
def test_t_is_the_exact_one(dtype, shift, length, flat):
    rng = np.random.default_rng(1)
    n, p = rng.normal(size=(2, 100, 3))
    along = np.cross(n, rng.normal(size=(100, 3)))
    o = (p + rng.normal(size=(100, 3)) + shift).astype(dtype)
    d = (length * (along + flat * n)).astype(dtype)
    planes = np.c_[n, -(n * (p + shift)).sum(-1)].astype(dtype)
    full = sl.geometry.ray_plane(o, d, planes, full_output=True)
    for i in range(100):
        height, speed = exact(o[i], d[i], planes[i])
        want = -height / speed
        assert abs(float(full.t_line[i]) - want) <= 4 * float(np.finfo(dtype).eps) * abs(want)
        assert full.t[i] == (full.t_line[i] if want > 0 else np.inf)
        assert np.sign(full.distance[i]) == np.sign(float(height)) and np.sign(full.cosine[i]) == np.sign(float(speed))


small = st.integers(-50, 50)


@settings(max_examples=150, deadline=None)
@given(o=st.tuples(small, small, small), d=st.tuples(small, small, small).filter(any), plane=st.tuples(*[small] * 4))
def test_parallel_only_if_they_are(o, d, plane):
    for dtype in (np.float32, np.float64):
        # Tenths are not exact: sums of their products cancel but for the last bits.
        ray, at = (np.array(x, dtype) / dtype(10) for x in (o, d)), np.array(plane, dtype) / dtype(10)
        o_, d_ = ray
        t = sl.geometry.ray_plane(o_, d_, at, t_min=-np.inf)
        if not any(plane[:3]):
            assert np.isnan(t)
            continue
        height, speed = exact(o_, d_, at)
        assert np.isinf(t) == (speed == 0)
        if speed:
            assert abs(float(t) - -height / speed) <= 4 * float(np.finfo(dtype).eps) * abs(height / speed)


def test_distance_and_cosine():
    full = sl.geometry.ray_plane([0, 0, 5], [0, 3.0, -4.0], [0, 0, 2, -4], full_output=True)
    assert [float(x) for x in full] == [0.75, 0.75, 3.0, -0.8]


def test_rays_on_in_and_beside_planes_miss():
    plane = [0, 0, 1.0, -1]
    assert np.isinf(sl.geometry.ray_plane([0, 0, 1.0], [1.0, 1, 0], plane))
    assert np.isinf(sl.geometry.ray_plane([0, 0, 2.0], [1.0, 1, 0], plane))
    assert np.isinf(sl.geometry.ray_plane([0, 0, 1.0], [1.0, 1, 1], plane))
    assert np.isinf(sl.geometry.ray_plane([0, 0, 2.0], [0, 0, -1.0], plane, t_max=1))


def test_agrees_with_trimesh():
    rng = np.random.default_rng(2)
    o, d = rng.normal(size=(2, 50, 3))
    n, p = np.array([0.2, 0.5, -1.0]), np.array([1.0, 2, 3])
    where = trimesh.intersections.planes_lines(p, n, o, d)[0]
    t = sl.geometry.ray_plane(o, d, [*n, -n @ p], t_min=-np.inf)
    assert np.allclose(o + t[:, None] * d, where, atol=1e-9)


def test_nan_stays_in_its_element_and_arguments_are_named():
    o, d, planes = np.ones((5, 3)), np.tile([0, 0, -1.0], (5, 1)), np.tile([0, 0, 1.0, 0], (5, 1))
    o[0, 0], d[1], planes[2, :3], planes[3, 3] = np.nan, 0, 0, np.inf
    t = sl.geometry.ray_plane(o, d, planes)
    assert np.isnan(t[:4]).all() and t[4] == 1
    with pytest.raises(ValueError, match=r"planes: expected shape \(\.\.\., 4\)"):
        sl.geometry.ray_plane(o, d, [0, 0, 1.0])
