"""Masking functions: how the forms of G differ by roughness and angle, and what they cost."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import brdf
from ..question import Candidate, Case, Metric, Question

__all__ = ["Surface", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Surface:
    """Facets of a distribution and an artist's roughness."""

    roughness: float
    distribution: str = "ggx"


_SCENES = {
    "smooth (0.25)": Surface(0.25),
    "middling (0.5)": Surface(0.5),
    "rough (1)": Surface(1.0),
    "Beckmann, middling": Surface(0.7, "beckmann"),
}


@dataclass(frozen=True)
class Pairs:
    """Directions (H, W, 3): the eye from grazing at the bottom to the normal, the light so from left to right."""

    surface: Surface
    wi: Array
    wo: Array
    exact: Array


def _at(cosine: Array, azimuth: float) -> Array:
    sine = np.sqrt(1 - cosine * cosine)
    return np.stack([sine * np.cos(azimuth), sine * np.sin(azimuth), cosine], -1)


def _form(surface: Surface, wi: Array, wo: Array, masking: Any) -> Array:
    distribution: Any = surface.distribution
    return brdf.masking_shadowing(wi, wo, surface.roughness**2, distribution, masking)


def _setup(case: Case) -> Pairs:
    surface = case.scene
    if not isinstance(surface, Surface):
        raise ValueError(
            f"scene: this question has scenes of its own, or takes a Surface, got {type(surface).__name__}"
        )
    width, height = case.size
    x = (np.arange(width) + 0.5) / width
    y = 1 - (np.arange(height) + 0.5) / height
    wi = np.broadcast_to(_at(x, np.pi), (height, width, 3))
    wo = np.broadcast_to(_at(y, 0.0)[:, None], (height, width, 3))
    wi, wo = np.ascontiguousarray(wi, case.dtype), np.ascontiguousarray(wo, case.dtype)
    exact = _form(surface, wi.astype(np.float64), wo.astype(np.float64), "height_correlated")
    return Pairs(surface, wi, wo, exact)


def _run(inputs: Pairs, prepared: Any, masking: str) -> Array:
    return _form(inputs.surface, inputs.wi, inputs.wo, masking)


def _residual(value: Array, reference: Array, inputs: Pairs) -> Array:
    return np.asarray(np.asarray(value, np.float64) - reference)


def _display(inputs: Pairs, value: Array) -> Array:
    gray = (np.clip(value, 0, 1) * 255 + 0.5).astype(np.uint8)
    return np.repeat(gray[..., None], 3, -1)


_ABOUT = """The share of facets that eye and light both see, G, has several forms. The reference is Smith's,
height-correlated: of the forms that keep the projected area it is the one that knows that high facets are seen by both.
How far are the product of two, Schlick's rational form and grooves from it, and do they spare time? Smith's forms do
not know the azimuth between eye and light: where both are on one side all of them are too dark."""


def question() -> Question:
    """The question, ready to be run."""
    forms = ("height_correlated", "separable", "schlick", "v_cavity")
    return Question(
        "masking functions",
        _SCENES,
        lambda inputs: inputs.exact,
        Metric("G", _residual, "", "root mean square of the difference of G over both cosines", "rms"),
        [Candidate("masking", _run, {"masking": forms}, about="G of two directions.")],
        setup=_setup,
        display=_display,
        size=(256, 256),
        about=" ".join(_ABOUT.split()),
        element="pair",
        max_error=0.05,
    )
