"""Extremes of `pathtrace`'s cameras, filters and older tracers: no lens, no width, no depth, no light, every size."""

from __future__ import annotations

import numpy as np

from ... import brdf, light, mesh, pathtrace, scene, transform
from ..._arrays import Floats
from ..stability import Measurement, extreme


def _strays(*arrays: np.ndarray) -> int:
    return sum(int((~np.isfinite(a)).sum()) for a in arrays)


@extreme(
    "pathtrace.camera_rays",
    "focus from 1e-6 to 1e6 and at infinity, apertures from 0 to 1e3",
    domain="a camera 5 from the origin; where rays of one pixel cross the plane of focus, off the pinhole's, relative "
    "to the distances of that plane, of the lens' rim and of the eye",
    unit="relative",
    claim={"float32": 2e-6, "float64": 5e-15},
)
def _focus(dtype: np.dtype) -> Measurement:
    rng = np.random.default_rng(0)
    worst, cases, strays = 0.0, 0, 0
    for focus in (1e-6, 1e-3, 1.0, 1e3, 1e6, np.inf):
        for aperture in (0.0, 1e-6, 1.0, 1e3):
            camera = scene.Camera((1, 2, 4), (0, 0, 0), aperture=aperture, focus_distance=focus)
            xy, lens = (rng.random((64, 2)) * 30).astype(dtype), rng.random((64, 2)).astype(dtype)
            o, d = (a.astype(float) for a in pathtrace.camera_rays(camera, (40, 30), xy, lens))
            eye, ahead = pathtrace.camera_rays(scene.Camera((1, 2, 4), (0, 0, 0)), (40, 30), xy.astype(float))
            axis = -camera.view()[2, :3]
            if np.isinf(focus):
                off = np.abs(d - ahead).max(-1)
            else:
                at = o + d * ((focus - (o - eye) @ axis) / (d @ axis))[:, None]
                sharp = eye + ahead * (focus / (ahead @ axis))[:, None]
                off = np.linalg.norm(at - sharp, axis=-1) / (focus + aperture + 5)
                # Rays almost across the axis meet the plane far away, by what they lean.
                off = off * (d @ axis)
            worst, cases, strays = max(worst, float(off.max())), cases + len(off), strays + _strays(o, d)
    return Measurement(worst, cases, strays)


@extreme(
    "pathtrace.PixelFilter",
    "u from 0 to 1 by way of their neighbours, radii from 1e-30 to 1e6",
    domain="all filters; offsets beyond the radius, out of order or not mirrored are counted",
    unit="count",
    claim=0,
)
def _borders(dtype: np.dtype) -> Measurement:
    t = dtype.type
    tiny = np.finfo(dtype).tiny
    u = np.array([0, tiny, 1e-30, 1e-7, 0.25, 0.5, 0.75, 1 - 1e-7, np.nextafter(t(1), t(0)), 1], dtype)
    wrong, cases, strays = 0, 0, 0
    for name in ("box", "tent", "gaussian", "blackman_harris"):
        for radius in (0.0, 1e-30, 1e-6, 1.0, 1e6):
            x = pathtrace.PixelFilter(name, radius).sample(u)
            wrong += int((np.abs(x) > t(radius)).sum() + (np.diff(x) < 0).sum() + (x[0] != -x[-1]))
            cases, strays = cases + x.size, strays + _strays(x)
    return Measurement(wrong, cases, strays)


def _still(scale: float) -> scene.Scene:
    """A matt box and a glass ball on a mirror under a point light."""

    def move(x: float, y: float, z: float) -> Floats:
        return transform.translate([x * scale, y * scale, z * scale])

    things = [
        scene.Instance(mesh.plane((6 * scale, 6 * scale)), move(0, -0.5, 0), scene.Material((0.9, 0.8, 0.7), 1, 0)),
        scene.Instance(mesh.box((scale,) * 3), move(-0.7, 0, 0), scene.Material((0.5, 0.6, 0.7), specular=0)),
        scene.Instance(mesh.icosphere(3, 0.5 * scale), move(0.7, 0, 0.3), brdf.Dielectric(eta=1.5)),
    ]
    lamp = light.PointLight((0.5 * scale, 3 * scale, 2 * scale), (9 * scale**2,) * 3)
    camera = scene.Camera((scale, 1.5 * scale, 4 * scale), (0, 0, 0), fov_y=0.5)
    return scene.Scene(things, lamp, camera, background=(0.2, 0.3, 0.4))


@extreme(
    "pathtrace.whitted",
    "the same picture at scales 1e-6 … 1e6",
    domain="box, mirror and glass ball under a point light; part of the pixels that differ by more than 1 %",
    unit="relative",
    claim={"float32": 0.02, "float64": 0.005},
)
def _scales(dtype: np.dtype) -> Measurement:
    base = pathtrace.whitted(_still(1.0), (32, 24), dtype=dtype).radiance
    worst, cases, strays = 0.0, 0, 0
    for scale in (1e-6, 1e-3, 1e3, 1e6):
        other = pathtrace.whitted(_still(scale), (32, 24), dtype=dtype).radiance
        apart = np.abs(other - base) > 0.01 * base
        worst, cases, strays = max(worst, float(apart.mean())), cases + other.size, strays + _strays(other)
    return Measurement(worst, cases, strays)


@extreme(
    "pathtrace.distribution",
    "lights of zero area, no depth, filters without width",
    domain="a matt floor under a rectangle that shrinks at constant power, against the closed form of a point with its "
    "cosine; relative to the brightest pixel",
    unit="relative",
    claim={"float32": 1e-3, "float64": 1e-3},
)
def _shrinking(dtype: np.dtype) -> Measurement:
    thing = scene.Instance(mesh.plane(4.0), materials=scene.Material((0.5, 0.5, 0.5), specular=0))
    camera = scene.Camera((0, 2, 4), (0, 0, 0), fov_y=0.5)
    point = pathtrace.PixelFilter("box", 0.0)
    worst, cases, strays = 0.0, 0, 0
    for side in (1e-3, 1e-6, 1e-9):
        lamp = light.RectLight((0, 2, 0), (side, 0, 0), (0, 0, side), (1 / side**2,) * 3)
        got = pathtrace.distribution(scene.Scene(thing, lamp, camera), (16, 12), 4, 0, filter=point, dtype=dtype)
        _, d = camera.rays((16, 12))
        at = np.asarray(camera.eye) + d * (-2 / d[..., 1:2])
        squared = at[..., 0] ** 2 + at[..., 2] ** 2 + 4
        # f = 0.5/π, both cosines 2/distance.
        wanted = np.where((np.abs(at[..., [0, 2]]) < 2).all(-1), 0.5 / np.pi * 4 / squared**2, 0.0)
        inner = np.abs(np.abs(at[..., [0, 2]]) - 2).min(-1) > 1e-3
        off = np.abs(got.radiance[..., 0] - wanted)[inner] / wanted.max()
        worst, cases, strays = max(worst, float(off.max())), cases + off.size, strays + _strays(got.radiance)
    return Measurement(worst, cases, strays)
