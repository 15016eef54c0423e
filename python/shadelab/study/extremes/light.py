"""Extremes of `light`: horizons, tiny and enormous lights, points on the light and below its plane."""

from __future__ import annotations

import mpmath
import numpy as np

from ... import light
from ...light import DirectionalLight, PointLight, RectLight
from ..stability import Measurement, extreme


def _facing(half_x: float, half_z: float, height: float) -> mpmath.mpf:
    """Irradiance of unit radiance from a rectangle overhead, edges along the axes: Lambert's formula by hand."""
    a, b = mpmath.mpf(half_x) / height, mpmath.mpf(half_z) / height
    ra, rb = mpmath.sqrt(1 + a * a), mpmath.sqrt(1 + b * b)
    return 2 * (a / ra * mpmath.atan(b / ra) + b / rb * mpmath.atan(a / rb))


def _upright(a: float, b: float, c: float) -> mpmath.mpf:
    """Irradiance from a rectangle that stands on the receiver's plane: width a, height b, distance c."""
    x, y = mpmath.mpf(b) / mpmath.mpf(a), mpmath.mpf(c) / mpmath.mpf(a)
    r = mpmath.sqrt(x * x + y * y)
    return (mpmath.atan(1 / y) - y / r * mpmath.atan(1 / r)) / 2


@extreme(
    "light.irradiance",
    "rectangle overhead, 1e-3 … 1e6 of its distance",
    domain="half edges 1e-3 … 1e6, height 1",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 1e-9},
)
def _overhead(dtype: np.dtype) -> Measurement:
    error, cases, strays = 0.0, 0, 0
    up, origin = np.array([0, 1, 0], dtype), np.zeros(3, dtype)
    with mpmath.workdps(40):
        for x in (2.0**-10, 2.0**-4, 1.0, 2.0**7, 2.0**20):
            for z in (2.0**-10, 1.0, 2.0**20):
                got = light.irradiance(RectLight((0, 1, 0), (2 * x, 0, 0), (0, 0, 2 * z)), origin, up)[0]
                error = max(error, float(abs(mpmath.mpf(float(got)) / _facing(x, z, 1) - 1)))
                cases, strays = cases + 1, strays + int(not np.isfinite(got))
    return Measurement(error, cases, strays)


@extreme(
    "light.irradiance",
    "rectangle that crosses the horizon",
    domain="an upright rectangle half below the receiver's plane, 1e-3 … 1e3 of its distance",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 1e-9},
)
def _horizon(dtype: np.dtype) -> Measurement:
    error, cases, strays = 0.0, 0, 0
    up, origin = np.array([0, 1, 0], dtype), np.zeros(3, dtype)
    with mpmath.workdps(40):
        for width in (2.0**-10, 1.0, 2.0**10):
            for height in (2.0**-10, 1.0, 2.0**10):
                # Twice the upper half, from the foot of one edge to both sides.
                rect = RectLight((0, 0, -1), (2 * width, 0, 0), (0, 2 * height, 0))
                got = light.irradiance(rect, origin, up)[0]
                exact = 2 * _upright(width, height, 1)
                error = max(error, float(abs(mpmath.mpf(float(got)) / exact - 1)))
                cases, strays = cases + 1, strays + int(not np.isfinite(got))
    return Measurement(error, cases, strays)


@extreme(
    "light.irradiance",
    "on the light, in its plane, behind it",
    domain="points on corners, edges, inside, on the plane's continuation, below; all lights",
    unit="count",
    claim=0,
)
def _on_the_light(dtype: np.dtype) -> Measurement:
    rect = RectLight((0, 1, 0), (2, 0, 0), (0, 0, 2))
    points = [[0, 1, 0], [1, 1, 0], [1, 1, 1], [5, 1, 5], [0, 2, 0], [1, 1.5, 1]]
    normals = np.array([[0, 1, 0], [0, -1, 0], [0.6, 0.8, 0]], dtype)[:, None]
    got = [light.irradiance(rect, np.array(points, dtype), normals)]
    got.append(light.irradiance(PointLight((0, 1, 0)), np.array([[0, 1, 0]], dtype), normals))
    got.append(light.irradiance(DirectionalLight((0, 0, 1e-30)), np.array([[0, 1, 0]], dtype), normals))
    values = np.concatenate([g.ravel() for g in got])
    return Measurement(int((values != 0).sum()), values.size, int((~np.isfinite(values)).sum()))


@extreme(
    "light.irradiance",
    "one part in 1e6 above a large light",
    domain="heights 1e-1 … 1e-6 over the middle of a unit rectangle; π is the limit",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 1e-14},
)
def _close(dtype: np.dtype) -> Measurement:
    heights = np.array([2.0**-k for k in (3, 6, 10, 16, 20)], dtype)
    rect = RectLight((0, 0, 0), (0, 0, 1), (1, 0, 0))
    points = np.stack([0 * heights, heights, 0 * heights], -1)
    got = light.irradiance(rect, points, np.array([0, -1, 0], dtype))[:, 0]
    with mpmath.workdps(40):
        exact = [_facing(0.5, 0.5, float(h)) for h in heights]
        error = max(float(abs(mpmath.mpf(float(g)) / e - 1)) for g, e in zip(got, exact, strict=True))
    return Measurement(error, len(got), int((~np.isfinite(got)).sum()))


@extreme(
    "light.light_sample",
    "seen edge-on, from its plane, from behind, from itself",
    domain="heights 0, ±1e-7, ±1 about the light's plane; u at the ends of the square; wrong signs and NaN are counted",
    unit="count",
    claim=0,
)
def _edge_on(dtype: np.dtype) -> Measurement:
    rect = RectLight((0, 0, 0), (0, 0, 1), (1, 0, 0))
    ends = np.array([0, 0.5, 1 - np.finfo(dtype).eps / 2], dtype)
    u = np.stack(np.meshgrid(ends, ends), -1).reshape(-1, 2)
    heights = np.array([0, 1e-7, -1e-7, 1, -1], dtype)
    points = np.stack([0 * heights + dtype.type(3), heights, 0 * heights], -1)[:, None]
    sample = light.light_sample(rect, points, u)
    front = np.broadcast_to(heights[:, None] > 0, sample.pdf.shape)
    wrong = int(((sample.pdf > 0) != front).sum())
    return Measurement(wrong, sample.pdf.size, int((~np.isfinite(sample.pdf)).sum()))


@extreme(
    "light.unshadowed",
    "grazing, edge-on and mirror-like",
    domain="roughness 0 and 1 under all lights at cosines 1 … 1e-7; values that are negative or not finite",
    unit="count",
    claim=0,
)
def _grazing(dtype: np.dtype) -> Measurement:
    cosine = np.array([1, 0.5, 1e-3, 1e-7, 0], dtype)
    wo = np.stack([np.sqrt(1 - cosine**2), cosine, 0 * cosine], -1)[:, None]
    lights: list[light.Light] = [
        PointLight((-5, 1e-6, 0)),
        DirectionalLight((1, -1e-7, 0)),
        RectLight((-1, 0, 0), (0, 2, 0), (0, 0, 2)),
        RectLight((0, 1e-6, 0), (1, 0, 0), (0, 0, 1)),
    ]
    rough = np.array([0, 0.01, 1], dtype)
    up = np.array([0, 1, 0], dtype)
    got = light.unshadowed(
        lights,
        np.zeros(3, dtype),
        up,
        np.ones((5, 3, 3), dtype),
        0.5,
        rough + np.zeros((5, 1), dtype),
        wo=wo + 0 * rough[:, None],
    )
    return Measurement(int((got < 0).sum()), got.size, int((~np.isfinite(got)).sum()))
