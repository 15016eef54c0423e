"""Winding numbers: exact on closed meshes, within the bound everywhere, solid angles of open meshes."""

import numpy as np
import pytest
import shadelab as sl
import trimesh


def bumpy(subdivisions, dtype=np.float64):
    mesh = trimesh.creation.icosphere(subdivisions)
    p = np.asarray(mesh.vertices) * (1 + 0.2 * np.sin(5 * mesh.vertices).sum(1, keepdims=True))
    return p.astype(dtype), np.asarray(mesh.faces)


def near_the_surface(rng, p, f, n, off):
    w = rng.dirichlet([1, 1, 1], n)
    on = (w[..., None] * p[f[rng.integers(len(f), size=n)]]).sum(1)
    return (on + off * rng.normal(size=(n, 3))).astype(p.dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("off", [1.0, 1e-3, 1e-6])
def test_closed_meshes_have_integers(dtype, off):
    p, f = bumpy(3, dtype)
    q = near_the_surface(np.random.default_rng(1), p, f, 1000, off)
    w = sl.accel.BVH(p, f).winding_number(q, max_error=0)
    # Some 1e3 angles in double, ill-conditioned next to edges; a result in single rounds its sum.
    assert np.abs(w - np.round(w)).max() < 1e-9 and set(np.round(w)) == {0, 1}


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("max_error", [0.3, 1e-2, 1e-3])
def test_the_bound_holds_on_soups(dtype, max_error):
    rng = np.random.default_rng(2)
    p, f = bumpy(4, dtype)
    f = f[rng.permutation(len(f))[: len(f) // 2]]
    flipped = rng.uniform(size=len(f)) < 0.2
    f[flipped] = f[flipped][:, ::-1]
    q = np.concatenate([rng.uniform(-1.5, 1.5, (300, 3)).astype(dtype), near_the_surface(rng, p, f, 300, 1e-3)])
    bvh = sl.accel.BVH(p, f)
    exact, fast = bvh.winding_number(q, max_error=0), bvh.winding_number(q, max_error=max_error)
    error = np.abs(exact.astype(float) - fast).max()
    # Not exact either, or the bound would mean nothing.
    assert 1e-8 < error < max_error


def test_solid_angles_agree_with_closed_forms():
    """A square seen from its axis at a distance z spans 4 asin(1 / (1 + z²)), by its half side."""
    square = sl.mesh.plane((2.0, 2.0))
    bvh = sl.accel.BVH(square.positions, square.faces)
    normal = sl.mesh.face_normals(square.positions, square.faces)[0]
    z = np.array([0.01, 0.3, 1.0, 7.0, 1e3])
    w = bvh.winding_number(-z[:, None] * normal, max_error=0)
    assert np.allclose(4 * np.pi * w, 4 * np.arcsin(1 / (1 + z * z)), rtol=1e-9)
    assert np.allclose(bvh.winding_number(z[:, None] * normal, max_error=0), -w, rtol=1e-12)


def test_on_faces_edges_and_corners_it_is_the_part_of_space_inside():
    box = sl.mesh.box((2, 2, 2))
    bvh = sl.accel.BVH(box.positions, box.faces)
    on = [[1, 0.3, 0.2], [1, 1, 0.1], [1, 1, 1], [1, 0.1, 0.1]]
    assert np.allclose(bvh.winding_number(on, max_error=0), [0.5, 0.25, 0.125, 0.5], atol=1e-14)
    # One rounding off the face decides.
    off = [[np.nextafter(1, 0), 0.3, 0.2], [np.nextafter(1, 2), 0.3, 0.2]]
    assert np.allclose(bvh.winding_number(off, max_error=0), [1, 0], atol=1e-12)


def test_parts_add_up_and_count_their_orientation():
    p, f = bumpy(3)
    twice = sl.accel.BVH(np.concatenate([p, p]), np.concatenate([f, f + len(p)]))
    inside_out = sl.accel.BVH(p, f[:, ::-1])
    q = np.array([[0, 0, 0.1], [3, 0, 0]])
    assert np.allclose(twice.winding_number(q), [2, 0], atol=1e-3)
    assert np.allclose(inside_out.winding_number(q), [-1, 0], atol=1e-3)


@pytest.mark.parametrize("max_error", [0, 1e-3])
def test_levels_and_threads_change_nothing(max_error):
    p, f = bumpy(4, np.float32)
    q = np.random.default_rng(3).uniform(-1.5, 1.5, (600, 3))
    bvh = sl.accel.BVH(p, f)
    results = []
    for threads in (1, 2, 5):
        sl.set_threads(threads)
        for level in sl.simd_levels():
            with sl.simd(level):
                results.append(bvh.winding_number(q, max_error=max_error))
    sl.set_threads(None)
    assert all(np.array_equal(r, results[0]) for r in results)


@pytest.mark.parametrize(("dtype", "scales"), [(np.float32, (1e17, 2e-12)), (np.float64, (1e149, 2e-100))])
@pytest.mark.parametrize("max_error", [0, 1e-3])
def test_scale_does_not_matter(dtype, scales, max_error):
    p, f = bumpy(2, dtype)
    q = np.array([[0.1, 0, 0], [0.9, 0.2, 0.3], [1.5, 0, 0], [30, 0, 0]], dtype)
    expected = sl.accel.BVH(p, f).winding_number(q, max_error=max_error)
    for scale in scales:
        bvh = sl.accel.BVH(p * dtype(scale), f)
        # Scaling rounds the vertices.
        assert np.allclose(bvh.winding_number(q * dtype(scale), max_error=max_error), expected, atol=1e-5)


@pytest.mark.parametrize("max_error", [0, 1e-3])
def test_bad_points_empty_meshes_and_faces_without_area(max_error):
    p, f = bumpy(2)
    q = np.zeros((5, 3))
    q[1, 0], q[3, 2] = np.nan, np.inf
    w = sl.accel.BVH(p, f).winding_number(q, max_error=max_error)
    assert np.isnan(w[[1, 3]]).all() and np.allclose(w[[0, 2, 4]], 1, atol=1e-3)
    assert (sl.accel.BVH(np.zeros((0, 3)), []).winding_number(np.ones((2, 2, 3)), max_error=max_error) == 0).all()
    flat = sl.accel.BVH([[0, 0, 0], [1, 0, 0], [2, 0, 0.0]], [[0, 1, 2], [0, 0, 0]])
    assert (flat.winding_number([[0.5, 0, 0], [0, 0, 0], [0, 1, 0]], max_error=max_error) == 0).all()


def test_a_bound_that_is_none_is_refused():
    bvh = sl.accel.BVH(np.eye(3), [[0, 1, 2]])
    with pytest.raises(ValueError, match="max_error"):
        bvh.winding_number([0, 0, 0], max_error=-1)
    with pytest.raises(ValueError, match="max_error"):
        bvh.winding_number([0, 0, 0], max_error=np.nan)
