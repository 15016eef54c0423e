"""Path tracing strategies: how fast the error falls with time, by how light is looked for and where it comes from."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import color, light, mesh, pathtrace, transform
from ...accel import BVH
from ...environment import Environment
from ...scene import Camera, Instance, Material, Scene
from ..question import Candidate, Case, Mask, Metric, MonteCarlo, Question

__all__ = ["question"]

Array = NDArray[Any]

SAMPLES = (4, 16, 64)
"""How many samples a pixel has."""

_DEPTH = 6


def _matt(*reflectance: float) -> Material:
    return Material(reflectance, specular=0.0)  # type: ignore[arg-type]


def _thing(shape: mesh.Mesh, material: Material, at: tuple[float, float, float], turn: float = 0.0) -> Instance:
    return Instance(shape, transform.translate(at) @ transform.rotate_axis((1, 0, 0), turn), (material,))


def _room(lamp: light.RectLight) -> Scene:
    """A room open to the eye, with a block in it: most light arrives by walls."""
    grey, quarter = _matt(0.7, 0.7, 0.7), math.pi / 2
    things = [
        _thing(mesh.plane((2, 2)), grey, (0, -1, 0)),
        _thing(mesh.plane((2, 2)), grey, (0, 1, 0), math.pi),
        _thing(mesh.plane((2, 2)), grey, (0, 0, -1), quarter),
        _thing(mesh.box((0.1, 2, 2)), _matt(0.6, 0.1, 0.1), (-1.05, 0, 0)),
        _thing(mesh.box((0.1, 2, 2)), _matt(0.1, 0.5, 0.1), (1.05, 0, 0)),
        _thing(mesh.box((0.6, 1.0, 0.6)), grey, (0.2, -0.5, -0.2)),
    ]
    return Scene(things, lamp, Camera((0, 0, 3.6), (0, 0, 0), fov_y=0.72))


def _small_lamp() -> Scene:
    return _room(light.RectLight((0, 0.95, 0), (0.1, 0, 0), (0, 0, 0.1), (400,) * 3))


def _bright_ceiling() -> Scene:
    return _room(light.RectLight((0, 0.98, 0), (1.8, 0, 0), (0, 0, 1.8), (1.5,) * 3))


def _mirrors() -> Scene:
    """Plates from polished to rough that show lamps from small to large (E. Veach's comparison of strategies)."""
    things = [_thing(mesh.plane((8, 8)), _matt(0.3, 0.3, 0.3), (0, -0.6, 0))]
    for i, roughness in enumerate((0.15, 0.3, 0.45, 0.6)):
        plate = Material((0.8, 0.8, 0.8), 1.0, roughness)
        things.append(_thing(mesh.plane((3.2, 0.45)), plate, (0, -0.35 + 0.22 * i, 0.7 - 0.5 * i), 0.2 + 0.14 * i))
    lamps = [
        light.SphereLight((-1.2 + 0.8 * i, 1.3, -1.6), radius, (0.12 / radius**2,) * 3)
        for i, radius in enumerate((0.03, 0.08, 0.18, 0.35))
    ]
    return Scene(things, lamps, Camera((0, 1.1, 4.2), (0, 0.2, 0), fov_y=0.65))


def _sky() -> Scene:
    """A ball and a block on the ground under a sky with its sun, a panorama."""
    rows, columns = 64, 128
    height = np.cos((np.arange(rows) + 0.5) / rows * np.pi)[:, None, None]
    blue = np.array([0.3, 0.5, 1.0]) * (1.2 - np.clip(height, 0, 1))
    ground = np.array([0.15, 0.13, 0.1])
    panorama = np.broadcast_to(np.where(height > 0, blue, ground), (rows, columns, 3)).copy()
    panorama[14:16, 40:42] = (900, 800, 600)
    things = [
        _thing(mesh.plane((8, 8)), _matt(0.5, 0.5, 0.5), (0, -0.5, 0)),
        _thing(mesh.icosphere(4, 0.5), Material((0.9, 0.7, 0.4), 1.0, 0.4), (-0.5, 0, 0)),
        _thing(mesh.box((0.7, 0.7, 0.7)), _matt(0.7, 0.4, 0.3), (0.6, -0.15, -0.2)),
    ]
    camera = Camera((0.4, 0.7, 3), (0, -0.1, 0), fov_y=0.6)
    return Scene(things, (), camera, environment=Environment(panorama.astype(np.float32)))


_SCENES = {
    "room, small lamp": _small_lamp,
    "room, bright ceiling": _bright_ceiling,
    "mirrors and lamps": _mirrors,
    "under a sky": _sky,
}


@dataclass(frozen=True)
class _Inputs:
    scene: Scene
    size: tuple[int, int]
    bvh: BVH
    brightness: float
    """Mean radiance of what is judged, to which errors are relative."""
    judged: Array
    """Pixels that show neither lamps nor sky, not even at an edge."""

    def trace(self, samples: int, seed: int, strategy: Any = "mis", start: int = 0, depth: int = _DEPTH) -> Array:
        traced = pathtrace.path_trace(
            self.scene,
            self.size,
            samples,
            depth,
            seed,
            start=start,
            strategy=strategy,
            bvh=self.bvh,
            dtype=self.bvh._positions.dtype,
        )
        return traced.radiance


def _setup(case: Case) -> _Inputs:
    scene = case.scene() if callable(case.scene) else case.scene
    if not isinstance(scene, Scene):
        raise ValueError(f"scene: expected a Scene, got {type(scene).__name__}")
    arrays = scene.flatten(case.dtype)
    pilot = _Inputs(scene, case.size, BVH(arrays.positions, arrays.faces), 1.0, np.empty(0))
    judged = pilot.trace(256, case.seed + 7, depth=0).max(-1) == 0
    mean = float(pilot.trace(64, case.seed + 7)[judged].mean(dtype=np.float64)) if judged.any() else 0.0
    return _Inputs(scene, case.size, pilot.bvh, mean if mean > 0 else 1.0, judged)


def _estimate(inputs: _Inputs, samples: int, seed: int, start: int, where: Array | None) -> Array:
    # By all strategies weighed, which misses nothing that one of them finds.
    return inputs.trace(samples, seed, start=start)


def _run(strategy: str) -> Callable[..., Array]:
    def run(inputs: _Inputs, prepared: Any, samples: int, seed: int) -> Array:
        return inputs.trace(samples, seed, strategy)

    return run


def _display(inputs: _Inputs, value: Array) -> Array:
    mapped = color.encode_transfer(np.clip(value / (2.5 * inputs.brightness), 0, 1))
    return np.asarray(mapped * 255 + 0.5).astype(np.uint8)


_METRIC = Metric(
    "error of radiance",
    lambda value, reference, inputs: (value.astype(np.float64) - reference).mean(-1) / inputs.brightness,
    about="Root mean square over pixels of the channels' mean, as a fraction of the mean radiance there: fireflies "
    "count.",
)

_STRATEGIES = {
    "uniform": "Directions evenly over the hemisphere: finds lamps by luck, and mirrors' images hardly ever.",
    "bsdf": "Directions of the material: good on mirrors and under large lights, poor under small ones.",
    "light": "Lights are asked: good on matt surfaces, poor where a polished one shows a large light.",
    "mis": "Both, weighed by the power heuristic: two chances at each light for one ray more.",
}

_ABOUT = """All four ways of looking for light agree in the mean; what they differ in is how long their noise lasts.
Directions drawn evenly serve no scene; those of the material find large lights, those towards lights find small ones,
and the two weighed against each other are never far from the better one. Errors are of whole pictures of light paths of
up to six reflections, with the same scrambled points for all."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "path tracing strategies",
        _SCENES,
        MonteCarlo(_estimate, first=256, most=1 << 12),
        _METRIC,
        [
            Candidate(
                name,
                _run(name),
                {"samples": SAMPLES},
                counters=lambda inputs, samples: {"samples": float(samples)},
                seeded=True,
                about=about,
            )
            for name, about in _STRATEGIES.items()
        ],
        Mask(
            "lit surfaces",
            lambda reference, inputs: inputs.judged,
            "Pixels in which neither lamps nor the sky are seen themselves: their edges are no strategy's.",
            "no pixel shows a surface alone",
        ),
        setup=_setup,
        display=_display,
        size=(96, 64),
        about=" ".join(_ABOUT.split()),
        max_error=0.2,
    )
