"""Area lights on glossy floors: what each way to find the mirrors' light costs, and how far it errs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import light
from ..question import Candidate, Case, Mask, Metric, Question

__all__ = ["Floor", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Floor:
    """A floor of metal of one roughness under a light."""

    light: light.RectLight | light.DiskLight | light.SphereLight
    roughness: float = 0.5


_PANEL = light.RectLight((0, 1.2, -0.5), (2, 0, 0), (0, 0.6, 0.8), (5, 5, 5))
_WALL = light.RectLight((0, 0.5, -2), (3, 0, 0), (0, 1.0, 0), (5, 5, 5))
# Stripes that grow brighter to one side, of the panel's mean.
_STRIPES = np.repeat(np.arange(16) % 2 * np.arange(16) / 4.0, 4)[None, :, None] * np.ones((8, 1, 3))
_SCREEN = light.RectLight((0, 1.2, -0.5), (2, 0, 0), (0, 0.6, 0.8), (5, 5, 5), texture=_STRIPES)
_SCENES = {
    "panel, roughness 0.1": Floor(_PANEL, 0.1),
    "panel, roughness 0.3": Floor(_PANEL, 0.3),
    "panel, roughness 0.6": Floor(_PANEL, 0.6),
    "panel, roughness 1": Floor(_PANEL, 1.0),
    "picture, roughness 0.3": Floor(_SCREEN, 0.3),
    "wall to the floor, roughness 0.3": Floor(_WALL, 0.3),
    "small panel, roughness 0.3": Floor(light.RectLight((0, 1.5, -1), (0.1, 0, 0), (0, 0, 0.1), (500,) * 3), 0.3),
    "sphere, roughness 0.3": Floor(light.SphereLight((0, 1, -0.5), 0.4, (5, 5, 5)), 0.3),
    "disk, roughness 0.3": Floor(light.DiskLight((0, 1, -0.5), (0, -1, 0), 0.6, (5, 5, 5)), 0.3),
}

_VIEWS = {"from above": 3.0, "grazing": 0.4}

# Beyond what single precision and the eye can tell: relative 1e-4 of the lobe.
_REFERENCE = 1 << 12


@dataclass(frozen=True)
class _Inputs:
    floor: Floor
    points: Array
    eye: Array

    def shade(self, **how: Any) -> Array:
        up = np.array([0, 1, 0], self.points.dtype)
        grey = np.full(3, 0.9, self.points.dtype)
        lamp, roughness = self.floor.light, self.floor.roughness
        found: Array = light.unshadowed(lamp, self.points, up, grey, 1.0, roughness, eye=self.eye, **how)[..., 0]
        return found


def _setup(case: Case) -> _Inputs:
    floor = case.scene
    if not isinstance(floor, Floor):
        raise ValueError(f"scene: this question has scenes of its own, or takes a Floor, got {type(floor).__name__}")
    width, height = case.size
    x = (np.arange(width) + 0.5) / width * 6 - 3
    z = (np.arange(height) + 0.5) / height * 4 - 2
    points = np.stack(np.broadcast_arrays(x, np.zeros((height, 1)), z[:, None]), -1)
    return _Inputs(floor, points.astype(case.dtype), np.array([0, case.view, 4], case.dtype))


def _reference(inputs: _Inputs) -> Array:
    exact = _Inputs(inputs.floor, inputs.points.astype(np.float64), inputs.eye.astype(np.float64))
    return exact.shade(samples=_REFERENCE)


_METRIC = Metric(
    "error of radiance",
    lambda value, reference, inputs: (value - reference) / max(float(reference.max()), 1e-30),
    about="Reflected radiance against that of many samples, over the brightest of the picture: what is seen.",
)

_LOBE = Mask(
    "highlight",
    lambda reference, inputs: reference > 0.01 * reference.max(),
    "pixels that are at least a hundredth as bright as the brightest",
)


def _run(**how: Any) -> Callable[..., Array]:
    return lambda inputs, prepared, **knobs: inputs.shade(**how, **knobs)


_ABOUT = """A rough mirror shows an area light as a blurred patch, an integral of the lobe over the light. It may be
averaged over points of the light and directions of the lobe, found in closed form for a lobe that is nearly the same
(linearly transformed cosines), or guessed from one point. How large is the error, over the highlight and relative to
its brightest pixel, and what does it cost? Nothing stands in the way of the light; the floor is of metal, so that all
of its light is the mirrors'."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "area lights",
        _SCENES,
        _reference,
        _METRIC,
        [
            Candidate(
                "ltc",
                _run(method="ltc"),
                counters=lambda inputs: {"samples": 0},
                about="Linearly transformed cosines from a table of 32 × 32 lobes: no noise, a smooth bias.",
            ),
            Candidate(
                "representative point",
                _run(method="representative_point"),
                counters=lambda inputs: {"samples": 1},
                about="All light from the point nearest to the mirror direction, under a wider lobe.",
            ),
            Candidate(
                "samples",
                _run(),
                {"samples": [1, 4, 16, 64, 256]},
                counters=lambda inputs, samples: {"samples": 2 * samples},
                seeded=True,
                about="Points of the light and directions of the lobe, by the balance heuristic; noise without bias.",
            ),
        ],
        views=lambda name, scene: _VIEWS,
        mask=_LOBE,
        setup=_setup,
        size=(160, 96),
        about=" ".join(_ABOUT.split()),
        max_error=0.02,
    )
