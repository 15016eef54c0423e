"""The models: parameters, value, density, draws."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

import numpy as np

from ._model import Model, color, option, parameter
from .interface import fresnel_average
from .workflow import to_metallic_roughness

__all__ = [
    "BlinnPhong",
    "Conductor",
    "Dielectric",
    "Diffuse",
    "MetallicRoughness",
    "OrenNayar",
    "Phong",
    "Plastic",
    "Principled",
    "RoughConductor",
    "RoughDielectric",
    "SpecularGlossiness",
]

SHAPES = ("ggx", "beckmann")
DIFFUSERS = ("qualitative", "energy_preserving")
COMPENSATIONS = ("none", "kulla_conty", "kulla_conty_as_published", "scaled")
MASKINGS = ("height_correlated", "separable", "schlick", "v_cavity")
# Beyond these squares of squares are no numbers in single, and pictures no others: a mirror, a point.
LEAST, MOST = 1e-9, 1e9
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
    compensation : {"none", "kulla_conty", "kulla_conty_as_published", "scaled"}
        Of the light that mirrors throw at each other, as of `RoughConductor`.

    Notes
    -----
    With compensation a white metal gives all light back within 0.2 % whatever its roughness (59 % are lost at roughness
    1 without), and no base colour gives back more than came. Of a dielectric it adds less than 0.003 of the light.

    References
    ----------
    Khronos, *glTF 2.0 specification*, 2021, appendix B; C. Kulla, A. Conty, *Revisiting physically based shading at
    Imageworks*, 2017; E. Turquin, *Practical multiple scattering compensation for microfacet models*, 2019.

    Examples
    --------
    >>> MetallicRoughness((0.8, 0.4, 0.2), roughness=1.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.2379, 0.1205, 0.0619])
    """

    base_color: Any = color((0.8, 0.8, 0.8))
    metallic: Any = parameter(0.0, 0, 0, 1)
    roughness: Any = parameter(0.5, 0, 0, 1)
    specular: Any = parameter(1.0, 0, 0, 1)
    compensation: Literal["none", "kulla_conty", "kulla_conty_as_published", "scaled"] = option("none", COMPENSATIONS)
    _kind: ClassVar[int] = 0
    _facets: ClassVar[bool] = True

    def _number(self) -> int:
        return 0 if self.compensation == "none" else 12

    def _stand_in(self) -> MetallicRoughness:
        return self if self.compensation == "none" else replace(self, compensation="none")


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
        Index in [1e-9, 1e9] and extinction in [0, 1e9] per channel; copper if not given. Large ones make a perfect
        mirror.
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

    eta: Any = parameter(COPPER_ETA, 3, LEAST, MOST)
    k: Any = parameter(COPPER_K, 3, 0.0, MOST)
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


class _Rough(Model):
    """Models of microscopic facets: `alpha_y` is `alpha` where it is not given."""

    alpha: Any
    alpha_y: Any
    _facets: ClassVar[bool] = True

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
        Index in [1e-9, 1e9] and extinction in [0, 1e9] per channel; copper if not given.
    alpha_y : array_like, optional
        Width along y, where it differs.
    distribution : {"ggx", "beckmann"}
    masking : {"height_correlated", "separable", "schlick", "v_cavity"}
        How mirrors hide each other: see `masking_shadowing`.
    tint : array_like, shape (..., 3)
        A factor of the reflectance, in [0, 1].
    compensation : {"none", "kulla_conty", "kulla_conty_as_published", "scaled"}
        Of the light that mirrors throw at each other: lost; given back as a lobe of its own (see `kulla_conty`); or the
        single bounce times ``1 + F0 (1/E(θo) − 1)``, which is cheaper and not reciprocal.

    Notes
    -----
    Without compensation what mirrors hide from each other is lost (`white_furnace` says how much). GGX normals are
    drawn as they are seen from `wo`, so that weights are at most one; of Beckmann's all are drawn. With two widths the
    compensation takes their geometric mean.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007;
    E. Turquin, *Practical multiple scattering compensation for microfacet models*, 2019.

    Examples
    --------
    >>> RoughConductor(0.5).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.3031, 0.1972, 0.1625])
    """

    alpha: Any = parameter(0.1, 0, high=1.0, above=0.0)
    eta: Any = parameter(COPPER_ETA, 3, LEAST, MOST)
    k: Any = parameter(COPPER_K, 3, 0.0, MOST)
    alpha_y: Any = parameter(None, 0, high=1.0, above=0.0)
    distribution: Literal["ggx", "beckmann"] = option("ggx", SHAPES)
    masking: Literal["height_correlated", "separable", "schlick", "v_cavity"] = option("height_correlated", MASKINGS)
    tint: Any = color((1.0, 1.0, 1.0))
    compensation: Literal["none", "kulla_conty", "kulla_conty_as_published", "scaled"] = option("none", COMPENSATIONS)
    _kind: ClassVar[int] = 4

    def _numbers(self) -> list[Any]:
        alpha, eta, k, alpha_y, distribution, masking, tint, compensation = self._parameters()
        plain = [tint, eta, k, alpha, alpha_y, distribution, masking]
        if self.compensation == "none":
            return plain
        if self.compensation == "scaled":
            fresnel = _normal_reflectance(np.asarray(self.eta), np.asarray(self.k))
        else:
            fresnel = fresnel_average(np.asarray(self.eta, np.float64), np.asarray(self.k, np.float64))
        # Rounding may pass one.
        return [*plain, compensation, (np.minimum(fresnel, 1.0), {"core": 3, "low": 0.0, "high": 1.0, "above": None})]

    def _number(self) -> int:
        return 4 if self.compensation == "none" else 10

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


@dataclass(frozen=True)
class OrenNayar(Model):
    """Rough diffusers, as of clay and the moon: brighter towards the light than Lambert's.

    Parameters
    ----------
    albedo : array_like, shape (..., 3)
        Of the facets, in [0, 1].
    sigma : array_like
        Roughness, in [0, 1]: the deviation of the slopes' angles in radians of the qualitative form, the parameter of
        the energy-preserving one; 0 is Lambert's.
    form : {"energy_preserving", "qualitative"}
        With the light of further bounces, so that an albedo of one gives all back; or the source's short form.

    Notes
    -----
    Directions are drawn by the cosine.

    References
    ----------
    M. Oren, S. K. Nayar, *Generalization of Lambert's reflectance model*, 1994; J. Portsmouth, P. Kutz, S. Hill,
    *EON: a practical energy-preserving rough diffuse BRDF*, 2025.

    Examples
    --------
    >>> OrenNayar(0.5, 0.5, form="qualitative").eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.1249, 0.1249, 0.1249])
    """

    albedo: Any = color((0.8, 0.8, 0.8))
    sigma: Any = parameter(0.5, 0, 0, 1)
    form: Literal["energy_preserving", "qualitative"] = option(
        "energy_preserving", ("qualitative", "energy_preserving")
    )
    _kind: ClassVar[int] = 6

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness(self.albedo, specular=0.0)


@dataclass(frozen=True)
class Phong(Model):
    """A highlight by the power of the cosine between the mirror direction and the light, over a diffuser.

    Parameters
    ----------
    diffuse, specular : array_like, shape (..., 3)
        Albedos of the diffuser and of the highlight, in [0, 1]; together at most one if energy is to be kept.
    exponent : array_like
        In [0, 1e9]; the larger, the smaller the highlight.
    normalized : bool
        The highlight gives back `specular` of light along the normal, and less of other light; False is the classic
        shading, ``specular * cos ** exponent`` in place of value times cosine.

    Notes
    -----
    The classic form is not reciprocal, and near grazing gives back more than came: a look.

    References
    ----------
    B. T. Phong, *Illumination for computer generated pictures*, 1975; E. P. Lafortune, Y. D. Willems, *Using the
    modified Phong reflectance model for physically based rendering*, 1994.

    Examples
    --------
    >>> Phong(0.0, 1.0, 10.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([1.9099, 1.9099, 1.9099])
    """

    diffuse: Any = color((0.5, 0.5, 0.5))
    specular: Any = color((0.5, 0.5, 0.5))
    exponent: Any = parameter(20.0, 0, 0.0, MOST)
    normalized: bool = True
    _kind: ClassVar[int] = 7
    _blinn: ClassVar[bool] = False

    def __post_init__(self) -> None:
        if not isinstance(self.normalized, bool):
            raise TypeError(f"normalized: expected a bool, got {type(self.normalized).__name__}")
        super().__post_init__()

    def _numbers(self) -> list[Any]:
        return [*self._parameters(), _flag(self.normalized), _flag(self._blinn)]

    def _stand_in(self) -> MetallicRoughness:
        # Slopes as far spread: alpha² = 2 / (n + 2), and four times n for Blinn's half angles.
        n = self.exponent if self._blinn else 4 * self.exponent
        return MetallicRoughness(self.diffuse, 0.0, (2 / (n + 2)) ** 0.25, min(1.0, max(self.specular)))


@dataclass(frozen=True)
class BlinnPhong(Phong):
    """As `Phong`, by the cosine between the half vector and the normal.

    The highlight stretches towards grazing, as that of microscopic mirrors does. About four times Phong's exponent
    gives a highlight of its size.

    Parameters
    ----------
    diffuse, specular, exponent, normalized
        As of `Phong`.

    References
    ----------
    J. F. Blinn, *Models of light reflection for computer synthesized pictures*, 1977; F. Giesen, *Phong and Blinn-Phong
    normalization factors*, 2009.

    Examples
    --------
    >>> BlinnPhong(0.0, 1.0, 10.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.6664, 0.6664, 0.6664])
    """

    _blinn: ClassVar[bool] = True


@dataclass(frozen=True)
class Plastic(Model):
    """A diffuser under a clear, smooth coat.

    Parameters
    ----------
    diffuse : array_like, shape (..., 3)
        Albedo of the diffuser, in [0, 1].
    eta : array_like
        Index of the coat over that outside, in [1, 1e9].
    nonlinear : bool
        Colour every bounce between diffuser and coat, which makes colours deeper.

    Notes
    -----
    The mirror direction is a specular draw; `eval` and `pdf` are of the diffuser under the coat.

    References
    ----------
    W. Jakob, *Mitsuba renderer*, 2010: `plastic`.

    Examples
    --------
    >>> Plastic(1.0, nonlinear=True).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.323, 0.323, 0.323])
    """

    diffuse: Any = color((0.5, 0.5, 0.5))
    eta: Any = parameter(1.5, 0, 1.0, MOST)
    nonlinear: bool = False
    _kind: ClassVar[int] = 8

    def __post_init__(self) -> None:
        if not isinstance(self.nonlinear, bool):
            raise TypeError(f"nonlinear: expected a bool, got {type(self.nonlinear).__name__}")
        super().__post_init__()

    def _numbers(self) -> list[Any]:
        passes = 1 - fresnel_average(np.asarray(self.eta, np.float64))
        return [*self._parameters(), (passes, _UNIT), _flag(self.nonlinear)]

    def _stand_in(self) -> MetallicRoughness:
        return MetallicRoughness(self.diffuse, 0.0, 0.0, _strength(self.eta))


@dataclass(frozen=True)
class SpecularGlossiness(Model):
    """The other workflow of real-time materials (see `to_metallic_roughness`).

    Parameters
    ----------
    diffuse : array_like, shape (..., 3)
        Albedo of what mirrors let in, in [0, 1].
    specular : array_like, shape (..., 3)
        Reflectance of mirrors along the normal, in [0, 1].
    glossiness : array_like
        One less the roughness, in [0, 1].

    References
    ----------
    Khronos, *KHR_materials_pbrSpecularGlossiness*, 2017.

    Examples
    --------
    >>> SpecularGlossiness(0.5, 0.04, 0.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.1499, 0.1499, 0.1499])
    """

    diffuse: Any = color((0.5, 0.5, 0.5))
    specular: Any = color((0.04, 0.04, 0.04))
    glossiness: Any = parameter(0.5, 0, 0, 1)
    _kind: ClassVar[int] = 9
    _facets: ClassVar[bool] = True

    def _stand_in(self) -> MetallicRoughness:
        base, metallic = to_metallic_roughness(self.diffuse, self.specular)
        return MetallicRoughness(tuple(base.tolist()), float(metallic), 1 - self.glossiness)


@dataclass(frozen=True)
class Principled(Model):
    """The artist's model of film: one set of parameters from cloth to car paint, metal and glass.

    Parameters
    ----------
    base_color : array_like, shape (..., 3)
        Linear, in [0, 1].
    metallic, roughness, specular, specular_tint, anisotropic, sheen, sheen_tint : array_like
        In [0, 1], as in the source. `specular` is the dielectric's strength in the form of 2012: 8 % at one.
    clearcoat, clearcoat_gloss, subsurface, spec_trans : array_like
        In [0, 1]. `spec_trans`, of the form of 2015, is the share of glass.
    eta : array_like
        Index of the body in the form of 2015, in [1e-9, 1e9].
    form : {"2012", "2015"}
        The BRDF of the first notes, or the BSDF of the later ones.

    Notes
    -----
    Not strictly conservative: at grazing angles the form of 2012 gives back more than came. In that of 2015 with
    `spec_trans` above 0, directions stand on both sides.

    The form of 2015 is Mitsuba's `principled` within 1e-5 but for three things: its coat is multiplied by
    4 cos θi cos θo, hues are taken by another luminance (the source's 0.3, 0.6, 0.1 here), and draws choose among lobes
    by other chances.

    References
    ----------
    B. Burley, *Physically based shading at Disney*, 2012; B. Burley, *Extending the Disney BRDF to a BSDF with
    integrated subsurface scattering*, 2015.

    Examples
    --------
    >>> Principled((0.8, 0.4, 0.2), roughness=1.0).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.2578, 0.1305, 0.0668])
    """

    base_color: Any = color((0.8, 0.8, 0.8))
    metallic: Any = parameter(0.0, 0, 0, 1)
    roughness: Any = parameter(0.5, 0, 0, 1)
    specular: Any = parameter(0.5, 0, 0, 1)
    specular_tint: Any = parameter(0.0, 0, 0, 1)
    anisotropic: Any = parameter(0.0, 0, 0, 1)
    sheen: Any = parameter(0.0, 0, 0, 1)
    sheen_tint: Any = parameter(0.5, 0, 0, 1)
    clearcoat: Any = parameter(0.0, 0, 0, 1)
    clearcoat_gloss: Any = parameter(1.0, 0, 0, 1)
    subsurface: Any = parameter(0.0, 0, 0, 1)
    spec_trans: Any = parameter(0.0, 0, 0, 1)
    eta: Any = parameter(1.5, 0, LEAST, MOST)
    form: Literal["2012", "2015"] = option("2012", ("2012", "2015"))
    _kind: ClassVar[int] = 11
    _facets: ClassVar[bool] = True

    def _stand_in(self) -> MetallicRoughness:
        strength = self.specular * 2 if self.form == "2012" else _strength(self.eta)
        return MetallicRoughness(self.base_color, self.metallic, self.roughness, min(1.0, strength))


_UNIT = {"core": 0, "low": 0.0, "high": 1.0, "above": None}


def _flag(on: bool) -> tuple[float, Any]:
    return float(on), _UNIT


def _metal(m: Any) -> tuple[float, ...]:
    """Reflectance at normal incidence."""
    return tuple((_normal_reflectance(np.asarray(m.eta), np.asarray(m.k)) * m.tint).tolist())


def _normal_reflectance(eta: Any, k: Any) -> Any:
    return ((eta - 1) ** 2 + k * k) / ((eta + 1) ** 2 + k * k)


def _strength(eta: float) -> float:
    """Reflectance at normal incidence over that of the glass that metallic-roughness has."""
    return min(1.0, ((eta - 1) / (eta + 1)) ** 2 / 0.04)
