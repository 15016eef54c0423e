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
    eye, target, up = (np.asarray(v, np.float64) for v in (camera.eye, camera.target, camera.up))
    forward = (target - eye) / np.linalg.norm(target - eye)
    right = np.cross(forward, up)
    right /= np.linalg.norm(right)
    height = 2 * math.tan(camera.fov_y / 2)
    step = height / size[1]
    down = -np.cross(right, forward)
    corner = forward - right * (step * size[0] / 2) - down * (height / 2)
    return tuple(tuple(float(x) for x in v) for v in (eye, corner, right * step, down * step))


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
