"""The grid: its cells, its walk cell by cell, and the bounds of its memory. What it answers: test_structure.py."""

import hypothesis
import numpy as np
import pytest
import shadelab as sl
from hypothesis import strategies as st

A = sl.accel


def soup(rng, n, size, dtype=np.float64):
    return (rng.uniform(size=(n, 1, 3)) + size * rng.normal(size=(n, 3, 3))).reshape(-1, 3).astype(dtype), np.arange(
        3 * n
    ).reshape(-1, 3)


def same_bits(a, b):
    return all(x.tobytes() == y.tobytes() for x, y in zip(a, b, strict=True) if y is not None)


@hypothesis.settings(max_examples=30, deadline=None)
@hypothesis.given(
    st.lists(st.integers(1, 40), min_size=3, max_size=3),
    st.integers(0, 2**31),
    st.booleans(),
    st.sampled_from([np.float32, np.float64]),
)
def test_any_resolution_gives_brute_forces_answers(resolution, seed, mailbox, dtype):
    rng = np.random.default_rng(seed)
    p, f = soup(rng, 40, 10 ** rng.uniform(-3, 0), dtype)
    grid = A.UniformGrid(p, f, resolution=resolution, mailbox=mailbox)
    o = rng.uniform(-1, 2, (80, 3))
    # Towards vertices, some of which are corners of the grid's planes.
    d = p[rng.integers(len(p), size=80)] - o
    d[::3] = np.eye(3)[rng.integers(3, size=len(d[::3]))]
    assert same_bits(grid.closest_hit(o, d), A.brute_force(p, f, o, d))
    assert same_bits(grid.all_hits(o, d), A.brute_force_all(p, f, o, d))


def test_a_ray_visits_the_cells_on_its_way_and_no_other():
    corners = np.array([[0, 0, 0], [0, 0, 0.01], [0, 0.01, 0], [8, 4, 2], [8, 4, 1.99], [8, 3.99, 2]])
    grid = A.UniformGrid(corners, [[0, 1, 2], [3, 4, 5]], resolution=(8, 4, 2))
    along_x = grid.counts([-1, 2.5, 0.5], [1, 0, 0])
    assert along_x.boxes == 8 and along_x.triangles == 0
    # From corner to corner through the middles of x, of y and of z: each plane crossed once more than the start.
    diagonal = grid.counts([-0.8, -0.39, -0.21], [8, 4, 2])
    assert diagonal.boxes == 1 + 7 + 3 + 1
    assert grid.counts([-1, 5, 0.5], [1, 0, 0]).boxes == 0


def test_the_resolution_follows_the_scenes_shape():
    rng = np.random.default_rng(1)
    p, f = soup(rng, 4000, 0.01)
    cube = A.UniformGrid(p, f, cells_per_face=2).resolution
    assert max(cube) - min(cube) <= 1 and 0.8 < np.prod(cube) / 8000 < 1.3
    x, y, z = A.UniformGrid(p * [100, 10, 1], f).resolution
    assert 8 < x / y < 12 and 8 < y / z < 12
    flat = p.copy()
    flat[:, 1] = 0
    x, y, z = A.UniformGrid(flat, f).resolution
    assert y == 1 and abs(x - z) <= 3 and 0.8 < x * z / 8000 < 1.2
    assert A.UniformGrid(p * 0, f).resolution == (1, 1, 1)


def test_long_triangles_do_not_fill_the_memory():
    rng = np.random.default_rng(2)
    p, f = soup(rng, 2000, 1.0, np.float32)
    grid = A.UniformGrid(p, f, resolution=(512, 512, 512))
    s = grid.stats()
    assert s.references <= 32 * 2000 + 64 and s.bytes < 10**6 and max(grid.resolution) < 512
    o, d = rng.normal(size=(2, 100, 3))
    assert same_bits(grid.closest_hit(o, d), A.brute_force(p, f, o, d))


def test_the_mailbox_saves_tests():
    rng = np.random.default_rng(3)
    p, f = soup(rng, 500, 0.1)
    o, d = rng.uniform(size=(2, 1000, 3)) * [[[1]], [[2]]] - [[[0]], [[1]]]
    kinds = [A.UniformGrid(p, f, cells_per_face=20, mailbox=m).counts(o, d, query="all_hits") for m in (True, False)]
    assert kinds[0].triangles.sum() < 0.6 * kinds[1].triangles.sum()
    assert np.array_equal(kinds[0].boxes, kinds[1].boxes)


def test_bad_knobs_are_named():
    p, f = soup(np.random.default_rng(4), 3, 0.1)
    for knobs, text in [
        ({"cells_per_face": 0}, "cells_per_face: expected a number"),
        ({"resolution": (1, 2)}, "resolution: expected three"),
        ({"resolution": (0, 2, 2)}, "resolution: expected an integer from 1"),
        ({"resolution": (1, 2, 10**6)}, "resolution: expected an integer from 1 to 2048"),
    ]:
        with pytest.raises(ValueError, match=text):
            A.UniformGrid(p, f, **knobs)
