"""Which side of a mesh nodes are on follows from their neighbours: the same as by each one's winding number."""

import numpy as np
import pytest
from shadelab import mesh
from shadelab.accel import BVH
from shadelab.shadow import distance_grid
from shadelab.shadow.grids import _closed


def bodies(*several):
    starts = np.cumsum([0] + [len(m.positions) for m in several[:-1]])
    positions = np.concatenate([m.positions for m in several])
    return positions, np.concatenate([m.faces + k for m, k in zip(several, starts, strict=True)])


def moved(m, offset):
    return mesh.Mesh(m.positions + np.asarray(offset, m.positions.dtype), m.faces)


def inside_out(m):
    return mesh.Mesh(m.positions, m.faces[:, ::-1].copy())


CLOSED = {
    "sphere": bodies(mesh.icosphere(2, 1.0)),
    "torus": bodies(mesh.torus(1.0, 0.3)),
    "shell": bodies(mesh.icosphere(2, 1.0), inside_out(mesh.icosphere(2, 0.6))),
    "crossing": bodies(mesh.box((1.0, 1, 1)), moved(mesh.box((1.0, 1, 1)), (0.4, 0.3, 0.2))),
    "many": bodies(*(moved(mesh.icosphere(1, 0.05), (0.3 * i, 0.0, 0.1 * i)) for i in range(20))),
    "thin": bodies(mesh.box((2.0, 0.01, 2.0)), moved(mesh.box((0.5, 1, 0.5)), (0, 0.7, 0))),
    "inverted": bodies(inside_out(mesh.icosphere(2, 1.0))),
}


@pytest.mark.parametrize("name", CLOSED)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_closed_meshes_have_the_sides_of_their_winding_numbers(name, dtype):
    positions, faces = CLOSED[name]
    tree = BVH(positions.astype(dtype), faces)
    assert _closed(tree)
    grid = distance_grid(tree, resolution=23, dtype=np.float64)
    axes = [grid.low[i] + grid.cell * np.arange(n) for i, n in enumerate(grid.distances.shape)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    assert np.array_equal(grid.distances, tree.signed_distance(points, "winding"))


def test_open_meshes_are_asked_at_every_node():
    positions, faces = CLOSED["sphere"]
    tree = BVH(positions, faces[:-40])
    assert not _closed(tree) and not _closed(BVH(*bodies(mesh.plane((2.0, 2.0)))))
    grid = distance_grid(tree, resolution=15, dtype=np.float64)
    axes = [grid.low[i] + grid.cell * np.arange(n) for i, n in enumerate(grid.distances.shape)]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), -1)
    assert np.array_equal(grid.distances, tree.signed_distance(points, "winding"))


def test_vertices_at_one_place_are_one():
    positions, faces = CLOSED["sphere"]
    assert _closed(BVH(positions[faces].reshape(-1, 3), np.arange(3 * len(faces)).reshape(-1, 3)))
