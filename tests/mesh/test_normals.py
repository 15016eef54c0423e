"""Normals: against trimesh, and by what they must not depend on."""

import numpy as np
import pytest
import trimesh
from shadelab.mesh import box, face_normals, icosphere, torus, vertex_normals


def soup(rng, dtype):
    """A closed mesh shaken, so that nothing is symmetric."""
    m = trimesh.creation.icosphere(3)
    p = (m.vertices + rng.normal(scale=0.02, size=m.vertices.shape)).astype(dtype)
    return p, np.asarray(m.faces, np.int32)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_face_normals_are_trimeshs(dtype):
    p, f = soup(np.random.default_rng(1), dtype)
    expected = trimesh.Trimesh(p.astype(float), f, process=False).face_normals
    got = face_normals(p, f)
    assert got.dtype == dtype and np.abs(got - expected).max() < 16 * np.finfo(dtype).eps


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("weights", ["angle", "area", "uniform"])
def test_vertex_normals_are_trimeshs(weights, dtype):
    p, f = soup(np.random.default_rng(2), dtype)
    m = trimesh.Trimesh(p.astype(float), f, process=False)
    share = {"angle": m.face_angles, "area": np.repeat(m.area_faces[:, None], 3, 1), "uniform": np.ones((len(f), 3))}
    expected = np.zeros_like(m.vertices)
    for k in range(3):
        np.add.at(expected, f[:, k], share[weights][:, k : k + 1] * m.face_normals)
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    assert np.abs(vertex_normals(p, f, weights=weights) - expected).max() < 16 * np.finfo(dtype).eps


def test_angle_weights_do_not_depend_on_how_a_side_is_cut():
    cube = box()
    welded, index = np.unique(cube.positions, axis=0, return_inverse=True)
    faces = index.reshape(-1)[cube.faces]
    a, b, c, d = faces[0, 0], faces[0, 1], faces[0, 2], faces[1, 2]
    other = np.concatenate([[[a, b, d], [b, c, d]], faces[2:]])  # one side along its other diagonal
    for cut in (faces, other):
        assert np.abs(vertex_normals(welded, cut) - np.sign(welded) / np.sqrt(3)).max() < 1e-15
    assert np.abs(vertex_normals(welded, other, weights="uniform") - np.sign(welded) / np.sqrt(3)).max() > 0.1


@pytest.mark.parametrize("scale", [1e-30, 1e30])
@pytest.mark.parametrize("weights", ["angle", "area", "uniform"])
def test_scale_changes_nothing_in_single_precision(weights, scale):
    ball = icosphere(2, dtype=np.float32)
    got = vertex_normals(ball.positions * np.float32(scale), ball.faces, weights=weights)
    assert np.abs(got - vertex_normals(ball.positions, ball.faces, weights=weights)).max() < 1e-6


def test_what_has_no_normal_is_nan_and_touches_no_other():
    p = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [5, 5, 5], [2, 0, 0]])
    f = [[0, 1, 2], [0, 1, 4], [1, 1, 2]]  # the second and the third have no area, vertex 3 has no face
    assert np.array_equal(np.isnan(face_normals(p, f)).all(1), [False, True, True])
    got = vertex_normals(p, f)
    assert np.array_equal(np.isnan(got).all(1), [False, False, False, True, True])
    assert np.array_equal(got[:3], [[0, 0, 1]] * 3)


def test_results_do_not_depend_on_threads():
    import shadelab as sl

    ring = torus(segments=300, sides=200)
    p = ring.positions + np.random.default_rng(3).normal(scale=1e-3, size=ring.positions.shape)
    before = sl.threads()
    results = []
    for n in (1, 3):
        sl.set_threads(n)
        results.append(vertex_normals(p, ring.faces))
    sl.set_threads(before)
    assert np.array_equal(*results)


def test_bad_faces_are_named():
    with pytest.raises(ValueError, match=r"faces: index 3 at \(0, 2\) is out of range"):
        face_normals(np.zeros((3, 3)), [[0, 1, 3]])
    with pytest.raises(ValueError, match="weights: expected one of"):
        vertex_normals(np.zeros((3, 3)), [[0, 1, 2]], weights="none")
    assert face_normals(np.zeros((0, 3)), np.zeros((0, 3), int)).shape == (0, 3)
