"""Kinds of light: what each radiates, and where."""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, fields
from hashlib import sha256
from typing import Any, TypeAlias
from weakref import WeakKeyDictionary

import numpy as np
from numpy.typing import NDArray

from .. import _arrays
from .._arrays import Floats
from .._kernels import light as _kernels

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

# Lengths whose squares are numbers in float32; and the brightest that a channel may be.
_LEAST, _MOST, _BRIGHTEST = 1e-15, 1e15, 1e30


def _freeze(light: Any, colors: str, skip: Sequence[str] = ()) -> None:
    """Turns what a light is given into finite floats and tuples of them; `colors` names the one that is a colour."""
    for each in fields(light):
        if each.name in skip:
            continue
        value = getattr(light, each.name)
        if each.type == "bool":
            object.__setattr__(light, each.name, _arrays.flag(each.name, value))
            continue
        if each.type == "float":
            object.__setattr__(light, each.name, _arrays.number(each.name, value))
            continue
        array = _arrays.array(each.name, value)
        if array.dtype.kind not in "fiu" or array.shape != (3,):
            raise ValueError(f"{each.name}: expected three numbers, got {value!r}")
        vector = tuple(_arrays.number(each.name, x) for x in array)
        if each.name == colors and min(vector) < 0:
            raise ValueError(f"{each.name}: expected no negative channel, got {vector}")
        if each.name == colors and max(vector) > _BRIGHTEST:
            raise ValueError(f"{each.name}: expected channels of at most {_BRIGHTEST:g}, got {vector}")
        object.__setattr__(light, each.name, vector)


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
    texture : array_like, shape (H, W, 3) or (H, W), optional
        A picture by which the radiance is multiplied, up to 2048 texels a side: linear, not negative. Seen from the
        front with `edge_v` up, row 0 is at the top and column 0 at the left.

    Raises
    ------
    TypeError, ValueError
        If a vector is not of three finite numbers, an edge is not of 1e-15 to 1e15 in length, the edges are not
        perpendicular (to 1e-6), a channel is not in [0, 1e30], or a texture holds integers, negative or infinite
        numbers, or is too large.

    Notes
    -----
    With a texture radiance is constant within each texel: what `shadelab.pathtrace` sees, and draws in proportion to
    luminance. `irradiance` sums Lambert's formula over the texels (about 0.2 µs for each that differs from its
    neighbour). Closed forms of reflection (`ltc`, `shade`) take the mean colour that a lobe sees, over a few
    cells of a summed-area table (24 bytes a texel, made once for each light and precision). Over random receivers, as
    a share of the mean, that adds to the error of transformed cosines: nothing to two digits for roughness from 0.5 on
    and for diffusers 0.001 (0.01 before texels of pure noise); 0.003 at roughness 0.25 (0.04), 0.005 at 0.05 (0.1).
    Lit fractions are those of an even light, so that shadows of a picture have no colours.

    References
    ----------
    E. Heitz, J. Dupuy, S. Hill, D. Neubelt, *Real-time polygonal-light shading with linearly transformed cosines*,
    2016.

    Examples
    --------
    >>> light = RectLight((0, 2, 0), edge_u=(1, 0, 0), edge_v=(0, 0, 2), radiance=(5, 5, 5))
    >>> light.normal, light.area
    ((0.0, -1.0, 0.0), 2.0)
    >>> RectLight((0, 2, 0), (1, 0, 0), (0, 0, 2), (4, 4, 4), texture=[[0.0, 1.0]]).mean_radiance
    (2.0, 2.0, 2.0)
    """

    center: Vector
    edge_u: Vector
    edge_v: Vector
    radiance: Vector = (1.0, 1.0, 1.0)
    two_sided: bool = False
    texture: Any = field(default=None, repr=False, compare=False)
    # What tells pictures apart where lights are compared, hashed and shown.
    _content: str = field(default="", init=False)

    def __post_init__(self) -> None:
        _freeze(self, "radiance", skip=("texture", "_content"))
        if self.texture is not None:
            texture = _picture(self.texture, max(self.radiance))
            object.__setattr__(self, "texture", texture)
            object.__setattr__(self, "_content", sha256(texture.tobytes()).hexdigest()[:16] + f" {texture.shape}")
        # By hypot, since squares of what is small are none.
        lengths = [math.hypot(*e) for e in (self.edge_u, self.edge_v)]
        for name, length in zip(("edge_u", "edge_v"), lengths, strict=True):
            if not _LEAST <= length <= _MOST:
                raise ValueError(f"{name}: expected an edge of {_LEAST:g} to {_MOST:g} in length, got {length:g}")
        cosine = float(np.dot(np.divide(self.edge_u, lengths[0]), np.divide(self.edge_v, lengths[1])))
        if abs(cosine) > 1e-6:
            raise ValueError(f"edge_v: expected an edge perpendicular to edge_u, got a cosine of {cosine:g}")

    def _row(self) -> list[float]:
        kind = 2 if self.texture is None else 8
        return [kind, *_packed(self.radiance, self.center, self.edge_u, self.edge_v, self.two_sided)]

    def _shown(self, double: bool) -> Any:
        """The picture of a textured light as kernels hold it."""
        held = _PICTURES.setdefault(self, {})
        if double not in held:
            texels = np.asarray(self.texture * np.asarray(self.radiance), np.float64 if double else np.float32)
            held[double] = _kernels.light_picture(np.ascontiguousarray(texels).reshape(-1, 3), texels.shape[1])
        return held[double]

    @property
    def mean_radiance(self) -> Vector:
        """The radiance over the area, in W/(m² sr)."""
        if self.texture is None:
            return self.radiance
        r, g, b = (self.texture.mean((0, 1), dtype=np.float64) * self.radiance).tolist()
        return r, g, b

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
        If a vector is not of three finite numbers, `normal` is zero, `radius` is not in [1e-15, 1e15], or a channel
        not in [0, 1e30].

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
        _arrays.number("radius", self.radius, _LEAST, _MOST)

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
        If a vector is not of three finite numbers, `radius` is not in [1e-15, 1e15], or a channel not in [0, 1e30].

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
        _arrays.number("radius", self.radius, _LEAST, _MOST)

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
        plane by more than 1e-6 of the polygon's size, if the polygon crosses itself, or a channel is not in [0, 1e30].

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
        with np.errstate(over="ignore"):
            size = float(np.ptp(corners, axis=0).max())
        if not _LEAST <= size <= _MOST:
            raise ValueError(f"corners: expected a polygon of {_LEAST:g} to {_MOST:g} in size, got {size:g}")
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


Light: TypeAlias = (
    PointLight | SpotLight | DirectionalLight | RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight
)
AreaLight: TypeAlias = RectLight | DiskLight | SphereLight | PolygonLight | AmbientLight


_PICTURES: WeakKeyDictionary[RectLight, dict[bool, Any]] = WeakKeyDictionary()
_MOST_TEXELS = 2048


def _picture(texture: Any, scale: float) -> Floats:
    """A light's picture as a read-only array (H, W, 3)."""
    given = _arrays.image("texture", texture)
    if given.ndim == 2 or given.shape[-1] == 1:
        given = np.repeat(given.reshape(*given.shape[:2], 1), 3, -1)
    height, width, channels = given.shape
    if channels != 3 or not (1 <= height <= _MOST_TEXELS and 1 <= width <= _MOST_TEXELS):
        most = f"(H, W, 3) of 1 to {_MOST_TEXELS} a side"
        raise ValueError(f"texture: expected shape {most}, got {np.shape(texture)}")
    if not (given >= 0).all() or not float(given.max()) * scale <= _BRIGHTEST:
        raise ValueError(f"texture: expected finite numbers, not negative, and radiance of at most {_BRIGHTEST:g}")
    array = np.array(given, order="C")
    array.flags.writeable = False
    return array


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


def _several(name: str, lights: Light | Iterable[Light]) -> list[Light]:
    """One light or many, as a list."""
    try:
        several = [lights] if isinstance(lights, Light) else list(lights)
    except TypeError:
        raise TypeError(f"{name}: expected a light or lights, got {type(lights).__name__}") from None
    for light in several:
        if not isinstance(light, Light):
            raise TypeError(f"{name}: expected a light or lights, got {type(light).__name__}")
    return several


def _table(name: str, lights: Light | Sequence[Light]) -> Any:
    """Lights as numbers for the kernels: the kind of each, how many numbers follow, and these.

    With what gives the pictures of those that show some, in order.
    """
    several = _several(name, lights)
    numbers = np.array([x for light in several for x in light._row()], np.float64)
    shown = [light._shown for light in several if isinstance(light, RectLight) and light.texture is not None]
    return (numbers, shown) if shown else numbers


def area_table(light: AreaLight) -> Any:
    """One light that has an area."""
    if not isinstance(light, AreaLight):
        raise TypeError(f"light: expected a light with an area, got {type(light).__name__}")
    return _table("light", light)
