"""Extremes of path tracing: far from the origin, a sun, faces without area, nothing at all, numbers that are none."""

from __future__ import annotations

from typing import Any

import numpy as np

from ... import light, mesh, pathtrace, scene, transform
from ..stability import Measurement, extreme

_MATT = scene.Material((0.5, 0.6, 0.7), specular=0.0)


def _strays(*arrays: np.ndarray) -> int:
    return sum(int((~np.isfinite(a)).sum()) for a in arrays)


def _still_life(shift: float = 0.0) -> scene.Scene:
    """A block on the ground under a lamp, all moved along each axis by `shift`."""

    def thing(shape: mesh.Mesh, height: float) -> scene.Instance:
        return scene.Instance(shape, transform.translate((shift, shift + height, shift)), (_MATT,))

    lamp = light.RectLight((shift, 2 + shift, shift), (1, 0, 0), (0, 0, 1), (5, 5, 5))
    camera = scene.Camera((0.5 + shift, 1.5 + shift, 3 + shift), (shift, shift, shift))
    return scene.Scene([thing(mesh.plane((4, 4)), -0.5), thing(mesh.box(), 0.0)], lamp, camera)


@extreme(
    "pathtrace.path_trace",
    "a scene far from the origin",
    domain="a block under a lamp, 1e3 of its size away (float32) or 1e9 (float64), against the same at the origin; the "
    "means of all pixels, and pixels more than 5 errors off by more than a twentieth (there positions have six digits)",
    unit="relative",
    claim={"float32": 5e-3, "float64": 1e-6},
)
def _far(dtype: np.dtype) -> Measurement:
    shift = 1e3 if dtype == np.float32 else 1e9
    options: dict[str, Any] = {"size": (24, 16), "samples": 64, "dtype": dtype}
    near, far = (pathtrace.path_trace(_still_life(s), **options) for s in (0.0, shift))
    error = abs(far.radiance.mean(dtype=np.float64) / near.radiance.mean(dtype=np.float64) - 1)
    off = np.abs(far.radiance - near.radiance)
    wrong = (off > 5 * np.sqrt(near.variance + far.variance)) & (off > 0.05 * near.radiance.mean())
    # Edges of shadows and of the block move by rounding: one pixel in a hundred may.
    return Measurement(float(error) + (wrong.mean() > 0.01), near.radiance.size, _strays(far.radiance))


@extreme(
    "pathtrace.path_trace",
    "a sun: small, far and bright",
    domain="a matt floor facing spheres of 1e-6 … 1e-2 of their distance, which is 1 … 1e6; light against E ρ / π",
    unit="relative",
    claim=2e-6,
)
def _sun(dtype: np.dtype) -> Measurement:
    floor = scene.Instance(mesh.plane((2, 2)), materials=_MATT)
    camera = scene.Camera((0, 1, 0.001), (0, 0, 0), fov_y=0.01)
    error, cases, strays = 0.0, 0, 0
    for distance in (1e1, 1e3, 1e6):
        for part in (1e-6, 1e-4, 1e-2):
            # Irradiance π on the floor below, since L π sin² of the half angle is.
            sun = light.SphereLight((0, distance, 0), part * distance, (part**-2,) * 3)
            got = pathtrace.path_trace(scene.Scene(floor, sun, camera), (4, 4), 64, dtype=dtype).radiance
            error = max(error, float(np.abs(got / np.array([0.5, 0.6, 0.7]) - 1).max()))
            cases, strays = cases + got.size, strays + _strays(got)
    return Measurement(error, cases, strays)


@extreme(
    "pathtrace.path_trace",
    "faces without area",
    domain="a block among faces that are points and lines and would emit: pixels more than 5 errors off the picture "
    "without them are counted",
    unit="count",
    claim=0,
)
def _no_area(dtype: np.dtype) -> Measurement:
    bare = _still_life()
    needles = mesh.Mesh(
        np.array([[0, 1, 0], [0.3, 1, 0], [0.6, 1, 0], [-1, 0.2, 0.3]], dtype),
        np.array([[0, 1, 2], [3, 3, 3], [0, 0, 1]], np.int32),
    )
    glowing = scene.Material((0.5, 0.5, 0.5), emission=(1e6, 1e6, 1e6))
    full = scene.Scene([*bare.instances, scene.Instance(needles, materials=glowing)], bare.lights, bare.camera)
    a, b = (pathtrace.path_trace(s, (24, 16), 16, dtype=dtype) for s in (bare, full))
    wrong = np.abs(a.radiance - b.radiance) > 5 * np.sqrt(a.variance + b.variance) + 1e-5
    return Measurement(int(wrong.sum()), wrong.size, _strays(b.radiance))


@extreme(
    "pathtrace.path_trace",
    "nothing there",
    domain="no thing and no light; no thing under a sky; things without any light: radiance that is not what is behind",
    unit="relative",
    claim=1e-6,
)
def _nothing(dtype: np.dtype) -> Measurement:
    camera = scene.Camera((0, 0, 3), (0, 0, 0))
    block = scene.Instance(mesh.box(), materials=_MATT)
    error, cases, strays = 0.0, 0, 0
    for things, sky in (((), (0.0,) * 3), ((), (0.25, 0.5, 1.0)), ((block,), (0.0,) * 3)):
        traced = pathtrace.path_trace(scene.Scene(things, (), camera, background=sky), (8, 8), 4, dtype=dtype)
        error = max(error, float(np.abs(traced.radiance - np.array(sky)).max()))
        cases, strays = cases + traced.radiance.size, strays + _strays(traced.radiance, traced.variance)
    return Measurement(error, cases, strays)


@extreme(
    "pathtrace.path_trace",
    "roughness → 0",
    domain="a metal floor of roughness 1e-8 … 0 that mirrors an even sky: all of its light, whatever the roughness",
    unit="relative",
    claim={"float32": 1e-6, "float64": 1e-7},
)
def _polished(dtype: np.dtype) -> Measurement:
    camera = scene.Camera((0, 1, 2), (0, 0, 0), fov_y=0.2)
    error, cases, strays = 0.0, 0, 0
    for roughness in (0.0, 1e-8, 1e-4, 1e-2):
        metal = scene.Material((1, 1, 1), 1.0, roughness)
        floor = scene.Instance(mesh.plane((20, 20)), materials=metal)
        got = pathtrace.path_trace(scene.Scene(floor, (), camera, background=(1, 1, 1)), (8, 8), 16, dtype=dtype)
        error = max(error, float(np.abs(got.radiance - 1).max()))
        cases, strays = cases + got.radiance.size, strays + _strays(got.radiance, got.variance)
    return Measurement(error, cases, strays)


@extreme(
    "pathtrace.path_trace",
    "numbers that are none",
    domain="NaN and infinity in vertices, transforms, cameras, lights, skies: refused by an error, those taken counted",
    unit="count",
    claim=0,
)
def _no_numbers(dtype: np.dtype) -> Measurement:
    camera = scene.Camera((0, 0, 3), (0, 0, 0))
    taken, cases = 0, 0
    for bad in (np.nan, np.inf, -np.inf):
        broken = np.eye(4)
        broken[0, 3] = bad
        makers: tuple[Any, ...] = (
            lambda bad=bad: mesh.Mesh(
                np.array([[0, 0, 0], [1, 0, 0], [0, bad, 0]], dtype), np.array([[0, 1, 2]], np.int32)
            ),
            lambda broken=broken: scene.Instance(mesh.box(), broken, (_MATT,)),
            lambda bad=bad: scene.Camera((0, 0, bad), (0, 0, 0)),
            lambda bad=bad: light.PointLight((0, bad, 0)),
            lambda bad=bad: light.RectLight((0, 1, 0), (1, 0, 0), (0, 0, 1), (bad, 1, 1)),
            lambda bad=bad: scene.Scene(mesh.box(), (), camera, background=(bad, 1, 1)),
            lambda bad=bad: scene.Material((bad, 0.5, 0.5)),
        )
        for make in makers:
            cases += 1
            try:
                make()
            except ValueError:
                continue
            taken += 1
    return Measurement(taken, cases)


@extreme(
    "pathtrace.spectral",
    "wavelengths from 1e-3 to 1e6 nm, reflectances 0 and 1, radiances from 1e-30 to 1e30",
    domain="a closed room of one radiance, eight reflections, each wavelength against its own geometric series; "
    "colours of what a screen shows",
    unit="relative",
    claim={"float32": 2e-7, "float64": 4e-16},
)
def _every_wavelength(dtype: np.dtype) -> Measurement:
    wavelengths = np.array([1e-3, 1.0, 380.0, 550.0, 780.0, 1e4, 1e6])
    radiances = np.array([1e-30, 1e30, 1.0, 1e-3, 7.0, 1e15, 1e-15])
    reflectances = np.array([1.0, 0.0, 0.5, 1e-6, 0.999999, 1.0, 0.3])

    def room(wavelength: float) -> scene.Scene:
        k = int(np.argmin(np.abs(wavelengths - wavelength)))
        paint = scene.Material(
            (float(reflectances[k]),) * 3, roughness=1.0, specular=0.0, emission=(float(radiances[k]),) * 3
        )
        walls = scene.Instance(mesh.box((4, 4, 4)), materials=paint)
        return scene.Scene(walls, (), scene.Camera((0, 0, 1), (0, 0, 0)))

    options: dict[str, Any] = {"strategy": "bsdf", "roulette": 64, "dtype": dtype}
    got = pathtrace.spectral(room, (6, 6), 16, 8, wavelengths=wavelengths, **options)
    exact = radiances * (reflectances[:, None] ** np.arange(9)).sum(1)
    off = np.abs(got.radiance / exact - 1)
    strays = int((~np.isfinite(got.rgb())).sum())
    return Measurement(float(off.max()), off.size, strays)
