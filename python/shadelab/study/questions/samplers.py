"""Samplers: how the error of an average falls with the number of points, by the kind of integrand."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import sampling
from ..question import Candidate, Case, Metric, Question

__all__ = ["Integrand", "question", "rates"]

Array = NDArray[Any]

COUNTS = (4, 16, 64, 256, 1024)
"""How many points an average is taken over."""


@dataclass(frozen=True)
class Integrand:
    """A function on the unit cube that differs from pixel to pixel, and its integral.

    `evaluate(u, pixel)` takes points (P, n, D) of P pixels and the numbers `parameters` gave for each; `exact(pixel)`
    gives the integrals. `parameters` are drawn uniformly from [0, 1), so many a pixel.
    """

    dimensions: int
    parameters: int
    evaluate: Callable[[Array, Array], Array]
    exact: Callable[[Array], Array]


def _exponent(p: Array) -> Array:
    return 1 + 2 * p[:, :2]


def _smooth(u: Array, p: Array) -> Array:
    return np.asarray(np.exp(-(u * _exponent(p)[:, None]).sum(-1)))


def _smooth_exact(p: Array) -> Array:
    return np.asarray((-np.expm1(-_exponent(p)) / _exponent(p)).prod(1))


def _disk(u: Array, p: Array) -> Array:
    radius = 0.15 + 0.2 * p[:, 2]
    center = radius[:, None] + (1 - 2 * radius[:, None]) * p[:, :2]
    return np.asarray(((u - center[:, None]) ** 2).sum(-1) < radius[:, None] ** 2, np.float64)


def _disk_exact(p: Array) -> Array:
    return np.asarray(np.pi * (0.15 + 0.2 * p[:, 2]) ** 2)


def _weights(p: Array) -> Array:
    # The first dimensions matter most, as they do along a path.
    return (0.5 + p) / (1 + np.arange(p.shape[1]))


def _high(u: Array, p: Array) -> Array:
    return np.asarray((1 + _weights(p)[:, None] * (3 * u**2 - 1)).prod(-1))


def _high_exact(p: Array) -> Array:
    return np.ones(len(p))


def _corner(u: Array, p: Array) -> Array:
    return np.asarray(u.sum(-1) < _sum(u.shape[-1], p)[:, None], np.float64)


def _sum(dimensions: int, p: Array) -> Array:
    return np.asarray(dimensions * (0.4 + 0.2 * p[:, 0]))


def _corner_exact(p: Array) -> Array:
    """The distribution of a sum of eight uniform numbers (Irwin and Hall), whose terms stay below 1e4."""
    t = _sum(8, p)
    terms = [(-1) ** k * math.comb(8, k) * np.maximum(t - k, 0) ** 8 for k in range(9)]
    return np.asarray(sum(terms) / math.factorial(8))


_SCENES = {
    "smooth, 2 dimensions": Integrand(2, 2, _smooth, _smooth_exact),
    "an edge, 2 dimensions": Integrand(2, 3, _disk, _disk_exact),
    "smooth, 16 dimensions": Integrand(16, 16, _high, _high_exact),
    "an edge, 8 dimensions": Integrand(8, 1, _corner, _corner_exact),
}


@dataclass(frozen=True)
class _Inputs:
    integrand: Integrand
    shape: tuple[int, int]
    parameters: Array


def _setup(case: Case) -> _Inputs:
    if not isinstance(case.scene, Integrand):
        raise ValueError(
            f"scene: this question has scenes of its own, or takes an Integrand, got {type(case.scene).__name__}"
        )
    width, height = case.size
    pixel = np.arange(width * height)[:, None]
    drawn = sampling.Generator(case.seed).uniform(pixel, 2**32 - 1, np.arange(case.scene.parameters))
    return _Inputs(case.scene, (height, width), drawn)


def _average(inputs: _Inputs, count: int, points: Callable[[Array], Array]) -> Array:
    """Averages over `count` points of each pixel, some pixels at a time."""
    integrand, total = inputs.integrand, len(inputs.parameters)
    out = np.empty(total)
    step = max((1 << 18) // (count * integrand.dimensions), 1)
    for first in range(0, total, step):
        pixel = np.arange(first, min(first + step, total))
        out[pixel] = integrand.evaluate(points(pixel), inputs.parameters[pixel]).mean(1)
    return out.reshape(inputs.shape)


def _by_pairs(kind: sampling.SamplerKind) -> Callable[..., Array]:
    def run(inputs: _Inputs, prepared: Any, samples: int, seed: int) -> Array:
        sampler = sampling.Sampler(kind, seed, samples)
        sample, dimension = np.arange(samples)[:, None], np.arange(inputs.integrand.dimensions)
        return _average(inputs, samples, lambda pixel: sampler.uniform(pixel[:, None, None], sample, dimension))

    return run


def _whole(inputs: _Inputs, prepared: Any, samples: int, seed: int) -> Array:
    def points(pixel: Array) -> Array:
        # A scramble for each pixel.
        keys = [(seed * 2**24 + int(p)) % 2**64 for p in pixel]
        return np.stack([sampling.sobol(samples, inputs.integrand.dimensions, seed=k) for k in keys])

    return _average(inputs, samples, points)


def rates(records: Any) -> dict[tuple[str, str], float]:
    """Fitted exponents: how the error falls with the number of points.

    Parameters
    ----------
    records : sequence of Record
        Those of this question's study, `study.run("samplers").records`.

    Returns
    -------
    dict of (technique, scene) to float
        The slope of log error over log n, by least squares: -1/2 for independent points, -3/2 at best.
    """
    found: dict[tuple[str, str], list[tuple[float, float]]] = {}
    for r in records:
        if r.error is not None and r.error.value > 0:
            found.setdefault((r.technique, r.scene), []).append((math.log(r.knobs["samples"]), math.log(r.error.value)))
    return {key: _slope(np.array(points)) for key, points in found.items() if len(points) > 1}


def _slope(points: Array) -> float:
    return float(np.polyfit(points[:, 0], points[:, 1], 1)[0])


_METRIC = Metric(
    "error of the average",
    lambda value, reference, inputs: np.asarray(value) - reference,
    about="Root mean square over the pixels, each with an integrand and points of its own, against the closed form.",
    signs=("too small", "too large"),
)

_ABOUT = """An average over n points errs by n^-1/2 if they are drawn independently. Points that keep out of each
other's way do better, by how much depends on the integrand: on smooth ones up to n^-3/2, on edges n^-3/4 in two
dimensions; and what is gained shrinks as dimensions grow. Each pixel is an integrand of its own, and its exact integral
is known. A time is that of drawing the points and evaluating the integrand."""

_TECHNIQUES: Mapping[str, tuple[sampling.SamplerKind | None, str]] = {
    "independent": ("independent", "Random points (Philox)."),
    "stratified": ("stratified", "A jittered grid in each pair of dimensions."),
    "latin hypercube": ("latin_hypercube", "Strata along each axis, combined at random."),
    "multi-jittered": ("multi_jittered", "A grid in each pair, and strata along both axes."),
    "R2": ("r2", "The golden ratio's sequence in each pair, randomly turned, in an order of the pair's own."),
    "Halton": ("halton", "Halton's sequence with nested scrambling, all dimensions together."),
    "Sobol, pairs": (
        "sobol",
        "The first two dimensions of Sobol's sequence, Owen-scrambled and shuffled for each pair.",
    ),
    "Sobol, whole": (None, "Sobol's sequence in all dimensions together, Owen-scrambled."),
}


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "samplers",
        _SCENES,
        lambda inputs: inputs.integrand.exact(inputs.parameters).reshape(inputs.shape),
        _METRIC,
        [
            Candidate(
                name,
                _whole if kind is None else _by_pairs(kind),
                {"samples": COUNTS},
                counters=lambda inputs, samples: {"points/pixel": float(samples)},
                seeded=True,
                about=about,
            )
            for name, (kind, about) in _TECHNIQUES.items()
        ],
        setup=_setup,
        size=(24, 16),
        about=" ".join(_ABOUT.split()),
        element="average",
        max_error=0.01,
    )
