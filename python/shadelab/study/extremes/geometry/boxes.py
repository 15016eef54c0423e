"""Extremes of rays at planes and boxes, against rational arithmetic."""

from __future__ import annotations

from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme
from ._rational import dot, sub, vector

Array = NDArray[Any]


def _stay(o: Array, d: Array, lower: Array, upper: Array) -> tuple[Fraction, Fraction] | None:
    """The line's stay in the closed box; None if it misses."""
    enter, leave = [], []
    for x, v, a, b in zip(*(vector(w) for w in (o, d, lower, upper)), strict=True):
        if v:
            near, far = sorted([(a - x) / v, (b - x) / v])
            enter.append(near)
            leave.append(far)
        elif not a <= x <= b:
            return None
    return (max(enter), min(leave)) if max(enter) <= min(leave) else None


def _boxes(rays: list[Array]) -> Measurement:
    """The largest error of entries and exits in eps of their size; wrong decisions are strays."""
    o, d, lower, upper = rays
    hit = geometry.ray_aabb(o, d, lower, upper)
    eps = Fraction(float(np.finfo(rays[0].dtype).eps))
    error, strays = 0.0, 0
    for i in range(len(rays[0])):
        want = _stay(*(x[i] for x in rays))
        strays += (want is not None) != bool(np.isfinite(hit.t_enter[i]))
        if want is not None and np.isfinite(hit.t_enter[i]):
            for got, t in zip((hit.t_enter[i], hit.t_exit[i]), want, strict=True):
                error = max(error, float(abs(Fraction(float(got)) - t) / (eps * abs(t))) if t else float(got != 0))
    return Measurement(error, len(rays[0]), strays)


def _corners(dtype: Any, seed: int, *, length: float = 1.0, shift: float = 0.0, thin: bool = False) -> list[Array]:
    """Rays at the corners of boxes, so that two or three slabs meet in one point but for rounding."""
    rng = np.random.default_rng(seed)
    lower = (rng.normal(size=(150, 3)) + shift).astype(dtype)
    upper = (lower + rng.uniform(0.1, 2, (150, 3)).astype(dtype)).astype(dtype)
    if thin:
        upper = np.where(rng.integers(0, 2, (150, 3)), lower, upper)
    goal = np.where(rng.integers(0, 2, (150, 3)), lower, upper)
    o = (4 * rng.normal(size=(150, 3)) + shift).astype(dtype)
    return [o, ((goal - o) * dtype.type(length)).astype(dtype), lower, upper]


AABB = "geometry.ray_aabb"


@extreme(AABB, "lines through corners, decided", domain="boxes of unit size", unit="eps of t", claim=1)
def _at_corners(dtype: np.dtype[Any]) -> Measurement:
    return _boxes(_corners(dtype, 1))


@extreme(AABB, "boxes of zero thickness", domain="in one to three axes", unit="eps of t", claim=1)
def _thin(dtype: np.dtype[Any]) -> Measurement:
    return _boxes(_corners(dtype, 2, thin=True))


@extreme(AABB, "1e6 from the origin", domain="boxes of unit size", unit="eps of t", claim=1)
def _far(dtype: np.dtype[Any]) -> Measurement:
    return _boxes(_corners(dtype, 3, shift=1e6))


@extreme(AABB, "directions of 1e-20", domain="boxes of unit size", unit="eps of t", claim=1)
def _short(dtype: np.dtype[Any]) -> Measurement:
    return _boxes(_corners(dtype, 4, length=1e-20))


@extreme(AABB, "directions of 1e20", domain="boxes of unit size", unit="eps of t", claim=1)
def _long(dtype: np.dtype[Any]) -> Measurement:
    return _boxes(_corners(dtype, 5, length=1e20))


@extreme(AABB, "rays along axes (0 · inf)", domain="within faces, along edges, beside them", unit="eps of t", claim=1)
def _axes(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(6)
    d = np.eye(3)[rng.integers(0, 3, 300)] * rng.choice([-1.0, 1.0], (300, 1)) * rng.choice([1.0, -1.0], (300, 3))
    o = rng.choice([-0.5, 0, 0.3, 1, 1.5], (300, 3))
    return _boxes([x.astype(dtype) for x in (o, d, np.zeros((300, 3)), np.ones((300, 3)))])


@extreme(AABB, "conservative loses none", domain="lines through corners", unit="count", claim=0)
def _conservative(dtype: np.dtype[Any]) -> Measurement:
    o, d, lower, upper = rays = _corners(dtype, 7)
    kept = np.isfinite(geometry.ray_aabb(o, d, lower, upper, method="conservative").t_enter)
    lost = sum(_stay(*(x[i] for x in rays)) is not None and not kept[i] for i in range(len(kept)))
    return Measurement(float(lost), len(kept))


def _oriented(dtype: Any, seed: int, shift: float, distance: float) -> Measurement:
    """The largest error of the borders of slabs in eps of their size."""
    rng = np.random.default_rng(seed)
    axes = np.linalg.qr(rng.normal(size=(60, 3, 3)))[0]
    c = rng.normal(size=(60, 3)) + shift
    o = c + distance * rng.normal(size=(60, 3))
    half = rng.uniform(0.2, 2, (60, 3))
    given = [x.astype(dtype) for x in (o, c + rng.normal(size=(60, 3)) - o, c, axes, half)]
    hit = geometry.ray_obb(*given, full_output=True)
    eps, error, strays = Fraction(float(np.finfo(dtype).eps)), 0.0, 0
    for i in range(60):
        w, d = sub(vector(given[2][i]), vector(given[0][i])), vector(given[1][i])
        for k in range(3):
            e, f, h = dot(vector(given[3][i][k]), w), dot(vector(given[3][i][k]), d), Fraction(float(given[4][i][k]))
            wanted = sorted([(e - h) / f, (e + h) / f])
            for got, want in zip((hit.slab_enter[i, k], hit.slab_exit[i, k]), wanted, strict=True):
                if np.isfinite(got):
                    error = max(error, float(abs(Fraction(float(got)) - want) / (eps * abs(want))))
                else:
                    strays += 1
    return Measurement(error, 60, strays)


@extreme("geometry.ray_obb", "1e6 from the origin", domain="borders of slabs", unit="eps of t", claim=4)
def _obb_far(dtype: np.dtype[Any]) -> Measurement:
    return _oriented(dtype, 8, 1e6, 4)


@extreme("geometry.ray_obb", "from 1e4 radii", domain="borders of slabs", unit="eps of t", claim=4)
def _obb_distant(dtype: np.dtype[Any]) -> Measurement:
    return _oriented(dtype, 9, 0, 1e4)


def _plane(dtype: Any, seed: int, *, flat: float = 1.0, shift: float = 0.0, length: float = 1.0) -> Measurement:
    """The largest error of `t` in eps of its size."""
    rng = np.random.default_rng(seed)
    n, p = rng.normal(size=(2, 150, 3))
    across = np.cross(n, rng.normal(size=(150, 3)))
    o = (p + rng.normal(size=(150, 3)) + shift).astype(dtype)
    d = (length * (across + flat * n)).astype(dtype)
    planes = np.c_[n, -(n * (p + shift)).sum(-1)].astype(dtype)
    t = geometry.ray_plane(o, d, planes, t_min=-np.inf)
    eps, error, strays = Fraction(float(np.finfo(dtype).eps)), 0.0, 0
    for i in range(150):
        normal, offset = vector(planes[i][:3]), Fraction(float(planes[i][3]))
        want = -(dot(normal, vector(o[i])) + offset) / dot(normal, vector(d[i]))
        if np.isfinite(t[i]):
            error = max(error, float(abs(Fraction(float(t[i])) - want) / (eps * abs(want))))
        else:
            strays += 1
    return Measurement(error, 150, strays)


@extreme("geometry.ray_plane", "rays almost in the plane", domain="at 1e-6", unit="eps of t", claim=4)
def _plane_flat(dtype: np.dtype[Any]) -> Measurement:
    return _plane(dtype, 10, flat=1e-6)


@extreme("geometry.ray_plane", "1e6 from the origin", domain="the plane as given", unit="eps of t", claim=4)
def _plane_far(dtype: np.dtype[Any]) -> Measurement:
    return _plane(dtype, 11, shift=1e6)


@extreme("geometry.ray_plane", "directions of 1e-20", domain="unit planes", unit="eps of t", claim=4)
def _plane_short(dtype: np.dtype[Any]) -> Measurement:
    return _plane(dtype, 12, length=1e-20)
