"""Translation, scaling, shear, rotation: against SciPy and trimesh, and by composition."""

import numpy as np
import pytest
import trimesh.transformations as tf
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from scipy.spatial.transform import Rotation
from shadelab.transform import (
    cross_matrix,
    rotate_2d,
    rotate_axis,
    rotate_x,
    rotate_y,
    rotate_z,
    scale,
    shear,
    shear_2d,
    translate,
)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_rotations_are_scipys(dtype):
    rng = np.random.default_rng(1)
    axis = rng.normal(size=(300, 3)) * 10.0 ** rng.uniform(-20, 20, (300, 1))
    angle = rng.uniform(-10, 10, 300)
    axis, angle = axis.astype(dtype), angle.astype(dtype)
    got = rotate_axis(axis, angle)
    assert got.dtype == dtype and got.shape == (300, 4, 4)
    unit = axis.astype(float) / np.linalg.norm(axis.astype(float), axis=-1, keepdims=True)
    half = angle.astype(float)[:, None] / 2
    expected = Rotation.from_quat(np.concatenate([unit * np.sin(half), np.cos(half)], -1)).as_matrix()
    # A product of three rounded unit components, a sine within two ulps, and SciPy's own normalisation.
    assert np.abs(got[:, :3, :3] - expected).max() < 6 * np.finfo(dtype).eps
    assert (got[:, 3] == [0, 0, 0, 1]).all() and (got[:, :3, 3] == 0).all()


def test_small_angles_keep_their_cosine():
    m = rotate_axis([0.0, 0.0, 1.0], 1e-8)
    assert m[1, 0] == pytest.approx(1e-8, rel=1e-15) and m[0, 0] == 1.0
    m = rotate_axis([0.0, 0.0, 1.0], 1e-7)
    assert 1 - m[0, 0] == pytest.approx(5e-15, rel=0.02)  # 5e-15 itself is 45 rounding units below one


def test_a_zero_axis_gives_nan_and_touches_no_other():
    m = rotate_axis([[0.0, 0, 0], [0, 0, 1]], 1.0)
    assert np.isnan(m[0]).any() and np.isfinite(m[1]).all()


def test_axes_and_angles_broadcast():
    assert rotate_axis(np.eye(3)[:, None], np.linspace(0, 1, 5)).shape == (3, 5, 4, 4)


def test_scale_and_translate_compose_on_column_vectors():
    p = np.array([1.0, 2.0, 3.0, 1.0])
    assert np.array_equal(translate([1.0, 0, 0]) @ scale([2.0, 3.0, 4.0]) @ p, [3, 6, 12, 1])
    assert np.array_equal(scale([2.0, 3.0, 4.0]) @ translate([1.0, 0, 0]) @ p, [4, 6, 12, 1])
    assert translate(np.zeros((0, 3), np.float32)).shape == (0, 4, 4)
    assert scale(np.float32(2)).dtype == np.float32
    with pytest.raises(ValueError, match=r"offset: expected shape \(\.\.\., 3\)"):
        translate([1.0, 2.0, 3.0, 4.0])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("rotate", [rotate_x, rotate_y, rotate_z])
def test_coordinate_rotations_are_scipys(rotate, dtype):
    angle = np.random.default_rng(2).uniform(-100, 100, 300).astype(dtype)
    got = rotate(angle)
    expected = Rotation.from_euler(rotate.__name__[-1], angle.astype(float)[:, None]).as_matrix()
    assert got.dtype == dtype and got.shape == (300, 4, 4)
    # Sines and cosines within two ulps, which are at most eps.
    assert np.abs(got[:, :3, :3] - expected).max() < 2 * np.finfo(dtype).eps
    assert (got[:, 3] == [0, 0, 0, 1]).all() and (got[:, :3, 3] == 0).all()


@given(arrays(float, (2, 3), elements=st.floats(-1e6, 1e6)))
def test_cross_matrix_takes_cross_products(vectors):
    a, b = vectors
    k = cross_matrix(a)
    # Two products and a difference of at most twice as much, each rounded, here and in NumPy: eight half units.
    assert np.abs(k @ b - np.cross(a, b)).max() <= 8 * 2.0**-53 * np.abs(np.outer(a, b)).max()
    assert np.array_equal(k, -k.T)


def test_rodrigues_formula_is_the_rotation_about_the_axis():
    k, angle = cross_matrix([0.6, 0.0, 0.8]), 0.7
    formula = np.eye(3) + np.sin(angle) * k + (1 - np.cos(angle)) * k @ k
    assert np.abs(formula - rotate_axis([0.6, 0.0, 0.8], angle)[:3, :3]).max() < 1e-15


def test_shear_is_trimeshs():
    # A shear by an angle along x on the planes y = const adds tan(angle) y to x.
    expected = tf.shear_matrix(0.4, [1, 0, 0], [0, 0, 0], [0, 1, 0])
    assert np.allclose(shear(xy=np.tan(0.4)), expected, rtol=0, atol=1e-15)
    m = shear(1.0, 2.0, 3.0, 4.0, 5.0, 6.0)
    assert np.array_equal(m[:3, :3], [[1, 1, 2], [3, 1, 4], [5, 6, 1]])
    assert shear(np.float32(1) + np.zeros((5, 1), np.float32), zy=np.zeros(4, np.float32)).dtype == np.float32
    assert shear(np.zeros((5, 1)), zy=np.zeros(4)).shape == (5, 4, 4, 4)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_the_plane_is_space_at_z_zero(dtype):
    angle, offset, factors = dtype(0.7), np.array([2, 3], dtype), np.array([4, 5], dtype)
    keep = np.ix_([0, 1, 3], [0, 1, 3])
    for plane, space in (
        (translate(offset), translate(np.append(offset, dtype(0)))),
        (scale(factors), scale(np.append(factors, dtype(1)))),
        (rotate_2d(angle), rotate_z(angle)),
        (shear_2d(angle, yx=offset[0]), shear(xy=angle, yx=offset[0])),
    ):
        assert plane.dtype == dtype and np.array_equal(plane, space[keep])
