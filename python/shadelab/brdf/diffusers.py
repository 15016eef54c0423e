"""Diffusers, smooth and rough."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar, Literal

from ._model import Model, color, option, parameter
from .artists import MetallicRoughness

__all__ = ["Diffuse", "OrenNayar"]


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
