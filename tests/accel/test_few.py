"""Meshes of few faces go without a tree: brute force's answers to the bit, where faces lie in one plane too."""

import numpy as np
import pytest
import shadelab as sl
import trimesh


def same_bits(a, b):
    return all(np.array_equal(x.view(np.uint8), y.view(np.uint8)) for x, y in zip(a[:4], b[:4], strict=True))


def room(dtype):
    """A box with two in it that stand in its floor, faces in one plane with it."""
    parts = [trimesh.creation.box((4, 4, 4)), trimesh.creation.box((1, 2, 1)), trimesh.creation.box((1, 1, 1))]
    parts[1].apply_translation((-0.75, -1, -0.5))
    parts[2].apply_translation((0.875, -1.5, 0.5))
    mesh = trimesh.util.concatenate(parts)
    return np.array(mesh.vertices, dtype), np.array(mesh.faces, np.int32)


def rays(kind, n, dtype, seed):
    rng = np.random.default_rng(seed)
    o, d = rng.uniform(-2, 2, (n, 3)), rng.normal(size=(n, 3))
    if kind == "grid":
        # On edges, through vertices, within planes.
        o, d = rng.integers(-8, 9, (n, 3)) / 4, rng.integers(-2, 3, (n, 3)).astype(float)
    elif kind == "down":
        # Bottoms of boxes and the floor at once.
        d = np.array([0.0, -1.0, 0.0]) + 1e-3 * d * rng.integers(0, 2, (n, 1))
    elif kind == "outside":
        o = 4 * o
    return o.astype(dtype), d.astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("kind", ["inside", "outside", "grid", "down"])
def test_few_faces_give_brute_forces_answers(kind, dtype):
    p, f = room(dtype)
    bvh = sl.accel.BVH(p, f)
    for seed, repeated in ((0, f), (1, np.concatenate([f, f[::-1]]))):
        tree = bvh if seed == 0 else sl.accel.BVH(p, repeated)
        o, d = rays(kind, 4001, dtype, seed)
        free = sl.accel.brute_force(p, repeated, o, d)
        assert same_bits(tree.closest_hit(o, d), free)
        # Ends before, at and just past the hit, and the face that was hit left out.
        t = np.where(np.isfinite(free.t), free.t, 1.0).astype(dtype)
        for t_max in (t, np.nextafter(t, dtype(np.inf)), t * dtype(0.75)):
            expected = sl.accel.brute_force(p, repeated, o, d, t_max=t_max, ignore_face=free.face)
            got = tree.closest_hit(o, d, t_max=t_max, ignore_face=free.face)
            assert same_bits(got, expected)
            assert np.array_equal(tree.any_hit(o, d, t_max=t_max, ignore_face=free.face), expected.face >= 0)
            expected = sl.accel.brute_force(p, repeated, o, d, t_max=t_max)
            assert same_bits(tree.closest_hit(o, d, t_max=t_max), expected)
            assert np.array_equal(tree.any_hit(o, d, t_max=t_max), expected.face >= 0)
