"""The octree: its knobs, how it adapts, and the order of faces. What it answers: test_structure.py."""

import hypothesis
import numpy as np
import pytest
import shadelab as sl
from hypothesis import strategies as st

A = sl.accel


def soup(rng, n, size, dtype=np.float64):
    p = (rng.uniform(size=(n, 1, 3)) + size * rng.normal(size=(n, 3, 3))).reshape(-1, 3)
    return p.astype(dtype), np.arange(3 * n).reshape(-1, 3)


def same_bits(a, b):
    return all(x.tobytes() == y.tobytes() for x, y in zip(a, b, strict=True) if y is not None)


@hypothesis.settings(max_examples=25, deadline=None)
@hypothesis.given(
    st.integers(1, 9), st.integers(0, 32), st.integers(0, 2**31), st.sampled_from([np.float32, np.float64])
)
def test_any_knobs_give_brute_forces_answers(leaf_size, max_depth, seed, dtype):
    rng = np.random.default_rng(seed)
    p, f = soup(rng, 60, 10 ** rng.uniform(-3, 0), dtype)
    tree = A.Octree(p, f, leaf_size=leaf_size, max_depth=max_depth)
    o = rng.uniform(-1, 2, (80, 3))
    d = p[rng.integers(len(p), size=80)] - o
    assert same_bits(tree.closest_hit(o, d), A.brute_force(p, f, o, d))
    assert same_bits(tree.all_hits(o, d), A.brute_force_all(p, f, o, d))


def test_knobs_shape_the_tree():
    rng = np.random.default_rng(1)
    p, f = soup(rng, 3000, 0.01)
    assert A.Octree(p, f, max_depth=0).stats()[1:5] == (0, 1, 0, 3000)
    shallow, deep = A.Octree(p, f, max_depth=2).stats(), A.Octree(p, f, leaf_size=1).stats()
    assert shallow.depth == 2 and shallow.nodes == 9 and shallow.leaves == 64
    assert deep.depth > 4 and deep.nodes > 1000 and deep.sah_cost < shallow.sah_cost
    assert deep.references <= 16 * 3000


def test_it_adapts_to_where_detail_is():
    """A small object in a large scene: the grid has it in one cell, the octree goes down to it."""
    rng = np.random.default_rng(2)
    p, f = soup(rng, 2000, 0.02)
    p[: 3 * 1900] = p[: 3 * 1900] * 1e-3 + 0.5
    o = rng.uniform(size=(1000, 3))
    d = p[rng.integers(3 * 1900, size=1000)] - o
    tested = {s.__name__: s(p, f).counts(o, d).triangles.mean() for s in (A.Octree, A.UniformGrid)}
    assert tested["Octree"] < 0.05 * tested["UniformGrid"]


def test_order_is_true_between_cells():
    rng = np.random.default_rng(3)
    # One tiny triangle in the middle of each of 512 cells.
    i = np.stack(np.meshgrid(*[np.arange(8)] * 3), -1).reshape(-1, 3)
    rng.shuffle(i)
    p = ((i[:, None] + 0.5 + 0.45 * rng.uniform(-1, 1, (512, 3, 3))) / 8).reshape(-1, 3)
    ends = np.array([[0, 0, 0], [0, 0, 0], [0, 0, 0], [1, 1, 1], [1, 1, 1], [1, 1, 1.0]])
    p = np.concatenate([p, ends])
    f = np.arange(len(p)).reshape(-1, 3)
    tree = A.Octree(p, f, leaf_size=1)
    eye = np.array([0.3, 1.7, -0.4])
    order = tree.order(eye, front_to_back=True)
    assert np.array_equal(np.sort(order.face), np.arange(len(f))) and np.array_equal(order.triangles, p[f[order.face]])
    rank = np.empty(len(f), int)
    rank[order.face] = np.arange(len(f))
    # Along any ray from the eye, hits come in that order.
    d = rng.uniform(size=(20000, 3)) - eye
    hits = tree.all_hits(eye, d)
    pairs = hits.ray[1:] == hits.ray[:-1]
    assert pairs.sum() > 50 and (rank[hits.face[1:]] > rank[hits.face[:-1]])[pairs].all()
    back = tree.order(eye)
    assert np.array_equal(back.face, order.face[::-1])


def test_bad_arguments_are_named():
    p, f = soup(np.random.default_rng(4), 3, 0.1)
    for knobs, text in [({"leaf_size": 0}, "leaf_size: expected"), ({"max_depth": 33}, "max_depth: expected")]:
        with pytest.raises(ValueError, match=text):
            A.Octree(p, f, **knobs)
    with pytest.raises(ValueError, match="eye: expected a finite point"):
        A.Octree(p, f).order([0, np.nan, 0])
