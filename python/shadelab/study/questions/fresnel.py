"""Fresnel reflectance: what Schlick's polynomial, or a constant, costs and loses by body and angle."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import brdf
from ..question import Candidate, Case, Metric, Question

__all__ = ["Body", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Body:
    """Index and extinction, per channel; without extinction it is clear."""

    eta: tuple[float, float, float]
    k: tuple[float, float, float] | None = None


# Metals at 630, 532 and 465 nm.
_SCENES = {
    "glass": Body((1.5, 1.5, 1.5)),
    "water": Body((1.33, 1.33, 1.33)),
    "diamond": Body((2.42, 2.42, 2.42)),
    "gold": Body((0.18, 0.54, 1.33), (3.42, 2.23, 1.86)),
    "copper": Body((0.2004, 0.924, 1.1022), (3.9129, 2.4528, 2.1421)),
    "aluminium": Body((1.37, 0.94, 0.63), (7.6, 6.46, 5.58)),
}


@dataclass(frozen=True)
class Incidence:
    """Cosines (H, W, 3), one for each pixel, and what the body is made of."""

    cosines: Array
    eta: Array
    k: Array | None
    f0: Array
    exact: Array


def _setup(case: Case) -> Incidence:
    body = case.scene
    if not isinstance(body, Body):
        raise ValueError(f"scene: this question has scenes of its own, or takes a Body, got {type(body).__name__}")
    width, height = case.size
    # Left to right from the normal to grazing, by even steps of the angle; all rows alike.
    angle = (np.arange(width) + 0.5) / width * (np.pi / 2)
    cosines = np.broadcast_to(np.cos(angle)[:, None], (height, width, 3)).astype(case.dtype)
    eta = np.asarray(body.eta)
    k = None if body.k is None else np.asarray(body.k)
    extinction = 0.0 if k is None else k
    f0 = ((eta - 1) ** 2 + extinction**2) / ((eta + 1) ** 2 + extinction**2)
    exact = brdf.fresnel(cosines.astype(np.float64), eta, k)
    return Incidence(np.ascontiguousarray(cosines), eta, k, f0, exact)


def _exact(inputs: Incidence, prepared: Any) -> Array:
    return brdf.fresnel(inputs.cosines, inputs.eta, inputs.k)


def _schlick(inputs: Incidence, prepared: Any) -> Array:
    return brdf.fresnel_schlick(inputs.cosines, inputs.f0.astype(inputs.cosines.dtype))


def _constant(inputs: Incidence, prepared: Any) -> Array:
    return np.broadcast_to(inputs.f0.astype(inputs.cosines.dtype), inputs.cosines.shape).copy()


def _candidate(name: str, run: Callable[..., Array], about: str) -> Candidate:
    return Candidate(name, run, about=about)


def _residual(value: Array, reference: Array, inputs: Incidence) -> Array:
    return np.asarray((np.asarray(value, np.float64) - reference).mean(-1))


def _display(inputs: Incidence, value: Array) -> Array:
    return (np.clip(value, 0, 1) ** (1 / 2.2) * 255 + 0.5).astype(np.uint8)


_ABOUT = """A mirror's reflectance depends on the angle by Fresnel's equations. Renderers take Schlick's polynomial of
the reflectance along the normal. How far is it off, for clear bodies and for metals, and what does it spare? Glass of
1.5 is off by 0.036 at most, near 85°; metals dip before they rise, which the polynomial does not know."""


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "fresnel",
        _SCENES,
        lambda inputs: inputs.exact,
        Metric("reflectance", _residual, "", "largest difference of reflectance, mean of channels", "max"),
        [
            _candidate("fresnel", _exact, "Fresnel's equations, of η or η + ik."),
            _candidate("schlick", _schlick, "f0 + (1 − f0)(1 − cos θ)⁵: a polynomial of one parameter."),
            _candidate("constant", _constant, "The reflectance along the normal, whatever the angle."),
        ],
        setup=_setup,
        display=_display,
        size=(512, 64),
        about=" ".join(_ABOUT.split()),
        element="pixel",
        max_error=0.04,
    )
