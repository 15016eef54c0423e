"""Smooth and rough interfaces of clear bodies."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from ._model import Model, color, option, parameter
from ._numbers import COMPENSATIONS, GLASS_COMPENSATIONS, LEAST, MASKINGS, MOST, SHAPES, _passes, _Rough, _strength
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
        Width of the distribution of normals (along x), in [1e-9, 1]; the square of an artist's roughness.
    eta : array_like
        Index of the body over that outside, in [1e-9, 1e9].
    alpha_y : array_like, optional
        Width along y, where it differs.
    distribution : {"ggx", "beckmann"}
    masking : {"separable", "height_correlated", "schlick", "v_cavity"}
        Of reflection; what is refracted takes Smith's separable form, or the product of what two V-cavities show.
    tint : array_like, shape (..., 3)
        A factor of what passes, in [0, 1].
    compensation : {"none", "kulla_conty", "scaled"}
        Of the light that facets send on to each other: lost; given back as a lobe on either side; or the single bounce
        over what it gives back along `wo`, which is cheaper and not symmetric.

    Notes
    -----
    Values are for radiance: what is refracted is divided by the square of the index that it meets (for `wo` outside).
    ``eval(wi, wo) * η(wi)² == eval(wo, wi) * η(wo)²``, with the index on each direction's side. Near η = 1 the lobe of
    what is refracted is |η − 1| alpha wide, which directions in float32 do not resolve below 1e-5; η = 1 passes light
    straight, specular. Beckmann facets narrower than 0.01 lose light in float32 at cosines below 1e-3, as those of
    `RoughConductor` do.

    Without compensation what facets send on to each other is lost. Of the power that comes from everywhere on one
    side, at η = 1.5 and √alpha 0.25, 0.5, 0.75 and 1: 0.5, 3, 11 and 25 % from outside, 1.5, 14, 36 and 56 % from
    within, where much is reflected totally and more often than once. Below √alpha = 0.25 it is less than 2 %.

    With compensation all comes back within 0.2 %, whatever index and width (`albedo_table` tells what a bounce gives).
    "kulla_conty" keeps the symmetry above. Of what is missing on one side the part that a smooth interface passes of
    diffuse light leaves on the other, or less where less is missing there: a random walk among the facets takes these
    sides but for 0.05 of the light (η to 2.5). Tint colours once what crosses. Near equal indices the lobes hold what
    masking takes from light that passes nearly straight, 23 % at alpha = 1, and make it diffuse; "scaled" keeps it
    straight. With two widths the table is of the mean of those that directions about see: of alpha 1 and 0.5 up to
    1.2 % is still lost, of 1 and 0.1 up to 3.5 %; "scaled" loses up to 1.7 and 5.2 %, and invents up to 1.2. Tables
    are made for an index when it is first asked for, in some 0.3 s; a path tracer takes a sixth longer than without.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007;
    C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*, 2017; E. Turquin, *Practical multiple
    scattering compensation for microfacet models*, 2019.

    Examples
    --------
    >>> RoughDielectric(0.5).eval([0, 0, -1], [0, 0, 1]).round(4)
    array([4.8892, 4.8892, 4.8892])
    """

    alpha: Any = parameter(0.1, 0, LEAST, 1.0)
    eta: Any = parameter(1.5, 0, LEAST, MOST)
    alpha_y: Any = parameter(None, 0, LEAST, 1.0)
    distribution: Literal["ggx", "beckmann"] = option("ggx", SHAPES)
    masking: Literal["height_correlated", "separable", "schlick", "v_cavity"] = option("separable", MASKINGS)
    tint: Any = color((1.0, 1.0, 1.0))
    compensation: Literal["none", "kulla_conty", "scaled"] = option("none", GLASS_COMPENSATIONS)
    _kind: ClassVar[int] = 5
    _transmits: ClassVar[bool] = True

    def _numbers(self) -> list[Any]:
        alpha, eta, alpha_y, distribution, masking, tint, _ = self._parameters()
        plain = [tint, eta, alpha, alpha_y, distribution, masking]
        if self.compensation == "none":
            return plain
        return [*plain, (self.compensation, {"choices": COMPENSATIONS}), _passes(self.eta)]

    def _number(self) -> int:
        return 5 if self.compensation == "none" else 13

    def _stand_in(self) -> MetallicRoughness:
        roughness = math.sqrt(math.sqrt(self.alpha * self.alpha_y))
        return MetallicRoughness((0.0, 0.0, 0.0), 0.0, roughness, _strength(self.eta))
