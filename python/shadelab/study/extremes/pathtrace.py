"""Extremes of `pathtrace`: reflectance one, scenes of every size, lights that shrink to points, narrow mirrors."""

from __future__ import annotations

import numpy as np

from ... import accel, light, mesh, pathtrace, scene
from ..._arrays import Floats
from ..stability import Measurement, extreme


def _block(material: scene.Material, scale: float = 1.0) -> scene.Scene:
    instance = scene.Instance(mesh.box((scale, scale, scale)), materials=(material,))
    camera = scene.Camera((scale, 2 * scale, 4 * scale), (0, 0, 0))
    return scene.Scene(instance, (), camera, background=(1, 1, 1))


@extreme(
    "pathtrace.path_trace",
    "reflectance 1 in an even sky",
    domain="a white diffuse block, flat-shaded; each path carries one",
    unit="relative",
    claim={"float32": 1e-6, "float64": 1e-14},
)
def _white(dtype: np.dtype) -> Measurement:
    traced = pathtrace.path_trace(_block(scene.Material((1, 1, 1), specular=0.0)), (16, 16), 16, 1000, dtype=dtype)
    error = float(np.abs(traced.radiance - 1).max())
    return Measurement(error, traced.radiance.size, int((~np.isfinite(traced.radiance)).sum()))


@extreme(
    "pathtrace.path_trace",
    "the same picture at scales 1e-6 … 1e6",
    domain="a block in an even sky; pixels whose mean differs by more than 4 of its errors are counted",
    unit="count",
    claim=0,
)
def _scales(dtype: np.dtype) -> Measurement:
    material = scene.Material((0.5, 0.6, 0.7), roughness=0.4)
    base = pathtrace.path_trace(_block(material), (16, 16), 16, dtype=dtype)
    wrong, strays, cases = 0, 0, 0
    for scale in (1e-6, 1e-3, 1e3, 1e6):
        other = pathtrace.path_trace(_block(material, scale), (16, 16), 16, dtype=dtype)
        error = np.sqrt(base.variance + other.variance) + 1e-6
        wrong += int((np.abs(other.radiance - base.radiance) > 4 * error).sum())
        strays += int((~np.isfinite(other.radiance)).sum())
        cases += other.radiance.size
    return Measurement(wrong, cases, strays)


def _waves(scale: float, shift: float, dtype: np.dtype) -> tuple[accel.BVH, Floats, Floats]:
    """A wavy floor, the middles of its faces, and their normals."""
    n = 33
    x, z = np.meshgrid(np.linspace(-1, 1, n), np.linspace(-1, 1, n))
    positions = np.stack([x, 0.05 * np.sin(3 * x) * np.cos(2 * z), z], -1).reshape(-1, 3) * scale + shift
    i = (np.arange(n - 1)[:, None] * n + np.arange(n - 1)).ravel()
    faces = np.concatenate([np.stack([i, i + n, i + 1], -1), np.stack([i + 1, i + n, i + n + 1], -1)])
    corners = positions.astype(dtype)[faces]
    normals = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]).astype(np.float64)
    normals /= np.linalg.norm(normals, axis=-1, keepdims=True)
    return accel.BVH(positions.astype(dtype), faces), corners.mean(1), normals.astype(dtype)


@extreme(
    "pathtrace.direct_light",
    "no surface shades itself",
    domain="a wavy floor at scales 1e-6 … 1e6, and 1e3 of its size from the origin, under a distant light",
    unit="count",
    claim=0,
)
def _acne(dtype: np.dtype) -> Measurement:
    wrong, cases, strays = 0, 0, 0
    sun = light.DirectionalLight((0.3, -1, 0.2))
    for scale, shift in ((1e-6, 0.0), (1.0, 0.0), (1e6, 0.0), (1.0, 1e3)):
        bvh, points, normals = _waves(scale, shift, dtype)
        got = pathtrace.direct_light(bvh, sun, points, normals, [1.0] * 3, specular=0.0, wo=normals).radiance
        wrong, strays = wrong + int((got == 0).any(-1).sum()), strays + int((~np.isfinite(got)).sum())
        cases += len(points)
    return Measurement(wrong, cases, strays)


@extreme(
    "pathtrace.direct_light",
    "rectangles that shrink to points",
    domain="edges 1e-3 … 1e-15 of the distance, radiance growing as 1/area, against a point light",
    unit="relative",
    claim=2e-6,
)
def _shrinking(dtype: np.dtype) -> Measurement:
    bvh = accel.BVH(np.array([[0, 90, 0], [1, 90, 0], [0, 90, 1]], dtype), [[0, 1, 2]])
    points, up = np.array([[0.3, 0, 0.2], [1, 0, -2]], dtype), np.array([0, 1, 0], dtype)
    error, strays, cases = 0.0, 0, 0
    exact = pathtrace.direct_light(bvh, light.PointLight((0, 1, 0)), points, up, [0.8] * 3, wo=up, samples=64).radiance
    # A rectangle sends cos θ of a point's intensity.
    exact = exact / np.sqrt((points.astype(np.float64) ** 2).sum(-1) + 1)[:, None]
    for edge in (1e-3, 1e-6, 1e-9, 1e-15):
        rect = light.RectLight((0, 1, 0), (edge, 0, 0), (0, 0, edge), (edge**-2,) * 3)
        got = pathtrace.direct_light(bvh, rect, points, up, [0.8] * 3, wo=up, samples=64).radiance
        error = max(error, float(np.abs(got / exact - 1).max()))
        strays, cases = strays + int((~np.isfinite(got)).sum()), cases + got.size
    return Measurement(error, cases, strays)


@extreme(
    "pathtrace.path_trace",
    "narrow mirrors: fireflies shown, none infinite",
    domain="a metal ball of roughness 0 on a floor under a small bright rectangle",
    unit="count",
    claim=0,
)
def _fireflies(dtype: np.dtype) -> Measurement:
    mirror, floor = scene.Material((1, 1, 1), 1.0, 0.0), scene.Material((0.5, 0.5, 0.5))
    lower = np.eye(4)
    lower[1, 3] = -0.5
    lower = np.eye(4)
    lower[1, 3] = -0.5
    things = [
        scene.Instance(mesh.icosphere(2, 0.5), materials=(mirror,)),
        scene.Instance(mesh.plane((4, 4)), lower, (floor,)),
    ]
    lamp = light.RectLight((0, 2, 0), (0.01, 0, 0), (0, 0, 0.01), (1e5,) * 3)
    world = scene.Scene(things, lamp, scene.Camera((0, 1, 3), (0, 0, 0)))
    traced = pathtrace.path_trace(world, (32, 24), 16, dtype=dtype)
    # Somewhere one sample of sixteen carries all: the standard error is as large as the mean, and says so.
    honest = bool(((traced.variance > 0.5 * traced.radiance**2) & (traced.radiance > 0)).any())
    strays = int((~np.isfinite(traced.radiance)).sum() + (~np.isfinite(traced.variance)).sum())
    return Measurement(float((traced.radiance < 0).sum()) + (not honest), traced.radiance.size, strays)
