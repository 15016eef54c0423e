"""Extremes of area lights and spots: points on them and in their planes, sizes to 1e6, cones of 0 and π, horizons."""

from __future__ import annotations

import math

import mpmath
import numpy as np

from ... import light
from ...light import DiskLight, PolygonLight, RectLight, SphereLight, SpotLight
from ..stability import Measurement, extreme


@extreme(
    "light.irradiance",
    "disk overhead, 1e-6 … 1e6 of its distance",
    domain="radii 2^-20 … 2^20, height 1, on the axis",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 1e-15},
)
def _disk(dtype: np.dtype) -> Measurement:
    error, cases = 0.0, 0
    up, origin = np.array([0, 1, 0], dtype), np.zeros(3, dtype)
    with mpmath.workdps(40):
        for k in range(-20, 21, 4):
            r = 2.0**k
            got = light.irradiance(DiskLight((0, 1, 0), (0, -1, 0), r), origin, up)[0]
            exact = mpmath.pi * mpmath.mpf(r) ** 2 / (1 + mpmath.mpf(r) ** 2)
            error, cases = max(error, float(abs(mpmath.mpf(float(got)) / exact - 1))), cases + 1
    return Measurement(error, cases, 0)


@extreme(
    "light.irradiance",
    "sphere that is cut by the horizon, from touching to 1e6 away",
    domain="distances 1 + 2^-20 … 2^20 radii, centre in the receiver's plane; over what a facing receiver gets",
    unit="relative",
    claim={"float32": 5e-8, "float64": 1e-10},
)
def _sphere(dtype: np.dtype) -> Measurement:
    error, cases, strays = 0.0, 0, 0
    up = np.array([0, 1, 0], dtype)
    with mpmath.workdps(40):
        for h in (1 + 2.0**-20, 1 + 2.0**-8, 1.5, 2.0**4, 2.0**12, 2.0**20):
            got = float(light.irradiance(SphereLight((h, 0, 0), 1.0), np.zeros(3, dtype), up)[0])
            x = mpmath.sqrt(mpmath.mpf(h) ** 2 - 1)
            # Snyder's closed form at a right angle, with y = 0.
            exact = mpmath.atan(1 / x) - x / mpmath.mpf(h) ** 2
            facing = mpmath.pi / mpmath.mpf(h) ** 2
            error, cases = max(error, float(abs(mpmath.mpf(got) - exact) / facing)), cases + 1
            strays += int(not np.isfinite(got))
    return Measurement(error, cases, strays)


@extreme(
    "light.irradiance",
    "on area lights, in their planes, within, behind",
    domain="disk, sphere, polygon: points on rims, corners, middles, in the planes, beyond; wrong ones counted",
    unit="count",
    claim=0,
)
def _on_areas(dtype: np.dtype) -> Measurement:
    points = np.array([[0, 1, 0], [1, 1, 0], [0.6, 1, 0.8], [5, 1, 5], [0, 2, 0], [0, 1.5, 0]], dtype)
    normals = np.array([[0, 1, 0], [0, -1, 0], [0.6, 0.8, 0]], dtype)[:, None]
    square = PolygonLight([[-1, 1, -1], [1, 1, -1], [1, 1, 1], [-1, 1, 1]])
    dark = [light.irradiance(lamp, points, normals) for lamp in (DiskLight((0, 1, 0), (0, -1, 0), 1.0), square)]
    within = light.irradiance(SphereLight((0, 1, 0), 3.0), points[[0, 1, 4, 5]], normals)
    values = np.concatenate([v.ravel() for v in (*dark, within)])
    return Measurement(int((values != 0).sum()), values.size, int((~np.isfinite(values)).sum()))


@extreme(
    "light.irradiance",
    "spots of 0 and π, and hard ones",
    domain="outer angles 0, 1e-6, π; inner equal or zero; on and off the axis; wrong values are counted",
    unit="count",
    claim=0,
)
def _spots(dtype: np.dtype) -> Measurement:
    points = np.array([[0, -1, 0], [0, 1, 0], [1, 0, 0]], dtype)
    toward = -points
    full = light.irradiance(SpotLight((0, 0, 0), (0, -1, 0), inner_angle=math.pi, outer_angle=math.pi), points, toward)
    ray = light.irradiance(SpotLight((0, 0, 0), (0, -1, 0), outer_angle=0.0), points, toward)
    narrow = light.irradiance(SpotLight((0, 0, 0), (0, -1, 0), outer_angle=1e-6), points, toward)
    smooth = light.irradiance(SpotLight((0, 0, 0), (0, -1, 0), outer_angle=math.pi), points, toward)
    expected = np.array([[1, 1, 1], [1, 0, 0], [1, 0, 0], [1, 0, 0.5]], dtype)
    got = np.stack([v[:, 0] for v in (full, ray, narrow, smooth)])
    wrong = np.abs(got - expected) > 4 * np.finfo(dtype).eps
    return Measurement(int(wrong.sum()), got.size, int((~np.isfinite(got)).sum()))


@extreme(
    "light.light_sample",
    "tiny, far, touching, from within",
    domain="spheres, disks, polygons of 1e-6 … 1e6, at surfaces and centres; ends of the square; bad draws counted",
    unit="count",
    claim=0,
)
def _draws(dtype: np.dtype) -> Measurement:
    ends = np.array([0, 0.5, 1 - np.finfo(dtype).eps / 2], dtype)
    u = np.stack(np.meshgrid(ends, ends), -1).reshape(-1, 2)
    bad = cases = strays = 0
    for size in (1e-6, 1.0, 1e6):
        corners = np.array([[-1, 0, -1], [1, 0, -1], [0, 0, 1]]) * size
        rect = RectLight((0, 0, 0), (2 * size, 0, 0), (0, 0, 2 * size), two_sided=True)
        sphere = SphereLight((0, 0, 0), size)
        lamps = [sphere, DiskLight((0, 0, 0), (0, 1, 0), size), PolygonLight(corners, two_sided=True), rect]
        for y in (0.0, 0.5, 1.0, 1.0 + 1e-5, 1e3):
            for lamp in lamps:
                for method in ("area", "solid_angle"):
                    at = np.array([0, y * size, 0], dtype)
                    wi, distance, pdf = light.light_sample(lamp, at, u, method=method)  # type: ignore[arg-type]
                    lengths = np.abs(np.linalg.norm(wi, axis=-1) - 1) < 1e-5
                    bad += int((((pdf > 0) != lengths) | (pdf < 0) | (distance < 0)).sum())
                    strays += int((~np.isfinite(wi).all(-1) | ~np.isfinite(pdf)).sum())
                    cases += pdf.size
    return Measurement(bad, cases, strays)


@extreme(
    "light.solid_angle",
    "triangles and spheres of 1e-6 … 1e6 of their distance",
    domain="an octant's triangle and a sphere, scaled by powers of two",
    unit="relative",
    claim={"float32": 1.2e-7, "float64": 1e-15},
)
def _solid_angles(dtype: np.dtype) -> Measurement:
    error, cases = 0.0, 0
    with mpmath.workdps(50):
        for k in range(-20, 21, 5):
            s = 2.0**k
            a, b, c = (np.array(v, dtype) for v in ((-s, -s, 1), (s, -s, 1), (0, s, 1)))
            got = float(light.solid_angle("triangle", np.zeros(3, dtype), a, b, c))
            v = [[mpmath.mpf(float(x)) for x in p] for p in (a, b, c)]
            la, lb, lc = (mpmath.sqrt(sum(x * x for x in p)) for p in v)
            ab, bc, ca = (sum(x * y for x, y in zip(v[i], v[j], strict=True)) for i, j in ((0, 1), (1, 2), (2, 0)))
            exact = 2 * mpmath.atan2(abs(mpmath.det(mpmath.matrix(v))), la * lb * lc + ab * lc + bc * la + ca * lb)
            error, cases = max(error, float(abs(mpmath.mpf(got) / exact - 1))), cases + 1
            if k <= 0:
                r = s / 2
                got = float(light.solid_angle("sphere", np.zeros(3, dtype), np.array([0, 1, 0], dtype), dtype.type(r)))
                exact = 2 * mpmath.pi * (1 - mpmath.sqrt(1 - mpmath.mpf(r) ** 2))
                error, cases = max(error, float(abs(mpmath.mpf(got) / exact - 1))), cases + 1
    return Measurement(error, cases, 0)


@extreme(
    "light.ltc",
    "sharp, grazing, on the light, in its plane, lights of 1e6",
    domain="alpha 1e-8 … 1, cosines 1 … 1e-7; values that are negative, above the light's, or not finite are counted",
    unit="count",
    claim=0,
)
def _ltc(dtype: np.dtype) -> Measurement:
    cosine = np.array([1, 0.5, 1e-3, 1e-7], dtype)
    wo = np.stack([np.sqrt(1 - cosine**2), cosine, 0 * cosine], -1)[:, None]
    alpha = np.array([1e-8, 1e-4, 1e-2, 0.3, 1], dtype)
    up = np.array([0, 1, 0], dtype)
    lamps: list[RectLight | SphereLight | DiskLight] = [
        RectLight((-1, 0, 0), (0, 2, 0), (0, 0, 2)),
        RectLight((0, 1e-6, 0), (1, 0, 0), (0, 0, 1)),
        RectLight((0, 1, 0), (2e6, 0, 0), (0, 0, 2e6)),
        RectLight((0, 0, 0), (1, 0, 0), (0, 0, 1)),
        SphereLight((0, 1e-3, 0), 1.0),
        DiskLight((0, 0, -1), (0, 0, 1), 1e6),
    ]
    got = np.stack([light.ltc(lamp, np.zeros(3, dtype), up, wo, alpha) for lamp in lamps])
    wrong = (got < 0) | (got > 1.01)
    return Measurement(int(wrong.sum()), got.size, int((~np.isfinite(got)).sum()))


@extreme(
    "light.irradiance",
    "one bright texel of a black picture, 1e-3 … 1e6 of its size away",
    domain="an 8 × 8 picture with one texel of 1e6; against that texel as a light in double; cosines to 1e-3",
    unit="relative",
    claim={"float32": 1e-7, "float64": 1e-9},
)
def _texel(dtype: np.dtype) -> Measurement:
    error, cases, strays = 0.0, 0, 0
    texture = np.zeros((8, 8))
    texture[2, 5] = 1e6
    for k in range(-10, 21, 3):
        height = 2.0**k
        screen = RectLight((0, height, 0), (2, 0, 0), (0, 0, 2), texture=texture)
        # Seen from the front, below, with z up: columns go along x, rows against z.
        own = RectLight((0.375, height, 0.375), (0.25, 0, 0), (0, 0, 0.25), (1e6,) * 3)
        points = np.array([[0.375, 0, 0.375], [0.5, 0, 0.5], [-0.9, 0, 0.1]])
        got = light.irradiance(screen, points.astype(dtype), np.array([0, 1, 0], dtype))
        exact = light.irradiance(own, points, np.array([0.0, 1, 0]))
        error = max(error, float(np.abs(got / exact - 1).max()))
        cases, strays = cases + got.size, strays + int((~np.isfinite(got)).sum())
    return Measurement(error, cases, strays)


@extreme(
    "light.light_sample",
    "pictures of one bright texel, black ones, of one row",
    domain="texels of 1e6, 1e-30 and 0; ends of the square; draws off the bright texel that have a density are counted",
    unit="count",
    claim=0,
)
def _picture_draws(dtype: np.dtype) -> Measurement:
    ends = np.array([0, 1e-7, 0.5, np.nextafter(dtype.type(1), dtype.type(0))], dtype)
    u = np.stack(np.meshgrid(ends, ends), -1).reshape(-1, 2)
    bad = cases = strays = 0
    for shape in ((8, 8), (1, 64), (64, 1)):
        for bright in (1e6, 1e-30, 0.0):
            texture = np.zeros(shape)
            row, column = shape[0] // 4, shape[1] // 2
            texture[row, column] = bright
            screen = RectLight((0, 1, 0), (2, 0, 0), (0, 0, 2), texture=texture)
            drawn = light.light_sample(screen, np.zeros(3, dtype), u)
            at = drawn.wi / np.maximum(drawn.wi[:, 1:2], dtype.type(1e-3))
            x, z = (at[:, 0] + 1) / 2 * shape[1], (1 - at[:, 2]) / 2 * shape[0]
            inside = (np.abs(x - column - 0.5) <= 0.501) & (np.abs(z - row - 0.5) <= 0.501)
            # A black picture is drawn evenly. Within 1e-6 of the ends draws may round to the border: no density.
            bad += int((~inside & (drawn.pdf > 0)).sum()) if bright else int((drawn.pdf <= 0).sum())
            bad += int((drawn.pdf[(u == 0.5).all(-1)] <= 0).sum())
            cases, strays = cases + len(u), strays + int((~np.isfinite(drawn.pdf)).sum())
    return Measurement(bad, cases, strays)
