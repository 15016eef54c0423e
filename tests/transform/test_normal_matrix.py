"""Normals stay perpendicular to what they were perpendicular to, and outside stays outside."""

import numpy as np
import pytest
from shadelab.transform import normal_matrix, scale, transform_normals, transform_vectors


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_normals_stay_perpendicular_and_outside(dtype):
    rng = np.random.default_rng(1)
    m = np.eye(4) + np.zeros((300, 4, 4))
    m[:, :3, :3] = rng.normal(size=(300, 3, 3))
    a, b = rng.normal(size=(2, 300, 3))
    n = np.cross(a, b)
    n /= np.linalg.norm(n, axis=-1, keepdims=True)
    got = transform_normals(n.astype(dtype), m.astype(dtype))
    assert got.dtype == dtype
    assert np.abs(np.linalg.norm(got, axis=-1) - 1).max() < 4 * np.finfo(dtype).eps
    inverse_transpose = np.linalg.inv(m[:, :3, :3].astype(dtype).astype(float)).swapaxes(-1, -2)
    expected = np.einsum("nij,nj->ni", inverse_transpose, n)
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    # Cofactors cancel where the matrix is near singular.
    condition = np.linalg.cond(m[:, :3, :3])
    assert (np.abs(got - expected).max(-1) < 8 * np.finfo(dtype).eps * condition**2).all()
    for v in (a, b):
        moved = transform_vectors(v, m)
        cosine = (moved * got).sum(-1) / np.linalg.norm(moved, axis=-1)
        assert (np.abs(cosine) < 8 * np.finfo(dtype).eps * condition**2).all()


def test_it_is_the_inverse_transpose_up_to_a_positive_factor_even_when_mirrored():
    m = np.diag([-2.0, 3.0, 4.0, 1.0])
    got = normal_matrix(m)
    ratio = np.diag(got) / np.diag(np.linalg.inv(m[:3, :3]).T)
    assert (ratio > 0).all() and np.allclose(ratio, ratio[0])


def test_a_flattened_scene_keeps_its_normals():
    flat = scale([1.0, 0.0, 1.0])
    assert np.array_equal(transform_normals([0.6, 0.8, 0.0], flat), [0, 1, 0])
    assert np.isnan(transform_normals([1.0, 0.0, 0.0], flat)).all()


@pytest.mark.parametrize("factor", [1e-30, 1e30])
def test_uniform_scale_of_any_size_changes_nothing_in_single_precision(factor):
    m = np.diag([factor] * 3 + [1]).astype(np.float32)
    n = np.array([[0.6, 0.0, 0.8]], np.float32)
    assert np.abs(transform_normals(n, m) - n).max() <= np.finfo(np.float32).eps
