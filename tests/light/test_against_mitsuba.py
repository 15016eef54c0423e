"""Irradiance of area lights, and the look of panoramas, beside Mitsuba 3."""

import numpy as np
import pytest
import shadelab as sl

mi = pytest.importorskip("mitsuba")
L = sl.light
POINT, NORMAL = np.array([0.3, 0.1, -0.2]), np.array([0.0, 0.8, 0.6])


def irradiance(shape, n=64):
    """Mitsuba's own draws from the emitter, over stratified squares: mean and standard error."""
    mi.set_variant("scalar_rgb")
    emitter = {"type": "area", "radiance": {"type": "rgb", "value": [3.0, 2.0, 1.0]}}
    scene = mi.load_dict({"type": "scene", "light": {**shape, "emitter": emitter}})
    at = mi.SurfaceInteraction3f()
    at.p, at.n = mi.Point3f(*POINT), mi.Normal3f(*NORMAL)
    rng, values = np.random.default_rng(1), []
    for i in range(n):
        for j in range(n):
            u = (np.array([i, j]) + rng.random(2)) / n
            ds, weight = scene.sample_emitter_direction(at, mi.Point2f(*u), False)
            values.append(np.array(weight) * max(float(np.dot(np.array(ds.d), NORMAL)), 0.0))
    values = np.array(values)
    return values.mean(0), values.std(0) / n


@pytest.mark.parametrize("kind", ["rectangle", "disk", "sphere"])
def test_irradiance_agrees(kind):
    color = (3.0, 2.0, 1.0)
    mi.set_variant("scalar_rgb")
    turn = mi.ScalarTransform4f().look_at(origin=[0.5, 2, 0.3], target=[0.2, 0, 0.1], up=[0, 0, 1])
    if kind == "sphere":
        light, shape = L.SphereLight((0.5, 2, 0.3), 0.7, color), {"center": [0.5, 2, 0.3], "radius": 0.7}
    else:
        m = np.array(turn.matrix)
        u, v, normal, center = m[:3, 0], m[:3, 1], m[:3, 2], m[:3, 3]
        shape = {"to_world": turn}
        light = (
            L.RectLight(center, 2 * u, 2 * v, color) if kind == "rectangle" else L.DiskLight(center, normal, 1, color)
        )
    mean, error = irradiance({"type": kind, **shape})
    exact = L.irradiance(light, POINT, NORMAL)
    # Stratified draws err by less than independent ones of that spread; Mitsuba works in single precision.
    assert np.all(np.abs(mean - exact) < 3 * error + 1e-5 * exact)


def test_panoramas_look_the_same():
    height, width = 64, 128
    i, j = np.meshgrid(np.arange(height) + 0.5, np.arange(width) + 0.5, indexing="ij")
    polar, azimuth = np.pi * i / height, 2 * np.pi * j / width
    sky = np.stack([1 + np.cos(polar), 1 + np.sin(polar) * np.cos(azimuth), 1.5 + np.sin(polar) * np.sin(azimuth)], -1)
    mi.set_variant("scalar_rgb")
    # Mitsuba's seam looks along −z, our centre does.
    turn = mi.ScalarTransform4f().rotate([0, 1, 0], 180)
    bitmap = mi.Bitmap(sky.astype(np.float32))
    theirs = mi.load_dict({"type": "envmap", "bitmap": bitmap, "to_world": turn})
    d = np.random.default_rng(1).normal(size=(200, 3))
    d /= np.linalg.norm(d, axis=-1, keepdims=True)
    seen = []
    for w in d:
        si = mi.SurfaceInteraction3f()
        si.wi = mi.Vector3f(*-w)
        seen.append(np.array(theirs.eval(si)))
    # Mitsuba's first and last rows stand at the poles, ours half a row from there.
    assert np.abs(np.array(seen) - sl.environment.Environment(sky).eval(d)).max() < 0.04
