"""Smooth and rough interfaces of clear bodies."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from ._model import Model, color, option, parameter
from ._numbers import LEAST, MASKINGS, MOST, SHAPES, _Rough, _strength
from .artists import MetallicRoughness

__all__ = ["Dielectric", "RoughDielectric"]


@dataclass(frozen=True)
class Dielectric(Model):
    """The smooth interface of two clear bodies: glass, water.

    Parameters
    ----------
    eta : array_like
        Index of the body over that outside, in [1e-9, 1e9]; 1.5 is glass in air.
    tint : array_like, shape (..., 3)
        A factor of what passes, in [0, 1].

    Notes
    -----
    Specular: `eval` and `pdf` are zero; `sample` reflects with the probability that Fresnel's equations give, and
    refracts otherwise. The weight of what is refracted holds radiance's factor: the square of the index on the side of
    `wo` over that on the side of `wi`.

    References
    ----------
    M. Born, E. Wolf, *Principles of Optics*, 1999, section 1.5.

    Examples
    --------
    >>> Dielectric(1.5).sample([0, 0, 1], [0, 0, 0.5]).weight.round(4)
    array([0.4444, 0.4444, 0.4444])
    """

    eta: Any = parameter(1.5, 0, LEAST, MOST)
    tint: Any = color((1.0, 1.0, 1.0))
    _kind: ClassVar[int] = 3
    _transmits: ClassVar[bool] = True

    def _numbers(self) -> list[Any]:
        eta, tint = self._parameters()
        return [tint, eta]

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness((0.0, 0.0, 0.0), roughness=0.0, specular=_strength(self.eta))


@dataclass(frozen=True)
class RoughDielectric(_Rough):
    """Rough glass: microscopic smooth interfaces that reflect and refract.

    Parameters
    ----------
    alpha : array_like
        Width of the distribution of normals (along x), in (0, 1]; the square of an artist's roughness.
    eta : array_like
        Index of the body over that outside, in [1e-9, 1e9].
    alpha_y : array_like, optional
        Width along y, where it differs.
    distribution : {"ggx", "beckmann"}
    masking : {"separable", "height_correlated", "schlick", "v_cavity"}
        Of reflection; what is refracted takes Smith's separable form.
    tint : array_like, shape (..., 3)
        A factor of what passes, in [0, 1].

    Notes
    -----
    Values are for radiance: what is refracted is divided by the square of the index that it meets (for `wo` outside).
    ``eval(wi, wo) * η(wi)² == eval(wo, wi) * η(wo)²``, with the index on each direction's side. Near η = 1 the lobe of
    what is refracted is |η − 1| alpha wide, which directions in float32 do not resolve below 1e-5; η = 1 passes light
    straight, specular. Beckmann facets narrower than 0.01 lose light in float32 at cosines below 1e-3, as those of
    `RoughConductor` do.

    What facets send on to each other is lost, and nothing gives it back. Of the power that comes from everywhere on one
    side, at η = 1.5 and √alpha 0.25, 0.5, 0.75 and 1: 0.5, 3, 11 and 25 % from outside, 1.5, 14, 36 and 56 % from
    within, where much is reflected totally and more often than once. Below √alpha = 0.25 it is less than 2 %.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

    Examples
    --------
    >>> RoughDielectric(0.5).eval([0, 0, -1], [0, 0, 1]).round(4)
    array([4.8892, 4.8892, 4.8892])
    """

    alpha: Any = parameter(0.1, 0, high=1.0, above=0.0)
    eta: Any = parameter(1.5, 0, LEAST, MOST)
    alpha_y: Any = parameter(None, 0, high=1.0, above=0.0)
    distribution: Literal["ggx", "beckmann"] = option("ggx", SHAPES)
    masking: Literal["height_correlated", "separable", "schlick", "v_cavity"] = option("separable", MASKINGS)
    tint: Any = color((1.0, 1.0, 1.0))
    _kind: ClassVar[int] = 5
    _transmits: ClassVar[bool] = True

    def _numbers(self) -> list[Any]:
        alpha, eta, alpha_y, distribution, masking, tint = self._parameters()
        return [tint, eta, alpha, alpha_y, distribution, masking]

    def _stand_in(self) -> MetallicRoughness:
        roughness = math.sqrt(math.sqrt(self.alpha * self.alpha_y))
        return MetallicRoughness((0.0, 0.0, 0.0), 0.0, roughness, _strength(self.eta))
