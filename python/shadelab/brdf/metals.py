"""Smooth and rough metal."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, Literal

import numpy as np

from ._model import Model, color, option, parameter
from ._numbers import (
    COMPENSATIONS,
    COPPER_ETA,
    COPPER_K,
    LEAST,
    MASKINGS,
    MOST,
    SHAPES,
    _metal,
    _normal_reflectance,
    _Rough,
)
from .artists import MetallicRoughness
from .interface import fresnel_average

__all__ = ["Conductor", "RoughConductor"]


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
class RoughConductor(_Rough):
    """Rough metal: microscopic mirrors under Fresnel's equations for a complex index η + ik.

    Parameters
    ----------
    alpha : array_like
        Width of the distribution of normals (along x), in [1e-9, 1]; the square of an artist's roughness.
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
    Without compensation what mirrors hide from each other is lost (`white_furnace` says how much). Normals are
    drawn as they are seen from `wo`, so that weights are at most one (of Beckmann's 1.004: see
    `masking_shadowing`); those of V-cavities by D cos, with weights of at most two. Draws of a compensating lobe weigh
    more where it has little: 150 at alpha = 1e-3. A draw of GGX takes some 90 ns on one thread, one of Beckmann,
    whose slopes are found by Newton's steps, 330. With two widths the compensation takes the mean of those that
    directions about see: where one is ten times the other, up to 2 % of white metal's light is still lost, of
    Beckmann's or by "scaled" 3.3 %. In float32 a half vector does not resolve Beckmann facets narrower than 0.01 at
    cosines below 1e-3, and light is lost there: 1 % at alpha = 1e-3, most of it at 1e-5. GGX loses none.

    References
    ----------
    B. Walter, S. R. Marschner, H. Li, K. E. Torrance, *Microfacet models for refraction through rough surfaces*, 2007;
    E. Turquin, *Practical multiple scattering compensation for microfacet models*, 2019.

    Examples
    --------
    >>> RoughConductor(0.5).eval([0, 0, 1], [0, 0, 1]).round(4)
    array([0.3031, 0.1972, 0.1625])
    """

    alpha: Any = parameter(0.1, 0, LEAST, 1.0)
    eta: Any = parameter(COPPER_ETA, 3, LEAST, MOST)
    k: Any = parameter(COPPER_K, 3, 0.0, MOST)
    alpha_y: Any = parameter(None, 0, LEAST, 1.0)
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
