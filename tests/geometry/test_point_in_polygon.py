"""Points in polygons: exact counts by rationals, both rules, borders, repeated and collinear vertices."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
from hypothesis import given, settings
from hypothesis import strategies as st

from .rational import vector


def exact(p, polygon):
    """On the border, winding number, crossings: by rationals, and another way of counting than the kernel's."""
    x, y = vector(p)
    corners = [vector(q) for q in polygon]
    winding = crossings = 0
    for (ax, ay), (bx, by) in zip(corners, corners[1:] + corners[:1], strict=True):
        turn = (bx - ax) * (y - ay) - (by - ay) * (x - ax)
        if turn == 0 and min(ax, bx) <= x <= max(ax, bx) and min(ay, by) <= y <= max(ay, by):
            return True, 0, 0
        # Where the edge meets the ray to the right, its lower end belonging to it.
        if min(ay, by) <= y < max(ay, by):
            at = ax + (bx - ax) * (y - ay) / (by - ay)
            if at > x:
                crossings += 1
                winding += 1 if by > ay else -1
    return False, winding, crossings


def check(points, polygon):
    place = sl.geometry.point_in_polygon(points, polygon, full_output=True)
    turned = sl.geometry.point_in_polygon(points, polygon, rule="winding", border=False)
    for i, p in enumerate(points):
        border, winding, crossings = exact(p, polygon)
        assert place.on_border[i] == border and place.winding[i] == winding
        # Half-open above or below: the number of crossings may differ, by pairs.
        assert (place.crossings[i] - crossings) % 2 == 0
        assert place.inside[i] == (border or crossings % 2 == 1)
        assert turned[i] == (winding != 0)


corner = st.tuples(st.integers(-3, 3), st.integers(-3, 3))


@settings(max_examples=150, deadline=None)
@given(polygon=st.lists(corner, min_size=1, max_size=9), divisor=st.sampled_from([1, 3, 10]))
def test_counts_on_a_grid_are_exact(polygon, divisor):
    x, y = np.meshgrid(np.arange(-4, 5), np.arange(-4, 5))
    grid = np.stack([x, y], -1).reshape(-1, 2)
    for dtype in (np.float32, np.float64):
        check(grid.astype(dtype) / dtype(divisor), np.array(polygon, dtype) / dtype(divisor))


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0, 1e6])
def test_points_within_a_rounding_of_edges(dtype, shift):
    rng = np.random.default_rng(1)
    polygon = (rng.normal(size=(7, 2)) + shift).astype(dtype)
    a, b = polygon, np.roll(polygon, -1, 0)
    s = rng.uniform(0, 1, (40, 7, 1))
    near = ((1 - s) * a.astype(float) + s * b).astype(dtype).reshape(-1, 2)
    check(np.concatenate([near, np.nextafter(near, near + 1), polygon]), polygon)


def test_border_repeated_collinear_and_vanishing_polygons():
    bent = [[0, 0], [1, 0], [1, 0], [2, 0], [2, 2], [2, 2], [0, 2], [0, 1]]
    points = [[1, 0], [2, 2], [0, 1.5], [1, 1], [3, 0], [-1, 0]]
    assert sl.geometry.point_in_polygon(points, bent).tolist() == [True] * 4 + [False] * 2
    assert sl.geometry.point_in_polygon(points, bent, border=False).tolist() == [False] * 3 + [True] + [False] * 2
    segment = sl.geometry.point_in_polygon([[1, 1], [3, 3], [1, 0]], [[0, 0], [2, 2]], full_output=True)
    assert segment.on_border.tolist() == [True, False, False] and not segment.winding.any()
    assert sl.geometry.point_in_polygon([[1, 1], [0, 0]], [[1, 1]]).tolist() == [True, False]


def test_rules_differ_where_the_border_turns_twice():
    angle = 4 * np.pi * np.arange(5) / 5
    star = np.stack([np.cos(angle), np.sin(angle)], -1)
    place = sl.geometry.point_in_polygon([0, 0], star, full_output=True)
    assert not place.inside and place.winding == 2
    assert sl.geometry.point_in_polygon([0, 0], star, rule="winding")
    assert sl.geometry.point_in_polygon([0, 0], star[::-1], full_output=True).winding == -2


def test_area_by_counting_points():
    rng = np.random.default_rng(2)
    angle = np.sort(rng.uniform(0, 2 * np.pi, 30))
    polygon = rng.uniform(0.3, 1, (30, 1)) * np.stack([np.cos(angle), np.sin(angle)], -1)
    share = sl.geometry.point_in_polygon(rng.uniform(-1, 1, (40000, 2)), polygon).mean()
    # Five standard deviations of the count.
    assert abs(4 * share - sl.geometry.signed_area(polygon)) < 5 * 4 * 0.5 / 200


def test_polygons_broadcast_with_points():
    rng = np.random.default_rng(3)
    points, polygons = rng.normal(size=(6, 1, 2)), rng.normal(size=(4, 5, 2))
    every = sl.geometry.point_in_polygon(points, polygons)
    assert every.shape == (6, 4)
    for j in range(4):
        assert np.array_equal(every[:, j], sl.geometry.point_in_polygon(points[:, 0], polygons[j]))


def test_nan_and_bad_arguments():
    square = np.array([[0, 0], [2, 0], [2, 2], [0, 2.0]])
    assert sl.geometry.point_in_polygon([[np.nan, 1], [1, 1], [np.inf, 1]], square).tolist() == [False, True, False]
    broken = np.stack([square, np.where(square == 2, np.nan, square)])
    assert sl.geometry.point_in_polygon([1, 1], broken).tolist() == [True, False]
    with pytest.raises(ValueError, match=r"polygon: expected shape \(\.\.\., n, 2\)"):
        sl.geometry.point_in_polygon([1, 1], np.zeros((0, 2)))
    with pytest.raises(ValueError, match="rule: expected one of"):
        sl.geometry.point_in_polygon([1, 1], square, rule="odd")


def test_exact_means_more_than_doubles_could_tell():
    # The point is off the edge by 2**-60 of it, which a rounded determinant does not see.
    polygon = [[0.0, 0.0], [3.0, 1.0], [0.0, 3.0]]
    y = float(np.nextafter(1 / 3, 0))
    assert Fraction(y) < Fraction(1, 3)
    assert not sl.geometry.point_in_polygon([1.0, y], polygon)
    assert sl.geometry.point_in_polygon([1.0, float(np.nextafter(1 / 3, 1))], polygon, border=False)
