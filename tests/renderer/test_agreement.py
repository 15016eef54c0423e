"""The same material and light in `render` and in `path_trace` agree within the error that the plan states."""

import numpy as np
import pytest
import shadelab as sl
from shadelab.scene import Camera, Instance, Material, Scene

from .things import LIGHTS, MATERIALS, PUNCTUAL

SIZE, SAMPLES = (16, 9), 128
# Low, so that no light is in view; the floor alone is seen.
CAMERA = Camera((0.3, 1.0, 3.0), (0, 0, 0.1), fov_y=0.35)
FLOOR = sl.mesh.plane(20.0)
ALL = MATERIALS | {"scene's own": Material((0.3, 0.5, 0.7), roughness=0.3)}


@pytest.mark.parametrize("light", LIGHTS.values(), ids=LIGHTS)
@pytest.mark.parametrize("material", ALL.values(), ids=ALL)
def test_render_and_path_trace_agree(material, light):
    scene = Scene(Instance(FLOOR, None, material), light, CAMERA)
    plan = sl.plan(scene, SIZE)
    frame = sl.render(scene, plan)
    assert (frame.face >= 0).all()
    # Rays through the middles of pixels, as the frame has them; one bounce is direct light.
    traced = sl.pathtrace.path_trace(
        scene, SIZE, SAMPLES, max_depth=1, filter=sl.pathtrace.PixelFilter("box", 1e-3), seed=7
    )
    (stated,) = {way.error for way in plan.shading}
    mean = traced.radiance.mean()
    if mean == 0:
        assert not frame.radiance.any()
        return
    apart = np.sqrt(np.mean((frame.radiance - traced.radiance) ** 2)) / mean
    noise = np.sqrt(traced.variance.mean()) / mean
    exact = 2e-4 if light in PUNCTUAL.values() else 0.0
    # The stated error is measured at other places of the same picture, at a lower resolution.
    assert apart <= 1.5 * stated + 1.2 * noise + exact, (apart, stated, noise)
    # And the plan kept its own bound where anything could.
    smooth = isinstance(material, sl.brdf.Dielectric)
    assert stated < 0.02 or smooth or plan.shading[0].samples == 256


def test_every_light_and_material_at_once():
    """Many materials, every light, shadows on: the frame is finite and about as bright as the traced picture."""
    balls = [
        Instance(sl.mesh.icosphere(3, 0.4), sl.transform.translate([1.1 * (k % 4) - 1.6, 0.4, 1.1 * (k // 4) - 1]), m)
        for k, m in enumerate(MATERIALS.values())
    ]
    high = [
        sl.light.PointLight((-3, 5, 3), (40, 30, 20)),
        sl.light.SpotLight((3, 5, 2), (-0.5, -1, -0.3), (90, 90, 90), 0.2, 0.5),
        sl.light.DirectionalLight((0.4, -1, -0.3), (0.5, 0.5, 0.6)),
        sl.light.RectLight((0, 5, 0), (1, 0, 0), (0, 0, 1), (6, 6, 6)),
        sl.light.DiskLight((2, 5, 3), (-0.3, -1, -0.4), 0.6, (5, 4, 4)),
        sl.light.SphereLight((-2, 4, 3), 0.4, (6, 6, 8)),
        sl.light.PolygonLight([[-2, 5, -2], [-1, 5, -2], [-2, 5, -1]], (9, 9, 6)),
        sl.light.AmbientLight((0.1, 0.1, 0.12)),
    ]
    scene = Scene([Instance(FLOOR), *balls], high, Camera((0.5, 4, 6), (0, 0.2, 0), fov_y=0.6))
    frame = sl.render(scene, size=(96, 64))
    assert np.isfinite(frame.radiance).all() and len(frame.lit) == len(high)
    text = str(frame.plan)
    assert len(frame.plan.shading) == len(balls) + 1 and "error" in text and "occlusion" in text
    for k, lamp in enumerate(high):
        shadowed = frame.lit[k][frame.face >= 0]
        assert shadowed.min() < (0.8 if isinstance(lamp, sl.light.AmbientLight) else 0.1), k
    traced = sl.pathtrace.path_trace(scene, (96, 64), 16, max_depth=1)
    both = (frame.face >= 0) & (frame.radiance.max(-1) < 4)
    # Soft shadows, and mirrors that would show their neighbours.
    ratio = frame.radiance[both].mean() / np.minimum(traced.radiance, 4)[both].mean()
    assert 0.9 < ratio < 1.15


def test_ambient_light_is_seen_and_hidden_alike():
    """A wall beside a floor keeps half of an even sky away; what is behind everything shows it."""
    wall = Instance(
        sl.mesh.plane(6.0),
        sl.transform.translate([-1.0, 0, 0]) @ sl.transform.rotate_axis([0, 0, 1], -np.pi / 2),
        Material((0.3, 0.3, 0.3), roughness=1.0),
    )
    matte = sl.brdf.Diffuse((0.7, 0.5, 0.3))
    camera = Camera((2.0, 1.5, 4.5), (-0.5, 0.4, 0), fov_y=0.9)
    scene = Scene([Instance(sl.mesh.plane(3.0), None, matte), wall], sl.light.AmbientLight((0.5, 0.7, 1.0)), camera)
    frame = sl.render(scene, size=(48, 32))
    traced = sl.pathtrace.path_trace(
        scene, (48, 32), 256, max_depth=1, filter=sl.pathtrace.PixelFilter("box", 1e-3), seed=3
    )
    seen = frame.face >= 0
    assert not seen.all() and np.allclose(frame.radiance[~seen], [0.5, 0.7, 1.0])
    assert np.allclose(traced.radiance[~seen], [0.5, 0.7, 1.0])
    assert frame.lit[0][seen].min() < 0.6 and frame.plan.find("shadow") is not None
    apart = (frame.radiance - traced.radiance)[seen]
    # Of 32 rays each about half look up: a deviation of some percent, and hardly any on the average.
    assert np.sqrt(np.mean(apart**2)) < 0.09 * traced.radiance[seen].mean()
    assert abs(apart.mean()) < 0.01 * traced.radiance[seen].mean()
