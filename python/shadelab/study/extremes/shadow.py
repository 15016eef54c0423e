"""Extremes of `shadow`: grazing light, contact, filters wider than the map, far from the origin, any scale."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import shadow
from ..._arrays import Floats
from ...accel import BVH
from ...light import PointLight, RectLight
from ..stability import Measurement, extreme, ulps

_DOWN = [[1, 0, 0], [0, 0, -1], [0, -1, 0]]
_QUAD = [[0, 2, 1], [0, 3, 2]]


def _chart(depth: Any, dtype: np.dtype, side: float = 1.0) -> shadow.ShadowMap:
    """A map from 4 above the ground, downwards."""
    z = np.asarray(depth, dtype)
    return shadow.ShadowMap(z, "perspective", [0, 4, 0], _DOWN, [-side, side, -side, side], float(z.min()), 4.0)  # type: ignore[arg-type]


def _square(tilt: float, half: float = 3.0) -> tuple[Floats, Floats]:
    """A square turned about z, and its normal."""
    c, s = np.cos(tilt), np.sin(tilt)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])
    corners = np.array([[-half, 0, -half], [half, 0, -half], [half, 0, half], [-half, 0, half]])
    return corners @ turn.T, turn @ [0.0, 1.0, 0.0]


def _fractions(lit: Floats, expected: int) -> Measurement:
    """Counts what is no fraction at all; NaN and infinity are strays."""
    finite = np.isfinite(lit)
    outside = (lit[finite] < 0) | (lit[finite] > 1)
    return Measurement(float(outside.sum()), expected, int((~finite).sum()))


@extreme(
    "shadow.shadow_map",
    "depth of a plane under a light at 87 degrees",
    domain="texel centres, tilts of 0 to 1.5",
    unit="ulp",
    claim=8,
)
def _depth(dtype: np.dtype) -> Measurement:
    worst, cases = 0.0, 0
    for tilt in (0.0, 0.7, 1.4, 1.5):
        corners, _ = _square(tilt)
        corners = corners.astype(dtype)
        m = shadow.shadow_map(corners, _QUAD, PointLight((0.0, 4.0, 0.0)), 64)
        left, right, bottom, top = m.window
        x = left + (np.arange(64) + 0.5) / 64 * (right - left)
        y = top - (np.arange(64) + 0.5) / 64 * (top - bottom)
        rays = x[None, :, None] * m.frame[0] + y[:, None, None] * m.frame[1] + m.frame[2]
        # The plane through the corners as they were rounded.
        wide = corners.astype(np.float64)
        normal = np.cross(wide[1] - wide[0], wide[3] - wide[0])
        exact = ((wide[0] - m.position) @ normal) / (rays @ normal)
        drawn = np.isfinite(m.depth)
        worst = max(worst, float(ulps(m.depth[drawn], exact[drawn], dtype).max()))
        cases += int(drawn.sum())
    return Measurement(worst, cases)


def _acne(dtype: np.dtype, filtered: bool) -> Measurement:
    dark, cases = 0, 0
    rng = np.random.default_rng(1)
    for tilt in (0.0, 1.0, 1.5, 1.55, 1.569):
        corners, normal = _square(tilt)
        m = shadow.shadow_map(corners.astype(dtype), _QUAD, PointLight((0.0, 4.0, 0.0)), 256)
        w = rng.uniform(0.001, 0.999, (5000, 2))
        points = corners[0] + w[:, :1] * (corners[1] - corners[0]) + w[:, 1:] * (corners[3] - corners[0])
        f = shadow.pcf if filtered else shadow.hard
        knobs: dict[str, Any] = {"radius": 30.0} if filtered else {}
        dark += int((f(m, points, normal, **knobs) < 1).sum())
        cases += len(points)
    return Measurement(dark, cases)


@extreme("shadow.hard", "no acne at grazing light", domain="a lit plane, 0 to 89.9 degrees", unit="count", claim=0)
def _acne_hard(dtype: np.dtype) -> Measurement:
    return _acne(dtype, False)


@extreme("shadow.pcf", "no acne in wide filters", domain="30 texels, 0 to 89.9 degrees", unit="count", claim=0)
def _acne_pcf(dtype: np.dtype) -> Measurement:
    return _acne(dtype, True)


@extreme("shadow.hard", "a million units from the origin", domain="steps of 1/16 unit", unit="count", claim=0)
def _far(dtype: np.dtype) -> Measurement:
    at = 2.0**20
    ground = np.array([[-2, 0, -2], [2, 0, -2], [2, 0, 2], [-2, 0, 2]])
    roof = np.array([[-2, 2, -2], [0, 2, -2], [0, 2, 2], [-2, 2, 2]])
    positions = (np.concatenate([ground, roof]) + at).astype(dtype)
    m = shadow.shadow_map(positions, [*_QUAD, [4, 6, 5], [4, 7, 6]], PointLight((at, at + 4.0, at)), 256)
    # Half a texel about the shadow's edge is not asked for.
    x, z = np.meshgrid(np.arange(-30, 31) / 16, np.arange(-30, 31) / 16)
    points = (np.stack([x, 0 * x, z], -1)[np.abs(x) > 0.05] + at).astype(dtype)
    lit = shadow.hard(m, points, [0, 1, 0])
    return Measurement(float((lit != (x[np.abs(x) > 0.05] > 0)).sum()), lit.size)


@extreme("shadow.pcf", "filters wider than the map", domain="radius 1e-30 to 1e30, 1 texel", unit="count", claim=0)
def _wide(dtype: np.dtype) -> Measurement:
    points = np.random.default_rng(2).uniform(-1, 1, (200, 3)).astype(dtype)
    parts = [shadow.pcf(_chart([[2.0]], dtype), points, [0, 1, 0], radius=r) for r in (0.0, 1e-30, 1.0, 1e6, 1e30)]
    return _fractions(np.concatenate(parts), 1000)


@extreme("shadow.pcss", "the light in the receiver's plane", domain="cos = 0 ± 1e-7", unit="count", claim=0)
def _in_plane(dtype: np.dtype) -> Measurement:
    rng = np.random.default_rng(3)
    points = rng.uniform(-2, 2, (2000, 3))
    towards = np.array([0, 4, 0]) - points
    normals = np.cross(towards, rng.normal(size=(2000, 3)))
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    normals += rng.uniform(-1e-7, 1e-7, (2000, 1)) * towards
    m = _chart(np.where(np.indices((64, 64))[1] < 32, 2.0, 4.0), dtype)
    return _fractions(shadow.pcss(m, points, normals, light_size=1.0), 2000)


@extreme("shadow.pcss", "blockers that touch the receiver", domain="gaps of 0 to 1e-3", unit="count", claim=0)
def _contact(dtype: np.dtype) -> Measurement:
    gaps = np.array([0.0, np.finfo(dtype).eps, 1e-6, 1e-3])
    parts = []
    for gap in gaps:
        m = _chart(np.where(np.indices((64, 64))[1] < 32, 4.0 - 4.0 * gap, 4.0), dtype)
        x = np.linspace(-1, 1, 101)
        parts.append(shadow.pcss(m, np.stack([x, 0 * x, 0 * x], -1), [0, 1, 0], light_size=1.0))
    return _fractions(np.concatenate(parts), 404)


@extreme(
    "shadow.pcss", "penumbra by similar triangles", domain="blockers at 2^-10 to 1 - 2^-10 of 4", unit="ulp", claim=16
)
def _penumbra(dtype: np.dtype) -> Measurement:
    worst = 0.0
    depths = [4 * 2.0**-10, 0.1, 1.0, 2.0, 3.3, 4 - 4 * 2.0**-10]
    for d in depths:
        m = _chart(np.full((32, 32), d), dtype, 1e4)
        found = shadow.pcss(m, [[0.0, 0, 0]], [0, 1, 0], light_size=0.25, full_output=True)
        blocker = np.float64(dtype.type(d))
        worst = max(worst, float(ulps(found.penumbra, (4 - blocker) / blocker * 0.25, dtype).max()))
    return Measurement(worst, len(depths))


@extreme("shadow.ray_traced", "tiny and huge scenes", domain="scales of 1e-6 to 1e6", unit="absolute", claim=0.002)
def _scales(dtype: np.dtype) -> Measurement:
    worst, cases = 0.0, 0
    for scale in (1e-6, 1e-3, 1.0, 1e3, 1e6):
        roof = np.array([[-9.0, 2, -9], [0, 2, -9], [0, 2, 9], [-9, 2, 9]]) * scale
        side = 0.8 * scale
        lamp = RectLight((0, 4 * scale, 0), (side, 0, 0), (0, 0, side))
        x = np.linspace(-0.6, 0.6, 61)
        points = np.stack([x, 0 * x, 0 * x], -1) * scale
        lit = shadow.ray_traced(BVH(roof.astype(dtype), [[0, 1, 2], [0, 2, 3]]), points, None, lamp, 1024)
        worst = max(worst, float(np.abs(lit - np.clip(0.5 + x / 0.8, 0, 1)).max()))
        cases += len(x)
    return Measurement(worst, cases)
