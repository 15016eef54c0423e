"""Extremes of `accel`: every answer of the tree against brute force, closed meshes against escaping rays."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import accel
from ..stability import Measurement, extreme

Array = NDArray[Any]


def _against_brute_force(positions: Array, faces: Array, origins: Array, directions: Array, dtype: Any) -> Measurement:
    """Rays whose hit differs from brute force's in any bit, or whose any_hit disagrees."""
    p = positions.astype(dtype)
    o, d = origins.astype(dtype), directions.astype(dtype)
    bvh = accel.BVH(p, faces)
    hit, expected = bvh.closest_hit(o, d), accel.brute_force(p, faces, o, d)
    pairs = ((hit.t, expected.t), (hit.u, expected.u), (hit.v, expected.v), (hit.face, expected.face))
    bits = f"u{np.dtype(dtype).itemsize}"
    differs = np.zeros(o.shape[0], bool)
    for a, b in pairs:
        differs |= a.view(bits if a.dtype == dtype else "u4") != b.view(bits if b.dtype == dtype else "u4")
    differs |= bvh.any_hit(o, d) != (expected.face >= 0)
    if not (expected.face >= 0).any():
        raise AssertionError("the extreme tries nothing: no ray hits")
    return Measurement(float(differs.sum()), o.shape[0], int(np.isnan(hit.t).sum()))


def _triangles(rng: np.random.Generator, n: int, thin: float = 1.0) -> Array:
    """Triangles about a unit cloud, (n, 3, 3); `thin` is height over length."""
    centre, along, across = rng.normal(size=(3, n, 3))
    return np.stack(
        [centre, centre + 0.4 * along, centre + 0.4 * (rng.uniform(size=(n, 1)) * along + thin * across)], 1
    )


def _aimed(rng: np.random.Generator, triangles: Array, n: int, grazing: float = 1.0) -> tuple[Array, Array]:
    """Rays at points of triangles, leaving their planes by `grazing`."""
    t = triangles[rng.integers(len(triangles), size=n)]
    w = rng.dirichlet([1, 1, 1], n)
    goal = (w[..., None] * t).sum(1)
    along = np.einsum("nk,nkc->nc", rng.normal(size=(n, 2)), t[:, 1:] - t[:, :1])
    d = along * (1 - grazing) * 5 + grazing * rng.normal(size=(n, 3))
    return goal - 2 * d, d


def _soup(triangles: Array) -> tuple[Array, Array]:
    return triangles.reshape(-1, 3), np.arange(3 * len(triangles)).reshape(-1, 3)


@extreme("accel.BVH", "near-coplanar layers", domain="layers 1e-7 apart met at 1e-5", unit="count", claim=0)
def _layers(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(1)
    t = _triangles(rng, 600)
    t[:, :, 2] = 0.6 * t[:, :, 0] - 0.36 * t[:, :, 1] + rng.uniform(0, 2e-7, (600, 1))
    return _against_brute_force(*_soup(t), *_aimed(rng, t, 4000, 1e-5), dtype)


@extreme("accel.BVH", "slivers", domain="height 1e-6 of length", unit="count", claim=0)
def _slivers(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(2)
    t = _triangles(rng, 600, 1e-6)
    return _against_brute_force(*_soup(t), *_aimed(rng, t, 4000), dtype)


@extreme("accel.BVH", "far from the origin", domain="unit triangles 1e6 away", unit="count", claim=0)
def _far(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(3)
    t = _triangles(rng, 600)
    o, d = _aimed(rng, t, 4000)
    return _against_brute_force(_soup(t + 1e6)[0], _soup(t)[1], o + 1e6, d, dtype)


@extreme("accel.BVH", "directions of 1e-20 and 1e20", domain="lengths", unit="count", claim=0)
def _lengths(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(4)
    t = _triangles(rng, 600)
    o, d = _aimed(rng, t, 4000)
    d[::2] *= 1e-20
    d[1::2] *= 1e20
    return _against_brute_force(*_soup(t), o, d, dtype)


@extreme(
    "accel.BVH", "axis-parallel rays on planes", domain="lattice of boxes, rays in their planes", unit="count", claim=0
)
def _lattice(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(5)
    # Right triangles on the planes of an integer lattice; rays along its lines: zeros in every slab.
    corner = rng.integers(-3, 4, (600, 1, 3)).astype(float)
    axis = rng.integers(3, size=600)
    unit = np.eye(3)
    t = corner + np.stack([np.zeros((600, 3)), unit[(axis + 1) % 3], unit[(axis + 2) % 3]], 1)
    d = unit[rng.integers(3, size=4000)] * rng.choice([-1.0, 1.0], (4000, 1))
    return _against_brute_force(*_soup(t), rng.integers(-4, 5, (4000, 3)) * 1.0, d, dtype)


@extreme("accel.BVH", "equal centroids", domain="500 triangles about one point", unit="count", claim=0)
def _centroids(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(6)
    t = rng.integers(-8, 9, (500, 3, 3)).astype(float)
    # Boxes of one centre, to the bit: a third corner that mirrors the first.
    t[:, 2] = -t[:, 0]
    t[:, 1] = np.clip(t[:, 1], -np.abs(t[:, 0]), np.abs(t[:, 0]))
    o, d = rng.normal(size=(2, 4000, 3))
    return _against_brute_force(*_soup(t), 9 * o, d, dtype)


@extreme("accel.BVH", "nested scales", domain="sizes from 1 to 1e-9 about one point", unit="count", claim=0)
def _nested(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(7)
    t = _triangles(rng, 600) * 10.0 ** -rng.uniform(0, 9, (600, 1, 1))
    return _against_brute_force(*_soup(t), *_aimed(rng, t, 4000), dtype)


@extreme("accel.BVH", "copies of a triangle", domain="each of 20 triangles 30 times", unit="count", claim=0)
def _copies(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(8)
    t = np.tile(_triangles(rng, 20), (30, 1, 1))
    return _against_brute_force(*_soup(t), *_aimed(rng, t, 4000), dtype)


@extreme("accel.BVH", "nothing and one", domain="no triangle, and one", unit="count", claim=0)
def _smallest(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(9)
    t = _triangles(rng, 1)
    o, d = _aimed(rng, t, 1000)
    empty = accel.BVH(np.zeros((0, 3), dtype), np.zeros((0, 3), np.int32)).closest_hit(o, d)
    one = _against_brute_force(*_soup(t), o, d, dtype)
    return Measurement(one.error + float((empty.face != -1).sum()), 2000, one.strays + int((~np.isinf(empty.t)).sum()))


def _ball() -> tuple[Array, Array]:
    """A closed mesh around the origin: a crumpled UV ball with poles of high valence."""
    rows, columns = 24, 32
    theta = np.pi * np.arange(1, rows) / rows
    phi = 2 * np.pi * np.arange(columns) / columns
    rings = [
        np.sin(theta)[:, None] * np.cos(phi),
        np.sin(theta)[:, None] * np.sin(phi),
        np.cos(theta)[:, None] + 0 * phi,
    ]
    p = np.concatenate([np.stack(rings, -1).reshape(-1, 3), [[0, 0, 1], [0, 0, -1]]])
    p *= np.random.default_rng(0).uniform(0.7, 1.0, (len(p), 1))
    i, j = np.meshgrid(np.arange(rows - 2), np.arange(columns), indexing="ij")
    a, b = i * columns + j, i * columns + (j + 1) % columns
    quads = [np.stack([a, a + columns, b + columns], -1), np.stack([a, b + columns, b], -1)]
    k = np.arange(columns)
    last, n = (rows - 2) * columns, len(p)
    top = np.stack([np.full(columns, n - 2), k, (k + 1) % columns], -1)
    bottom = np.stack([np.full(columns, n - 1), last + (k + 1) % columns, last + k], -1)
    return p, np.concatenate([quads[0].reshape(-1, 3), quads[1].reshape(-1, 3), top, bottom])


def _leaks(dtype: Any, scale: float, shift: float) -> Measurement:
    rng = np.random.default_rng(10)
    p, f = _ball()
    p = (p * scale + shift).astype(dtype)
    n = 60_000
    face, k = rng.integers(len(f), size=n), rng.integers(3, size=n)
    a, b = p[f[face, k]].astype(np.float64), p[f[face, (k + 1) % 3]].astype(np.float64)
    w = np.where(np.arange(n) % 4 == 0, 0, rng.uniform(size=n))[:, None]
    o = (0.2 * scale * rng.uniform(-1, 1, (n, 3)) + shift).astype(dtype)
    hit = accel.BVH(p, f).closest_hit(o, (a + w * (b - a) - o).astype(dtype))
    return Measurement(float((hit.face < 0).sum()), n, int(np.isnan(hit.t).sum()))


@extreme("accel.BVH", "leaks at edges and vertices", domain="closed unit mesh", unit="count", claim=0)
def _leaks_near(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 1.0, 0.0)


@extreme("accel.BVH", "leaks 1e6 from the origin", domain="closed mesh of size 100", unit="count", claim=0)
def _leaks_far(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 100.0, 1e6)


@extreme("accel.BVH", "leaks at 1e-12", domain="closed mesh of size 1e-12", unit="count", claim=0)
def _leaks_tiny(dtype: np.dtype[Any]) -> Measurement:
    return _leaks(dtype, 1e-12, 0.0)


@extreme(
    "accel.brute_force",
    "t at grazing rays",
    domain="sine 1e-3",
    unit="relative",
    claim={"float32": 2e-4, "float64": 4e-13},
)
def _grazing(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(11)
    t = _triangles(rng, 2000).astype(dtype)
    normal = np.cross(t[:, 1] - t[:, 0], t[:, 2] - t[:, 0]).astype(np.longdouble)
    keep = np.linalg.norm(normal.astype(float), axis=-1) > 0.02
    t, normal = t[keep], normal[keep]
    along = (t[:, 1] - t[:, 0]).astype(float)
    along /= np.linalg.norm(along, axis=-1, keepdims=True)
    unit = (normal / np.sqrt((normal**2).sum(-1, keepdims=True))).astype(float)
    d = (along + 1e-3 * unit).astype(dtype)
    o = (t.mean(1) - 2.0 * d).astype(dtype)
    # One triangle, one ray: as many meshes.
    error, cases = 0.0, 0
    for i in range(0, len(t), 8):
        hit = accel.brute_force(t[i], [[0, 1, 2]], o[i], d[i])
        if np.isfinite(hit.t):
            wide = [x.astype(np.longdouble) for x in (o[i], d[i], t[i, 0])]
            n = np.cross(t[i, 1].astype(np.longdouble) - wide[2], t[i, 2].astype(np.longdouble) - wide[2])
            exact = (n * (wide[2] - wide[0])).sum() / (n * wide[1]).sum()
            error, cases = max(error, float(abs(hit.t - exact) / exact)), cases + 1
    return Measurement(error, cases)


@extreme(
    "accel.offset_ray", "own face met", domain="sizes 1e-6 to 100 at 0 to 1e6, angles from 1e-7", unit="count", claim=0
)
def _offset(dtype: np.dtype[Any]) -> Measurement:
    rng = np.random.default_rng(12)
    met = cases = 0
    for scale, shift in ((1.0, 0.0), (1e-6, 0.0), (1.0, 1e3), (100.0, 1e6)):
        turns = np.linalg.qr(rng.normal(size=(200, 3, 3)))[0]
        corners = np.array([[0, 0, 0], [1, 0.1, 0], [0.2, 0.9, 0]]) @ turns + rng.normal(size=(200, 1, 3))
        p = (scale * corners + shift).reshape(-1, 3).astype(dtype)
        f = np.arange(600).reshape(-1, 3)
        face = rng.integers(200, size=5000)
        a, b, c = (p[f[face, k]] for k in range(3))
        w = rng.dirichlet([0.5, 0.5, 0.5], 5000).astype(dtype)
        points = (1 - w[:, :1] - w[:, 1:2]) * a + w[:, :1] * b + w[:, 1:2] * c
        n = np.cross((b - a).astype(float), (c - a).astype(float))
        n /= np.linalg.norm(n, axis=-1, keepdims=True)
        along = (b - a).astype(float) * rng.normal(size=(5000, 1)) + (c - a) * rng.normal(size=(5000, 1))
        along /= np.linalg.norm(along, axis=-1, keepdims=True)
        d = (along + 10.0 ** rng.uniform(-7, 0, (5000, 1)) * n).astype(dtype)
        extent = np.abs(p[f[face]]).max((1, 2))
        o = accel.offset_ray(points, n.astype(dtype), d, extent=extent)
        met += int((accel.BVH(p, f).closest_hit(o, d).face == face).sum())
        cases += 5000
    return Measurement(float(met), cases)


from . import accel_queries  # noqa: E402, F401  (registers)
