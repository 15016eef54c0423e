"""The kd-tree: its methods and knobs, and that the heuristic pays. What it answers: test_structure.py."""

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
    st.sampled_from(["sah", "median"]),
    st.integers(1, 9),
    st.integers(0, 96),
    st.integers(0, 2**31),
    st.sampled_from([np.float32, np.float64]),
)
def test_any_knobs_give_brute_forces_answers(method, leaf_size, max_depth, seed, dtype):
    rng = np.random.default_rng(seed)
    p, f = soup(rng, 100, 10 ** rng.uniform(-3, 0), dtype)
    p = np.round(p, 2)  # Planes through vertices, boxes without thickness.
    tree = A.KDTree(p, f, method=method, leaf_size=leaf_size, max_depth=max_depth)
    o = rng.uniform(-1, 2, (80, 3))
    d = p[rng.integers(len(p), size=80)] - o
    assert same_bits(tree.closest_hit(o, d), A.brute_force(p, f, o, d))
    assert same_bits(tree.all_hits(o, d), A.brute_force_all(p, f, o, d))


def test_the_heuristic_cuts_off_empty_space():
    """Triangles in two far corners: few lines meet them, and the tree knows after some planes."""
    rng = np.random.default_rng(1)
    p, f = soup(rng, 2000, 0.05)
    p[::2] += 30
    p = np.repeat(p[::3], 3, 0) + 0.05 * rng.normal(size=p.shape)
    o = rng.uniform(-1, 31, (2000, 3))
    d = rng.normal(size=(2000, 3))
    sah, median = (A.KDTree(p, f, method=m).counts(o, d) for m in ("sah", "median"))
    assert sah.boxes.mean() < 0.7 * median.boxes.mean() and sah.triangles.mean() <= median.triangles.mean()
    costs = [A.KDTree(p, f, method=m).stats().sah_cost for m in ("sah", "median")]
    assert costs[0] < 0.7 * costs[1]


def test_the_expected_cost_is_what_lines_through_the_box_pay():
    """`sah_cost` against planes and triangles counted on random lines; mailboxes save some of the triangles."""
    rng = np.random.default_rng(2)
    p, f = soup(rng, 3000, 0.02)
    tree = A.KDTree(p, f)
    low, high = p.min(0), p.max(0)
    # Uniform lines through a sphere around the box; those that meet the box are distributed as the heuristic has it.
    n = rng.normal(size=(60_000, 3))
    d = n / np.linalg.norm(n, axis=-1, keepdims=True)
    u = np.cross(d, rng.normal(size=d.shape))
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    radius = np.linalg.norm(high - low) / 2
    o = (low + high) / 2 + radius * (u * np.sqrt(rng.uniform(size=(len(d), 1))) - 2 * d)
    counts = tree.counts(o, d, query="all_hits")
    passing = counts.boxes > 0
    paid = (counts.boxes + counts.triangles)[passing].mean()
    assert 0.75 < paid / tree.stats().sah_cost < 1.02


def test_depth_and_leaves_keep_to_the_knobs():
    rng = np.random.default_rng(3)
    p, f = soup(rng, 2000, 0.01)
    for method in ("sah", "median"):
        s = A.KDTree(p, f, method=method, max_depth=5).stats()
        assert s.depth == 5 and s.nodes <= 31 and s.references >= 2000
        assert A.KDTree(p, f, method=method, max_depth=0).stats().references == 2000
    with pytest.raises(ValueError, match="method: expected one of"):
        A.KDTree(p, f, method="middle")
    with pytest.raises(ValueError, match="max_depth: expected"):
        A.KDTree(p, f, max_depth=97)
