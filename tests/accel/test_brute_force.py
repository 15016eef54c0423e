"""Brute force, the oracle of every structure, against oracles of its own: exact rationals, and Embree."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
import trimesh


def exact_crossing(o, d, a, b, c):
    """`t` of the ray and triangle in rational arithmetic; None if they do not meet, in front or at all."""
    o, d, a, b, c = ([Fraction(float(x)) for x in v] for v in (o, d, a, b, c))

    def sub(p, q):
        return [x - y for x, y in zip(p, q, strict=True)]

    def cross(p, q):
        return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]

    def dot(p, q):
        return sum(x * y for x, y in zip(p, q, strict=True))

    e1, e2, s = sub(b, a), sub(c, a), sub(o, a)
    det = dot(e1, cross(d, e2))
    if det == 0:
        return None
    u, v, t = dot(s, cross(d, e2)) / det, dot(d, cross(s, e1)) / det, dot(e2, cross(s, e1)) / det
    return t if u >= 0 and v >= 0 and u + v <= 1 and t > 0 else None


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_agrees_with_exact_arithmetic(dtype):
    rng = np.random.default_rng(1)
    p = rng.normal(size=(60, 3)).astype(dtype)
    f = np.arange(60).reshape(-1, 3)
    o, d = rng.normal(size=(2, 300, 3)).astype(dtype)
    hit = sl.accel.brute_force(p, f, o, d)
    for i in range(300):
        met = [(t, k) for k in range(20) if (t := exact_crossing(o[i], d[i], *p[f[k]])) is not None]
        assert (hit.face[i] == -1) == (not met)
        if met:
            t, k = min(met)
            assert hit.face[i] == k
            # Big triangles met at an angle: a few hundred round-offs.
            assert abs(float((Fraction(float(hit.t[i])) - t) / t)) < 500 * np.finfo(dtype).eps


def test_agrees_with_embree_on_a_torus():
    mesh = trimesh.creation.torus(1.0, 0.4, 24, 24)
    rng = np.random.default_rng(2)
    o, d = rng.normal(size=(2, 3000, 3)).astype(np.float32)
    hit = sl.accel.brute_force(mesh.vertices.astype(np.float32), mesh.faces, o, d)
    embree = trimesh.ray.ray_pyembree.RayMeshIntersector(mesh) if trimesh.ray.has_embree else mesh.ray
    expected = embree.intersects_first(o, d)
    # Random rays meet an edge within single precision about once in 10^5.
    assert (hit.face != expected).sum() <= 1
