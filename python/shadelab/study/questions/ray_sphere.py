"""Rays and spheres: what each test costs, how far it errs, and which silhouettes fray with the distance."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import geometry, transform
from ..question import Case, Question
from . import _rays
from ._rays import EPS, Rays

__all__ = ["Ball", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Ball:
    """A sphere, and how far away from its centre the eye and the origin of coordinates are, in radii."""

    distance: float = 2.0
    radius: float = 1.0
    offset: float = 0.0


_SCENES = {
    "2 radii away": Ball(),
    "100 radii away": Ball(distance=1e2),
    "4000 radii away": Ball(distance=4e3),
    "1e6 radii away": Ball(distance=1e6),
    "radius 1e-6": Ball(radius=1e-6),
    "radius 1e6": Ball(radius=1e6),
    "1000 radii from the origin": Ball(offset=1e3),
}

_VIEWS = {"the sphere": "whole", "its limb magnified": "limb"}


def _views(name: str, scene: Any) -> Mapping[str, str]:
    # From the surface itself it does not matter how far the eye was.
    return _VIEWS | ({"leaving the surface": "leaving"} if getattr(scene, "distance", 0.0) <= 10 else {})


def _setup(case: Case) -> Rays:
    """A sphere for each tile; rays in single precision from about one eye, or from the rounded surface."""
    ball = case.scene
    if not isinstance(ball, Ball):
        raise ValueError(f"scene: this question has scenes of its own, or takes a Ball, got {type(ball).__name__}")
    rng = np.random.default_rng([case.seed, 2])
    x, y, tile, n = _rays.tiles(case.size)
    frame = _rays.random_frame(rng, n)
    center = _rays.rounded(_rays.random_frame(rng, n)[:, :, 0] * ball.offset * ball.radius)[tile]
    radius = _rays.rounded(ball.radius * rng.uniform(0.9, 1.1, n))[tile]
    right, up, toward = (frame[:, :, k][tile] for k in range(3))
    if case.view == "leaving":
        # Outwards in the upper half of a tile, inwards in the lower one; the normal turns from left to right.
        normal = np.cos(np.pi * x)[..., None] * right + np.sin(np.pi * x)[..., None] * toward
        origins = _rays.rounded(center + normal * radius[..., None])
        local = rng.normal(size=(*tile.shape, 3))
        local /= np.linalg.norm(local, axis=-1, keepdims=True)
        local[..., 2] = np.copysign(np.maximum(np.abs(local[..., 2]), 0.1), y)
        basis = transform.orthonormal_basis(normal)
        directions = _rays.rounded((basis * local[..., None, :]).sum(-1) * radius[..., None])
    else:
        jitter = 0.01 * ball.distance * rng.normal(size=(*tile.shape, 3))
        origins = _rays.rounded(center + (toward * ball.distance + jitter) * radius[..., None])
        apart = center - origins
        length = np.linalg.norm(apart, axis=-1)
        if case.view == "limb":
            # About the whole limb from bottom to top; across it half a rounding of the largest number a pixel.
            reach = min(_rays.TILE / 4 * EPS * max(ball.distance, ball.offset), 0.5)
            turn, impact = np.pi * y, 1 + reach * x
        else:
            turn, impact = np.arctan2(y, x), 1.3 * np.hypot(x, y)
        # The direction that passes the centre at `impact` radii.
        side = np.cos(turn)[..., None] * right + np.sin(turn)[..., None] * up
        ahead = apart / length[..., None]
        side -= ahead * (side * ahead).sum(-1, keepdims=True)
        side /= np.linalg.norm(side, axis=-1, keepdims=True)
        sine = np.minimum(impact * radius / length, 1.0)
        directions = _rays.rounded(
            (ahead * np.sqrt(1 - sine**2)[..., None] + side * sine[..., None]) * length[..., None]
        )
    exact, shade = _exact(origins, directions, center, radius)
    arrays = [np.ascontiguousarray(v[:, :, None], case.dtype) for v in (origins, directions, center, radius)]
    return Rays(arrays[0], arrays[1], tuple(arrays[2:]), exact, shade)


def _exact(o: Array, d: Array, c: Array, r: Array) -> tuple[Array, Array]:
    """The distance of the first crossing, decided exactly, or -1; and a shade, brighter where the ray meets the front.

    All in long double: numbers of single precision. Lines that pass within a few roundings of touching are decided in
    rationals; the power of the origin, which tells inside from outside, is summed with its rounding errors.
    """
    o, d, c, r = (v.astype(np.longdouble) for v in (o, d, c, r))
    f = o - c
    square = (d * d).sum(-1)
    middle = -(d * f).sum(-1) / square
    across = f + middle[..., None] * d
    room = r**2 - (across**2).sum(-1)
    # The foot of the perpendicular is off by some roundings of the origin's distance.
    size = np.sqrt((f**2).sum(-1))
    slack = 16 * np.finfo(np.longdouble).eps * (size + r) * r
    touches = room >= 0
    for i in zip(*np.nonzero(np.abs(room) <= slack), strict=True):
        ray, off = ([Fraction(float(x)) for x in v[i]] for v in (d, f))
        dot, dd, ff = (sum(x * y for x, y in zip(*pair, strict=True)) for pair in ((ray, off), (ray, ray), (off, off)))
        touches[i] = dot * dot >= dd * (ff - Fraction(float(r[i])) ** 2)
    half = np.sqrt(np.maximum(room, 0) / square)
    # The root that does not cancel, and the other from the product of both.
    power = _sum_of_products([*(f[..., k] for k in range(3)), r], [*(f[..., k] for k in range(3)), -r])
    far = middle + np.copysign(half, middle)
    with np.errstate(divide="ignore", invalid="ignore"):
        other = np.where(far != 0, power / (square * far), 0)
    first, second = np.minimum(far, other), np.maximum(far, other)
    t = np.where(first > 0, first, second)
    hit = touches & (t > 0)
    cosine = np.where(hit, half * np.sqrt(square) / r, 0)
    return np.where(hit, t, -1).astype(np.float64), (0.3 + 0.6 * cosine).astype(np.float64)


def _sum_of_products(a: list[Array], b: list[Array]) -> Array:
    """Σ a b of few terms with all rounding errors of the sum: the products are exact or nearly so in long double."""
    total, lost = np.zeros_like(a[0]), np.zeros_like(a[0])
    for x, y in zip(a, b, strict=True):
        term = x * y
        new = total + term
        part = new - total
        lost += (total - (new - part)) + (term - part)
        total = new
    return np.asarray(total + lost)


def _run(method: Any) -> Callable[..., Array]:
    def run(inputs: Rays, prepared: Any, precision: str) -> Array:
        origins, directions, centers, radii = prepared
        return geometry.ray_sphere(origins, directions, centers, radii, method=method).t

    return run


_ABOUT = """The textbook's discriminant is the difference of two squared distances: with the distance of the sphere its
digits go, silhouettes fray, and rays that leave a surface meet it again. How many rays are decided wrongly, by distance
and scale; how far is the distance wrong where a hit is found; and what does a test cost? A third of the cases shows
the sphere, another a strip along its limb, 32 roundings wide, and from up close rays leave its rounded surface."""

_TECHNIQUES = {
    "robust": "The discriminant from the perpendicular vector, roundings carried along; the smaller root from the "
    "product of both.",
    "quadratic": "The quadratic equation as in textbooks: subtracts squares of the distance.",
    "geometric": "Pythagoras from the point nearest to the centre: the same subtraction.",
}


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "ray sphere",
        _SCENES,
        lambda inputs: inputs.exact,
        _rays.METRIC,
        [_rays.candidate(method, _run(method), about) for method, about in _TECHNIQUES.items()],
        views=_views,
        setup=_setup,
        compose=lambda inputs, t: _rays.answer(t),
        also=_rays.also,
        display=_rays.display,
        size=(320, 192),
        about=" ".join(_ABOUT.split()),
        element="ray",
        max_error=1e-5,
    )
