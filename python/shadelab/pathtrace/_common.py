"""What the techniques of the chapter share: sizes, cameras, estimates with their errors."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .. import _arrays
from .._arrays import Floats
from ..accel import BVH

if TYPE_CHECKING:
    from ..scene import Camera

Size = tuple[int, int]

# Rays leave surfaces by this many rounding units of the largest coordinate: a point's own rounding is worth about 4.
_OFFSET = 16.0


class Estimate(NamedTuple):
    radiance: Floats
    variance: Floats
    samples: int


def merge(a: Estimate, b: Estimate) -> Estimate:
    """Two estimates of the same from different samples, as one."""
    n = a.samples + b.samples
    if a.samples == 0 or b.samples == 0:
        return b if a.samples == 0 else a
    x, y = a.radiance.astype(np.float64), b.radiance.astype(np.float64)
    mean = (a.samples * x + b.samples * y) / n
    # Sums of squares about the means; a lone sample has none.
    squares = (y - x) ** 2 * (a.samples * b.samples / n)
    for e in (a, b):
        if e.samples > 1:
            squares = squares + e.variance.astype(np.float64) * (e.samples * (e.samples - 1.0))
    dtype = a.radiance.dtype
    return Estimate(mean.astype(dtype), (squares / (n * (n - 1.0))).astype(dtype), n)


def picture_size(size: Any) -> Size:
    try:
        width, height = size
    except (TypeError, ValueError):
        raise ValueError(f"size: expected (width, height), got {size!r}") from None
    return _arrays.count("size", width, 1), _arrays.count("size", height, 1)


def pinhole(camera: Camera, size: Size) -> tuple[tuple[float, ...], ...]:
    """Eye, direction through the picture's top left corner, and its steps a pixel to the right and down."""
    # In plain numbers: arrays of three take longer than small pictures have.
    eye = tuple(map(float, camera.eye))
    forward = _unit(*(t - e for t, e in zip(map(float, camera.target), eye, strict=True)))
    right = _unit(*_cross(forward, tuple(map(float, camera.up))))
    down = _cross(forward, right)
    height = 2 * math.tan(camera.fov_y / 2)
    step = height / size[1]
    corner = (f - r * (step * size[0] / 2) - d * (height / 2) for f, r, d in zip(forward, right, down, strict=True))
    return eye, tuple(corner), tuple(r * step for r in right), tuple(d * step for d in down)


def _unit(*v: float) -> tuple[float, ...]:
    length = math.hypot(*v)
    return tuple(x / length for x in v)


def _cross(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
    return a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


Pose = tuple[tuple[tuple[float, ...], ...], tuple[tuple[float, ...], ...], float]


def _pose(camera: Camera, size: Size) -> Pose:
    """The pinhole, the lens' radii to the right and upwards, and one over the distance of focus."""
    eye, corner, right, down = pinhole(camera, size)
    radius = camera.aperture / 2
    lens = tuple(tuple(s * radius * x / math.hypot(*v) for x in v) for v, s in ((right, 1.0), (down, -1.0)))
    focus = math.dist(camera.eye, camera.target) if camera.focus_distance is None else camera.focus_distance
    return (eye, corner, right, down), lens, 1 / focus


def lens_camera(
    camera: Camera, size: Size, shutter: tuple[float, float] | None = None
) -> tuple[Pose, Pose | None, tuple[float, float]]:
    """The camera as kernels take it: how it stands at time 0 and, if it moves, at time 1; its shutter's times."""
    check_camera(camera)
    end = None if camera.end is None else _pose(camera.end, size)
    return _pose(camera, size), end, camera.shutter if shutter is None else shutter


def check_camera(camera: Any) -> Camera:
    from ..scene import Camera

    if not isinstance(camera, Camera):
        raise TypeError(f"camera: expected a Camera, got {type(camera).__name__}")
    return camera


def check_bvh(bvh: Any) -> None:
    if not isinstance(bvh, BVH):
        raise TypeError(f"bvh: expected a BVH, got {type(bvh).__name__}")


def surface_offset(positions: Floats) -> float:
    largest = float(np.abs(positions).max()) if positions.size else 0.0
    return _OFFSET * float(np.finfo(positions.dtype).eps) * largest
