"""The models: parameters, value, density, draws."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from ._model import Model, color, option, parameter

__all__ = [
    "Conductor",
    "Dielectric",
    "Diffuse",
    "MetallicRoughness",
    "RoughConductor",
    "RoughDielectric",
]

SHAPES = ("ggx", "beckmann")
MASKINGS = ("height_correlated", "separable", "schlick", "v_cavity")
# Copper, at 630, 532 and 465 nm.
COPPER_ETA = (0.2004, 0.924, 1.1022)
COPPER_K = (3.9129, 2.4528, 2.1421)


@dataclass(frozen=True)
class MetallicRoughness(Model):
    """The material of real-time rendering: a mix of metal and of a dielectric base (see `metallic_roughness`).

    Parameters
    ----------
    base_color : array_like, shape (..., 3)
        Albedo of the dielectric's diffuse part, reflectance of the metal at normal incidence; linear, in [0, 1].
    metallic, roughness, specular : array_like
        The metal's share, the artist's roughness (alpha is its square, no less than 1e-4), the strength of the
        dielectric's mirrors; in [0, 1].

    Examples
    --------
    >>> MetallicRoughness((0.8, 0.4, 0.2), roughness=1.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.2379, 0.1205, 0.0619])
    """

    base_color: Any = color((0.8, 0.8, 0.8))
    metallic: Any = parameter(0.0, 0, 0, 1)
    roughness: Any = parameter(0.5, 0, 0, 1)
    specular: Any = parameter(1.0, 0, 0, 1)
    _kind: ClassVar[int] = 0

    def _stand_in(self) -> MetallicRoughness:
        return self


@dataclass(frozen=True)
class Diffuse(Model):
    """Lambert's perfect diffuser: albedo / π in every direction.

    Parameters
    ----------
    albedo : array_like, shape (..., 3)
        The fraction of light given back, in [0, 1].

    References
    ----------
    J. H. Lambert, *Photometria*, 1760.

    Examples
    --------
    >>> Diffuse(0.5).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.1592, 0.1592, 0.1592])
    """

    albedo: Any = color((0.8, 0.8, 0.8))
    _kind: ClassVar[int] = 1

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness(self.albedo, specular=0.0)


@dataclass(frozen=True)
class Conductor(Model):
    """The smooth metal: a mirror whose reflectance is Fresnel's for a complex index η + ik.

    Parameters
    ----------
    eta, k : array_like, shape (..., 3)
        Index and extinction per channel; copper if not given. Indices that are large make a perfect mirror.
    tint : array_like, shape (..., 3)
        A factor of the reflectance, in [0, 1].

    Notes
    -----
    Specular: `eval` and `pdf` are zero, `sample` gives the mirror direction.

    Examples
    --------
    >>> Conductor().sample([0.6, 0, 0.8], [0.1, 0.2, 0.3]).wi
    array([-0.6, -0. ,  0.8])
    """

    eta: Any = parameter(COPPER_ETA, 3, above=0.0)
    k: Any = parameter(COPPER_K, 3, 0.0)
    tint: Any = color((1.0, 1.0, 1.0))
    _kind: ClassVar[int] = 2

    def _numbers(self) -> list[Any]:
        eta, k, tint = self._parameters()
        return [tint, eta, k]

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness(_metal(self), 1.0, 0.0)


@dataclass(frozen=True)
class Dielectric(Model):
    """The smooth interface of two clear bodies: glass, water.

    Parameters
    ----------
    eta : array_like
        Index of the body over that outside, above 0; 1.5 is glass in air.
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

    eta: Any = parameter(1.5, above=0.0)
    tint: Any = color((1.0, 1.0, 1.0))
    _kind: ClassVar[int] = 3
    _transmits: ClassVar[bool] = True

    def _numbers(self) -> list[Any]:
        eta, tint = self._parameters()
        return [tint, eta]

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness((0.0, 0.0, 0.0), roughness=0.0, specular=_strength(self.eta))


class _Rough(Model):
    """Models of microscopic facets: `alpha_y` is `alpha` where it is not given."""

    alpha: Any
    alpha_y: Any

    def __post_init__(self) -> None:
        if self.alpha_y is None:
            object.__setattr__(self, "alpha_y", self.alpha)
        super().__post_init__()


@dataclass(frozen=True)
class RoughConductor(_Rough):
    """Rough metal: microscopic mirrors under Fresnel's equations for a complex index η + ik.

    Parameters
    ----------
    alpha : array_like
        Width of the distribution of normals (along x), in (0, 1]; the square of an artist's roughness.
    eta, k : array_like, shape (..., 3)
        Index and extinction per channel; copper if not given.
    alpha_y : array_like, optional
        Width along y, where it differs.
    distribution : {"ggx", "beckmann"}
    masking : {"height_correlated", "separable", "schlick", "v_cavity"}
        How mirrors hide each other: see `masking_shadowing`.
    tint : array_like, shape (..., 3)
        A factor of the reflectance, in [0, 1].

    Notes
    -----
    One bounce: what mirrors hide from each other is lost (`white_furnace` says how much). GGX normals are drawn as they
    are seen from `wo`, so that weights are at most one; of Beckmann's all are drawn.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

    Examples
    --------
    >>> RoughConductor(0.5).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.3035, 0.1967, 0.1616])
    """

    alpha: Any = parameter(0.1, 0, high=1.0, above=0.0)
    eta: Any = parameter(COPPER_ETA, 3, above=0.0)
    k: Any = parameter(COPPER_K, 3, 0.0)
    alpha_y: Any = parameter(None, 0, high=1.0, above=0.0)
    distribution: Literal["ggx", "beckmann"] = option("ggx", SHAPES)
    masking: Literal["height_correlated", "separable", "schlick", "v_cavity"] = option("height_correlated", MASKINGS)
    tint: Any = color((1.0, 1.0, 1.0))
    _kind: ClassVar[int] = 4

    def _numbers(self) -> list[Any]:
        alpha, eta, k, alpha_y, distribution, masking, tint = self._parameters()
        return [tint, eta, k, alpha, alpha_y, distribution, masking]

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness(_metal(self), 1.0, math.sqrt(math.sqrt(self.alpha * self.alpha_y)))


@dataclass(frozen=True)
class RoughDielectric(_Rough):
    """Rough glass: microscopic smooth interfaces that reflect and refract.

    Parameters
    ----------
    alpha : array_like
        Width of the distribution of normals (along x), in (0, 1]; the square of an artist's roughness.
    eta : array_like
        Index of the body over that outside, above 0.
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
    straight, specular.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007.

    Examples
    --------
    >>> RoughDielectric(0.5).eval([0, 0, -1], [0, 0, 1]).round(4)
    array([4.8892, 4.8892, 4.8892])
    """

    alpha: Any = parameter(0.1, 0, high=1.0, above=0.0)
    eta: Any = parameter(1.5, above=0.0)
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


def _metal(m: Any) -> tuple[float, ...]:
    """Reflectance at normal incidence."""
    return tuple(
        t * ((e - 1) ** 2 + k * k) / ((e + 1) ** 2 + k * k) for e, k, t in zip(m.eta, m.k, m.tint, strict=True)
    )


def _strength(eta: float) -> float:
    """Reflectance at normal incidence over that of the glass that metallic-roughness has."""
    return min(1.0, ((eta - 1) / (eta + 1)) ** 2 / 0.04)
