"""Nearest points: exact rationals, trimesh, and brute force to the bit."""

import math
from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
import trimesh
from hypothesis import given, settings
from hypothesis import strategies as st

FIELDS = ("point", "distance", "face", "u", "v", "feature")


def same_bits(a, b):
    return all(np.array_equal(getattr(a, n).view(np.uint8), getattr(b, n).view(np.uint8)) for n in FIELDS)


def soup(rng, n, dtype, size=0.2):
    p = rng.normal(size=(n, 1, 3)) + size * rng.normal(size=(n, 3, 3))
    return p.reshape(-1, 3).astype(dtype), np.arange(3 * n).reshape(-1, 3)


def exact_square(p, a, b, c):
    """The squared distance from a triangle in rational arithmetic."""
    p, a, b, c = ([Fraction(float(x)) for x in v] for v in (p, a, b, c))

    def sub(x, y):
        return [i - j for i, j in zip(x, y, strict=True)]

    def dot(x, y):
        return sum(i * j for i, j in zip(x, y, strict=True))

    def away(q):
        return dot(sub(p, q), sub(p, q))

    def segment(a, b):
        e = sub(b, a)
        s = max(Fraction(0), min(Fraction(1), dot(sub(p, a), e) / dot(e, e))) if any(e) else 0
        return away([x + s * y for x, y in zip(a, e, strict=True)])

    best = min(segment(a, b), segment(b, c), segment(c, a))
    e, f, w = sub(b, a), sub(c, a), sub(p, a)
    ee, ef, ff = dot(e, e), dot(e, f), dot(f, f)
    det = ee * ff - ef * ef
    if det:
        u, v = (ff * dot(w, e) - ef * dot(w, f)) / det, (ee * dot(w, f) - ef * dot(w, e)) / det
        if u >= 0 and v >= 0 and u + v <= 1:
            best = min(best, away([x + u * y + v * z for x, y, z in zip(a, e, f, strict=True)]))
    return best


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("thin", [1.0, 1e-3])
@pytest.mark.parametrize("near", [1.0, 1e-4, 0.0])
def test_distance_agrees_with_exact_arithmetic(dtype, thin, near):
    rng = np.random.default_rng(1)
    t = rng.normal(size=(100, 3, 3))
    t[:, 2] = t[:, 0] + rng.uniform(size=(100, 1)) * (t[:, 1] - t[:, 0]) + thin * rng.normal(size=(100, 3))
    w = rng.dirichlet([0.5] * 3, 100)
    p, t = ((w[..., None] * t).sum(1) + near * rng.normal(size=(100, 3))).astype(dtype), t.astype(dtype)
    for point, corners in zip(p, t, strict=True):
        found = sl.accel.BVH(corners, [[0, 1, 2]]).closest_point(point)
        square = exact_square(point, *corners)
        exact = math.sqrt(square)
        reach = np.linalg.norm(corners.astype(float) - point, axis=-1).max()
        # The docstring's bound.
        assert abs(float(found.distance) - exact) <= 4 * np.finfo(dtype).eps * reach


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("level", sl.simd_levels())
@pytest.mark.parametrize("scale", [1.0, 1e-6, 1e6])
def test_tree_equals_brute_force_to_the_bit(dtype, level, scale):
    rng = np.random.default_rng(2)
    p, f = soup(rng, 600, dtype)
    p = (p * scale).astype(dtype)
    q = rng.normal(size=(1000, 3))
    # On vertices, on edges, in planes and far away too.
    q[:100] = p[rng.integers(len(p), size=100)] / scale
    q[100:200] = (p[f[:100, 0]] + p[f[:100, 1]]) / 2 / scale
    q[200:300] = p[f[:100]].mean(1) / scale
    q[300:320] *= 1e3
    bvh = sl.accel.BVH(p, f)
    expected = bvh.closest_point(q * scale, method="brute_force", full_output=True)
    with sl.simd(level):
        for limit in (np.inf, scale * rng.uniform(0, 0.5, 1000)):
            found = bvh.closest_point(q * scale, limit, full_output=True)
            assert same_bits(found, bvh.closest_point(q * scale, limit, method="brute_force", full_output=True))
            far = ~(expected.distance < limit)
            assert (found.face[far] == -1).all() and np.array_equal(found.face[~far], expected.face[~far])


@settings(max_examples=40, deadline=None)
@given(st.data())
def test_equality_holds_on_degenerate_meshes(data):
    """Grid points make coincident, collinear and touching triangles, and many ties."""
    n = data.draw(st.integers(1, 60))
    coordinates = st.lists(st.integers(-2, 2), min_size=9 * n, max_size=9 * n)
    p = np.array(data.draw(coordinates), float).reshape(-1, 3)
    q = np.array(data.draw(st.lists(st.integers(-6, 6), min_size=30, max_size=30)), float).reshape(-1, 3) / 2
    bvh = sl.accel.BVH(p, np.arange(3 * n).reshape(-1, 3))
    found = bvh.closest_point(q, full_output=True)
    assert same_bits(found, bvh.closest_point(q, method="brute_force", full_output=True))
    for i in range(2):
        exact = min(exact_square(q[i], *p[3 * k : 3 * k + 3]) for k in range(n))
        assert abs(float(found.distance[i]) - math.sqrt(exact)) < 1e-14


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_agrees_with_trimesh(dtype):
    mesh = trimesh.creation.torus(1.0, 0.4, 24, 24)
    q = np.random.default_rng(3).uniform(-2, 2, (500, 3)).astype(dtype)
    found = sl.accel.BVH(mesh.vertices.astype(dtype), mesh.faces).closest_point(q)
    _, distance, _ = trimesh.proximity.closest_point(mesh, q.astype(float))
    # trimesh works in double; the mesh in single precision is itself off by a rounding.
    assert np.allclose(found.distance, distance, rtol=0, atol=8 * np.finfo(dtype).eps)


def test_ties_go_to_the_lowest_face_and_features_are_named():
    p = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [-1, 0, 0], [0, -1, 0.0]])
    bvh = sl.accel.BVH(p, [[0, 1, 2], [0, 2, 3], [0, 3, 4], [0, 4, 1]])
    found = bvh.closest_point([0, 0, 1.0], full_output=True)
    assert found.face == 0 and found.feature == 4 and found.distance == 1
    one = sl.accel.BVH(p[:3], [[0, 1, 2]])
    q = [[0.2, 0.2, 1], [0.5, -1, 1], [1, 1, 0], [-1, 0.5, 0], [-1, -1, 0], [2, 0, 3], [0, 5, 0]]
    found = one.closest_point(q, full_output=True)
    assert found.feature.tolist() == [0, 1, 2, 3, 4, 5, 6]
    assert np.array_equal(found.point[4:], p[:3])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_what_is_no_point_gives_nan_and_touches_no_other(dtype):
    rng = np.random.default_rng(4)
    p, f = soup(rng, 50, dtype)
    q = rng.normal(size=(7, 3)).astype(dtype)
    bvh = sl.accel.BVH(p, f)
    clean = bvh.closest_point(q)
    q[1, 2], q[3, 0], q[5, 1] = np.nan, -np.inf, np.finfo(dtype).max
    found = bvh.closest_point(q)
    bad, good = [1, 3, 5], [0, 2, 4, 6]
    assert np.isnan(found.distance[bad]).all() and (found.face[bad] == -1).all() and np.isnan(found.point[bad]).all()
    assert np.array_equal(found.distance[good], clean.distance[good])
    limits = np.ones(7, dtype)
    limits[2] = np.nan
    assert np.isnan(bvh.closest_point(clean.point, limits).distance).tolist() == [False] * 2 + [True] + [False] * 4


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_ends_of_the_domain(dtype):
    """An empty mesh, one triangle as large and as small as meshes may be, and no points."""
    empty = sl.accel.BVH(np.zeros((0, 3), dtype), []).closest_point(np.zeros((2, 3, 3)))
    assert np.isinf(empty.distance).all() and (empty.face == -1).all() and empty.point.shape == (2, 3, 3)
    triangle = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0]], dtype)
    for size in (1e17, 2e-12) if dtype == np.float32 else (1e149, 2e-100):
        bvh = sl.accel.BVH(triangle * dtype(size), [[0, 1, 2]])
        found = bvh.closest_point(np.array([[0.25, 0.25, 2], [3, 0, 0]], dtype) * dtype(size))
        assert np.allclose(found.distance / dtype(size), 2, rtol=1e-6)
    assert bvh.closest_point(np.zeros((0, 3))).distance.shape == (0,)


def test_threads_change_nothing():
    rng = np.random.default_rng(5)
    p, f = soup(rng, 5000, np.float32, 0.05)
    q = rng.normal(size=(5000, 3))
    bvh = sl.accel.BVH(p, f)
    results = []
    for threads in (1, 2, 5):
        sl.set_threads(threads)
        results.append(bvh.closest_point(q, full_output=True))
    sl.set_threads(None)
    assert all(same_bits(r, results[0]) for r in results)


def test_bad_arguments_are_named():
    bvh = sl.accel.BVH(np.eye(3), [[0, 1, 2]])
    with pytest.raises(ValueError, match=r"points: expected shape \(\.\.\., 3\), got \(4, 2\)"):
        bvh.closest_point(np.zeros((4, 2)))
    with pytest.raises(ValueError, match="max_distance: expected a number, got nan"):
        bvh.closest_point([0, 0, 0], np.nan)
    with pytest.raises(ValueError, match="method: expected one of"):
        bvh.closest_point([0, 0, 0], method="fast")
