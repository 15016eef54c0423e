"""Extremes of `shadow`: exact shares and distance fields at any scale, in contact, edge-on."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import shadow
from ...light import RectLight
from ..stability import Measurement, extreme


def _light(height: float, side: float) -> RectLight:
    return RectLight((0.0, height, 0.0), (side, 0.0, 0.0), (0.0, 0.0, side))


@extreme(
    "shadow.half_plane",
    "tiny and huge scenes, thin and wide penumbrae",
    domain="scales 1e-6 to 1e6, occluders at 0.001 to 0.999 of the light's height",
    unit="absolute",
    claim={"float32": 1e-7, "float64": 1e-12},
)
def _half_plane(dtype: np.dtype) -> Measurement:
    """Against similar triangles; receivers' rounding counts over the width of the penumbra."""
    worst, cases, bad = 0.0, 0, 0
    for scale in (1e-6, 1.0, 1e6):
        for height in (0.001, 0.1, 0.5, 0.999):
            width = height / (1 - height) * scale
            x = (np.linspace(-0.6, 0.6, 121) * width).astype(dtype)
            points = np.stack([x, 0 * x, 0 * x], -1)
            edge: Any = [[0.0, height * scale, 0.0], [0, 0, 1], [-1, 0, 0]]
            lit = shadow.half_plane(points, None, _light(scale, scale), edge)
            exact = np.clip(0.5 + x.astype(np.float64) / width, 0, 1)
            worst, cases = max(worst, float(np.abs(lit - exact).max())), cases + len(x)
            bad += int((~np.isfinite(lit)).sum())
    return Measurement(worst, cases, bad)


@extreme("shadow.half_plane", "occluders through receivers and lights", domain="any", unit="count", claim=0)
def _degenerate(dtype: np.dtype) -> Measurement:
    """Shares outside of [0, 1], or none, where planes pass through receivers, the light lies edge-on or below."""
    rng = np.random.default_rng(5)
    points = rng.integers(-2, 3, (4000, 3)).astype(dtype)
    normals = rng.integers(-1, 2, (4000, 3)).astype(dtype)
    normals[~normals.any(-1)] = [0, 1, 0]
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    edges = [[[0, 1, 0], [0, 0, 1], [-1, 0, 0]], [[0, 2, 0], [1, 0, 0], [0, 1, 0]], [[1, 0, 1], [0, 0, 1], [0, 1, 1]]]
    wrong = 0
    for n in (None, normals):
        lit = shadow.half_plane(points, n, _light(2.0, 2.0), edges)
        wrong += int((~((lit >= 0) & (lit <= 1))).sum())
    return Measurement(wrong, 2 * len(points))


@extreme(
    "shadow.distance_field",
    "tiny and huge scenes",
    domain="scales 1e-6 to 1e6",
    unit="absolute",
    claim={"float32": 1e-5, "float64": 1e-12},
)
def _scales(dtype: np.dtype) -> Measurement:
    """One ball's shadow at several scales against that at scale 1."""
    x = np.linspace(-1.5, 1.5, 61)
    flat = np.stack([*np.meshgrid(x, x)], -1)
    points = np.stack([flat[..., 0], 0 * flat[..., 0], flat[..., 1]], -1)

    def at(scale: float) -> np.ndarray:
        def ball(p: np.ndarray) -> np.ndarray:
            return np.asarray(np.linalg.norm(p - np.array([0.0, 1.5 * scale, 0.0]), axis=-1) - 0.5 * scale)

        box = np.array([(-2.0, -0.25, -2.0), (2.0, 3.75, 2.0)]) * scale
        grid = shadow.distance_grid(ball, box, resolution=24, dtype=dtype)
        given = (points * scale).astype(dtype)
        return np.asarray(shadow.distance_field(grid, given, [0.0, 1.0, 0.0], _light(4.0 * scale, 0.6 * scale)))

    one = at(1.0)
    found = [at(s) for s in (1e-6, 1e6)]
    bad = sum(int((~np.isfinite(f)).sum()) for f in found)
    return Measurement(max(float(np.abs(f - one).max()) for f in found), 2 * one.size, bad)


@extreme("shadow.distance_field", "receivers in contact and within things", domain="any", unit="count", claim=0)
def _contact(dtype: np.dtype) -> Measurement:
    """Fractions outside of [0, 1] for receivers on and in a ball, at the light, and beyond the grid."""
    grid = shadow.distance_grid(
        lambda p: np.linalg.norm(p, axis=-1) - 0.5, [(-1, -1, -1), (1, 1, 1)], resolution=16, dtype=dtype
    )
    rng = np.random.default_rng(3)
    points = rng.normal(size=(4000, 3))
    points *= rng.choice([0.0, 0.25, 0.5, 0.5000001, 1.0, 1e3], (4000, 1)) / np.linalg.norm(points, axis=-1)[:, None]
    points[:10] = [0.0, 2.0, 0.0]
    wrong = 0
    for normals in (None, [0.0, 1.0, 0.0]):
        for how in ("centered", "outer"):
            lit = shadow.distance_field(grid, points.astype(dtype), normals, _light(2.0, 1.0), penumbra=how)
            wrong += int((~((lit >= 0) & (lit <= 1))).sum())
    return Measurement(wrong, 4 * len(points))
