"""Scenes that break someone's shadows: what each is there for stands beside it."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from ... import mesh, scene, transform
from ...light import RectLight
from ...mesh import Mesh
from ...scene import Camera, Instance, Scene

__all__ = ["SCENES", "own_camera", "views"]


def _at(shape: Mesh, x: float, y: float, z: float, turn: float = 0.0) -> Instance:
    """A shape set at a place, turned about the vertical."""
    return Instance(shape, transform.translate([x, y, z]) @ transform.rotate_axis([0.0, 1.0, 0.0], turn))


def _light(center: tuple[float, float, float], side: float, target: tuple[float, float, float]) -> RectLight:
    """A square light that looks at a target, with about the irradiance of 3 W/m² below it whatever its size."""
    axis = np.subtract(target, center)
    distance = float(np.linalg.norm(axis))
    axis = axis / distance
    u = np.cross(axis, [0.0, 0.0, 1.0])
    u /= np.linalg.norm(u)
    v = np.cross(axis, u)
    radiance = 3.0 * distance**2 / side**2
    edges = [(float(e[0]), float(e[1]), float(e[2])) for e in (side * u, side * v)]
    return RectLight(center=center, edge_u=edges[0], edge_v=edges[1], radiance=(radiance,) * 3)


def _scene(things: list[Instance], light: RectLight, camera: Camera) -> Scene:
    return Scene([Instance(mesh.plane(8.0)), *things], lights=(light,), camera=camera)


def contact() -> Scene:
    """Boxes and a sphere that stand and lie on the ground: the penumbra begins at nothing."""
    things = [
        _at(mesh.box((0.9, 1.4, 0.9)), -0.9, 0.7, 0.0, 0.5),
        _at(mesh.icosphere(4, 0.5), 0.7, 0.5, 0.3),
        _at(mesh.box((1.6, 0.12, 0.5)), 0.2, 0.06, 1.2, -0.3),
    ]
    return _scene(
        things, _light((2.0, 4.0, 1.0), 1.0, (0.0, 0.0, 0.3)), Camera((2.4, 2.4, 4.2), (0.0, 0.4, 0.3), fov_y=0.6)
    )


def thin_fence() -> Scene:
    """Posts and rails thinner than the light and than a few texels: few samples miss them."""
    post, rail = mesh.box((0.03, 1.2, 0.03)), mesh.box((3.0, 0.03, 0.03))
    things = [_at(post, x, 0.6, 0.0) for x in np.linspace(-1.45, 1.45, 18)]
    things += [_at(rail, 0.0, y, 0.0) for y in (0.35, 1.0)]
    return _scene(
        things, _light((0.8, 3.5, -2.5), 0.6, (0.0, 0.0, 0.6)), Camera((1.2, 2.2, 4.4), (0.0, 0.3, 0.6), fov_y=0.65)
    )


def two_depths() -> Scene:
    """A low slab below a high one: blockers of two depths, whose mean is the depth of neither; light leaks."""
    things = [
        _at(mesh.box((1.6, 0.1, 1.6)), -0.2, 0.45, 0.2, 0.2),
        _at(mesh.box((1.0, 0.1, 2.6)), 0.4, 1.9, 0.0, -0.4),
    ]
    return _scene(
        things, _light((0.6, 4.5, 0.4), 1.2, (0.0, 0.0, 0.0)), Camera((2.6, 1.9, 4.6), (0.1, 0.75, 0.2), fov_y=0.65)
    )


def large_penumbra() -> Scene:
    """A sphere and a bar high above the ground under a large near light: hardly any umbra."""
    things = [_at(mesh.icosphere(4, 0.5), -0.6, 1.3, 0.0), _at(mesh.box((0.25, 0.25, 2.4)), 0.8, 1.1, 0.0, 0.4)]
    return _scene(
        things, _light((0.3, 3.2, 0.0), 2.4, (0.0, 0.0, 0.0)), Camera((1.8, 3.0, 4.6), (0.0, 0.5, 0.0), fov_y=0.7)
    )


def long_view() -> Scene:
    """A road of posts from before the camera to 60 m away: one map holds texels for near and far alike."""
    post, slab = mesh.box((0.3, 1.6, 0.3)), mesh.box((1.2, 0.3, 0.4))
    places = np.geomspace(2.0, 60.0, 14)
    things = [_at(post, 1.2 * side, 0.8, -float(z), 0.3 * side) for z in places for side in (-1.0, 1.0)]
    things += [_at(slab, 0.0, 0.15, -float(z) - 0.6, 0.5) for z in places[::2]]
    light = _light((-30.0, 36.0, 4.0), 1.6, (0.0, 0.0, -24.0))
    camera = Camera((0.3, 1.5, 1.5), (0.0, 0.9, -6.0), fov_y=0.8)
    ground = Instance(mesh.plane(140.0), transform.translate([0.0, 0.0, -40.0]))
    return Scene([ground, *things], lights=(light,), camera=camera)


SCENES: Mapping[str, Callable[[], Scene]] = {
    "default": scene.default,
    "contact": contact,
    "thin fence": thin_fence,
    "two depths": two_depths,
    "large penumbra": large_penumbra,
    "long view": long_view,
}
"""The scenes by name."""


def own_camera(name: str, made: Any) -> Mapping[str, Camera]:
    """The one view of a scene that its own camera has."""
    if not isinstance(made, Scene):
        raise TypeError(f"scene: expected {name!r} to be a Scene, got {type(made).__name__}")
    return {"": made.camera}


def views(name: str, made: Scene) -> Mapping[str, Any]:
    """A scene's own camera; around the default scene two more, steep and grazing."""
    own = own_camera(name, made)
    if name != "default":
        return own
    camera = made.camera
    eye, target = np.asarray(camera.eye, float), np.asarray(camera.target, float)
    away = eye - target
    distance, azimuth = float(np.linalg.norm(away)), math.atan2(away[2], away[0])

    def around(turn: float, elevation: float, zoom: float) -> Camera:
        a, e = azimuth + turn, elevation
        direction = np.array([math.cos(e) * math.cos(a), math.sin(e), math.cos(e) * math.sin(a)])
        return Camera(tuple(target + zoom * distance * direction), tuple(target), fov_y=camera.fov_y)

    return {"front": camera, "steep": around(0.9, 1.1, 0.9), "grazing": around(-0.7, 0.2, 0.75)}
