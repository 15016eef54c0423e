"""The BSP tree: its knobs and the order of faces. What it answers: test_structure.py."""

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
    st.integers(1, 9), st.integers(0, 96), st.integers(0, 2**31), st.sampled_from([np.float32, np.float64])
)
def test_any_knobs_give_brute_forces_answers(leaf_size, max_depth, seed, dtype):
    rng = np.random.default_rng(seed)
    p, f = soup(rng, 60, 10 ** rng.uniform(-3, 0), dtype)
    tree = A.BSPTree(p, f, leaf_size=leaf_size, max_depth=max_depth)
    o = rng.uniform(-1, 2, (80, 3))
    d = p[rng.integers(len(p), size=80)] - o
    assert same_bits(tree.closest_hit(o, d), A.brute_force(p, f, o, d))
    assert same_bits(tree.all_hits(o, d), A.brute_force_all(p, f, o, d))


def test_halves_take_turns_of_axes():
    rng = np.random.default_rng(1)
    p, f = soup(rng, 4000, 0.002)
    s = A.BSPTree(p, f, max_depth=6).stats()
    assert s.depth == 6 and s.nodes == 63 and s.leaves == 64
    with pytest.raises(ValueError, match="leaf_size: expected"):
        A.BSPTree(p, f, leaf_size=0)


def test_order_lists_each_face_once_and_cells_truly():
    rng = np.random.default_rng(2)
    i = np.stack(np.meshgrid(*[np.arange(4)] * 3), -1).reshape(-1, 3)
    rng.shuffle(i)
    p = ((i[:, None] + 0.5 + 0.45 * rng.uniform(-1, 1, (64, 3, 3))) / 4).reshape(-1, 3)
    p = np.concatenate([p, np.zeros((3, 3)), np.ones((3, 3))])
    f = np.arange(len(p)).reshape(-1, 3)
    tree = A.BSPTree(p, f, leaf_size=1)
    eye = np.array([0.3, 1.7, -0.4])
    order = tree.order(eye, front_to_back=True)
    assert np.array_equal(np.sort(order.face), np.arange(len(f))) and np.array_equal(order.triangles, p[f[order.face]])
    rank = np.argsort(order.face)
    d = rng.uniform(size=(20000, 3)) - eye
    hits = tree.all_hits(eye, d)
    pairs = hits.ray[1:] == hits.ray[:-1]
    assert pairs.sum() > 50 and (rank[hits.face[1:]] > rank[hits.face[:-1]])[pairs].all()
    assert np.array_equal(tree.order(eye).face, order.face[::-1])
