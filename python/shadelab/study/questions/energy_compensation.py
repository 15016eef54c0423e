"""Energy compensation: what single bounces lose by roughness, and what giving it back costs."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ... import brdf, sampling
from ..question import Candidate, Case, Metric, Question

__all__ = ["Furnace", "question"]

Array = NDArray[Any]


@dataclass(frozen=True)
class Furnace:
    """A perfect rough mirror, or clear rough glass, of an artist's roughness under light from everywhere."""

    roughness: float
    distribution: str = "ggx"
    eta: float | None = None
    """Of glass: the index across its surface over that on the side of the eye."""


_SCENES = {f"roughness {r:g}": Furnace(r) for r in (0.25, 0.5, 0.75, 1.0)}
_SCENES["Beckmann, roughness 0.75"] = Furnace(0.75, "beckmann")
_SCENES["glass from outside, roughness 0.75"] = Furnace(0.75, eta=1.5)
_SCENES["glass from within, roughness 0.75"] = Furnace(0.75, eta=1 / 1.5)
# Draws of each pixel.
_DRAWS = 64


@dataclass(frozen=True)
class Views:
    """Directions to the eye (H, W, 1, 3), from the normal at the left to grazing, and random numbers for each."""

    furnace: Furnace
    wo: Array
    u: Array


def _setup(case: Case) -> Views:
    furnace = case.scene
    if not isinstance(furnace, Furnace):
        raise ValueError(
            f"scene: this question has scenes of its own, or takes a Furnace, got {type(furnace).__name__}"
        )
    width, height = case.size
    cosine = np.broadcast_to(1 - (np.arange(width) + 0.5) / width, (height, width))
    wo = np.stack([np.sqrt(1 - cosine**2), np.zeros_like(cosine), cosine], -1)[:, :, None]
    # One sequence over each column, so that its mean is that of all its draws.
    u = sampling.sobol(_DRAWS * height, 3, seed=case.seed).reshape(height, 1, _DRAWS, 3)
    u = np.broadcast_to(u, (height, width, _DRAWS, 3))
    return Views(furnace, np.ascontiguousarray(wo, case.dtype), np.ascontiguousarray(u, case.dtype))


def _run(inputs: Views, prepared: Any, compensation: Any) -> Array:
    """The light that comes back, by the column: drawn with the model's own density."""
    f = inputs.furnace
    distribution: Any = f.distribution
    masking: Any = "height_correlated" if distribution == "ggx" and f.eta is None else "separable"
    facets: Any = {"distribution": distribution, "masking": masking}
    model: brdf.Model
    if f.eta is None:
        model = brdf.RoughConductor(f.roughness**2, 1e-9, 1e9, **facets, compensation=compensation)
    else:
        # Clear facets colour nothing: the two colours are one.
        form: Any = "kulla_conty" if compensation == "kulla_conty_as_published" else compensation
        model = brdf.RoughDielectric(f.roughness**2, f.eta, **facets, compensation=form)
    draws = model.sample(inputs.wo, np.minimum(inputs.u, 1 - np.finfo(np.float32).eps))
    # Power rather than radiance.
    weight = draws.weight[..., 0] * draws.eta * draws.eta
    albedo = weight.mean((0, 2), dtype=np.float64)
    return np.broadcast_to(albedo, inputs.wo.shape[:2]).astype(inputs.wo.dtype)


def _residual(value: Array, reference: Array, inputs: Views) -> Array:
    # By the cosine: what a surface sends to all sides counts as it is seen.
    cosine = inputs.wo[:, :, 0, 2].astype(np.float64)
    return np.asarray((np.asarray(value, np.float64) - reference) * cosine / cosine.mean())


def _display(inputs: Views, value: Array) -> Array:
    gray = (np.clip(value, 0, 1) ** (1 / 2.2) * 255 + 0.5).astype(np.uint8)
    return np.repeat(gray[..., None], 3, -1)


_ABOUT = """Mirrors of a rough surface throw light at each other; models of one bounce lose it, a third at roughness
0.75 and 59 % at 1. Rough glass loses as well, most of light from within. A perfect mirror in a furnace must give all
back, and glass must, reflected and passed together: the reference is one. How much of it does each
compensation give back, and what do 64 draws for a direction cost
with it? The two colours of Kulla and Conty's lobe
agree here, where nothing is absorbed; they part for coloured metals."""

_FORMS = ("none", "kulla_conty", "kulla_conty_as_published", "scaled")


def question() -> Question:
    """The question, ready to be run."""
    return Question(
        "energy compensation",
        _SCENES,
        lambda inputs: np.ones(inputs.wo.shape[:2]),
        Metric("light", _residual, "", "mean share of light lost or invented, weighted by the cosine", "mean"),
        [Candidate("facets", _run, {"compensation": _FORMS}, about="Rough metal of GGX or Beckmann at F = 1; glass.")],
        setup=_setup,
        display=_display,
        size=(64, 64),
        about=" ".join(_ABOUT.split()),
        element="direction",
        max_error=0.005,
    )
