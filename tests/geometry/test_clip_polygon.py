"""Polygons in convex windows: areas and corners that rational clipping leaves."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial import ConvexHull
from shadelab import geometry


def area(p):
    x, y = p[..., 0], p[..., 1]
    return (x * np.roll(y, -1, -1) - np.roll(x, -1, -1) * y).sum(-1) / 2


def points(clipped, i=()):
    return clipped.points[i][: int(clipped.counts[i])]


def rational_clip(polygon, window):
    """Sutherland and Hodgman in rationals, for windows that turn counter-clockwise."""
    polygon = [tuple(Fraction(float(x)) for x in p) for p in polygon]
    window = [tuple(Fraction(float(x)) for x in p) for p in window]
    for a, b in zip(window, window[1:] + window[:1], strict=True):
        out = []
        for i, p in enumerate(polygon):
            q = polygon[(i + 1) % len(polygon)]
            dp, dq = ((b[0] - a[0]) * (r[1] - a[1]) - (b[1] - a[1]) * (r[0] - a[0]) for r in (p, q))
            if dp >= 0:
                out.append(p)
            if dp * dq < 0:
                t = dp / (dp - dq)
                out.append(tuple(x + t * (y - x) for x, y in zip(p, q, strict=True)))
        polygon = out
    return polygon


def window_of(n, rng, dtype=float):
    p = rng.normal(size=(n, 2))
    return p[ConvexHull(p).vertices].astype(dtype)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
@pytest.mark.parametrize("shift", [0.0, 1e6])
def test_corners_are_those_of_rational_clipping(dtype, shift):
    rng = np.random.default_rng(1)
    met = 0
    for _ in range(60):
        size = 1.0 if shift == 0 else 1e4
        window = (size * window_of(8, rng) + shift).astype(dtype)
        # Some polygons have corners and edges of the window.
        polygon = (size * rng.normal(size=(5, 2)) + shift).astype(dtype)
        k = rng.integers(0, 3)
        polygon[:k] = window[:k]
        expected = rational_clip(polygon, window)
        for turned in (window, window[::-1]):
            got = points(geometry.clip_polygon(polygon, turned)).astype(float)
            assert got.shape[0] == len(expected) or turned is not window
            want = np.array([[float(x) for x in p] for p in expected]).reshape(-1, 2)
            # Four units of the largest coordinate, as documented, over the sine at which borders are met.
            scale = 40 * float(np.finfo(dtype).eps) * float(np.abs(polygon).max())
            assert abs(area(got) - area(want)) <= 20 * scale * size
        met += len(expected) > 2
    assert met > 30


def test_grids_where_polygons_touch():
    corner = st.tuples(st.integers(-3, 3), st.integers(-3, 3))
    window = np.array([[-2, -2], [1, -2], [2, 0], [2, 2], [-2, 2]], float)

    @settings(max_examples=200, deadline=None)
    @given(st.lists(corner, min_size=3, max_size=6))
    def check(polygon):
        expected = rational_clip(polygon, window.tolist())
        got = geometry.clip_polygon(np.array(polygon, float), window)
        assert got.counts == len(expected) or (len(expected) > got.counts and len(set(expected)) <= 2)
        if len(expected) == got.counts and expected:
            assert np.allclose(points(got), [[float(x) for x in p] for p in expected], atol=1e-14)
        assert np.isnan(got.points[int(got.counts) :]).all()

    check()


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_halves_make_the_whole(dtype):
    rng = np.random.default_rng(2)
    polygon = rng.normal(size=(500, 7, 3)).astype(dtype)
    # Flat: in the plane z = 2 x - y + 1.
    polygon[..., 2] = 2 * polygon[..., 0] - polygon[..., 1] + 1
    plane = rng.normal(size=(500, 1, 4)).astype(dtype)
    parts = [geometry.clip_polygon(polygon, s * plane) for s in (dtype(1), dtype(-1))]
    total = sum(np.array([area(points(part, i).astype(float)) for i in range(500)]) for part in parts)
    assert np.allclose(total, area(polygon.astype(float)), atol=100 * np.finfo(dtype).eps)
    # New corners are the same from both sides, to the bit.
    for i in range(500):
        own = {tuple(p) for p in polygon[i].tolist()}
        new = [{tuple(p) for p in points(part, i).tolist()} - own for part in parts]
        assert new[0] == new[1]


def test_what_is_left_is_in_front_of_the_planes():
    rng = np.random.default_rng(3)
    polygon, planes = rng.normal(size=(300, 3, 3)), rng.normal(size=(300, 5, 4))
    planes[..., 3] += 1
    got = geometry.clip_polygon(polygon, planes)
    heights = np.einsum("nki,nmi->nkm", got.points, planes[..., :3]) + planes[:, None, :, 3]
    assert np.nanmin(heights) > -1e-14 and 50 < (got.counts > 2).sum() < 290
    assert got.points.shape == (300, 8, 3) and np.array_equal(np.isfinite(got.points[..., 0]).sum(-1), got.counts)


def test_one_polygon_in_many_windows_and_parts_that_stay_joined():
    comb = [[0, 0], [9, 0], [9, 4], [8, 4], [8, 1], [7, 1], [7, 4], [6, 4], [6, 1], [5, 1], [5, 4], [0, 4.0]]
    windows = np.array([[[0, 2], [9, 2], [9, 3], [0, 3]], [[0, 0], [1, 0], [1, 1], [0, 1.0]]])
    got = geometry.clip_polygon(comb, windows)
    assert got.points.shape[0] == 2
    assert [area(points(got, i)) for i in range(2)] == [7, 1]


def test_slots_grow_where_a_polygon_needs_them():
    # A saw of 20 teeth, of which a strip cuts off tips and roots.
    x = np.arange(41.0)
    saw = np.concatenate([np.stack([x, x % 2], -1), [[40, -9], [0, -9]]])
    got = geometry.clip_polygon(saw, [[-1, 0.25], [41, 0.25], [41, 0.75], [-1, 0.75]])
    assert got.points.shape[0] == got.counts > 43 + 4
    assert np.isclose(area(points(got)), -20 * (0.75 + 0.25), atol=20)


def test_slivers_keep_their_corners():
    p = np.array([[0, 0], [1, 1e-30], [1, 2e-30]])
    got = geometry.clip_polygon(p, [[-1, -1], [0.5, -1], [0.5, 1], [-1, 1]])
    assert got.counts == 3
    assert set(points(got)[:, 0]) == {0, 0.5} and points(got)[:, 1].max() == 1e-30


def test_bad_windows_and_nan():
    square = np.array([[0, 0], [1, 0], [1, 1], [0, 1.0]])
    for window in (square[[0, 1, 3, 2]], [[0, 0], [1, 1], [2, 2]]):
        with pytest.raises(ValueError, match="window: expected a convex polygon with area"):
            geometry.clip_polygon(square, window)
    with pytest.raises(ValueError, match=r"window: expected shape \(\.\.\., M, 4\)"):
        geometry.clip_polygon(np.zeros((3, 3)), square)
    many = np.stack([square, square])
    many[0, 0, 0] = np.nan
    got = geometry.clip_polygon(many, square)
    assert got.counts.tolist() == [0, 4] and np.isnan(got.points[0]).all()
    assert geometry.clip_polygon(np.zeros((0, 3, 2)), square).points.shape == (0, 7, 2)


def test_a_star_is_no_convex_window():
    """It turns one way at every corner, but twice around."""
    around = 4 * np.pi * np.arange(5) / 5
    star = np.stack([np.cos(around), np.sin(around)], -1)
    square = [[-2, -2], [2, -2], [2, 2], [-2, 2.0]]
    with pytest.raises(ValueError, match="window: expected a convex polygon"):
        geometry.clip_polygon(square, star)
    for turn in (star[np.argsort(np.arctan2(star[:, 1], star[:, 0]))], star[[0, 2, 4, 1, 3]][::-1]):
        # The same corners, once around.
        assert geometry.clip_polygon(square, turn).counts == 5
