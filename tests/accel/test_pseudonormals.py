"""Signed distances by both methods, and containment: analytic shapes, trimesh, and meshes that are not closed."""

import numpy as np
import pytest
import shadelab as sl
import trimesh

METHODS = ["winding", "angle_weighted"]


def bvh_of(mesh, dtype=np.float64):
    return sl.accel.BVH(np.asarray(mesh.vertices, dtype), mesh.faces)


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_box_has_its_closed_form(method, dtype):
    box = sl.mesh.box((2, 4, 6))
    half = np.array([1, 2, 3])
    rng = np.random.default_rng(1)
    # Many next to vertices and edges, where the nearest point is no face's own.
    q = np.concatenate([rng.uniform(-4, 4, (3000, 3)), half * rng.choice([-1, 1], (3000, 3)) * 1.2]).astype(dtype)
    q[3000:] += rng.normal(size=(3000, 3)) * 0.5
    d = np.abs(q.astype(float)) - half
    expected = np.linalg.norm(np.maximum(d, 0), axis=-1) + np.minimum(d.max(-1), 0)
    found = sl.accel.BVH(box.positions.astype(dtype), box.faces).signed_distance(q, method)
    assert np.allclose(found, expected, rtol=0, atol=40 * np.finfo(dtype).eps)


@pytest.mark.parametrize("method", METHODS)
def test_sphere_and_torus_have_theirs_up_to_tessellation(method):
    rng = np.random.default_rng(2)
    q = rng.uniform(-1.8, 1.8, (2000, 3))
    sphere = bvh_of(trimesh.creation.icosphere(5)).signed_distance(q, method)
    assert np.abs(sphere - (np.linalg.norm(q, axis=-1) - 1)).max() < 1e-3
    torus = bvh_of(trimesh.creation.torus(1.0, 0.4, 96, 96)).signed_distance(q, method)
    ring = np.hypot(np.hypot(q[:, 0], q[:, 1]) - 1, q[:, 2]) - 0.4
    # The chord's height.
    assert np.abs(torus - ring).max() < 1e-3


@pytest.mark.parametrize("method", METHODS)
def test_agrees_with_trimesh(method):
    mesh = trimesh.creation.torus(1.0, 0.4, 24, 24)
    q = np.random.default_rng(3).uniform(-1.6, 1.6, (400, 3))
    # trimesh counts inside positive.
    assert np.allclose(bvh_of(mesh).signed_distance(q, method), -trimesh.proximity.signed_distance(mesh, q), atol=1e-12)
    assert np.array_equal(bvh_of(mesh).contains(q), mesh.contains(q))


@pytest.mark.parametrize("method", METHODS)
def test_split_vertices_do_no_harm(method):
    mesh = trimesh.creation.icosphere(2)
    mesh.vertices[:, 0] *= 3
    q = np.random.default_rng(4).uniform(-2, 2, (1000, 3))
    split = sl.accel.BVH(mesh.vertices[mesh.faces].reshape(-1, 3), np.arange(3 * len(mesh.faces)).reshape(-1, 3))
    assert np.array_equal(split.signed_distance(q, method) < 0, bvh_of(mesh).signed_distance(q, method) < 0)


def test_angle_weights_decide_where_plain_normals_fail():
    """At the tip of a lopsided spike, the unweighted mean of normals tells the wrong side for some points."""
    n = 40
    turn = np.concatenate([np.linspace(0, 0.2, n - 2), [2.2, 4.3]])
    p = np.concatenate([[[0, 0, 0]], np.stack([np.cos(turn), np.sin(turn), 0 * turn - 2.0], -1), [[0, 0, -3.0]]])
    ring = np.arange(n)
    f = np.concatenate(
        [
            np.stack([0 * ring, 1 + ring, 1 + (ring + 1) % n], -1),
            np.stack([0 * ring + n + 1, 1 + (ring + 1) % n, 1 + ring], -1),
        ]
    )
    q = np.random.default_rng(5).normal(size=(4000, 3)) * 0.3
    bvh = sl.accel.BVH(p, f)
    assert np.array_equal(bvh.signed_distance(q, "angle_weighted") < 0, bvh.contains(q, max_error=0))
    near = bvh.closest_point(q, full_output=True)
    at_tip = (near.feature >= 4) & (near.distance > 0) & (np.abs(near.point) < 1e-12).all(-1)
    plain = np.nan_to_num(sl.mesh.face_normals(p, f))[:n].sum(0)
    assert ((q[at_tip] @ plain < 0) != bvh.contains(q[at_tip], max_error=0)).any()


def test_open_meshes_are_completed_by_winding_and_overlaps_united():
    bowl = trimesh.creation.icosphere(4)
    bowl = bvh_of(trimesh.Trimesh(bowl.vertices, bowl.faces[bowl.triangles_center[:, 2] < 0.5], process=False))
    q = np.array([[0, 0, 0], [0, 0, -0.9], [0, 0, 1.5], [0, 0, -1.1]])
    assert bowl.contains(q).tolist() == [True, True, False, False]
    a, b = trimesh.creation.box((2, 2, 2)), trimesh.creation.box((2, 2, 2))
    b.apply_translation([1, 0.5, 0.25])
    both = bvh_of(trimesh.util.concatenate([a, b]))
    rng = np.random.default_rng(6)
    q = rng.uniform(-2, 3, (2000, 3))
    inside = (np.abs(q) < 1).all(-1) | (np.abs(q - [1, 0.5, 0.25]) < 1).all(-1)
    assert np.array_equal(both.contains(q), inside)
    assert np.array_equal(both.signed_distance(q) < 0, inside)


def test_points_that_are_none_and_meshes_that_are_none():
    box = sl.mesh.box()
    bvh = sl.accel.BVH(box.positions, box.faces)
    q = np.zeros((3, 3))
    q[1] = np.nan
    for method in METHODS:
        assert np.isnan(bvh.signed_distance(q, method)).tolist() == [False, True, False]
        assert np.isposinf(sl.accel.BVH(np.zeros((0, 3)), []).signed_distance([0, 0, 0], method))
    assert bvh.contains(q).tolist() == [True, False, True]
    with pytest.raises(ValueError, match="method: expected one of"):
        bvh.signed_distance(q, "parity")


def test_on_the_surface_the_distance_is_nothing():
    box = sl.mesh.box((2, 2, 2))
    bvh = sl.accel.BVH(box.positions, box.faces)
    q = [[1, 0, 0], [1, 1, 0.3], [1, 1, 1], [-1, -0.25, 0.5]]
    for method in METHODS:
        assert np.array_equal(np.abs(bvh.signed_distance(q, method)), np.zeros(4))
