"""Rays and polygons: agree with triangles and with the plane's point; nothing passes between neighbours."""

from fractions import Fraction

import numpy as np
import pytest
import shadelab as sl
import trimesh

from .rational import cross, dot, sub, vector

PRECISIONS = pytest.mark.parametrize("dtype", [np.float32, np.float64])


def flat_polygon(rng, n):
    """A star-shaped polygon in a random plane, its frame and its plane coordinates."""
    angle = np.sort(rng.uniform(0, 2 * np.pi, n))
    plane = rng.uniform(0.3, 1, (n, 1)) * np.stack([np.cos(angle), np.sin(angle)], -1)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    return plane @ frame[:2], frame, plane


@PRECISIONS
@pytest.mark.parametrize("n", [3, 4, 17, 200])
def test_hits_are_those_of_the_plane(dtype, n):
    rng = np.random.default_rng(n)
    polygon, frame, plane = flat_polygon(rng, n)
    goal = rng.uniform(-1, 1, (500, 2))
    o = goal @ frame[:2] + rng.uniform(1, 3, (500, 1)) * frame[2] + 0.3 * rng.normal(size=(500, 3))
    d = goal @ frame[:2] - o
    hit = sl.geometry.ray_polygon(o.astype(dtype), d.astype(dtype), polygon.astype(dtype), full_output=True)
    assert hit.t.dtype == dtype
    inside = sl.geometry.point_in_polygon(goal, plane)
    # Away from edges by more than rounding.
    a, b = plane, np.roll(plane, -1, 0)
    s = np.clip(((goal[:, None] - a) * (b - a)).sum(-1) / ((b - a) ** 2).sum(-1), 0, 1)
    clear = np.linalg.norm(a + s[..., None] * (b - a) - goal[:, None], axis=-1).min(1) > 1e-5
    assert np.array_equal(np.isfinite(hit.t[clear]), inside[clear]) and clear.mean() > 0.9
    assert np.allclose(hit.t[clear & inside], 1, atol=40 * np.finfo(dtype).eps)
    turns = np.sign(-(d @ np.cross(frame[0], frame[1])))
    assert np.array_equal(hit.winding[clear & inside], turns[clear & inside])
    assert np.allclose(hit.normal, np.cross(frame[0], frame[1]), atol=1e-5)


@PRECISIONS
def test_triangles_hit_where_the_watertight_test_does(dtype):
    rng = np.random.default_rng(1)
    corners = rng.normal(size=(3000, 3, 3)).astype(dtype)
    o, w = rng.normal(size=(3000, 3)).astype(dtype), rng.dirichlet([0.3] * 3, (3000, 1)).astype(dtype)
    d = (w @ corners)[:, 0] - o
    polygon = sl.geometry.ray_polygon(o, d, corners)
    triangle = sl.geometry.ray_triangle(o, d, *np.moveaxis(corners, 1, 0)).t
    assert np.array_equal(np.isfinite(polygon), np.isfinite(triangle))


@PRECISIONS
@pytest.mark.parametrize("shift", [0, 1e6])
def test_no_ray_passes_between_polygons_that_share_edges(dtype, shift):
    rng = np.random.default_rng(2)
    # A closed prism with a star for its base, seen from inside: rays at its edges and vertices.
    n = 12
    angle = 2 * np.pi * np.arange(n) / n
    rim = np.stack([np.cos(angle), np.sin(angle)], -1) * np.where(np.arange(n) % 2, 1, 0.4)[:, None]
    low, high = (np.c_[rim, np.full(n, z)] for z in (-1.0, 1.0))
    turn = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    low, high = ((3 * x @ turn + shift).astype(dtype) for x in (low, high))
    sides = np.stack([low, np.roll(low, -1, 0), np.roll(high, -1, 0), high], 1)
    o = (0.3 * rng.uniform(-1, 1, (400, 3)) + shift).astype(dtype)
    s = rng.choice([0, 0.25, 0.5, 1], (400, 1))
    edge = rng.integers(0, n, 400)
    starts, ends = np.concatenate([low, low]), np.concatenate([np.roll(low, -1, 0), high])
    pick = rng.integers(0, 2 * n, 400)
    goal = ((1 - s) * starts[pick].astype(float) + s * ends[pick]).astype(dtype)
    d = goal - o
    t = [sl.geometry.ray_polygon(o, d, base) for base in (low, high)]
    t += [sl.geometry.ray_polygon(o, d, side) for side in sides]
    assert np.isfinite(np.min(t, 0)).all() and edge.size


@PRECISIONS
@pytest.mark.parametrize("length", [1e-20, 1e20])
def test_length_of_direction_scales_t_alone(dtype, length):
    rng = np.random.default_rng(3)
    polygon = flat_polygon(rng, 9)[0].astype(dtype)
    o, d = rng.normal(size=(2, 500, 3)).astype(dtype)
    factor = dtype(2.0 ** np.round(np.log2(length)))
    one, many = (sl.geometry.ray_polygon(o, x, polygon) for x in (d, d * factor))
    assert np.array_equal(one / factor, many)


def test_t_against_rationals_far_from_the_origin():
    rng = np.random.default_rng(4)
    for dtype in (np.float32, np.float64):
        # Whole coordinates in the plane x + y + z = c, so that the polygon is flat.
        xy = rng.integers(-50, 50, (12, 2)) + 1_000_000
        polygon = np.c_[xy, 3_000_000 - xy.sum(1)].astype(dtype)
        o = (np.array([1e6, 1e6, 1e6]) + 100 * rng.normal(size=(200, 3))).astype(dtype)
        d = (polygon.mean(0) + 20 * rng.normal(size=(200, 3)) - o).astype(dtype)
        hit = sl.geometry.ray_polygon(o, d, polygon, rule="winding")
        n = vector([1, 1, 1])
        for i in np.flatnonzero(np.isfinite(hit)):
            want = (3_000_000 - dot(n, vector(o[i]))) / dot(n, vector(d[i]))
            flat = float(abs(dot(n, vector(d[i])))) / np.linalg.norm(d[i])
            assert abs(Fraction(float(hit[i])) - want) <= 40 * float(np.finfo(dtype).eps) * abs(want) / flat


def test_agrees_with_trimesh_on_a_fan():
    rng = np.random.default_rng(5)
    polygon, frame, _ = flat_polygon(rng, 11)
    fan = trimesh.Trimesh(np.vstack([polygon, [0, 0, 0]]), [[i, (i + 1) % 11, 11] for i in range(11)], process=False)
    o = 3 * frame[2] + rng.normal(size=(200, 3))
    d = rng.uniform(-0.8, 0.8, (200, 2)) @ frame[:2] - o
    met = fan.ray.intersects_any(o, d)
    # The fan covers the polygon if it turns about the centre everywhere.
    assert (np.isfinite(sl.geometry.ray_polygon(o, d, polygon, rule="winding")) == met).mean() > 0.99


def test_rays_in_the_plane_polygons_without_area_and_borders():
    square = [[0, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1.0]]
    assert np.isinf(sl.geometry.ray_polygon([-1, 1, 1], [1.0, 0, 0], square))
    assert np.isinf(sl.geometry.ray_polygon([1, 1, 0], [0, 0, 1.0], [[0, 1, 1], [1, 1, 1], [2, 1, 1]]))
    assert np.isinf(sl.geometry.ray_polygon([1, 1, 0], [0, 0, 1.0], [[1, 1, 1]] * 4))
    full = sl.geometry.ray_polygon([[2, 1, 0], [0, 0, 0], [1, 1, 0]], [0, 0, 2.0], square, full_output=True)
    assert full.t.tolist() == [0.5] * 3 and full.on_border.tolist() == [True, True, False]
    repeated = [[0, 0, 1], [0, 0, 1], [1, 0, 1], [2, 0, 1], [2, 2, 1], [0, 2, 1], [0, 2, 1.0]]
    assert sl.geometry.ray_polygon([1, 1, 0], [0, 0, 2.0], repeated) == 0.5
    assert np.isinf(sl.geometry.ray_polygon([1, 1, 0], [0, 0, 2.0], square, t_max=0.5))


def test_normals_are_newell():
    polygon = flat_polygon(np.random.default_rng(6), 8)[0]
    got = sl.geometry.ray_polygon([0, 0, 5.0], [0, 0, -1.0], polygon, full_output=True).normal
    corners = [vector(p) for p in polygon]
    total = [Fraction()] * 3
    for a, b in zip(corners, corners[1:] + corners[:1], strict=True):
        total = [x + y for x, y in zip(total, cross(sub(a, corners[0]), sub(b, corners[0])), strict=True)]
    want = np.array([float(x) for x in total])
    assert np.allclose(got, want / np.linalg.norm(want), atol=1e-14)


def test_nan_stays_in_its_element_and_polygons_broadcast():
    rng = np.random.default_rng(7)
    polygons = np.stack([flat_polygon(rng, 6)[0] for _ in range(4)])
    o, d = rng.normal(size=(2, 5, 1, 3))
    clean = sl.geometry.ray_polygon(o, d, polygons)
    assert clean.shape == (5, 4)
    o[0, 0, 0], d[1] = np.nan, 0
    polygons[2, 3, 1] = np.inf
    t = sl.geometry.ray_polygon(o, d, polygons)
    assert np.isnan(t[:2]).all() and np.isnan(t[:, 2]).all()
    assert np.array_equal(t[2:, [0, 1, 3]], clean[2:, [0, 1, 3]])
    with pytest.raises(ValueError, match="t_min: expected a number, got nan"):
        sl.geometry.ray_polygon([0, 0, 0], [0, 0, 1], polygons[0], t_min=np.nan)
