"""What questions of shadow maps share: lit fractions as pictures, on scenes of one light with or without extent."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import color, shadow
from ...light import PointLight
from ...scene import Camera, Scene
from ..question import Case, Mask, Metric
from ._shadow_scenes import SCENES, own_camera
from .soft_shadows import Inputs, _setup, _widened

__all__ = [
    "BREAKING",
    "EDGES",
    "display",
    "edges",
    "facing",
    "line",
    "lit_error",
    "near_and_far",
    "pointed",
    "pointlike",
    "spread",
    "traced",
]

Array = NDArray[Any]

BREAKING: Mapping[str, Callable[[], Scene]] = {name: make for name, make in SCENES.items() if name != "default"}
"""The scenes that break someone; what each is there for stands beside it."""


def pointlike(case: Case) -> Inputs:
    """The inputs of a case whose area light is shrunk to its centre: of sharp shadows, right or wrong."""
    scene = case.scene
    if not isinstance(scene, Scene):
        raise TypeError(f"scene: expected {case.scene_name!r} to be a Scene, got {type(scene).__name__}")
    lights = tuple(pointed(l) for l in scene.lights)
    return _setup(replace(case, scene=Scene(scene.instances, lights=lights, camera=scene.camera)))


def pointed(light: Any) -> Any:
    """A light at the centre of one with an area; any other as it is."""
    center = getattr(light, "center", None)
    if center is None:
        return light
    area = float(getattr(light, "area", 1.0))
    red, green, blue = (float(c) * area for c in light.radiance)
    return PointLight(center, (red, green, blue))


def traced(inputs: Inputs) -> Array:
    """Of lights without extent: what rays to them say, exact."""
    lit = [shadow.ray_traced(inputs.bvh, inputs.points, inputs.geometric, l) for l in inputs.lights]
    return spread(inputs, np.stack(lit))


def spread(inputs: Inputs, lit: Any) -> Array:
    """Lit fractions of receivers, light by light, as one picture: their mean; 0 where there is no surface."""
    given = np.asarray(lit)
    expected = (len(inputs.lights), len(inputs.points))
    if given.shape != expected:
        raise ValueError(f"expected lit fractions of shape {expected} (lights, receivers), got {given.shape}")
    return inputs.spread(given.mean(0))


def facing(inputs: Inputs) -> Array:
    """Pixels that would get light with nothing in between."""
    return np.asarray(inputs.spread(inputs.unshadowed.sum(0)).sum(-1) > 0)


def edges(reference: Array, inputs: Inputs) -> Array:
    """Pixels within a 60th of the picture's height of a shadow's edge, where any light would arrive."""
    reach = max(1, round(reference.shape[0] / 60))
    there = inputs.covered
    found = np.zeros(reference.shape, bool)
    for axis in (0, 1):
        a, b = (np.take(reference, range(s, reference.shape[axis] - 1 + s), axis) for s in (0, 1))
        both = [np.take(there, range(s, reference.shape[axis] - 1 + s), axis) for s in (0, 1)]
        step = (a != b) & both[0] & both[1]
        pad = [(0, 0), (0, 0)]
        pad[axis] = (0, 1)
        found |= np.pad(step, pad)
    return _widened(found, reach) & facing(inputs)


EDGES = Mask(
    "within a 60th of the height of shadow edges",
    edges,
    "Pixels within a 60th of the picture's height of a step of the exact shadow, where any light would arrive.",
    "there is no shadow's edge",
)


def _residual(value: Array, reference: Array, inputs: Inputs) -> Array:
    return np.asarray(value - reference)


def lit_error(about: str) -> Metric:
    """The root mean square of what lit fractions are off by."""
    return Metric("rms error of the lit fraction", _residual, about=line(about))


def display(inputs: Inputs, value: Array) -> Array:
    """Surfaces as the lights would show them, in this shadow."""
    bright = color.luminance(inputs.spread(inputs.unshadowed.sum(0))) * inputs.exposure
    shown = color.encode_transfer(np.clip(np.nan_to_num(value) * bright, 0, 1))[..., None].repeat(3, -1)
    shown[np.isnan(value)] = (1, 0, 1)
    return np.asarray((shown * 255 + 0.5).astype(np.uint8))


def near_and_far(name: str, scene: Any) -> Mapping[str, Camera]:
    """The scene's own camera, and one that has gone three fifths of the way towards what it looks at."""
    camera = own_camera(name, scene)[""]
    eye, target = np.asarray(camera.eye, float), np.asarray(camera.target, float)
    x, y, z = (eye + 0.6 * (target - eye)).tolist()
    return {"far": camera, "near": replace(camera, eye=(x, y, z))}


def line(text: str) -> str:
    """A text without its line breaks."""
    return " ".join(text.split())
