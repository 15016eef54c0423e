"""Rays and oriented boxes: the slabs of exact arithmetic, and the axis-aligned test in the box's frame."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
import trimesh

from .rational import dot, sub, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def boxes(rng, n, dtype, shift=0.0, distance=4.0):
    axes = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0].astype(dtype)
    c = rng.normal(size=(n, 3)) + shift
    half = rng.uniform(0.2, 2, (n, 3))
    o = c + distance * rng.normal(size=(n, 3))
    d = c + rng.normal(size=(n, 3)) - o
    return [o.astype(dtype), d.astype(dtype), c.astype(dtype), axes, half.astype(dtype)]


def exact(o, d, c, axes, half):
    """Entry and exit of each slab."""
    w, d = sub(vector(c), vector(o)), vector(d)
    near, far = [], []
    for axis, h in zip(axes, vector(half), strict=True):
        e, f = dot(vector(axis), w), dot(vector(axis), d)
        near.append(min((e - h) / f, (e + h) / f))
        far.append(max((e - h) / f, (e + h) / f))
    return near, far


@PRECISIONS
@pytest.mark.parametrize(("shift", "distance"), [(0, 4), (1e6, 4), (0, 1e4)])
def test_borders_of_slabs_are_the_exact_ones(dtype, shift, distance):
    given = boxes(np.random.default_rng(1), 120, dtype, shift, distance)
    hit = sl.geometry.ray_obb(*given, full_output=True)
    eps = Fraction(float(np.finfo(dtype).eps))
    for i in range(120):
        near, far = exact(*(x[i] for x in given))
        for got, want in zip([*hit.slab_enter[i], *hit.slab_exit[i]], near + far, strict=True):
            assert abs(Fraction(float(got)) - want) <= 4 * eps * abs(want)
        enter, leave = max(near), min(far)
        if abs(enter - leave) > 8 * eps * max(abs(enter), abs(leave)):
            assert np.isfinite(hit.t_enter[i]) == (enter <= leave)


@PRECISIONS
def test_agrees_with_the_axis_aligned_test_to_the_last_bits(dtype):
    rng = np.random.default_rng(2)
    o, d, c = rng.integers(-8, 9, (3, 3000, 3)).astype(dtype) / 4
    half = rng.integers(0, 5, (3000, 3)).astype(dtype) / 2
    d[~d.any(-1)] = 1
    # The axes permuted and turned round, which is exact.
    axes = np.eye(3, dtype=dtype)[rng.permuted(np.tile(np.arange(3), (3000, 1)), axis=1)]
    axes = axes * rng.choice([-1, 1], (3000, 3, 1)).astype(dtype)
    turned = np.take_along_axis(half, np.abs(axes).argmax(-1), 1)
    got = sl.geometry.ray_obb(o, d, c, axes, turned, full_output=True)
    want = sl.geometry.ray_aabb(o, d, c - half, c + half)
    assert np.array_equal(got.t, want.t) and np.array_equal(got.t_enter, want.t_enter)
    assert 0.1 < np.isfinite(got.t).mean() < 0.9


def test_faces_are_the_boxes_own():
    rng = np.random.default_rng(3)
    o, d, c, axes, half = boxes(rng, 500, np.float64)
    hit = sl.geometry.ray_obb(o, d, c, axes, half, full_output=True)
    met = np.isfinite(hit.t_enter)
    for t, face in ((hit.t_enter, hit.face_enter), (hit.t_exit, hit.face_exit)):
        local = np.einsum("nij,nj->ni", axes, o + t[:, None] * d - c)[met] / half[met]
        side = np.where(face[met] % 2 == 0, 1, -1)
        assert np.allclose(local[np.arange(met.sum()), face[met] // 2], side, atol=1e-9)


def test_agrees_with_trimesh():
    rng = np.random.default_rng(4)
    for o, d, c, axes, half in zip(*boxes(rng, 30, np.float64), strict=True):
        frame = np.eye(4)
        frame[:3, :3], frame[:3, 3] = axes.T, c
        where, _, _ = trimesh.creation.box(2 * half, frame).ray.intersects_location([o], [d])
        hit = sl.geometry.ray_obb(o, d, c, axes, half)
        assert np.isfinite(hit.t) == (len(where) > 0)
        if len(where):
            assert np.isclose(np.linalg.norm(where - o, axis=-1).min(), hit.t * np.linalg.norm(d), rtol=1e-6)


@PRECISIONS
@pytest.mark.parametrize("length", [1e-20, 1e20])
def test_length_of_direction_scales_t_alone(dtype, length):
    o, d, c, axes, half = boxes(np.random.default_rng(5), 500, dtype)
    factor = dtype(2.0 ** np.round(np.log2(length)))
    one, many = (sl.geometry.ray_obb(o, x, c, axes, half) for x in (d, d * factor))
    assert all(np.array_equal(x / factor, y) for x, y in zip(one, many, strict=True))


def test_rays_parallel_to_slabs_and_flat_boxes():
    s = np.sqrt(0.5)
    axes = [[s, s, 0], [-s, s, 0], [0, 0, 1]]
    # Along an axis, inside the slabs of the others, or outside.
    assert sl.geometry.ray_obb([-3 * s, -3 * s, 0], [s, s, 0], [0, 0, 0], axes, [1, 1, 1]).t == pytest.approx(2)
    assert np.isinf(sl.geometry.ray_obb([-3 * s, -3 * s, 1.5], [s, s, 0], [0, 0, 0], axes, [1, 1, 1]).t)
    assert sl.geometry.ray_obb([0, 0, 2], [0, 0, -1.0], [0, 0, 0], axes, [1, 1, 0]).t == 2
    assert sl.geometry.ray_obb([0, 0, 0], [0, 0, -1.0], [0, 0, 0], axes, [1, 1, 1]).t == 0


def test_nan_and_negative_extents_stay_in_their_element():
    o, d, c, axes, half = boxes(np.random.default_rng(6), 6, np.float64)
    clean = sl.geometry.ray_obb(o, d, c, axes, half)
    o[0, 1], d[1], c[2, 0], axes[3, 1, 1], half[4, 2] = np.nan, 0, np.inf, np.nan, -1
    hit = sl.geometry.ray_obb(o, d, c, axes, half)
    assert all(np.isnan(x[:5]).all() and x[5] == y[5] for x, y in zip(hit, clean, strict=True))
    with pytest.raises(ValueError, match=r"axes: expected shape \(\.\.\., 3, 3\)"):
        sl.geometry.ray_obb(o, d, c, [1, 2, 3], half)
