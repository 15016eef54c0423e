"""Kinds of light: what each radiates, and where."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import NDArray

from .. import _arrays

__all__ = [
    "AmbientLight",
    "DirectionalLight",
    "DiskLight",
    "PointLight",
    "PolygonLight",
    "RectLight",
    "SphereLight",
    "SpotLight",
]

Vector: TypeAlias = tuple[float, float, float]


def _freeze(light: Any, colors: str, skip: Sequence[str] = ()) -> None:
    """Turns what a light is given into finite floats and tuples of them; `colors` names the one that is a colour."""
    for field in fields(light):
        if field.name in skip:
            continue
        value = getattr(light, field.name)
        if field.type == "bool":
            object.__setattr__(light, field.name, bool(value))
            continue
        if field.type == "float":
            object.__setattr__(light, field.name, _arrays.number(field.name, value))
            continue
        array = np.asarray(value)
        if array.dtype.kind not in "fiu" or array.shape != (3,):
            raise ValueError(f"{field.name}: expected three numbers, got {value!r}")
        vector = tuple(_arrays.number(field.name, x) for x in array)
        if field.name == colors and min(vector) < 0:
            raise ValueError(f"{field.name}: expected no negative channel, got {vector}")
        object.__setattr__(light, field.name, vector)


def _nonzero(name: str, vector: Vector) -> None:
    if not any(vector):
        raise ValueError(f"{name}: expected a vector of non-zero length, got {vector}")


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
        If a vector is not of three finite numbers, or a channel is negative.

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
        If a vector is not of three finite numbers, `direction` is zero, a channel is negative, or the angles are not
        ``0 <= inner_angle <= outer_angle <= pi``.

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
        If a vector is not of three finite numbers, `direction` is zero, or a channel is negative.

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
class RectLight:
    """A rectangle that radiates evenly from its front, the side to which ``cross(edge_u, edge_v)`` points.

    Parameters
    ----------
    center : sequence of 3 floats
    edge_u, edge_v : sequence of 3 floats
        The full edges, perpendicular to each other.
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.
    two_sided : bool
        Whether the back radiates as well.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, an edge is zero, the edges are not perpendicular (to 1e-6), or a
        channel is negative.

    Examples
    --------
    >>> light = RectLight((0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 2), radiance=(5, 5, 5))
    >>> light.normal, light.area
    ((0.0, -1.0, 0.0), 2.0)
    """

    center: Vector
    edge_u: Vector
    edge_v: Vector
    radiance: Vector = (1.0, 1.0, 1.0)
    two_sided: bool = False

    def __post_init__(self) -> None:
        _freeze(self, "radiance")
        lengths = [float(np.linalg.norm(e)) for e in (self.edge_u, self.edge_v)]
        for name, length in zip(("edge_u", "edge_v"), lengths, strict=True):
            if length == 0:
                raise ValueError(f"{name}: expected an edge of non-zero length, got {getattr(self, name)}")
        cosine = float(np.dot(np.divide(self.edge_u, lengths[0]), np.divide(self.edge_v, lengths[1])))
        if abs(cosine) > 1e-6:
            raise ValueError(f"edge_v: expected an edge perpendicular to edge_u, got a cosine of {cosine:g}")

    def _row(self) -> list[float]:
        return [2, *_packed(self.radiance, self.center, self.edge_u, self.edge_v, self.two_sided)]

    @property
    def normal(self) -> Vector:
        """The unit vector to which the front points."""
        cross = np.cross(np.divide(self.edge_u, np.max(np.abs(self.edge_u))), self.edge_v)
        cross = cross / np.max(np.abs(cross))
        x, y, z = (float(c) + 0.0 for c in cross / np.linalg.norm(cross))
        return x, y, z

    @property
    def area(self) -> float:
        """In m²."""
        return float(np.linalg.norm(self.edge_u) * np.linalg.norm(self.edge_v))

    @property
    def corners(self) -> NDArray[np.float64]:
        """The four corners, (4, 3), counter-clockwise as seen from the front."""
        u, v = np.multiply(self.edge_u, 0.5), np.multiply(self.edge_v, 0.5)
        return np.asarray([self.center - u - v, self.center + u - v, self.center + u + v, self.center - u + v])


@dataclass(frozen=True)
class DiskLight:
    """A disk that radiates evenly from its front.

    Parameters
    ----------
    center : sequence of 3 floats
    normal : sequence of 3 floats
        To which the front points; of any length.
    radius : float
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.
    two_sided : bool
        Whether the back radiates as well.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, `normal` is zero, `radius` is not positive, or a channel is
        negative.

    Examples
    --------
    >>> round(DiskLight((0, 2, 0), (0, -1, 0), 0.5).area, 6)
    0.785398
    """

    center: Vector
    normal: Vector
    radius: float
    radiance: Vector = (1.0, 1.0, 1.0)
    two_sided: bool = False

    def __post_init__(self) -> None:
        _freeze(self, "radiance")
        _nonzero("normal", self.normal)
        _arrays.number("radius", self.radius, above=0)

    def _row(self) -> list[float]:
        return [4, *_packed(self.radiance, self.center, self.normal, self.radius, self.two_sided)]

    @property
    def area(self) -> float:
        """Of one side, in m²."""
        return math.pi * self.radius**2


@dataclass(frozen=True)
class SphereLight:
    """A sphere that radiates evenly outwards.

    Parameters
    ----------
    center : sequence of 3 floats
    radius : float
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, `radius` is not positive, or a channel is negative.

    Examples
    --------
    >>> round(SphereLight((0, 2, 0), 0.5).area, 6)
    3.141593
    """

    center: Vector
    radius: float
    radiance: Vector = (1.0, 1.0, 1.0)

    def __post_init__(self) -> None:
        _freeze(self, "radiance")
        _arrays.number("radius", self.radius, above=0)

    def _row(self) -> list[float]:
        return [5, *_packed(self.radiance, self.center, self.radius)]

    @property
    def area(self) -> float:
        """In m²."""
        return 4 * math.pi * self.radius**2


@dataclass(frozen=True)
class PolygonLight:
    """A planar polygon, convex or not, that radiates evenly from its front.

    Parameters
    ----------
    corners : sequence of n times 3 floats
        Counter-clockwise as seen from the front.
    radiance : sequence of 3 floats
        In W/(m² sr), per channel.
    two_sided : bool
        Whether the back radiates as well.

    Raises
    ------
    TypeError, ValueError
        If corners are not n times three finite numbers, n at least 3, if they have no area, or are off their common
        plane by more than 1e-6 of the polygon's size, if the polygon crosses itself, or a channel is negative.

    Examples
    --------
    >>> light = PolygonLight([[0, 2, 0], [1, 2, 0], [0, 2, 1]])
    >>> light.normal, light.area
    ((0.0, -1.0, 0.0), 0.5)
    """

    corners: Any
    radiance: Vector = (1.0, 1.0, 1.0)
    two_sided: bool = False

    def __post_init__(self) -> None:
        corners = _arrays.vectors("corners", self.corners, 3, np.float64)
        if corners.ndim != 2 or len(corners) < 3:
            raise ValueError(f"corners: expected shape (n, 3) with n of at least 3, got {corners.shape}")
        if not np.isfinite(corners).all():
            raise ValueError("corners: expected finite numbers")
        object.__setattr__(self, "corners", tuple((float(x), float(y), float(z)) for x, y, z in corners))
        _freeze(self, "radiance", skip=("corners",))
        size = float(np.ptp(corners, axis=0).max())
        twice = self._twice_area()
        if not np.linalg.norm(twice) > 1e-12 * size**2:
            raise ValueError("corners: expected a polygon with an area")
        off = np.abs((corners - corners[0]) @ (twice / np.linalg.norm(twice))).max()
        if off > 1e-6 * size:
            raise ValueError(f"corners: expected a planar polygon, got one that is {off:.3g} off its plane")
        if _crosses_itself(corners - corners[0], twice):
            raise ValueError("corners: expected a polygon that does not cross itself")

    def _row(self) -> list[float]:
        return [6, *_packed(self.radiance, *self.corners, self.two_sided)]

    def _twice_area(self) -> NDArray[np.float64]:
        out = np.asarray(self.corners) - self.corners[0]
        return np.asarray(np.cross(out[1:-1], out[2:]).sum(0))

    @property
    def normal(self) -> Vector:
        """The unit vector to which the front points."""
        twice = self._twice_area()
        x, y, z = (float(c) + 0.0 for c in twice / np.linalg.norm(twice))
        return x, y, z

    @property
    def area(self) -> float:
        """Of one side, in m²."""
        return float(np.linalg.norm(self._twice_area())) / 2


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
        If `radiance` is not of three finite numbers, or a channel is negative.

    Notes
    -----
    `shadelab.pathtrace` sees it where rays miss everything, and shadows it; `shadelab.render` does neither.

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


Light: TypeAlias = (
    PointLight | SpotLight | DirectionalLight | RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight
)
AreaLight: TypeAlias = RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight


def _packed(*parts: Any) -> list[float]:
    """The length of what follows, then vectors and numbers, as the kernels take them: all vectors first."""
    numbers = [float(x) for part in parts for x in (part if isinstance(part, tuple) else (part,))]
    return [len(numbers), *numbers]


def _crosses_itself(corners: NDArray[np.float64], twice: NDArray[np.float64]) -> bool:
    """Whether two edges of a planar polygon that are no neighbours have a point in common."""
    axis = int(np.argmax(np.abs(twice)))
    flat = np.delete(corners, axis, 1)
    start, end = flat, np.roll(flat, -1, 0)

    def side(p: NDArray[np.float64]) -> NDArray[np.float64]:
        """On which side of edge i point j lies."""
        (ax, ay), (px, py) = (end - start).T[..., None], (p[None] - start[:, None]).transpose(2, 0, 1)
        return np.asarray(np.sign(ax * py - ay * px))

    n = len(flat)
    first, last = side(start), side(end)
    apart = np.subtract.outer(np.arange(n), np.arange(n)) % n
    crossing = (first * last < 0) & (first * last < 0).T & (apart > 1) & (apart < n - 1)
    return bool(crossing.any())


def _table(name: str, lights: Light | Sequence[Light]) -> NDArray[np.float64]:
    """Lights as numbers for the kernels: the kind of each, how many numbers follow, and these."""
    several = [lights] if isinstance(lights, Light) else list(lights)
    for light in several:
        if not isinstance(light, Light):
            raise TypeError(f"{name}: expected a light or lights, got {type(light).__name__}")
    return np.array([x for light in several for x in light._row()], np.float64)


def area_table(light: AreaLight) -> NDArray[np.float64]:
    """One light that has an area."""
    if not isinstance(light, AreaLight):
        raise TypeError(f"light: expected a light with an area, got {type(light).__name__}")
    return _table("light", light)
