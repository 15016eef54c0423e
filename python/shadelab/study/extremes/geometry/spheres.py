"""Extremes of rays at spheres, against rational arithmetic and 60 digits."""

from __future__ import annotations

from decimal import Decimal, localcontext
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .... import geometry
from ...stability import Measurement, extreme

Array = NDArray[Any]
KERNEL = "geometry.ray_sphere"


def _exact(o: Array, d: Array, c: Array, r: Any) -> tuple[Fraction, tuple[Fraction, Fraction] | None]:
    """The discriminant in squared radii, and the roots to 60 digits."""
    ro, rd, rc = ([Fraction(float(x)) for x in v] for v in (o, d, c))
    radius = Fraction(float(r))
    f = [x - y for x, y in zip(ro, rc, strict=True)]
    a, b = sum((x * x for x in rd), Fraction()), -sum((x * y for x, y in zip(f, rd, strict=True)), Fraction())
    left = radius * radius - sum((x * x for x in f), Fraction()) + b * b / a
    relative = left / (radius * radius) if radius else left
    if left < 0:
        return relative, None
    with localcontext(prec=60, Emin=-9999, Emax=9999):
        root = Fraction((Decimal((a * left).numerator) / Decimal((a * left).denominator)).sqrt())
    return relative, ((b - root) / a, (b + root) / a)


def _aimed(
    dtype: Any, seed: int, distance: float, *, size: float = 1.0, shift: float = 0.0, length: float = 1.0, n: int = 100
) -> list[Array]:
    """Rays from `distance` radii away, at points up to 1.1 radii beside the centre."""
    rng = np.random.default_rng(seed)
    u, side = rng.normal(size=(2, n, 3))
    u /= np.linalg.norm(u, axis=-1, keepdims=True)
    side = np.cross(u, side)
    side /= np.linalg.norm(side, axis=-1, keepdims=True)
    r = size * rng.uniform(0.5, 2, n)
    c = size * rng.normal(size=(n, 3)) + shift
    o = c + u * (distance * r)[:, None]
    d = c + side * (r * rng.uniform(0, 1.1, n))[:, None] - o
    return [x.astype(dtype) for x in (o, length * d / np.linalg.norm(d, axis=-1, keepdims=True), c, r)]


def _worst(rays: list[Array], floor: float = 0.0) -> Measurement:
    """Measure the largest error of both roots in eps of their size, where the chord is a radius or more.

    Wrong decisions farther than 4 eps from touching are strays.
    """
    o, d, c, r = rays
    hit = geometry.ray_sphere(o, d, c, r)
    eps = Fraction(float(np.finfo(o.dtype).eps))
    error, strays = 0.0, 0
    for i in range(len(o)):
        discriminant, roots = _exact(o[i], d[i], c[i], r[i])
        if abs(discriminant) > 4 * eps:
            strays += (roots is not None) != bool(np.isfinite(hit.t_near[i]))
        if roots is None or discriminant < Fraction(1, 4) or not np.isfinite(hit.t_near[i]):
            continue
        for got, want in zip((hit.t_near[i], hit.t_far[i]), roots, strict=True):
            unit = eps * max(abs(want), Fraction(floor) * eps)
            error = max(error, float(abs(Fraction(float(got)) - want) / unit))
    return Measurement(error, len(o), strays)


@extreme(KERNEL, "spheres at 1e4 radii", domain="chords of a radius or more", unit="eps of t", claim=4)
def _far_spheres(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 1, 1e4))


@extreme(KERNEL, "spheres at 1e6 radii", domain="chords of a radius or more", unit="eps of t", claim=4)
def _farther_spheres(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 2, 1e6))


@extreme(KERNEL, "1e6 from the origin", domain="spheres of size 1e4", unit="eps of t", claim=4)
def _far_scene(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 3, 3, size=1e4, shift=1e6))


@extreme(KERNEL, "directions of 1e-20", domain="unit spheres", unit="eps of t", claim=4)
def _short(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 4, 3, length=1e-20))


@extreme(KERNEL, "directions of 1e20", domain="unit spheres", unit="eps of t", claim=4)
def _long(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 5, 3, length=1e20))


@extreme(KERNEL, "radii of 1e-30", domain="from three radii", unit="eps of t", claim=4)
def _tiny(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 6, 3, size=1e-30))


@extreme(KERNEL, "radii of 1e30", domain="from three radii", unit="eps of t", claim=4)
def _huge(dtype: np.dtype[Any]) -> Measurement:
    return _worst(_aimed(dtype, 7, 3, size=1e30))


@extreme(KERNEL, "starting on the surface", domain="unit spheres; eps of t, or eps² of r", unit="eps of t", claim=4)
def _surface(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(8)
    u = rng.normal(size=(100, 3))
    o = (u / np.linalg.norm(u, axis=-1, keepdims=True)).astype(dtype)
    d = (-o + 0.3 * rng.normal(size=(100, 3))).astype(dtype)
    return _worst([o, d, np.zeros((100, 3), dtype), np.ones(100, dtype)], floor=1.0)
