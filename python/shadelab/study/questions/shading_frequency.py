"""Shading frequency: what light once a face, once a vertex or once a pixel costs and shows, by mesh and roughness."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import mesh, renderer, transform
from ...light import PointLight
from ...scene import Camera, Instance, Material, Scene
from ..question import Candidate, Case, Mask, Metric, Question

__all__ = ["Ball", "question"]

Array = NDArray[Any]

# The finest sphere, 81,920 faces: its shading normals are those of a sphere to 1e-3.
_FINE = 6
_SUBDIVISIONS = [1, 2, 3, 4, 5]


@dataclass(frozen=True)
class Ball:
    """A ball of one material under a lamp, as a mesh of as many faces as a candidate likes."""

    material: Material

    def scene(self, subdivisions: int) -> Scene:
        """The ball on its own: convex, so that nothing shades anything."""
        ball = Instance(mesh.icosphere(subdivisions), transform.translate([0.0, 0.0, 0.0]), self.material)
        return Scene(ball, PointLight((2.0, 3.0, 3.0), (60.0, 60.0, 60.0)), Camera((0, 0.6, 3.4), (0, 0, 0)))


_SCENES = {
    "matte": Ball(Material((0.6, 0.5, 0.4), specular=0.0)),
    "roughness 0.6": Ball(Material((0.6, 0.3, 0.2), roughness=0.6)),
    "roughness 0.35": Ball(Material((0.6, 0.3, 0.2), roughness=0.35)),
    "metal, roughness 0.3": Ball(Material((0.9, 0.7, 0.4), 1.0, 0.3)),
}


@dataclass(frozen=True)
class _Inputs:
    size: tuple[int, int]
    balls: dict[int, Scene]

    def picture(self, frequency: Any, subdivisions: int) -> Array:
        plan = renderer.plan(self.balls[subdivisions], self.size, frequency=frequency)
        found: Array = renderer.render(self.balls[subdivisions], plan).radiance
        return found


def _setup(case: Case) -> _Inputs:
    ball = case.scene
    if not isinstance(ball, Ball):
        raise ValueError(f"scene: this question has scenes of its own, or takes a Ball, got {type(ball).__name__}")
    return _Inputs(case.size, {n: ball.scene(n) for n in (*_SUBDIVISIONS, _FINE)})


def _candidate(frequency: Any, about: str) -> Candidate:
    plans: dict[tuple[int, int], Any] = {}

    def run(inputs: _Inputs, prepared: Any, subdivisions: int) -> Array:
        # What a plan costs is not the frame's.
        key = (id(inputs), subdivisions)
        if key not in plans:
            plans[key] = inputs, renderer.plan(inputs.balls[subdivisions], inputs.size, frequency=frequency)
        return np.asarray(renderer.render(inputs.balls[subdivisions], plans[key][1]).radiance)

    return Candidate(frequency, run, {"subdivisions": _SUBDIVISIONS}, counters=_counters(frequency), about=about)


def _counters(frequency: str) -> Callable[..., dict[str, float]]:
    def counted(inputs: _Inputs, subdivisions: int) -> dict[str, float]:
        faces = 20 * 4**subdivisions
        shaded = {"flat": faces, "gouraud": faces / 2 + 2, "phong": inputs.size[0] * inputs.size[1]}[frequency]
        return {"points shaded at most": shaded, "faces": faces}

    return counted


def _residual(value: Array, reference: Array, inputs: _Inputs) -> Array:
    return np.asarray((np.asarray(value, np.float64) - reference).mean(-1) / float(reference.max()))


_METRIC = Metric(
    "error of radiance",
    _residual,
    about="Radiance beside that of the finest ball shaded at every pixel, over the brightest of the picture.",
)

# Where the coarsest ball of all is seen as well, so that outlines, which no frequency mends, do not count.
_INSIDE = Mask(
    "within the outline",
    lambda reference, inputs: inputs.picture("flat", 1).sum(-1) + inputs.picture("phong", 1).sum(-1) > 0,
    "pixels that even the ball of 80 faces covers and its light reaches",
)

_ABOUT = """Light may be worked out once a face (flat), once a vertex and interpolated (Gouraud), or once a pixel with
the interpolated normal (Phong). Fewer places are cheaper only where they are fewer than pixels; what they miss is the
highlight between them. How many faces does each need for a given error, by roughness? The ball is convex, its outline
left out, so that shading alone differs."""


def question() -> Question:
    """The question, ready to be run."""
    about = {
        "flat": "Once a face, at its middle, with the face's own normal: bands as wide as faces.",
        "gouraud": "Once a vertex, then linear: highlights between vertices are lost, or flash as they pass one.",
        "phong": "Once a pixel: the error left is that of interpolated normals and of the mesh's place.",
    }
    return Question(
        "shading frequency",
        _SCENES,
        lambda inputs: inputs.picture("phong", _FINE).astype(np.float64),
        _METRIC,
        [_candidate(name, text) for name, text in about.items()],
        mask=_INSIDE,
        setup=_setup,
        size=(320, 240),
        about=" ".join(_ABOUT.split()),
        element="pixel",
        max_error=0.01,
    )
