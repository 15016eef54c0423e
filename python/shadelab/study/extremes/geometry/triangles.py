"""Extremes of rays at triangles and of barycentric coordinates."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme

Array = NDArray[Any]


def _rational(x: Array) -> list[Fraction]:
    return [Fraction(float(v)) for v in x]


def _exact(o: Array, d: Array, a: Array, b: Array, c: Array) -> tuple[Fraction, Fraction, Fraction] | None:
    """`t`, `u`, `v` of the ray's line and the triangle's plane in rational arithmetic; None if they are parallel."""
    ro, rd, ra, rb, rc = (_rational(x) for x in (o, d, a, b, c))
    e1 = [x - y for x, y in zip(rb, ra, strict=True)]
    e2 = [x - y for x, y in zip(rc, ra, strict=True)]
    s = [x - y for x, y in zip(ro, ra, strict=True)]

    def cross(p: list[Fraction], q: list[Fraction]) -> list[Fraction]:
        return [p[1] * q[2] - p[2] * q[1], p[2] * q[0] - p[0] * q[2], p[0] * q[1] - p[1] * q[0]]

    def dot(p: list[Fraction], q: list[Fraction]) -> Fraction:
        return p[0] * q[0] + p[1] * q[1] + p[2] * q[2]

    p, q = cross(rd, e2), cross(s, e1)
    det = dot(e1, p)
    return None if det == 0 else (dot(e2, q) / det, dot(s, p) / det, dot(rd, q) / det)


def _worst_t(rays: list[Array]) -> Measurement:
    """The largest relative error of `t` where rays meet their triangles."""
    o, d, a, b, c = rays
    hit = geometry.ray_triangle(o, d, a, b, c)
    error, cases, strays = 0.0, 0, 0
    for i in range(len(o)):
        exact = _exact(o[i], d[i], a[i], b[i], c[i])
        if exact is None or min(exact[1], exact[2], 1 - exact[1] - exact[2]) < Fraction(1, 100):
            continue
        cases += 1
        if not np.isfinite(hit.t[i]):
            strays += 1
        else:
            error = max(error, float(abs(Fraction(float(hit.t[i])) - exact[0]) / abs(exact[0])))
    return Measurement(error, cases, strays)


def _aimed(dtype: Any, seed: int, n: int, size: float = 1.0, shift: float = 0.0, length: float = 1.0) -> list[Array]:
    """Rays from a unit away at well-shaped triangles, met at 30 degrees or more."""
    rng = np.random.default_rng(seed)
    turns = np.linalg.qr(rng.normal(size=(n, 3, 3)))[0]
    corners = size * np.array([[0, 0, 0], [1, 0.1, 0], [0.2, 0.9, 0]]) @ turns + shift
    goal = (rng.dirichlet([2, 2, 2], n)[..., None] * corners).sum(1)
    slant = rng.normal(size=(n, 3))
    slant /= np.linalg.norm(slant, axis=-1, keepdims=True)
    d = size * (turns[:, 2] + 0.8 * slant)
    rays = [goal - 2 * d, length * d, *(corners[:, k] for k in range(3))]
    return [np.ascontiguousarray(x).astype(dtype) for x in rays]


@extreme(
    "geometry.ray_triangle",
    "signs near edges are exact",
    domain="rays along z at needles 1e-9 wide",
    unit="count",
    claim=0,
)
def _signs(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(1)
    # From the origin along z the shear is zero and vertices are exact, so inside or outside must be exactly right.
    # The edge from a to b passes the ray within a few units of round-off.
    n = 400
    a = rng.normal(size=(n, 3))
    a[:, 2] = rng.uniform(1, 2, n)
    b, c = a.copy(), rng.normal(size=(n, 3))
    c[:, 2] = 1.5
    b[:, :2] *= -rng.uniform(0.1, 3, (n, 1)) * (1 + rng.integers(-3, 4, (n, 2)) * np.finfo(dtype).eps)
    a, b, c = a.astype(dtype), b.astype(dtype), c.astype(dtype)
    o, d = np.zeros((n, 3), dtype), np.tile(np.array([0, 0, 1], dtype), (n, 1))
    hit = geometry.ray_triangle(o, d, a, b, c)
    wrong = 0
    for i in range(n):
        exact = _exact(o[i], d[i], a[i], b[i], c[i])
        inside = exact is not None and min(exact[1], exact[2], 1 - exact[1] - exact[2]) >= 0
        wrong += inside != bool(np.isfinite(hit.t[i]))
    return Measurement(float(wrong), n)


@extreme(
    "geometry.ray_triangle",
    "t, directions of 1e-20",
    domain="unit triangles",
    unit="relative",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _short(dtype: np.dtype[Any]) -> Measurement:
    return _worst_t(_aimed(dtype, 2, 300, length=1e-20))


@extreme(
    "geometry.ray_triangle",
    "t, directions of 1e20",
    domain="unit triangles",
    unit="relative",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _long(dtype: np.dtype[Any]) -> Measurement:
    return _worst_t(_aimed(dtype, 3, 300, length=1e20))


@extreme(
    "geometry.ray_triangle",
    "t, 1e6 from the origin",
    domain="triangles of size 1e4",
    unit="relative",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _far(dtype: np.dtype[Any]) -> Measurement:
    return _worst_t(_aimed(dtype, 4, 300, size=1e4, shift=1e6))


@extreme(
    "geometry.ray_triangle",
    "t, area of 1e-30",
    domain="triangles of size 1e-15",
    unit="relative",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _small(dtype: np.dtype[Any]) -> Measurement:
    return _worst_t(_aimed(dtype, 5, 300, size=1e-15))


@extreme(
    "geometry.ray_triangle",
    "points and lines",
    domain="rays at triangles without area",
    unit="relative",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _degenerate(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(6)
    # Lines along an axis stay lines in floating point.
    a = rng.normal(size=(1000, 3)).astype(dtype)
    b, c = a.copy(), a.copy()
    b[::2, 0] += 1
    c[::2, 0] += 2
    # Across the lines, rather than along them.
    o = (a + rng.normal(size=(1000, 3)) * [0.3, 1, 1]).astype(dtype)
    hit = geometry.ray_triangle(o, a - o, a, b, c)
    # A ray that passes within round-off of a line may meet it, where it is: at t = 1.
    met = np.isfinite(hit.t) & (np.arange(1000) % 2 == 0)
    points = np.isfinite(hit.t[1::2]).sum()
    error = np.abs(hit.t[met].astype(np.float64) - 1).max(initial=0)
    return Measurement(float(error), 1000, int(points + np.isnan([hit.t, hit.u, hit.v]).sum()))


@extreme(
    "geometry.barycentric",
    "1e6 from the origin",
    domain="triangles of size 1e4",
    unit="absolute",
    claim={"float32": 6e-7, "float64": 1.2e-15},
)
def _barycentric_far(dtype: np.dtype[Any]) -> Measurement:
    _, _, a, b, c = _aimed(dtype, 7, 300, size=1e4, shift=1e6)
    w = np.random.default_rng(8).dirichlet([1, 1, 1], 300)
    p = (w[:, :1] * a + w[:, 1:2] * b + w[:, 2:] * c).astype(dtype)
    got = geometry.barycentric(p, a, b, c)
    wide = [x.astype(np.longdouble) for x in (p, a, b, c)]
    n = np.cross(wide[2] - wide[1], wide[3] - wide[1])
    area = (n * n).sum(-1)
    weights = [
        (n * np.cross(y - wide[0], x - wide[0])).sum(-1) / area
        for x, y in ((wide[3], wide[2]), (wide[1], wide[3]), (wide[2], wide[1]))
    ]
    error = np.abs(got - np.stack(weights, -1))
    return Measurement(float(np.nanmax(error)), 300, int(np.isnan(got).sum()))
