"""Extremes of `geometry`: overlap tests, frusta, clipping, bounds."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme
from ._rational import Vector, cross, dot, sub, vector

Array = NDArray[Any]


def _apart(axes: Iterable[Vector], a: list[Vector], b: list[Vector]) -> bool:
    """Whether the shadows of two sets of corners are apart on some axis."""
    for n in axes:
        p, q = [dot(n, x) for x in a], [dot(n, x) for x in b]
        if max(p) < min(q) or max(q) < min(p):
            return True
    return False


def _wrong(got: Array, expected: list[bool]) -> Measurement:
    """The count of answers that are not those of rational arithmetic; both answers must occur."""
    both = 0 < sum(expected) < len(expected)
    return Measurement(float((got != np.array(expected)).sum()), len(expected), 0 if both else 1)


def _turns(rng: np.random.Generator, n: int) -> Array:
    q = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    return np.asarray(q * np.sign(np.linalg.det(q))[:, None, None])


def _boxes_apart(a: tuple[Array, Array, Array], b: tuple[Array, Array, Array]) -> bool:
    (ac, bc), edges = (vector(a[0]), vector(b[0])), [vector(x) for x in [*a[1], *b[1]]]
    half = vector(np.concatenate([a[2], b[2]]))
    between = sub(bc, ac)
    for i in range(6):
        for j in range(i + 1, 6):
            n = cross(edges[i], edges[j])
            if abs(dot(n, between)) > sum(h * abs(dot(n, e)) for h, e in zip(half, edges, strict=True)):
                return True
    return False


def _side_by_side(dtype: Any, tilt: float, flat: bool = False) -> Measurement:
    """Boxes whose edges are parallel but for a tilt, that touch but for rounding."""
    rng = np.random.default_rng(1)
    n = 40
    aa = _turns(rng, n)
    spin = tilt * rng.normal(size=(n, 3))
    ba = aa + np.cross(spin[:, None], aa)
    ac, (ah, bh) = rng.normal(size=(n, 3)), rng.uniform(0.5, 2, (2, n, 3))
    if flat:
        ah[:, 2] = 0
    shift = rng.uniform(-0.4, 0.4, (n, 3))
    k = rng.integers(0, 3, n)
    shift[np.arange(n), k] = (ah + bh)[np.arange(n), k]
    bc = ac + np.einsum("ni,nij->nj", shift, aa)
    boxes = [np.ascontiguousarray(x).astype(dtype) for x in (ac, aa, ah, bc, ba, bh)]
    near = geometry.obb_obb(*boxes, full_output=True)
    boxes[3] = boxes[3] - near.gap[:, None] * near.direction
    a, b = (list(zip(*boxes[i : i + 3], strict=True)) for i in (0, 3))
    return _wrong(geometry.obb_obb(*boxes), [not _boxes_apart(*x) for x in zip(a, b, strict=True)])


@extreme("geometry.obb_obb", "parallel axes", domain="boxes that touch but for rounding", unit="count", claim=0)
def _parallel(dtype: np.dtype[Any]) -> Measurement:
    return _side_by_side(dtype, 0.0)


@extreme("geometry.obb_obb", "axes parallel to 1e-7", domain="boxes that touch but for rounding", unit="count", claim=0)
def _near_parallel(dtype: np.dtype[Any]) -> Measurement:
    return _side_by_side(dtype, 1e-7)


@extreme(
    "geometry.obb_obb", "zero thickness", domain="rectangles touching boxes but for rounding", unit="count", claim=0
)
def _flat(dtype: np.dtype[Any]) -> Measurement:
    return _side_by_side(dtype, 0.0, flat=True)


def _triangles_meet(a: Array, b: Array) -> bool:
    """For triangles with area: the axes of their normals, of their edges' products, and of edges in a common plane."""
    p, q = [vector(x) for x in a], [vector(x) for x in b]
    ep, eq = ([sub(t[(i + 1) % 3], t[i]) for i in range(3)] for t in (p, q))
    normal = cross(ep[0], ep[1])
    axes = [normal, cross(eq[0], eq[1]), *(cross(u, v) for u in ep for v in eq)]
    return not _apart([*axes, *(cross(normal, e) for e in ep + eq)], p, q)


def _meeting(a: Array, b: Array) -> Measurement:
    got = geometry.triangle_triangle(*(a[:, i] for i in range(3)), *(b[:, i] for i in range(3)))
    return _wrong(got, [_triangles_meet(*x) for x in zip(a, b, strict=True)])


@extreme("geometry.triangle_triangle", "coplanar", domain="small grids of a slanted plane", unit="count", claim=0)
def _coplanar(dtype: np.dtype[Any]) -> Measurement:
    p = np.random.default_rng(2).integers(-3, 4, (120, 2, 3, 2))
    p = np.concatenate([p, (2 * p[..., :1] - 3 * p[..., 1:])], -1).astype(dtype)
    area = np.cross(p[:, :, 1] - p[:, :, 0], p[:, :, 2] - p[:, :, 0])
    p = p[area.any(-1).all(-1)]
    return _meeting(p[:, 0], p[:, 1])


def _touching(dtype: Any, shift: float, squeeze: float) -> Measurement:
    """A vertex of one on the face of the other, but for rounding; the rest to one side."""
    rng = np.random.default_rng(3)
    n = 60
    a, b = rng.normal(size=(2, n, 3, 3))
    a[..., 0] *= squeeze
    on = (rng.dirichlet([1, 1, 1], n)[..., None] * a).sum(1)
    normal = np.cross(a[:, 1] - a[:, 0], a[:, 2] - a[:, 0])
    height = np.einsum("nki,ni->nk", b - on[:, None], normal)
    b = b - np.where(height < 0, 2 * height / (normal**2).sum(-1)[:, None], 0)[..., None] * normal[:, None]
    b[:, 0] = on
    return _meeting((a + shift).astype(dtype), (b + shift).astype(dtype))


@extreme("geometry.triangle_triangle", "touching", domain="a vertex on a face but for rounding", unit="count", claim=0)
def _vertex(dtype: np.dtype[Any]) -> Measurement:
    return _touching(dtype, 0.0, 1.0)


@extreme("geometry.triangle_triangle", "slivers", domain="a vertex on a face 1e-9 wide", unit="count", claim=0)
def _sliver(dtype: np.dtype[Any]) -> Measurement:
    return _touching(dtype, 0.0, 1e-9)


@extreme("geometry.triangle_triangle", "1e6 from the origin", domain="touching but for rounding", unit="count", claim=0)
def _far_triangles(dtype: np.dtype[Any]) -> Measurement:
    return _touching(dtype, 1e6, 1.0)


def _grazing(dtype: Any, shift: float, thick: float) -> Measurement:
    """Triangles that graze a box's corner but for rounding."""
    rng = np.random.default_rng(4)
    n = 150
    low = np.full((n, 3), shift)
    high = low + np.array([64, 64, thick])
    corner = rng.integers(0, 2, (n, 3)) * (high - low)
    out = rng.normal(size=(n, 3, 3)) * 40
    # Three points of a plane through the corner, around it or not.
    u, v = out[:, 0], out[:, 1]
    s = rng.uniform(-1, 1, (n, 3, 2, 1))
    t = (low + corner)[:, None] + s[:, :, 0] * u[:, None] + s[:, :, 1] * v[:, None]
    low, high, t = low.astype(dtype), high.astype(dtype), t.astype(dtype)
    expected = []
    for tri, lo, hi in zip(t, low, high, strict=True):
        p = [vector(x) for x in tri]
        edges = [sub(p[(i + 1) % 3], p[i]) for i in range(3)]
        unit = [[Fraction(int(i == k)) for i in range(3)] for k in range(3)]
        box = [vector(np.where([i & 1, i & 2, i & 4], hi, lo)) for i in range(8)]
        axes = [*unit, cross(edges[0], edges[1]), *(cross(e, f) for e in unit for f in edges)]
        expected.append(not _apart(axes, p, box))
    return _wrong(geometry.triangle_aabb(t[:, 0], t[:, 1], t[:, 2], low, high), expected)


@extreme("geometry.triangle_aabb", "touching", domain="planes through corners but for rounding", unit="count", claim=0)
def _corner(dtype: np.dtype[Any]) -> Measurement:
    return _grazing(dtype, 0.0, 64.0)


@extreme("geometry.triangle_aabb", "zero thickness", domain="rectangles grazed but for rounding", unit="count", claim=0)
def _thin(dtype: np.dtype[Any]) -> Measurement:
    return _grazing(dtype, 0.0, 0.0)


@extreme("geometry.triangle_aabb", "1e6 from the origin", domain="boxes of 64, grazed", unit="count", claim=0)
def _far_box(dtype: np.dtype[Any]) -> Measurement:
    return _grazing(dtype, 1e6, 64.0)


def _balls(dtype: Any, size: float) -> Measurement:
    """Balls that touch but for rounding."""
    rng = np.random.default_rng(5)
    a, b = (size * rng.normal(size=(2, 300, 3))).astype(dtype)
    ra = (size * rng.uniform(0, 0.3, 300)).astype(dtype)
    away = np.sqrt((((a.astype(np.longdouble) - b) / size) ** 2).sum(-1)) * size
    rb = (away - ra).astype(dtype)
    expected = []
    for p, r, q, s in zip(a, ra, b, rb, strict=True):
        d = sub(vector(p), vector(q))
        expected.append(dot(d, d) <= (Fraction(float(r)) + Fraction(float(s))) ** 2)
    return _wrong(geometry.sphere_sphere(a, ra, b, rb), expected)


@extreme("geometry.sphere_sphere", "size 1e-30", domain="touching but for rounding", unit="count", claim=0)
def _tiny_balls(dtype: np.dtype[Any]) -> Measurement:
    return _balls(dtype, 1e-30)


@extreme("geometry.sphere_sphere", "size 1e30", domain="touching but for rounding", unit="count", claim=0)
def _huge_balls(dtype: np.dtype[Any]) -> Measurement:
    return _balls(dtype, 1e30)


@extreme(
    "geometry.three_planes",
    "near-parallel to 1e-6",
    domain="one plane leans on the others' pencil",
    unit="relative",
    claim={"float32": 7e-8, "float64": 1e-13},
)
def _pencil(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(6)
    a, b = rng.normal(size=(2, 150, 4)).astype(dtype)
    c = (0.3 * a - 1.7 * b + 1e-6 * rng.normal(size=(150, 4))).astype(dtype)
    got = geometry.three_planes(a, b, c)
    error, strays = Fraction(0), 0
    for point, *planes in zip(got, a, b, c, strict=True):
        rows = [vector(p) for p in planes]
        x, y, z = ([r[i] for r in rows] for i in range(3))
        d = [-r[3] for r in rows]
        det = dot(x, cross(y, z))
        exact = [dot(d, cross(y, z)) / det, dot(x, cross(d, z)) / det, dot(x, cross(y, d)) / det]
        if not np.isfinite(point).all():
            strays += 1
            continue
        error = max(error, *(abs(Fraction(float(p)) - e) / abs(e) for p, e in zip(point, exact, strict=True)))
    return Measurement(float(error), 150, strays)


def _clip_points(matrix: Array, p: Array) -> Vector:
    point = [*vector(p), Fraction(1)]
    return [dot(vector(row), point) for row in matrix]


def _visible(dtype: Any, far: float, shift: float) -> Measurement:
    """Points on a frustum's faces but for rounding: how many that show are lost, or called inside but do not."""
    from .... import transform

    rng = np.random.default_rng(7)
    view = transform.look_at([3 + shift, 2, 5.0], [shift, 1, 0])
    matrix = (transform.perspective(fov_y=1.0, aspect=1.5, near=0.5, far=far) @ view).astype(dtype)
    planes = geometry.frustum_planes(matrix)
    n = 300
    depth = rng.uniform(0.5, 0.9 * min(far, 100.0), (n, 1))
    local = np.concatenate(
        [rng.uniform(-0.9, 0.9, (n, 2)) * depth * np.tan(0.5) * [1.5, 1], -depth, np.ones((n, 1))], -1
    )
    p = (local @ np.linalg.inv(view).T)[:, :3]
    plane = planes[rng.integers(0, 5, n)].astype(float)
    p -= ((p * plane[:, :3]).sum(-1) + plane[:, 3])[:, None] * plane[:, :3]
    p = p.astype(dtype) + (rng.integers(-2, 3, (n, 3)) * np.spacing(np.abs(p).astype(dtype))).astype(dtype)
    got = geometry.frustum_sphere(planes, p, dtype.type(0))
    seen = []
    for q in p:
        x, y, z, w = _clip_points(matrix, q)
        seen.append(-w <= x <= w and -w <= y <= w and -w <= z <= w)
    wrong = np.where(seen, got < 0, got > 0).sum()
    return Measurement(float(wrong), n, 0 if 0 < sum(seen) < n else 1)


@extreme("geometry.frustum_sphere", "points at the border", domain="off by units of rounding", unit="count", claim=0)
def _border(dtype: np.dtype[Any]) -> Measurement:
    return _visible(dtype, 30.0, 0.0)


@extreme("geometry.frustum_sphere", "infinite far, 1e4 away", domain="off by units of rounding", unit="count", claim=0)
def _border_far(dtype: np.dtype[Any]) -> Measurement:
    return _visible(dtype, np.inf, 1e4)


def _contained(sets: Array, bound: Callable[[Array], Any], distance: Callable[[Array, Any], Array]) -> Measurement:
    """By how much points stick out of their bounds, which must be not at all."""
    got = bound(sets)
    out = distance(sets, got)
    return Measurement(float(np.maximum(out, 0).max()), sets.shape[0] * sets.shape[1], int(np.isnan(out).sum()))


def _sets(dtype: Any, shift: float, size: float) -> Array:
    rng = np.random.default_rng(8)
    p = rng.normal(size=(60, 12, 3))
    # Some cospherical, some coplanar, some in line, some alike.
    p[:15] /= np.linalg.norm(p[:15], axis=-1, keepdims=True)
    p[15:30, :, 2] = p[15:30, :, 0]
    p[30:40, :, 1:] = p[30:40, :, :1] * [0.5, 2]
    p[40:45] = p[40:45, :1]
    return np.asarray((size * p + shift).astype(dtype))


def _outside_ball(p: Array, ball: geometry.BoundingSphere) -> Array:
    offset = p - ball.center[:, None]
    return np.asarray(np.sqrt((offset * offset).sum(-1)) - ball.radius[:, None])


def _outside_box(p: Array, box: geometry.BoundingOBB) -> Array:
    local = np.einsum("snj,sij->sni", p - box.center[:, None], box.axes)
    return np.asarray(np.abs(local) - box.half_extents[:, None])


@extreme("geometry.bounding_sphere", "1e6 from the origin", domain="flat, cospherical, alike", unit="absolute", claim=0)
def _ball_far(dtype: np.dtype[Any]) -> Measurement:
    return _contained(_sets(dtype, 1e6, 10.0), geometry.bounding_sphere, _outside_ball)


@extreme("geometry.bounding_sphere", "size 1e-15", domain="flat, cospherical, alike", unit="absolute", claim=0)
def _ball_small(dtype: np.dtype[Any]) -> Measurement:
    return _contained(_sets(dtype, 0.0, 1e-15), geometry.bounding_sphere, _outside_ball)


@extreme("geometry.bounding_obb", "1e6 from the origin", domain="flat, in line, alike", unit="absolute", claim=0)
def _obb_far(dtype: np.dtype[Any]) -> Measurement:
    return _contained(_sets(dtype, 1e6, 10.0), geometry.bounding_obb, _outside_box)


@extreme("geometry.bounding_obb", "size 1e-15", domain="flat, in line, alike", unit="absolute", claim=0)
def _obb_small(dtype: np.dtype[Any]) -> Measurement:
    return _contained(_sets(dtype, 0.0, 1e-15), geometry.bounding_obb, _outside_box)


@extreme("geometry.clip_homogeneous", "w to zero and below", domain="inside to the bit", unit="count", claim=0)
def _behind(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(9)
    p = rng.normal(size=(2000, 4, 4))
    p[:, :, 3] *= 10.0 ** rng.integers(-8, 1, (2000, 4))
    got = geometry.clip_homogeneous(p.astype(dtype))
    there = np.arange(got.points.shape[1]) < got.counts[:, None]
    inside = (np.abs(got.points[..., :3]) <= got.points[..., 3:]).all(-1)
    return Measurement(float((there & ~inside).sum()), 2000, int((~np.isfinite(got.points[there])).sum()))


@extreme(
    "geometry.clip_segment", "1e6 from the origin", domain="corners grazed but for rounding", unit="count", claim=0
)
def _corner_segments(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(10)
    n = 200
    low = np.full((n, 2), 1e6)
    high = low + 64
    corner = np.where(rng.integers(0, 2, (n, 1)) > 0, [0, 64], [64, 0])
    way = np.where(corner > 0, -1, 1) * [1, -1] * rng.uniform(5, 90, (n, 2))
    p, q = ((low + corner + s * way).astype(dtype) for s in (1.0, -0.8))
    low, high = low.astype(dtype), high.astype(dtype)
    expected = []
    for a, b, lo, hi in zip(p, q, low, high, strict=True):
        first, last = Fraction(0), Fraction(1)
        for x, y, u, v in zip(*(vector(w) for w in (a, b, lo, hi)), strict=True):
            s, t = sorted([(u - x) / (y - x), (v - x) / (y - x)])
            first, last = max(first, s), min(last, t)
        expected.append(first <= last)
    return _wrong(geometry.clip_segment(p, q, low, high).hit, expected)
