"""Solid angles: known ones, sums of parts, tiny and far shapes, extremes."""

import mpmath
import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

solid_angle = sl.light.solid_angle
FLOATS = [np.float32, np.float64]
coordinate = st.floats(-5, 5).map(lambda x: round(x, 3))
vector = st.tuples(coordinate, coordinate, coordinate)


@pytest.mark.parametrize("dtype", FLOATS)
def test_known_ones(dtype):
    o = np.zeros(3, dtype)
    tolerance = float(4 * np.finfo(dtype).eps)
    assert solid_angle("triangle", o, [1, 0, 0], [0, 1, 0], [0, 0, 1]).dtype == dtype
    for got, expected in (
        (solid_angle("triangle", o, [1, 0, 0], [0, 1, 0], [0, 0, 1]), np.pi / 2),
        (solid_angle("rectangle", o, [0, 0, 1], [2, 0, 0], [0, 2, 0]), 4 * np.pi / 6),
        (solid_angle("sphere", o, [0, 2, 0], 1.0), 2 * np.pi * (1 - np.sqrt(0.75))),
        (solid_angle("sphere", o, [0, 0.5, 0], 1.0), 4 * np.pi),
        (solid_angle("box", o, [-1, -1, -1], [1, 1, 1]), 4 * np.pi),
        (solid_angle("box", o, [1, -1, -1], [3, 1, 1]), 4 * np.pi / 6),
        (solid_angle("box", o, [0, 0, 0], [1, 1, 1]), 4 * np.pi / 8),
        (solid_angle("polygon", o, [[-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]), 4 * np.pi / 6),
    ):
        # Seen from a box's own corner its three far faces are not seen; the limit from without is none.
        assert got == pytest.approx(expected, rel=tolerance, abs=1e-12)


@settings(max_examples=60, deadline=None)
@given(vector, vector, vector)
def test_a_box_is_the_sum_of_what_is_seen_of_its_faces(p, a, b):
    low, high = np.minimum(a, b), np.maximum(a, b) + 0.01
    p = np.asarray(p) + 0.0037
    total, c, s = 0.0, (low + high) / 2, high - low
    if ((p > low) & (p < high)).all():
        assert solid_angle("box", p, low, high) == pytest.approx(4 * np.pi)
        return
    for axis in range(3):
        u, v = np.roll([s[0], 0, 0], 0), 0
        others = [k for k in range(3) if k != axis]
        u, v = (np.eye(3)[k] * s[k] for k in others)
        for sign in (-1, 1):
            face = c.copy()
            face[axis] += sign * s[axis] / 2
            if sign * (p[axis] - face[axis]) > 0:
                total += solid_angle("rectangle", p, face, u, v)
    assert solid_angle("box", p, low, high) == pytest.approx(total, rel=1e-9, abs=1e-13)


def test_far_and_small_triangles_keep_their_digits():
    """Against forty digits, with corners that single precision holds exactly."""
    for scale in (1.0, 2.0**-10, 2.0**-20):
        a, b, c = ([3.0, 4.0, 5.0], [3.0 + scale, 4.0, 5.0], [3.0, 4.0 + scale, 5.0])
        with mpmath.workdps(40):
            v = [[mpmath.mpf(x) for x in p] for p in (a, b, c)]
            dot = lambda p, q: sum(x * y for x, y in zip(p, q, strict=True))  # noqa: E731
            la, lb, lc = (mpmath.sqrt(dot(p, p)) for p in v)
            det = mpmath.det(mpmath.matrix(v))
            bottom = la * lb * lc + dot(v[0], v[1]) * lc + dot(v[1], v[2]) * la + dot(v[2], v[0]) * lb
            exact = float(2 * mpmath.atan2(det, bottom))
        assert solid_angle("triangle", [0.0, 0, 0], a, b, c) == pytest.approx(exact, rel=1e-14)
        far = solid_angle("sphere", [0.0, 0, 0], [0, 1 / scale, 0], 1.0)
        assert far == pytest.approx(float(2 * mpmath.pi * (1 - mpmath.sqrt(1 - mpmath.mpf(scale) ** 2))), rel=1e-9)


def test_concave_polygons_and_their_planes():
    notch = [[0, 2, 0], [2, 2, 0], [2, 2, 2], [1, 2, 0.5], [0, 2, 2]]
    parts = [[notch[0], notch[1], notch[3]], [notch[1], notch[2], notch[3]], [notch[4], notch[0], notch[3]]]
    p = np.random.default_rng(1).uniform(-3, 5, (50, 3))
    total = sum(solid_angle("triangle", p, *t) for t in parts)
    assert np.allclose(solid_angle("polygon", p, notch), total, rtol=1e-12, atol=1e-14)
    triangle = ([0, 0, 0], [1, 0, 0], [0, 0, 1])
    assert solid_angle("triangle", [0.25, 0, 0.25], *triangle) == pytest.approx(2 * np.pi)
    assert solid_angle("triangle", [2.0, 0, 2.0], *triangle) == 0


def test_bad_elements_and_arguments():
    got = solid_angle("sphere", [[np.nan, 0, 0], [0.0, 0, 0]], [0, 2, 0], [1.0, -1.0])
    assert np.isnan(got).all()
    assert np.isnan(solid_angle("box", [0.0, 0, 0], [1, 1, 1], [0, 2, 2]))
    assert np.isnan(solid_angle("box", [np.nan, 0, 0], [1, 1, 1], [2, 2, 2]))
    assert np.isnan(solid_angle("triangle", [np.nan, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]))
    with pytest.raises(ValueError, match="shape: expected one of"):
        solid_angle("cone", [0.0, 0, 0])
    with pytest.raises(ValueError, match="parameters: expected center, radius of a sphere, got 1 arrays"):
        solid_angle("sphere", [0.0, 0, 0], [0, 0, 1])


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_on_a_shape_what_lies_before_it_is_half_of_everything(dtype):
    def of(kind, points, *shape):
        return solid_angle(kind, np.array(points, dtype), *shape) / np.pi

    # Within, on the diagonal of its triangles, beside, and before its edge's line.
    places = [[0, 0, 0], [0.2, 0.2, 0], [0.2, -0.3, 0], [0.6, 0, 0], [3, 0.5, 0]]
    assert np.array_equal(of("rectangle", places, [0, 0, 0], [1, 0, 0], [0, 1, 0]), [2, 2, 2, 0, 0])
    corner = np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0.0]])
    for k in range(6):
        found = of("polygon", [[0.5, 0.5, 0], [0.5, 1.5, 0], [1.5, 1.5, 0], [-1, 1, 0]], np.roll(corner, k, 0))
        assert np.array_equal(found, [2, 2, 0, 0])
    on = of("box", [[0, 0.1, 0.2], [0, 1, 0.2], [0, 1, 1], [0.5, 0.1, 0.2]], [0, -1, -1], [2, 1, 1])
    assert np.array_equal(on, [2, 1, 0.5, 4])
