"""The models of artists: metallic-roughness, specular-glossiness, principled."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, ClassVar, Literal

from ._model import Model, color, option, parameter
from ._numbers import COMPENSATIONS, LEAST, MOST, _grazing, _passes, _strength
from .workflow import to_metallic_roughness

__all__ = ["MetallicRoughness", "Principled", "SpecularGlossiness"]


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
    compensation : {"none", "kulla_conty", "kulla_conty_as_published", "scaled"}
        Of the light that facets send on to each other, as of `RoughConductor` for the mirrors and of `RoughDielectric`
        for the glass (of which the forms of the colour are one). No part of the model as published.

    Notes
    -----
    Not conservative, in either form, as published: the diffuse lobe is not darkened by what the mirrors keep, and
    brightens at grazing. In `white_furnace` a white dielectric gives back 4 to 9 % more than came, by roughness (11 %
    with sheen and a coat on it), and at a cosine of 0.05 and roughness 1 half as much again. Metal loses what its
    mirrors send on to each other: 1.3, 12, 36 and 62 % at roughness 0.25, 0.5, 0.75 and 1. Its glass loses what
    `RoughDielectric` does. With `spec_trans` above 0 directions stand on both sides.

    Compensation restores the light that is lost between facets, of metal, of dielectric mirrors and of glass each by
    itself, and takes nothing away: paint that gives back too much still does, and a little more. White metal or glass
    of any roughness then gives all back within 0.2 %. With two widths it takes the mean of those that directions about
    see: up to roughness 0.75 at most 0.5 % of white metal's light is still lost at `anisotropic` 0.5, 7 % at 1. Widths
    above one, which `anisotropic` makes of roughness near one, are compensated as one: there 3 % and a quarter are.
    "scaled" keeps less of two widths: 18 % are lost at roughness 0.75 and `anisotropic` 1, two thirds at roughness 1.

    The form of 2015 is Mitsuba's `principled` within 1e-5 but for three things: its coat is multiplied by
    4 cos θi cos θo, hues are taken by another luminance (the source's 0.3, 0.6, 0.1 here), and draws choose among lobes
    by other chances.

    References
    ----------
    B. Burley, *Physically based shading at Disney*, 2012; B. Burley, *Extending the Disney BRDF to a BSDF with
    integrated subsurface scattering*, 2015; C. Kulla, A. Conty, *Revisiting physically based shading at Imageworks*,
    2017.

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
    compensation: Literal["none", "kulla_conty", "kulla_conty_as_published", "scaled"] = option("none", COMPENSATIONS)
    _kind: ClassVar[int] = 11
    _facets: ClassVar[bool] = True

    def _numbers(self) -> list[Any]:
        *plain, compensation = self._parameters()
        if self.compensation == "none":
            return plain
        return [*plain, compensation, _passes(self.eta), _grazing(self.eta)]

    def _number(self) -> int:
        return 11 if self.compensation == "none" else 14

    def _stand_in(self) -> MetallicRoughness:
        strength = self.specular * 2 if self.form == "2012" else _strength(self.eta)
        return MetallicRoughness(self.base_color, self.metallic, self.roughness, min(1.0, strength))
