"""Points, vectors, pixels: against NumPy's matrix product, and there and back."""

import numpy as np
import pytest
from shadelab.transform import (
    look_at,
    perspective,
    project,
    transform_points,
    transform_vectors,
    translate,
    unproject,
    viewport,
)


def camera(depth="standard", far=50.0):
    return perspective(1.0, 4 / 3, 0.5, far, depth=depth) @ look_at([1.0, 2.0, 6.0], [0.2, 0.1, 0.0])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(), (0,), (7,), (50_000,), (3, 5)])
def test_one_matrix_for_all_is_the_matrix_product(shape, dtype):
    p = np.random.default_rng(1).normal(size=(*shape, 3)).astype(dtype)
    m = camera()
    exact = np.concatenate([p, np.ones((*shape, 1))], -1).astype(float) @ m.astype(dtype).astype(float).T
    bound = 8 * np.finfo(dtype).eps * 10  # terms are below 10
    got = transform_points(p, m, homogeneous=True)
    assert got.dtype == dtype and got.shape == (*shape, 4)
    assert np.abs(got - exact).max(initial=0) < bound
    with np.errstate(invalid="ignore"):
        assert np.abs(transform_points(p, m) - exact[..., :3] / exact[..., 3:]).max(initial=0) < 4 * bound
    assert np.abs(transform_vectors(p, m) - p.astype(float) @ m[:3, :3].T).max(initial=0) < bound


def test_each_its_own_matrix_and_broadcasting():
    rng = np.random.default_rng(2)
    p, offsets = rng.normal(size=(20, 3)), rng.normal(size=(6, 1, 3))
    assert np.allclose(transform_points(p, translate(offsets)), p + offsets, atol=1e-15)
    assert np.allclose(transform_vectors(p, translate(offsets)), np.broadcast_to(p, (6, 20, 3)))


def test_out_is_written_and_non_contiguous_input_works():
    p = np.random.default_rng(3).normal(size=(100, 6)).astype(np.float32)[::-2, ::2]
    out = np.empty(p.shape, np.float32)
    assert transform_points(p, camera(), out=out) is out
    assert np.array_equal(out, transform_points(p.copy(), camera()))
    with pytest.raises(ValueError, match="out: expected shape"):
        transform_points(p, camera(), out=np.empty((3, 3), np.float32))


@pytest.mark.parametrize("depth", ["standard", "zero_to_one", "reversed"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_unproject_undoes_project(depth, dtype):
    p = np.random.default_rng(4).uniform(-1, 1, (500, 3)).astype(dtype)
    m = camera(depth)
    back = unproject(project(p, m, (640, 480)), m, (640, 480))
    # Depth at distances up to 9 in front of a near plane of 0.5.
    assert back.dtype == dtype and np.abs(back - p).max() < 9**2 / 0.5 * 4 * np.finfo(dtype).eps


def test_project_is_matrix_division_and_viewport():
    p = np.random.default_rng(5).uniform(-1, 1, (50, 3))
    clip = transform_points(p, camera(), homogeneous=True)
    expected = (clip / clip[:, 3:]) @ viewport((640, 480)).T
    assert np.allclose(project(p, camera(), (640, 480)), expected[:, :3], atol=1e-10)


def test_what_lies_behind_the_eye_has_no_pixel():
    got = project([[0.0, 0, -1], [0, 0, 1], [0, 0, 0], [np.nan, 0, -1]], perspective(1.0), (64, 64))
    assert np.array_equal(np.isnan(got).any(-1), [False, True, True, True])


def test_a_singular_matrix_has_no_way_back():
    with pytest.raises(ValueError, match="matrix: expected an invertible matrix"):
        unproject([0.0, 0.0, 0.0], np.zeros((4, 4)), (64, 64))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shape", [(), (0,), (50_000,), (3, 5)])
def test_points_of_the_plane_go_through_matrices_of_the_plane(shape, dtype):
    rng = np.random.default_rng(6)
    p, m = rng.normal(size=(*shape, 2)).astype(dtype), rng.normal(size=(3, 3))
    m[2] = [0.1, -0.2, 3.0]
    exact = np.concatenate([p, np.ones((*shape, 1))], -1).astype(float) @ m.astype(dtype).astype(float).T
    bound = 16 * np.finfo(dtype).eps * 4  # terms are below 4
    got = transform_points(p, m, homogeneous=True)
    assert got.dtype == dtype and got.shape == (*shape, 3) and np.abs(got - exact).max(initial=0) < bound
    flat = transform_points(p, m)
    assert flat.shape == p.shape
    assert np.abs(flat * exact[..., 2:] - exact[..., :2]).max(initial=0) < bound
    assert np.abs(transform_vectors(p, m) - p.astype(float) @ m[:2, :2].T).max(initial=0) < bound


def test_each_point_of_the_plane_has_its_own_matrix():
    p, offsets = np.random.default_rng(7).normal(size=(20, 2)), np.arange(12.0).reshape(6, 1, 2)
    assert np.allclose(transform_points(p, translate(offsets)), p + offsets, atol=1e-15)
    with pytest.raises(ValueError, match=r"matrix: expected shape \(\.\.\., 3, 3\)"):
        transform_points(p, np.eye(4))
    with pytest.raises(ValueError, match=r"points: expected shape \(\.\.\., 3\)"):
        transform_points(np.ones((5, 4)), np.eye(4))
