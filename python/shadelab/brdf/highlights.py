"""Highlights over a diffuser: powers of cosines, and a smooth coat."""

# ruff: noqa: RUF009 (parameters are descriptions, made once)

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from ._model import Model, color, parameter
from ._numbers import _UNIT, MOST, _flag, _strength
from .artists import MetallicRoughness
from .interface import fresnel_average

__all__ = ["BlinnPhong", "Phong", "Plastic"]


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
