"""Angles and projections: against mpmath, down to the smallest angle."""

import mpmath
import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from shadelab.transform import angle_between, project_onto


def exact_angle(a, b):
    with mpmath.workdps(120):
        a, b = ([mpmath.mpf(float(x)) for x in v] for v in (a, b))
        cross = [a[i - 2] * b[i - 1] - a[i - 1] * b[i - 2] for i in range(3)]
        return mpmath.atan2(mpmath.sqrt(sum(c * c for c in cross)), sum(x * y for x, y in zip(a, b, strict=True)))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("sign", [1, -1])
def test_angles_are_exact_down_to_the_smallest(sign, dtype):
    rng = np.random.default_rng(1)
    a = rng.normal(size=(300, 3))
    b = sign * (a + rng.normal(size=(300, 3)) * np.geomspace(1e-15 if dtype is np.float64 else 1e-7, 10, 300)[:, None])
    # Lengths whose exact products neither overflow nor vanish.
    a, b = a.astype(dtype), (b * np.geomspace(1e-10, 1e10, 300)[:, None]).astype(dtype)
    got = angle_between(a, b)
    assert got.dtype == dtype
    for x, y, angle in zip(a, b, got, strict=True):
        exact = exact_angle(x, y)
        assert abs(float(angle) - exact) <= 4 * np.finfo(dtype).eps * exact


def test_the_arc_cosine_would_have_lost_half_of_the_digits():
    a, b = np.array([1.0, 0, 0]), np.array([1.0, 1e-9, 0])
    assert angle_between(a, b) == pytest.approx(1e-9, rel=1e-15)
    assert np.arccos(a @ b / np.linalg.norm(b)) == 0


def test_right_straight_and_zero_angles():
    assert angle_between([2.0, 0, 0], [0, 3.0, 0]) == np.pi / 2
    assert angle_between([2.0, 1.0, 0], [-4.0, -2.0, 0]) == np.pi
    assert angle_between([2.0, 1.0, 3.0], [4.0, 2.0, 6.0]) == 0
    assert angle_between(np.float32([1e-30, 0, 0]), np.float32([0, 0, 1e30])).dtype == np.float32
    bad = angle_between([[0.0, 0, 0], [1, 0, 0], [np.inf, 0, 0], [np.nan, 1, 0]], [1.0, 0, 0])
    assert np.array_equal(np.isnan(bad), [True, False, True, True])


@settings(max_examples=200)
@given(arrays(float, (2, 3), elements=st.floats(-1e3, 1e3).filter(lambda x: x == 0 or abs(x) > 1e-100)))
def test_angles_are_symmetric_and_parts_add_up(vectors):
    v, onto = vectors
    if np.abs(onto).max() < 1e-3:
        return
    if np.abs(v).max() >= 1e-3:
        assert angle_between(v, onto) == angle_between(onto, v)
    parts = project_onto(v, onto, full_output=True)
    eps, length = np.finfo(float).eps, np.linalg.norm(v)
    assert np.abs(parts.parallel + parts.perpendicular - v).max() <= eps * length
    assert abs(parts.perpendicular @ onto) <= 4 * eps * length * np.linalg.norm(onto)
    assert np.abs(np.cross(parts.parallel, onto)).max() <= 4 * eps * length * np.linalg.norm(onto)
    assert abs(parts.length - v @ onto / np.linalg.norm(onto)) <= 4 * eps * length
    assert np.array_equal(project_onto(v, onto), parts.parallel)


@pytest.mark.parametrize("length", [1e-30, 1e30])
def test_the_length_of_what_is_projected_onto_does_not_count(length):
    v, onto = np.float32([3, 4, 5]), np.float32([0, 2, 0]) * np.float32(length)
    assert np.array_equal(project_onto(v, onto), np.float32([0, 4, 0]))
    assert np.isnan(project_onto(v, np.float32([0, 0, 0]))).all()
