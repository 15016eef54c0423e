"""Rays and triangles: what each test costs, how far it errs, and which rays slip through a shared edge."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import geometry
from ..question import Case, Question
from . import _rays
from ._rays import EPS, Rays

__all__ = ["Pairs", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Pairs:
    """Pairs of triangles that share an edge, and where they are looked at from.

    Lengths are in sizes: `size` is the length of the shared edge. `thin` is the triangles' height over it, `offset` the
    scene's distance from the origin, `grazing` the angle in radians between the rays and the triangles' plane (None:
    from anywhere in front).
    """

    distance: float = 2.0
    size: float = 1.0
    offset: float = 0.0
    thin: float = 0.7
    grazing: float | None = None


_SCENES = {
    "2 sizes away": Pairs(),
    "100 sizes away": Pairs(distance=1e2),
    "10 000 sizes away": Pairs(distance=1e4),
    "size 1e-6": Pairs(size=1e-6),
    "size 1e6": Pairs(size=1e6),
    "1000 sizes from the origin": Pairs(offset=1e3),
    "slivers, 1 : 1000": Pairs(thin=1e-3),
    "grazing, 0.1°": Pairs(grazing=np.radians(0.1)),
}

_VIEWS = {"both triangles": False, "their edge magnified": True}


def _views(name: str, scene: Any) -> Mapping[str, bool]:
    return _VIEWS


def _setup(case: Case) -> Rays:
    """A pair for each tile, turned at random; rays in single precision from about one eye, aimed at its window."""
    pairs = case.scene
    if not isinstance(pairs, Pairs):
        raise ValueError(f"scene: this question has scenes of its own, or takes Pairs, got {type(pairs).__name__}")
    rng = np.random.default_rng([case.seed, 1])
    x, y, tile, n = _rays.tiles(case.size)
    frame = _rays.random_frame(rng, n)
    away = frame[:, :, 0] * pairs.offset

    def world(local: Array) -> Array:
        return (np.einsum("nij,nj->ni", frame, local) + away) * pairs.size

    # The edge lies along y; the triangles fold away from the eye, so that none hides the other.
    flat = pairs.grazing is not None
    fold = np.zeros(n) if flat else rng.uniform(0, 0.4, n) * pairs.thin
    side = [np.stack([s * pairs.thin + np.zeros(n), rng.uniform(-0.3, 0.3, n), -fold], -1) for s in (-1, 1)]
    ends = [np.tile([0, s * 0.5, 0], (n, 1)) for s in (-1, 1)]
    p, q, left, right = (_rays.rounded(world(v)) for v in (*ends, *side))
    turn = rng.uniform(0, 2 * np.pi, n)
    lean = np.tan(pairs.grazing) ** -1 if pairs.grazing is not None else np.tan(np.radians(40)) * rng.random(n)
    toward = np.stack([lean * np.cos(turn), lean * np.sin(turn), np.ones(n)], -1)
    toward /= np.linalg.norm(toward, axis=-1, keepdims=True)

    # Each ray has its own eye, about the tile's, so that no two are rounded alike.
    jitter = 0.01 * pairs.distance * rng.normal(size=(*tile.shape, 3))
    eye = world(toward * pairs.distance)[tile] + jitter * (0.0 if flat else pairs.size)
    origins = _rays.rounded(eye)
    if case.view:
        # Across the edge half a rounding of the largest number a pixel; along it, two fifths of it.
        unit = EPS * max(pairs.distance, pairs.offset, 1.0) * pairs.size
        along = (q - p)[tile]
        across = np.cross(along, origins - p[tile])
        across /= np.linalg.norm(across, axis=-1, keepdims=True)
        target = p[tile] + along * (0.5 + 0.2 * y[..., None]) + across * (x * _rays.TILE / 4 * unit)[..., None]
    else:
        local = np.stack([1.1 * pairs.thin * x, 0.6 * y, np.zeros_like(x)], -1)
        target = (np.einsum("hwij,hwj->hwi", frame[tile], local) + away[tile]) * pairs.size
    directions = _rays.rounded(target - origins)
    corners = [np.stack([v[tile] for v in pair], 2) for pair in ((p, q), (q, p), (left, right))]
    rays = [np.repeat(v[:, :, None], 2, 2) for v in (origins, directions)]
    exact, which = _exact(*rays, *corners)
    wide = [np.ascontiguousarray(v, case.dtype) for v in (*rays, *corners)]
    return Rays(wide[0], wide[1], tuple(wide[2:]), exact, np.where(which == 0, 0.55, 0.8))


def _exact(o: Array, d: Array, a: Array, b: Array, c: Array) -> tuple[Array, Array]:
    """The distance of the nearest hit and which triangle it is of, decided exactly; -1 where there is none.

    All in double: numbers of single precision, whose differences it holds, and whose determinants it holds to more
    digits than their signs need but for a few, which are decided in rationals.
    """
    at = (a - o, b - o, c - o)
    signs = [_side(d, at[i], at[j], o, corners) for i, j, corners in ((0, 1, (a, b)), (1, 2, (b, c)), (2, 0, (c, a)))]
    ea, eb, ec = signs
    inside = ((ea >= 0) & (eb >= 0) & (ec >= 0)) | ((ea <= 0) & (eb <= 0) & (ec <= 0))
    inside &= (ea != 0) | (eb != 0) | (ec != 0)
    # In more than double, where there is more: else the techniques in double would be judged by their like.
    n = np.cross((b - a).astype(np.longdouble), (c - a).astype(np.longdouble))
    with np.errstate(divide="ignore", invalid="ignore"):
        t = np.where(inside, ((n * at[0]).sum(-1) / (n * d).sum(-1)).astype(np.float64), np.inf)
    t = np.where(t > 0, t, np.inf)
    nearest = t.min(-1)
    return np.where(np.isinf(nearest), -1.0, nearest), t.argmin(-1)


def _side(d: Array, a: Array, b: Array, o: Array, corners: tuple[Array, Array]) -> Array:
    """The sign of det(d, a, b), exactly: on which side of the edge the ray passes."""
    terms = d[..., [0, 1, 2, 0, 1, 2]] * a[..., [1, 2, 0, 2, 0, 1]] * b[..., [2, 0, 1, 1, 2, 0]]
    value = (terms[..., :3] - terms[..., 3:]).sum(-1)
    sign = np.sign(value)
    # Roundings of the differences, of two products a term, and of five sums.
    unsure = np.abs(value) <= 16 * np.finfo(np.float64).eps * np.abs(terms).sum(-1)
    for i in zip(*np.nonzero(unsure), strict=True):
        eye, ray = ([Fraction(x) for x in v[i].tolist()] for v in (o, d))
        u, v = ([Fraction(x) - e for x, e in zip(w[i].tolist(), eye, strict=True)] for w in corners)
        total = sum(ray[k] * (u[k - 2] * v[k - 1] - u[k - 1] * v[k - 2]) for k in range(3))
        sign[i] = (total > 0) - (total < 0)
    return np.asarray(sign)


def _run(method: Any) -> Callable[..., Array]:
    def run(inputs: Rays, prepared: Any, precision: str) -> Array:
        origins, directions, a, b, c = prepared
        return geometry.ray_triangle(origins, directions, a, b, c, method=method).t

    return run


_ABOUT = """A ray that passes the edge of two triangles must hit one of them. Tests that round each triangle by itself
let some rays through, and the sky shines through the wall. How many do, by distance and scale; how far is the distance
wrong where a hit is found; and what does a test cost? Each ray is tested against both triangles of a pair, at once and
without a tree. Half of the cases show the pair, the others a strip along its edge, 32 roundings wide."""

_TECHNIQUES = {
    "watertight": "Woop's test: edge functions in the ray's frame, with opposite signs for the two sides of an edge. "
    "Rays are decided alike for both triangles; the vertices are off by a few roundings of their distance, "
    "so outer borders move by as much.",
    "moller_trumbore": "Cramer's rule on the edges from the first vertex, each triangle rounded alone: "
    "rays slip between them.",
    "plane": "The point where the ray meets the plane, then its barycentrics: rounding the distance moves the point.",
}


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "ray triangle",
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
