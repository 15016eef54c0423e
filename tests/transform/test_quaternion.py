"""Quaternions: against SciPy and mpmath, at angles of 0 and pi, between equal and opposite ones."""

import mpmath
import numpy as np
import pytest
from scipy.spatial.transform import Rotation, Slerp
from shadelab.transform import (
    quaternion_conjugate,
    quaternion_from_axis,
    quaternion_from_matrix,
    quaternion_inverse,
    quaternion_multiply,
    quaternion_rotate,
    quaternion_slerp,
    quaternion_to_matrix,
    rotate_axis,
    scale,
)

BOTH = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def units(seed, n, dtype=np.float64):
    q = np.random.default_rng(seed).normal(size=(n, 4))
    return (q / np.linalg.norm(q, axis=-1, keepdims=True)).astype(dtype)


@BOTH
def test_products_are_scipys(dtype):
    a, b = units(1, 500, dtype), units(2, 500, dtype)
    got = quaternion_multiply(a, b)
    assert got.dtype == dtype
    # SciPy multiplies as it is, up to normalisation and sign.
    expected = (Rotation.from_quat(a.astype(float)) * Rotation.from_quat(b.astype(float))).as_quat()
    expected *= np.sign((expected * got).sum(-1, keepdims=True))
    assert np.abs(got - expected).max() < 4 * np.finfo(dtype).eps


def test_hamiltons_rules():
    i, j, k, one = np.eye(4)
    for a, b, c in ((i, j, k), (j, k, i), (k, i, j)):
        assert np.array_equal(quaternion_multiply(a, b), c) and np.array_equal(quaternion_multiply(b, a), -c)
        assert np.array_equal(quaternion_multiply(a, a), -one)


@BOTH
def test_axis_angle_and_matrices_are_scipys(dtype):
    rng = np.random.default_rng(3)
    axis = rng.normal(size=(400, 3)).astype(dtype)
    angle = np.concatenate([[0, 1e-8, np.pi, -np.pi, 2 * np.pi], rng.uniform(-6, 6, 395)]).astype(dtype)
    q = quaternion_from_axis(axis, angle)
    unit = axis.astype(float) / np.linalg.norm(axis.astype(float), axis=-1, keepdims=True)
    half = angle.astype(float)[:, None] / 2
    eps = np.finfo(dtype).eps
    assert np.abs(q - np.concatenate([unit * np.sin(half), np.cos(half)], -1)).max() < 2 * eps
    m = quaternion_to_matrix(q)
    assert m.dtype == dtype and m.shape == (400, 4, 4)
    assert np.abs(m[:, :3, :3] - Rotation.from_quat(q.astype(float)).as_matrix()).max() < 6 * eps
    assert np.abs(m - rotate_axis(axis, angle)).max() < 8 * eps


@BOTH
def test_from_matrix_undoes_to_matrix_at_every_angle(dtype):
    rng = np.random.default_rng(4)
    angle = np.concatenate([np.geomspace(1e-20, 3, 300), np.pi - np.geomspace(1e-16, 1, 300), [0, np.pi]])
    q = quaternion_from_axis(rng.normal(size=(602, 3)), angle)
    q[np.arange(0, 600, 7), 0] = 0  # Axes in the coordinate planes too.
    q /= np.linalg.norm(q, axis=-1, keepdims=True)
    m = Rotation.from_quat(q).as_matrix().astype(dtype)
    got = quaternion_from_matrix(m)
    assert got.dtype == dtype and (got[:, 3] >= 0).all()
    same = np.sign((got.astype(float) * q).sum(-1, keepdims=True))
    # The matrix's own rounding, too.
    assert np.abs(got * same - q).max() < 4 * np.finfo(dtype).eps
    assert np.array_equal(quaternion_from_matrix(np.eye(4, dtype=dtype)), [0, 0, 0, 1])
    for i in range(3):
        half = -np.eye(3, dtype=dtype)
        half[i, i] = 1
        assert np.array_equal(quaternion_from_matrix(half), np.eye(4)[i])


def test_what_is_no_rotation_has_no_quaternion():
    with pytest.raises(ValueError, match="matrix: expected a rotation"):
        quaternion_from_matrix(scale(1.1))
    with pytest.raises(ValueError, match="matrix: expected a rotation"):
        quaternion_from_matrix(-np.eye(3))
    assert np.array_equal(np.isnan(quaternion_from_matrix([np.eye(3), -np.eye(3)])).any(-1), [False, True])


@BOTH
@pytest.mark.parametrize("length", [1e-30, 1.0, 1e30])
def test_inverse_undoes_at_every_length(length, dtype):
    q = (units(5, 300) * length).astype(dtype)
    eps = np.finfo(dtype).eps
    inverse = quaternion_inverse(q)
    one = quaternion_multiply(q.astype(float), inverse.astype(float))
    assert np.abs(one - [0, 0, 0, 1]).max() < 4 * eps
    assert np.array_equal(quaternion_conjugate(q), q * np.array([-1, -1, -1, 1], dtype))
    v = np.random.default_rng(6).normal(size=(300, 3)).astype(dtype)
    expected = Rotation.from_quat(q.astype(float) / length).apply(v.astype(float))
    turned = quaternion_rotate(q, v)
    assert turned.dtype == dtype
    assert (np.abs(turned - expected).max(-1) < 4 * eps * np.linalg.norm(v, axis=-1)).all()
    assert np.abs(quaternion_rotate(quaternion_inverse(q), turned) - v).max() < 40 * eps


def exact_slerp(a, b, t):
    """In 60 digits; the arc from `a` to `b` itself."""
    with mpmath.workdps(60):
        a, b = ([mpmath.mpf(float(x)) for x in q] for q in (a, b))
        t = mpmath.mpf(float(t))
        minus = mpmath.sqrt(sum((x - y) ** 2 for x, y in zip(a, b, strict=True)))
        plus = mpmath.sqrt(sum((x + y) ** 2 for x, y in zip(a, b, strict=True)))
        angle = 2 * mpmath.atan2(minus, plus)
        wa, wb = (1 - t, t) if angle == 0 else (mpmath.sin((1 - t) * angle), mpmath.sin(t * angle))
        over = mpmath.mpf(1) if angle == 0 else mpmath.sin(angle)
        return [float((wa * x + wb * y) / over) for x, y in zip(a, b, strict=True)]


@BOTH
@pytest.mark.parametrize("gap", [0, 1e-30, 1e-12, 1e-8, 1e-6, 1e-4, 1e-2, 1.0])
def test_slerp_is_exact_between_near_and_far_rotations(gap, dtype):
    rng = np.random.default_rng(7)
    a, t = units(8, 40), rng.random(40).astype(dtype)
    b = a + gap * rng.normal(size=(40, 4))
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    a, b = a.astype(dtype), b.astype(dtype)
    got = quaternion_slerp(a, b, t)
    toward = np.where((a.astype(float) * b).sum(-1, keepdims=True) < 0, -1.0, 1.0) * b
    expected = np.array([exact_slerp(*x) for x in zip(a, toward, t, strict=True)])
    assert got.dtype == dtype and np.abs(got - expected).max() < 4 * np.finfo(dtype).eps


def test_slerp_is_scipys_and_has_its_ends():
    a, b = units(9, 1)[0], units(10, 1)[0]
    t = np.linspace(0, 1, 33)
    expected = Slerp([0, 1], Rotation.from_quat([a, b]))(t)
    got = Rotation.from_quat(quaternion_slerp(a, b, t))
    assert (got.inv() * expected).magnitude().max() < 1e-14
    ends = quaternion_slerp(a, b, [0.0, 1.0])
    assert np.array_equal(ends[0], a) and np.array_equal(ends[1], b * np.sign(a @ b))


@BOTH
@pytest.mark.parametrize("gap", [0, 1e-30, 1e-17, 1e-7, 1e-3, 0.5])
def test_the_long_way_to_opposite_quaternions_stays_on_the_sphere(gap, dtype):
    rng = np.random.default_rng(11)
    a = units(12, 100)
    b = -a + gap * rng.normal(size=(100, 4))
    b /= np.linalg.norm(b, axis=-1, keepdims=True)
    t = rng.random(100)
    eps = np.finfo(dtype).eps
    got = quaternion_slerp(a.astype(dtype), b.astype(dtype), t.astype(dtype), shortest=False).astype(float)
    assert np.abs(np.linalg.norm(got, axis=-1) - 1).max() < 8 * eps
    # As far along as t says: the angle from a grows evenly.
    angle = 2 * np.arctan2(np.linalg.norm(a - b, axis=-1), np.linalg.norm(a + b, axis=-1))
    gone = 2 * np.arctan2(np.linalg.norm(got - a, axis=-1), np.linalg.norm(got + a, axis=-1))
    assert np.abs(gone - t * angle).max() < 16 * eps
    ends = quaternion_slerp(a, b, np.array([[0.0], [1.0]]), shortest=False)
    assert np.abs(ends - [a, b]).max() < 8e-16
    # The short way goes nowhere.
    short = quaternion_slerp(a, b, t)
    assert gap or np.abs(short - a).max() < 3e-16


def test_zero_gives_nan_and_touches_no_other():
    q = np.array([[0.0, 0, 0, 0], [0, 0, 0, 1], [np.nan, 0, 0, 1]])
    bad = [True, False, True]
    assert np.array_equal(np.isnan(quaternion_to_matrix(q)).any((1, 2)), bad)
    assert np.array_equal(np.isnan(quaternion_rotate(q, [1.0, 2, 3])).any(-1), bad)
    assert np.array_equal(np.isnan(quaternion_inverse(q)).any(-1), bad)
    assert np.array_equal(np.isnan(quaternion_from_axis(q[:, 1:] * [1, 1, 1], [1.0, 1, np.nan])).any(-1), bad)
    assert np.array_equal(np.isnan(quaternion_slerp(q, q[1], 0.5)).any(-1), bad)


def test_batches_broadcast():
    a, v = units(13, 5)[:, None], np.ones((4, 3))
    assert quaternion_rotate(a, v).shape == (5, 4, 3)
    assert quaternion_slerp(a, units(14, 4), 0.5).shape == (5, 4, 4)
    assert quaternion_multiply(np.zeros((0, 4)), units(15, 1)).shape == (0, 4)


def test_slerp_of_zero_is_nan():
    b, zero = np.array([0.5, -0.5, 0.5, 0.5]), np.zeros(4)
    for x, y in ((zero, b), (b, zero), (zero, zero)):
        for shortest in (True, False):
            assert np.isnan(quaternion_slerp(x, y, [0.0, 0.3, 1.0], shortest=shortest)).all()
