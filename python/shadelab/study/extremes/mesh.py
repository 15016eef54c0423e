"""Extremes of normals and primitives."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import mesh
from ..stability import Measurement, extreme

_ANY = np.dtype[Any]


def _units(error: Any, dtype: _ANY, cases: int) -> Measurement:
    """The largest of absolute errors in rounding units (eps) of the precision; what is not finite is a stray."""
    error = np.asarray(error, np.float64)
    finite = np.isfinite(error)
    return Measurement(float(error[finite].max(initial=0) / np.finfo(dtype).eps), cases, int(error.size - finite.sum()))


def _exact(a: NDArray[Any], b: NDArray[Any], c: NDArray[Any]) -> NDArray[Any]:
    """Unit normals in long double, of edges taken exactly."""
    a, b, c = (v.astype(np.longdouble) for v in (a, b, c))
    n = np.cross(b - a, c - a)
    return np.asarray(n / np.sqrt((n**2).sum(-1, keepdims=True)))


@extreme("mesh.face_normals", "slivers: error x height / base", domain="height / base 1e-6 .. 1", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(1)
    a, direction = rng.normal(size=(2, 500, 3))
    direction /= np.linalg.norm(direction, axis=-1, keepdims=True)
    across = np.cross(direction, rng.normal(size=(500, 3)))
    across /= np.linalg.norm(across, axis=-1, keepdims=True)
    thin = np.geomspace(1e-6 if dtype == np.float64 else 1e-4, 1, 500)[:, None]
    corners = [
        v.astype(dtype) for v in (a, a + direction, a + direction * rng.uniform(0.2, 0.8, (500, 1)) + thin * across)
    ]
    p = np.stack(corners, 1).reshape(-1, 3)
    got = mesh.face_normals(p, np.arange(1500).reshape(-1, 3))
    return _units(np.abs(got - _exact(*corners)).max(-1) * thin[:, 0], dtype, 500)


@extreme("mesh.face_normals", "sizes 1e-30 to 1e30", domain="all finite", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    rng = np.random.default_rng(2)
    corners = rng.normal(size=(3, 400, 3))
    # Not thin: the scale alone is tried.
    normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
    corners = corners[:, np.linalg.norm(normal, axis=-1) > 1.5]
    count = corners.shape[1]
    corners = (corners * np.geomspace(1e-30, 1e30, count)[:, None]).astype(dtype)
    got = mesh.face_normals(corners.swapaxes(0, 1).reshape(-1, 3), np.arange(3 * count).reshape(-1, 3))
    return _units(np.abs(got - _exact(*corners)).max(-1), dtype, count)


@extreme("mesh.face_normals", "no area: NaN, neighbours right", domain="all", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    p = np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [0, 1, 0]], dtype)
    faces = np.array([[0, 0, 0], [0, 1, 2], [0, 1, 3], [1, 1, 3], [0, 3, 1]])
    got = mesh.face_normals(p, faces)
    wrong = np.isnan(got).all(-1) != [True, True, False, True, False]
    return Measurement(float(wrong.sum() + (got[2, 2] != 1) + (got[4, 2] != -1)), 5)


def _fan(valence: int, dtype: _ANY) -> tuple[NDArray[Any], NDArray[Any]]:
    """A cone of unequal slices around vertex 0, closed."""
    rng = np.random.default_rng(valence)
    angle = np.sort(rng.uniform(0, 2 * np.pi, valence))
    rim = np.stack([np.cos(angle), np.full(valence, -0.5), np.sin(angle)], -1)
    ring = np.arange(1, valence + 1)
    return np.concatenate([[[0, 0, 0]], rim]).astype(dtype), np.stack([0 * ring, np.roll(ring, -1), ring], -1)


@extreme("mesh.vertex_normals", "valence 3, 300 and 30000, three weights", domain="all", unit="eps", claim=5)
def _(dtype: _ANY) -> Measurement:
    worst: list[float] = []
    weights: tuple[Any, ...] = ("angle", "area", "uniform")
    for valence in (3, 300, 30000):
        p, faces = _fan(valence, dtype)
        corners = p.astype(np.longdouble)[faces]
        e, f = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        n = np.cross(e, f)
        area = np.sqrt((n**2).sum(-1))
        angle = np.arctan2(area, (e * f).sum(-1))
        solid = area > 0
        unit = n[solid] / area[solid, None]
        for kind, share in zip(weights, (angle[solid], area[solid], np.ones(solid.sum())), strict=True):
            exact = (share[:, None] * unit).sum(0)
            exact /= np.sqrt((exact**2).sum())
            # A thin slice's own normal errs by eps over its angle, in which its weight is proportional but for uniform.
            slack = 1.0 if kind != "uniform" else max(1.0, float((1 / angle[solid]).mean()))
            worst.append(float(np.abs(mesh.vertex_normals(p, faces, weights=kind)[0] - exact).max()) / slack)
    return _units(worst, dtype, 9)


@extreme("mesh.vertex_normals", "isolated, non-manifold, doubled faces", domain="all", unit="count", claim=0)
def _(dtype: _ANY) -> Measurement:
    p = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, -1, 0], [0, 0, 1], [9, 9, 9]], dtype)
    # Three faces at one edge, one of them twice; vertex 5 alone; one face of no area.
    faces = np.array([[0, 1, 2], [0, 3, 1], [0, 1, 4], [0, 1, 4], [0, 0, 1]])
    got = mesh.vertex_normals(p, faces, weights="uniform")
    expected = np.array([[0, -1, 1], [0, -1, 1], [0, 0, 1], [0, 0, 1], [0, -1, 0], [np.nan] * 3])
    expected /= np.linalg.norm(expected, axis=-1, keepdims=True)
    close = np.isclose(got, expected, rtol=0, atol=4 * np.finfo(dtype).eps, equal_nan=True)
    return Measurement(float((~close).sum()), 18)


@extreme("mesh.icosphere", "vertices on the sphere", domain="radius 1e-30 .. 1e30", unit="eps", claim=2)
def _(dtype: _ANY) -> Measurement:
    worst = []
    for radius in (1e-30, 1.0, 1e30):
        p = mesh.icosphere(5, radius, dtype=dtype).positions.astype(np.longdouble)
        worst.append(float(np.abs(np.sqrt((p**2).sum(-1)) / np.longdouble(dtype.type(radius)) - 1).max()))
    return _units(worst, dtype, 3)
