"""Lights without an area, and the light of all directions."""

from __future__ import annotations

import math
from dataclasses import dataclass

from .. import _arrays
from ._parts import Vector, _freeze, _nonzero, _packed

__all__ = ["AmbientLight", "DirectionalLight", "PointLight", "SpotLight"]


@dataclass(frozen=True)
class PointLight:
    """A point that sends light evenly in every direction.

    Parameters
    ----------
    position : sequence of 3 floats
    intensity : sequence of 3 floats
        Radiant intensity in W/sr, per channel.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, or a channel is not in [0, 1e30].

    Notes
    -----
    Nothing arrives at the light's own place, nor from so near that no number of the precision holds what does.

    Examples
    --------
    >>> PointLight((0, 2, 0), intensity=(10, 10, 10)).intensity
    (10.0, 10.0, 10.0)
    """

    position: Vector
    intensity: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        _freeze(self, "intensity")

    def _row(self) -> list[float]:
        return [0, *_packed(self.intensity, self.position)]


@dataclass(frozen=True)
class SpotLight:
    """A point that sends light into a cone with a smooth border.

    Parameters
    ----------
    position : sequence of 3 floats
    direction : sequence of 3 floats
        Along the axis, from the light; of any length.
    intensity : sequence of 3 floats
        Radiant intensity on the axis in W/sr, per channel.
    inner_angle, outer_angle : float
        From the axis, in radians: full intensity within the inner one, none beyond the outer one.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, `direction` is zero, a channel is not in [0, 1e30], or the angles
        are not ``0 <= inner_angle <= outer_angle <= pi``.

    Notes
    -----
    Between the angles the intensity falls as the cubic 3t² − 2t³, with t from one to zero linear in the cosine, so that
    it is smooth and its flux is a closed form. With equal angles the cone has a hard border; at 0 it is a single ray,
    at π a point light.

    Examples
    --------
    >>> SpotLight((0, 3, 0), (0, -1, 0), (9, 9, 9), outer_angle=0.5).inner_angle
    0.0
    """

    position: Vector
    direction: Vector
    intensity: Vector = (1.0, 1.0, 1.0)
    inner_angle: float = 0.0
    outer_angle: float = math.pi / 4

    def __post_init__(self) -> None:
        _freeze(self, "intensity")
        _nonzero("direction", self.direction)
        _arrays.number("outer_angle", self.outer_angle, 0, math.pi)
        _arrays.number("inner_angle", self.inner_angle, 0, self.outer_angle)

    def _row(self) -> list[float]:
        # 1 − cos without cancellation.
        depths = (2 * math.sin(angle / 2) ** 2 for angle in (self.inner_angle, self.outer_angle))
        return [3, *_packed(self.intensity, self.position, self.direction, *depths)]


@dataclass(frozen=True)
class DirectionalLight:
    """Parallel light from very far away, such as the sun's.

    Parameters
    ----------
    direction : sequence of 3 floats
        In which light travels, from the light to the scene; of any length.
    irradiance : sequence of 3 floats
        On a plane that faces the light, in W/m², per channel.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, `direction` is zero, or a channel is not in [0, 1e30].

    Examples
    --------
    >>> DirectionalLight((0, -1, 0)).irradiance
    (1.0, 1.0, 1.0)
    """

    direction: Vector
    irradiance: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        _freeze(self, "irradiance")
        _nonzero("direction", self.direction)

    def _row(self) -> list[float]:
        return [1, *_packed(self.irradiance, self.direction)]


@dataclass(frozen=True)
class AmbientLight:
    """The same radiance from every direction.

    Parameters
    ----------
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.

    Raises
    ------
    TypeError, ValueError
        If `radiance` is not of three finite numbers, or a channel is not in [0, 1e30].

    Notes
    -----
    It has no place, as a sky has none: seen where rays miss everything, and kept away by what stands around a surface.
    `shadelab.pathtrace` and `shadelab.render` agree in both; `render` finds what is kept away by 32 rays a pixel, as
    the share of irradiance: exact for diffusers but for noise (7 % of the mean beside a wall). `Scene.background` is
    the cheaper light of that kind, which `render` lets nothing hide.

    Examples
    --------
    >>> AmbientLight((0.1, 0.1, 0.2)).radiance
    (0.1, 0.1, 0.2)
    """

    radiance: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        _freeze(self, "radiance")

    def _row(self) -> list[float]:
        return [7, *_packed(self.radiance)]
