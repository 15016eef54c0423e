"""Primitives are closed, face outwards, have the volume of their kind, and exact normals."""

import numpy as np
import pytest
import trimesh
from shadelab.mesh import Mesh, box, face_normals, icosphere, plane, torus

CLOSED = {
    "box": (box((1.0, 2.0, 3.0)), 6.0, 0.0),
    "icosphere": (icosphere(4, 2.0), 4 / 3 * np.pi * 8, 0.005),
    "torus": (torus(1.5, 0.5, 128, 64), 2 * np.pi**2 * 1.5 * 0.25, 0.005),
}


@pytest.mark.parametrize("name", CLOSED)
def test_closed_outward_and_of_the_right_volume(name):
    m, volume, slack = CLOSED[name]
    t = trimesh.Trimesh(m.positions, m.faces)  # merges equal positions
    assert t.is_watertight and t.is_winding_consistent
    # A polyhedron inscribed in a round body is a little smaller.
    assert volume * (1 - slack) - 1e-12 <= t.volume <= volume + 1e-12


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("make", [box, plane, icosphere, torus])
def test_normals_are_unit_and_on_the_side_of_the_faces(make, dtype):
    m = make(dtype=dtype)
    assert m.dtype == dtype and m.normals.dtype == dtype
    assert np.abs(np.linalg.norm(m.normals.astype(float), axis=-1) - 1).max() < 2 * np.finfo(dtype).eps
    facing = face_normals(m.positions, m.faces)
    assert (np.einsum("fk,fck->fc", facing, m.normals[m.faces]) > 0.9).all()


def test_vertices_lie_on_their_surfaces():
    assert np.abs(np.linalg.norm(icosphere(5, 3.0).positions, axis=-1) - 3).max() < 2e-15
    p = torus(2.0, 0.5).positions
    assert np.abs(np.hypot(np.hypot(p[:, 0], p[:, 2]) - 2, p[:, 1]) - 0.5).max() < 1e-15
    assert np.array_equal(box(2.0).bounds, [[-1] * 3, [1] * 3])
    m = plane((2.0, 4.0), 3)
    assert np.array_equal(m.bounds, [[-1, 0, -2], [1, 0, 2]])
    assert np.array_equal(m.uvs[0], [0, 0]) and np.array_equal(m.positions[0], [-1, 0, 2])


def test_parameters_out_of_domain_are_named():
    for make, match in [
        (lambda: box(0.0), "size"),
        (lambda: box((1.0, 2.0)), "size: expected one number or 3"),
        (lambda: plane(1.0, 0), "segments"),
        (lambda: icosphere(11), "subdivisions"),
        (lambda: torus(1.0, 1.0), "tube"),
    ]:
        with pytest.raises(ValueError, match=match):
            make()


def test_a_mesh_refuses_what_it_cannot_hold():
    p = np.zeros((3, 3))
    for arguments, match in [
        (([[0, 0, 0], [0, np.nan, 0]], [[0, 1, 1]]), "positions: vertex 1 is not finite"),
        ((p, [[0, 1, 2]], None, None, np.full((3, 3), 1.1)), "colors: vertex 0 is not in"),
        ((p, [[0, 1, 3]]), r"faces: index 3 at \(0, 2\)"),
        ((p, [[0, 1, -1]]), "faces: index -1"),
        ((p, [[0, 1]]), r"faces: expected shape \(m, 3\)"),
        ((np.zeros((3, 2)), [[0, 1, 2]]), r"positions: expected shape \(V, 3\)"),
        ((p, [[0, 1, 2]], np.zeros((2, 3))), r"normals: expected shape \(3, 3\)"),
        ((p, [[0, 1, 2]], None, None, None, [0, 1]), r"material_ids: expected shape \(1,\)"),
    ]:
        with pytest.raises(ValueError, match=match):
            Mesh(*arguments)
    with pytest.raises(TypeError, match="faces: expected integers"):
        Mesh(p, [[0.5, 1, 2]])
    assert len(Mesh(np.zeros((0, 3)), np.zeros((0, 3), int)).faces) == 0


def test_transformed_keeps_the_outside_outside_even_when_mirrored():
    m = torus()
    for matrix in (np.diag([-1.0, 2, 3, 1]), np.diag([1.0, 2, 3, 1])):
        t = m.transformed(matrix)
        assert trimesh.Trimesh(t.positions, t.faces).volume > 0
        assert (np.einsum("fk,fck->fc", face_normals(t.positions, t.faces), t.normals[t.faces]) > 0.8).all()
    assert m.astype(np.float32).normals.dtype == np.float32
