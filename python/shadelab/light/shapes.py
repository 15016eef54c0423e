"""Lights of other shapes: disks, spheres, polygons."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from .. import _arrays
from ._parts import _LEAST, _MOST, Vector, _freeze, _nonzero, _packed

__all__ = ["DiskLight", "PolygonLight", "SphereLight"]


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


def _crosses_itself(corners: NDArray[np.float64], twice: NDArray[np.float64]) -> bool:
    """Whether two edges of a planar polygon that are no neighbours have a point in common."""
    axis = int(np.argmax(np.abs(twice)))
    start = np.delete(corners, axis, 1)
    end, n = np.roll(start, -1, 0), len(corners)

    def straddled(edges: slice, others: slice) -> NDArray[np.bool_]:
        """Whether the ends of each of the others lie on either side of each edge's line: (edges, others)."""
        (x, y), origin = (end - start)[edges].T[..., None], start[edges, None]
        from_, to = (np.moveaxis(p[None, others] - origin, -1, 0) for p in (start, end))
        return np.asarray(np.sign(x * from_[1] - y * from_[0]) * np.sign(x * to[1] - y * to[0]) < 0)

    # So many edges at a time that memory stays small.
    every, some = slice(None), max(1, (1 << 20) // n)
    for first in range(0, n, some):
        few = slice(first, first + some)
        apart = np.subtract.outer(np.arange(n)[few], np.arange(n)) % n
        crossing = straddled(few, every) & straddled(every, few).T & (apart > 1) & (apart < n - 1)
        if crossing.any():
            return True
    return False
