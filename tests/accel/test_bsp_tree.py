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


def painted(tree, o, d):
    """The face that painting back to front from the eye `o` leaves last along each ray, and where it lies."""
    order = tree.order(o)
    a, b, c = (order.triangles[:, k].astype(np.float64) for k in range(3))
    t = sl.geometry.ray_triangle(o, d[:, None], a, b, c).t
    last = t.shape[1] - 1 - np.argmax(np.isfinite(t[:, ::-1]), axis=1)
    met = np.isfinite(t).any(1)
    rows = np.arange(len(d))
    return np.where(met, order.face[last], -1), np.where(met, t[rows, last], np.inf)


def cyclic():
    """Three bars that overlap in a ring: no order of whole triangles is right."""
    bar = np.array([[-1, -0.2, -0.3], [1, -0.2, 0.3], [1, 0.2, 0.3], [-1, 0.2, -0.3]])
    bar += np.array([0, 0.5, 0])
    turns = [sl.transform.rotate_axis([0, 0, 1], 2 * np.pi / 3 * i)[:3, :3] for i in range(3)]
    p = np.concatenate([bar @ t.T for t in turns])
    return p, np.concatenate([[[0, 1, 2], [0, 2, 3]] + 4 * np.array(i) for i in range(3)])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("mesh", ["cyclic", "crossing", "torus"])
def test_painters_see_what_rays_see(mesh, dtype):
    rng = np.random.default_rng(3)
    if mesh == "cyclic":
        p, f = cyclic()
    elif mesh == "crossing":
        p, f = soup(rng, 40, 0.3)
    else:
        torus = sl.mesh.torus()
        p, f = torus.positions, torus.faces[::7]
    p = p.astype(dtype)
    tree = A.BSPTree(p, f, method="polygon_aligned")
    for eye in ([3.0, 2.0, 4.0], [0.1, 0.0, 3.0], p.mean(0)):
        eye = np.array(eye, dtype)
        d = rng.uniform(p.min(0), p.max(0), (300, 3)).astype(dtype) - eye
        face, t = painted(tree, eye, d)
        hit = tree.closest_hit(eye, d)
        same = (face == hit.face) | np.isclose(t, hit.t, rtol=1e-4 if dtype == np.float32 else 1e-9)
        # Fragments are rounded to the tree's precision: cracks along cuts, near silhouettes.
        assert same.mean() > (0.98 if dtype == np.float32 else 0.999), np.flatnonzero(~same)
    if mesh == "cyclic":
        # Sorted by any one depth a face, some face is wrong from some eye; cut, none is.
        assert len(tree.order([0, 0, 9]).face) > len(f)


def test_fragments_make_up_their_faces():
    rng = np.random.default_rng(4)
    p, f = soup(rng, 60, 0.3)
    tree = A.BSPTree(p, f, method="polygon_aligned")
    order = tree.order([0, 0, 0])

    def area_vectors(t):
        return np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0])

    total = np.zeros((60, 3))
    np.add.at(total, order.face, area_vectors(order.triangles))
    # Same area and winding; round-off of some cuts.
    assert np.allclose(total, area_vectors(p[f]), atol=1e-12)
    assert len(order.face) > 60 and tree.stats().references <= 8 * 60 + 4096


@hypothesis.settings(max_examples=25, deadline=None)
@hypothesis.given(
    st.integers(1, 9), st.integers(0, 128), st.integers(0, 99999), st.sampled_from([np.float32, np.float64])
)
def test_polygon_aligned_trees_give_brute_forces_answers(leaf_size, max_depth, seed, dtype):
    rng = np.random.default_rng(seed)
    p, f = soup(rng, 60, 10 ** rng.uniform(-3, 0), dtype)
    p = np.round(p, rng.integers(1, 9)) * dtype(10.0 ** rng.integers(-6, 7))
    tree = A.BSPTree(p, f, method="polygon_aligned", leaf_size=leaf_size, max_depth=max_depth)
    o = rng.uniform(-1, 2, (80, 3)) * np.abs(p).max()
    d = p[rng.integers(len(p), size=80)] - o
    # In the planes of triangles, too.
    o[:20], d[:20] = p[:60:3], p[1:60:3] - p[:60:3]
    assert same_bits(tree.closest_hit(o, d), A.brute_force(p, f, o, d))
    assert same_bits(tree.all_hits(o, d), A.brute_force_all(p, f, o, d))


@pytest.mark.parametrize(
    ("dtype", "scale"), [(np.float32, 1e17), (np.float32, 1e-11), (np.float64, 1e145), (np.float64, 1e-99)]
)
def test_meshes_at_the_ends_of_the_domain(dtype, scale):
    rng = np.random.default_rng(5)
    p, f = soup(rng, 100, 0.2)
    p = (p * scale).astype(dtype)
    o = (rng.uniform(-1, 2, (200, 3)) * scale).astype(dtype)
    d = p[rng.integers(len(p), size=200)] - o
    for method in ("axis_aligned", "polygon_aligned"):
        tree = A.BSPTree(p, f, method=method)
        assert same_bits(tree.closest_hit(o, d), A.brute_force(p, f, o, d))


def test_convex_meshes_do_not_degenerate():
    mesh = sl.mesh.icosphere(4)
    tree = A.BSPTree(mesh.positions, mesh.faces, method="polygon_aligned")
    s = tree.stats()
    # A chain would be as deep as there are faces, 5120.
    assert s.depth < 60 and s.references < 4 * s.faces
