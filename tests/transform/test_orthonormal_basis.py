"""Frames about normals: orthonormal and right-handed everywhere, at the poles too."""

import numpy as np
import pytest
from shadelab.transform import orthonormal_basis


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_frames_are_orthonormal_right_handed_and_about_the_normal(dtype):
    rng = np.random.default_rng(1)
    n = rng.normal(size=(20_000, 3))
    # Around both poles and the equator, where the formula's sign changes.
    n[:6000, :2] *= np.geomspace(1e-30, 1, 6000)[:, None]
    n[6000:12_000, 2] *= np.geomspace(1e-30, 1, 6000)
    n = n.astype(dtype)
    n[-6:] = [[0, 0, 1], [0, 0, -1], [1, 0, 0.0], [1, 0, -0.0], [0, 1, 0.0], [0, -1, -0.0]]
    basis = orthonormal_basis(n)
    assert basis.dtype == dtype
    b = basis.astype(float)
    eps = np.finfo(dtype).eps
    assert np.abs(b.swapaxes(-1, -2) @ b - np.eye(3)).max() < 4 * eps
    assert (np.linalg.det(b) > 0.999).all()
    unit = n.astype(float) / np.linalg.norm(n.astype(float), axis=-1, keepdims=True)
    assert np.abs(b[..., 2] - unit).max() < 2 * eps


def test_exact_at_the_poles():
    assert np.array_equal(orthonormal_basis([0.0, 0, 1]), np.eye(3))
    assert np.array_equal(orthonormal_basis([0.0, 0, -1]), np.diag([1, -1, -1]))
    assert np.array_equal(orthonormal_basis([0.0, 0, -1e-30]), np.diag([1, -1, -1]))


def test_no_normal_no_frame():
    got = orthonormal_basis([[0.0, 0, 0], [0, 0, 1], [np.nan, 0, 1]])
    assert np.array_equal(np.isnan(got).any((1, 2)), [True, False, True])
