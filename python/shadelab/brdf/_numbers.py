"""What the parameters of several models share: bounds, options, stand-ins for reflectance."""

from __future__ import annotations

from typing import Any, ClassVar

import numpy as np

from ._model import Model
from .interface import fresnel, fresnel_average

SHAPES = ("ggx", "beckmann")
DIFFUSERS = ("qualitative", "energy_preserving")
COMPENSATIONS = ("none", "kulla_conty", "kulla_conty_as_published", "scaled")
# Clear facets absorb nothing, so that the forms of the colour are one.
GLASS_COMPENSATIONS = ("none", "kulla_conty", "scaled")
MASKINGS = ("height_correlated", "separable", "schlick", "v_cavity")
# Beyond these squares of squares are no numbers in single, and pictures no others: a mirror, a point.
LEAST, MOST = 1e-9, 1e9
# Copper, at 630, 532 and 465 nm.
COPPER_ETA = (0.2004, 0.924, 1.1022)
COPPER_K = (3.9129, 2.4528, 2.1421)


class _Rough(Model):
    """Models of microscopic facets: `alpha_y` is `alpha` where it is not given."""

    alpha: Any
    alpha_y: Any
    _facets: ClassVar[bool] = True

    def __post_init__(self) -> None:
        if self.alpha_y is None:
            object.__setattr__(self, "alpha_y", self.alpha)
        super().__post_init__()


_UNIT = {"core": 0, "low": 0.0, "high": 1.0, "above": None}


def _flag(on: bool) -> tuple[float, Any]:
    return float(on), _UNIT


def _passes(eta: Any) -> tuple[Any, Any]:
    """What an interface passes of diffuse light that meets the larger index."""
    eta = np.asarray(eta, np.float64)
    with np.errstate(all="ignore"):
        return np.clip(1 - fresnel_average(np.maximum(eta, 1 / eta)), 0.0, 1.0), _UNIT


def _grazing(eta: Any) -> tuple[Any, Any]:
    """What an interface reflects of diffuse light under Schlick's weight, (1 − cos θ)⁵."""
    x, weight = np.polynomial.legendre.leggauss(64)
    cosine = (x + 1) / 2
    eta = np.asarray(eta, np.float64)[..., None]
    with np.errstate(all="ignore"):
        reflected = fresnel(cosine, eta) * (weight * cosine * (1 - cosine) ** 5)
    return np.clip(reflected.sum(-1), 0.0, 1.0), _UNIT


def _metal(m: Any) -> tuple[float, ...]:
    """Reflectance at normal incidence."""
    return tuple((_normal_reflectance(np.asarray(m.eta), np.asarray(m.k)) * m.tint).tolist())


def _normal_reflectance(eta: Any, k: Any) -> Any:
    return ((eta - 1) ** 2 + k * k) / ((eta + 1) ** 2 + k * k)


def _strength(eta: float) -> float:
    """Reflectance at normal incidence over that of the glass that metallic-roughness has."""
    return min(1.0, ((eta - 1) / (eta + 1)) ** 2 / 0.04)
