"""Cameras: where pictures are taken from, through what lens and when. Public through `shadelab.scene`."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, TypeAlias

import numpy as np
from numpy.typing import DTypeLike, NDArray

from . import _arrays, transform
from ._arrays import Floats

__all__ = ["Camera"]

Vector: TypeAlias = tuple[float, float, float]


def _triple(name: str, value: Any, low: float = -math.inf, high: float = math.inf) -> Vector:
    try:
        x, y, z = value
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected three numbers, got {value!r}") from None
    return (
        _arrays.number(name, x, low, high),
        _arrays.number(name, y, low, high),
        _arrays.number(name, z, low, high),
    )


def _interval(name: str, value: Any) -> tuple[float, float]:
    """Two times in [0, 1], in order."""
    try:
        start, end = value
    except (TypeError, ValueError):
        raise ValueError(f"{name}: expected two numbers, got {value!r}") from None
    start = _arrays.number(name, start, 0, 1)
    return start, _arrays.number(name, end, start, 1)


def _endless(value: Any) -> bool:
    """Whether a number is infinite; what is no number is not."""
    return isinstance(value, float | np.floating) and value == math.inf


@dataclass(frozen=True)
class Camera:
    """A camera: a pinhole, or a thin lens; still, or moving while its shutter is open.

    Parameters
    ----------
    eye, target : three floats
        World positions.
    up : three floats
        What should appear upwards.
    fov_y : float
        Vertical field of view in radians.
    near, far : float, optional
        Distances of the clipping planes; None means a thousandth of the distance to the target, and infinity.
    aperture : float
        Diameter of the lens in units of length; 0 is a pinhole.
    focus_distance : float, optional
        How far along the axis the plane lies that is seen sharp, maybe infinite; None means the target's distance.
    shutter : two floats in [0, 1]
        When it opens and closes: 0 is the time of `Instance.transform`, 1 that of `Instance.transform_end`.
    end : Camera, optional
        Where this one is at time 1 (its eye, target, up, angle and lens), if it moves.

    Raises
    ------
    TypeError, ValueError
        If a number is out of its domain, or the view does not exist (see `shadelab.transform.look_at`).

    Notes
    -----
    What is at distance `z` is blurred to a disk whose diameter on the plane of focus is `aperture |z − f| / z`, and in
    pixels `aperture |z − f| / (z f) · height / (2 tan(fov_y / 2))`. Rays and the path tracer know lens and shutter;
    rasterised pictures are those of the pinhole at time 0.

    Examples
    --------
    >>> camera = Camera((0, 1, 5), (0, 1, 0))
    >>> origins, directions = camera.rays((4, 3))
    >>> directions.shape
    (3, 4, 3)
    """

    eye: Vector
    target: Vector
    up: Vector = (0.0, 1.0, 0.0)
    fov_y: float = math.pi / 4
    near: float | None = None
    far: float | None = None
    aperture: float = 0.0
    focus_distance: float | None = None
    shutter: tuple[float, float] = (0.0, 1.0)
    end: Camera | None = None

    def __post_init__(self) -> None:
        set_ = object.__setattr__
        for name in ("eye", "target", "up"):
            set_(self, name, _triple(name, getattr(self, name)))
        set_(self, "fov_y", _arrays.number("fov_y", self.fov_y, above=0, below=math.pi))
        if self.near is not None:
            set_(self, "near", _arrays.number("near", self.near, above=0))
        if self.far is not None and not _endless(self.far):
            set_(self, "far", _arrays.number("far", self.far, above=self._near()))
        set_(self, "aperture", _arrays.number("aperture", self.aperture, 0))
        if self.focus_distance is not None and not _endless(self.focus_distance):
            set_(self, "focus_distance", _arrays.number("focus_distance", self.focus_distance, above=0))
        set_(self, "shutter", _interval("shutter", self.shutter))
        if self.end is not None and not isinstance(self.end, Camera):
            raise TypeError(f"end: expected a Camera, got {type(self.end).__name__}")
        self.view()

    def _near(self) -> float:
        return self.near if self.near is not None else math.dist(self.eye, self.target) * 1e-3

    def view(self) -> NDArray[np.float64]:
        """The matrix from world to eye space, (4, 4)."""
        return transform.look_at(self.eye, self.target, self.up).astype(np.float64, copy=False)

    def projection(self, aspect: float, depth: transform.Depth = "standard") -> NDArray[np.float64]:
        """The matrix from eye to clip space, (4, 4), for a picture of that width over height."""
        far = math.inf if self.far is None else self.far
        made = transform.perspective(self.fov_y, aspect, self._near(), far, depth=depth)
        return made.astype(np.float64, copy=False)

    def rays(self, size: tuple[int, int], *, dtype: DTypeLike = np.float64) -> tuple[Floats, Floats]:
        """Rays through the centres of pixels.

        Parameters
        ----------
        size : (width, height)
        dtype : data type
            float32 or float64.

        Returns
        -------
        origins, directions : ndarray, shape (height, width, 3)
            Directions are of unit length. Origins are all the eye, whatever `near` and `far`: a read-only view of one
            point.

        Raises
        ------
        TypeError, ValueError
            If the size is not of two positive integers.
        """
        width, height = (_arrays.count("size", n, 1) for n in size)
        dtype = _arrays.precision("dtype", dtype)
        right, up, back = self.view()[:3, :3]
        reach = math.tan(self.fov_y / 2)
        x = (2 * np.arange(width) + 1 - width) / height * reach
        y = (height - 1 - 2 * np.arange(height)) / height * reach
        # Directions are a sum of a row's and a column's part; so is their squared length, since axes are orthonormal.
        length = np.sqrt(1 + x * x + (y * y)[:, None])[..., None].astype(dtype)
        directions = (x[:, None] * right).astype(dtype) + (y[:, None] * up - back).astype(dtype)[:, None]
        directions /= length
        return np.broadcast_to(np.asarray(self.eye, dtype), directions.shape), directions
