"""Pixel filters: what each lets through that the pixel grid cannot hold, what it blurs that it could, and its noise."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ...pathtrace import PixelFilter
from ..question import Candidate, Case, Mask, Metric, Question

__all__ = ["Pattern", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Pattern:
    """An image without end.

    A zone plate whose frequency reaches `frequency` cycles a pixel at half the height, or an edge leaning by `slope`.
    """

    frequency: float = 0.0
    slope: float = 0.0


_SCENES = {
    "zone plate": Pattern(frequency=1.0),
    "fine zone plate": Pattern(frequency=2.5),
    "leaning edge": Pattern(slope=0.1),
}

# Around the grid's limit neither answer is right or wrong.
_BELOW, _ABOVE = 0.4, 0.6


def _views(name: str, scene: Any) -> Mapping[str, str]:
    if getattr(scene, "frequency", 0.0):
        return {"what the grid holds": "below", "what it cannot": "above"}
    return {"the edge": "edge"}


@dataclass(frozen=True)
class Picture:
    """The image as a function of points in pixels, what a perfect low-pass leaves of it, and where that is judged."""

    image: Callable[[Array, Array], Array]
    ideal: Array
    judged: Array
    dtype: np.dtype[Any]


def _setup(case: Case) -> Picture:
    pattern = case.scene
    if not isinstance(pattern, Pattern):
        raise ValueError(
            f"scene: this question has scenes of its own, or takes a Pattern, got {type(pattern).__name__}"
        )
    width, height = case.size
    y, x = np.mgrid[:height, :width] + 0.5
    # A little off the middle, so that nothing is symmetric to the grid.
    cx, cy = width / 2 + 0.21, height / 2 - 0.13
    if pattern.frequency:
        chirp = pattern.frequency / (height / 2)

        def zones(px: Array, py: Array) -> Array:
            # The phase in double: it grows with the square of the radius.
            squared = (px - cx) ** 2 + (py - cy) ** 2
            return np.asarray(0.5 + 0.5 * np.cos(math.pi * chirp * squared))

        local = chirp * np.hypot(x - cx, y - cy)
        ideal = np.where(local < 0.5, zones(x, y), 0.5)
        judged = local < _BELOW if case.view == "below" else local > _ABOVE
        return Picture(zones, ideal, judged, case.dtype)
    normal = np.array([1.0, pattern.slope]) / math.hypot(1.0, pattern.slope)

    def edge(px: Array, py: Array) -> Array:
        return np.asarray(((px - cx) * normal[0] + (py - cy) * normal[1] > 0) * 1.0)

    distance = (x - cx) * normal[0] + (y - cy) * normal[1]
    # The step less all beyond half a cycle a pixel: the sine integral.
    ideal = 0.5 + _sine_integral(math.pi * distance) / math.pi
    return Picture(edge, ideal, np.abs(distance) < 4, case.dtype)


def _sine_integral(x: Array) -> Array:
    """∫ sin t / t from 0 to x, by Gauss-Legendre over unit steps."""
    nodes, weights = np.polynomial.legendre.leggauss(16)
    size = np.abs(x)
    steps = int(size.max(initial=0.0)) + 1
    total = np.zeros_like(size)
    for i in range(steps):
        length = np.clip(size - i, 0.0, 1.0)
        t = i + length[..., None] * (nodes + 1) / 2
        total += (np.sinc(t / math.pi) * weights).sum(-1) * length / 2
    return np.asarray(np.copysign(total, x))


def _run(name: str) -> Callable[..., Array]:
    def run(inputs: Picture, prepared: PixelFilter, radius: float, samples: int, seed: int) -> Array:
        side = math.isqrt(samples)
        height, width = inputs.ideal.shape
        y, x = np.mgrid[:height, :width] + 0.5
        rng = np.random.default_rng(seed)
        total = np.zeros((height, width))
        for i in range(side):
            for j in range(side):
                u, v = rng.random((2, height, width), np.float32)
                dx, dy = prepared.sample((u + j) / side), prepared.sample((v + i) / side)
                total += inputs.image(x + dx, y + dy)
        return (total / (side * side)).astype(inputs.dtype)

    return run


def _candidate(name: Any, radii: tuple[float, ...], about: str) -> Candidate:
    def prepare(inputs: Picture, radius: float, samples: int) -> PixelFilter:
        return PixelFilter(name, radius)

    def counters(inputs: Picture, radius: float, samples: int) -> dict[str, float]:
        return {"samples": float(samples)}

    knobs = {"radius": radii, "samples": (4, 16, 64)}
    return Candidate(name, _run(name), knobs, prepare, counters, seeded=True, about=about)


def _residual(value: Array, reference: Array, inputs: Picture) -> Array:
    return np.asarray(value, np.float64) - reference


def _display(inputs: Picture, value: Array) -> Array:
    gray = (np.clip(value, 0, 1) ** (1 / 2.2) * 255 + 0.5).astype(np.uint8)
    return np.repeat(gray[..., None], 3, -1)


_ABOUT = """A picture's pixels can hold half a cycle each. What is finer should be gone, or it comes back as patterns
that are not there; what is coarser should be as it is. The reference is a perfect low-pass, which no filter without
negative lobes can be: which one leaks least, which one blurs least, and how many samples does it take until their noise
no longer matters? Samples are drawn in proportion to the filter, on a jittered grid."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "pixel filters",
        _SCENES,
        lambda inputs: inputs.ideal,
        Metric(
            "error of the value",
            _residual,
            about="Root mean square against the image without all that is finer than half a cycle a pixel; values lie "
            "in 0 … 1.",
        ),
        [
            _candidate("box", (0.5, 1.0), "All of the pixel's square alike: sharp, and leaks at every frequency."),
            _candidate("tent", (1.0, 1.5), "Falls straight: the box twice over, its leaks squared."),
            _candidate("gaussian", (1.0, 1.5, 2.0), "A bell cut off at four deviations: hardly leaks, blurs most."),
            _candidate("blackman_harris", (1.0, 1.5, 2.0), "A window made for low side lobes: as the bell, shorter."),
        ],
        Mask(
            "where the answer is clear",
            lambda reference, inputs: inputs.judged,
            "Below 0.4 or above 0.6 cycles a pixel, or within 4 pixels of the edge.",
        ),
        views=_views,
        setup=_setup,
        display=_display,
        size=(256, 192),
        about=" ".join(_ABOUT.split()),
        max_error=0.1,
    )
