"""Three angles in every order, both ways: against SciPy, at gimbal lock and beside it."""

import itertools

import numpy as np
import pytest
from scipy.spatial.transform import Rotation
from shadelab.transform import euler, euler_angles, rotate_x, rotate_y, rotate_z, scale

AXES = [a + b + c for a, b, c in itertools.product("xyz", repeat=3) if a != b != c]
ORDERS = AXES + [a.upper() for a in AXES]
TURN = {"x": rotate_x, "y": rotate_y, "z": rotate_z}


def middle(order, rng, n):
    """Middle angles of the range that `euler_angles` answers in."""
    return rng.uniform(0, np.pi, n) if order[0] == order[2] else rng.uniform(-np.pi / 2, np.pi / 2, n)


def test_there_are_24_orders():
    assert len(set(ORDERS)) == 24


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_both_ways_are_scipys(order, dtype):
    rng = np.random.default_rng(1)
    angles = np.stack([rng.uniform(-3, 3, 300), middle(order, rng, 300), rng.uniform(-3, 3, 300)], -1).astype(dtype)
    m = euler(angles, order)
    eps = np.finfo(dtype).eps
    assert m.dtype == dtype and (m[:, 3] == [0, 0, 0, 1]).all() and (m[:, :3, 3] == 0).all()
    assert np.abs(m[:, :3, :3] - Rotation.from_euler(order, angles.astype(float)).as_matrix()).max() < 3 * eps
    back = euler_angles(m, order)
    assert back.dtype == dtype
    # The outer angles are as uncertain as rounding over the sine between their axes.
    b = angles[:, 1].astype(float)
    apart = np.abs(np.sin(b) if order[0] == order[2] else np.cos(b))
    assert (np.abs(back - angles).max(-1) < 8 * eps / apart).all()
    assert np.array_equal(euler_angles(m[:, :3, :3], order), back)


@pytest.mark.parametrize("order", ORDERS)
def test_an_order_is_the_product_of_its_turns(order):
    a, b, c = (TURN[axis](angle) for axis, angle in zip(order.lower(), (0.3, 1.2, -2.0), strict=True))
    expected = a @ b @ c if order.isupper() else c @ b @ a
    assert np.abs(euler([0.3, 1.2, -2.0], order) - expected).max() < 4e-16


@pytest.mark.parametrize("order", ORDERS)
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_at_gimbal_lock_the_last_angle_is_zero_and_the_rotation_stays(order, dtype):
    rng = np.random.default_rng(2)
    lock = np.array([0, np.pi] if order[0] == order[2] else [-np.pi / 2, np.pi / 2]).repeat(50)
    angles = np.stack([rng.uniform(-3, 3, 100), lock, rng.uniform(-3, 3, 100)], -1).astype(dtype)
    m = euler(angles, order)
    found = euler_angles(m, order, full_output=True)
    assert found.gimbal_lock.all() and (found.angles[:, 2] == 0).all()
    again = euler(found.angles.astype(float), order)
    assert np.abs(again - m).max() < 12 * np.finfo(dtype).eps


@pytest.mark.parametrize("order", ["XYZ", "zyx", "ZXZ", "yxy"])
@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_beside_gimbal_lock_the_angles_still_give_the_rotation(order, dtype):
    rng = np.random.default_rng(3)
    near = np.geomspace(1e-18, 1, 200) * rng.choice([-1, 1], 200)
    b = np.abs(near) if order[0] == order[2] else np.pi / 2 - np.abs(near)
    m = euler(np.stack([rng.uniform(-3, 3, 200), b, rng.uniform(-3, 3, 200)], -1), order).astype(dtype)
    found = euler_angles(m, order, full_output=True)
    assert found.gimbal_lock.any() and not found.gimbal_lock.all()
    assert np.abs(euler(found.angles.astype(float), order) - m).max() < 12 * np.finfo(dtype).eps


def test_what_is_no_rotation_and_no_order_is_an_error():
    for bad in ("XY", "XXY", "XyZ", "abc", ""):
        with pytest.raises(ValueError, match="order"):
            euler([0.0, 0, 0], bad)
    with pytest.raises(TypeError, match="order: expected a string"):
        euler([0.0, 0, 0], 3)
    for matrix in (scale(2.0), scale([-1.0, 1, 1])):
        with pytest.raises(ValueError, match="matrix: expected a rotation"):
            euler_angles(matrix)
    found = euler_angles([np.eye(3), np.diag([1, 1, -1]), np.full((3, 3), np.nan)])
    assert np.array_equal(np.isnan(found).any(-1), [False, True, True])
    with pytest.raises(ValueError, match="matrix: expected shape"):
        euler_angles(np.eye(2))
